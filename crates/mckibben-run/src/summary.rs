//! What a run came to, as numbers with names.
//!
//! A name is that of a reduction of a sweep where there is one: `length.final`, `tension.max`, `air.used`. Of a plant each begins
//! with the part that it is of: `flexor.length.final`. Pressures are gauge pressures, and say so.
//!
//! Checked by the tests below, and by those of the Python package, which hold it to the columns of the run.

mod json;

use crate::closed_loop::Goal;
use crate::failure::Failure;
use crate::joint::{self, NAMES};
use crate::observation::{self, AirUse, Ended, Range};
use crate::plant::PlantFigures;
use crate::run::{Figures, ViewFigures};
use mckibben::plant::{ActuatorLedger, Balance, MechanismLedger, PlantLedger};
use mckibben::simulation::{EventKind, JointRig, Rig};
use std::collections::BTreeMap;

/// A number that a run came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its name.
    pub name: String,
    /// Its unit in SI; empty for a pure number.
    pub unit: &'static str,
    /// The number.
    pub value: f64,
}

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// The numbers, in groups: states, air, energy, exergy, control, cost.
    pub numbers: Vec<Number>,
    /// How many events of each kind there were.
    pub events: BTreeMap<&'static str, u64>,
}

impl Figures {
    /// The figures as numbers with names.
    pub fn summary(&self) -> Summary {
        match self {
            Self::Actuator(of) => of_actuator(of),
            Self::Joint(of) => of_joint(of),
            Self::Plant(of) => of_plant(of),
        }
    }
}

impl Summary {
    /// Checks that every number is finite.
    ///
    /// # Errors
    /// [`Failure::not_finite`] with the name of the first that is not.
    pub fn check(&self) -> Result<(), Failure> {
        match self.numbers.iter().find(|number| !number.value.is_finite()) {
            None => Ok(()),
            Some(number) => Err(Failure::not_finite(&format!("{} = {}", number.name, number.value))),
        }
    }

    fn put(&mut self, name: impl Into<String>, unit: &'static str, value: f64) {
        self.numbers.push(Number { name: name.into(), unit, value });
    }

    /// A quantity at the end, and its least and greatest value.
    fn range(&mut self, name: &str, unit: &'static str, last: f64, range: Range) {
        self.put(format!("{name}.final"), unit, last);
        self.put(format!("{name}.min"), unit, range.least);
        self.put(format!("{name}.max"), unit, range.greatest);
    }

    /// A gauge pressure in Pa, of an absolute one.
    fn gauge(&mut self, name: &str, last: f64, Range { least, greatest }: Range, atmosphere: f64) {
        self.range(name, "Pa", last - atmosphere, Range { least: least - atmosphere, greatest: greatest - atmosphere });
    }

    /// The air that came in through valves and where a pressure is given, if the run has one of these.
    fn air_used(&mut self, ended: &Ended) {
        if ended.draws || ended.ledger.has_given_pressure() {
            self.put("air.used", "kg", ended.ledger.air_used());
        }
    }

    fn air(&mut self, prefix: &str, air: &AirUse) {
        self.put(format!("{prefix}air.from_supply"), "kg", air.from_supply);
        self.put(format!("{prefix}air.to_exhaust"), "kg", air.to_atmosphere);
        self.put(format!("{prefix}air.to_supply"), "kg", air.to_supply);
        self.put(format!("{prefix}air.from_exhaust"), "kg", air.from_atmosphere);
    }

    /// Where the work of the gas and the exergy of the air went.
    fn ledger(&mut self, ledger: &PlantLedger, draws: bool) {
        let total = ledger.total();
        let actuators = |of: fn(&ActuatorLedger) -> f64| -> f64 { ledger.actuators.iter().map(of).sum() };
        let mechanisms = |of: fn(&MechanismLedger) -> f64| -> f64 { ledger.mechanisms.iter().map(of).sum() };
        let energy = [
            ("gas_work", total.gas_work),
            ("to_load", total.work),
            ("kinetic", mechanisms(|of| of.kinetic)),
            ("potential", mechanisms(|of| of.potential)),
            ("stored", total.elastic),
            ("viscous", actuators(|of| of.viscous)),
            ("coulomb", actuators(|of| of.coulomb)),
            ("slip", actuators(|of| of.slip)),
            ("relaxation", actuators(|of| of.branches)),
            ("exchanged", actuators(|of| of.branch_exchange)),
            ("taut_braid", actuators(|of| of.braid)),
            ("slack", actuators(|of| of.slack)),
            ("driven", mechanisms(|of| of.driven)),
            ("belt", mechanisms(|of| of.belt - of.belt_work)),
            ("joints", mechanisms(|of| of.damping + of.stops)),
            ("effectiveness", total.effectiveness_loss),
        ];
        energy.into_iter().for_each(|(name, value)| self.put(format!("energy.{name}"), "J", value));
        self.residual("energy", "J", &ledger.work());
        if !draws {
            return;
        }
        let exergy = [
            ("drawn", total.drawn),
            ("compressed", total.compressed),
            ("left_inside", total.stored),
            ("exhaust", total.exhaust),
            ("leaked", total.leaked),
            ("others", total.others),
            ("throttled", total.throttled),
            ("mixing", total.mixed),
            ("heat", total.heat_loss),
        ];
        exergy.into_iter().for_each(|(name, value)| self.put(format!("exergy.{name}"), "J", value));
        if let Some(temperature) = ledger.reference_temperature() {
            self.put("exergy.reference_temperature", "K", temperature);
        }
        self.residual("exergy", "J", &ledger.exergy());
        self.residual("air", "kg", &ledger.air());
        if let Some(efficiency) = total.efficiency() {
            self.put("exergy.efficiency", "", efficiency);
        }
    }

    fn residual(&mut self, of: &str, unit: &'static str, balance: &Balance) {
        self.put(format!("{of}.residual"), unit, balance.residual);
    }

    /// How far goals were missed.
    fn goals<'g>(&mut self, goals: impl IntoIterator<Item = (String, &'g Goal)>) {
        for (prefix, goal) in goals {
            let (miss, row) = (goal.miss(), goal.quantity.rows().set_point);
            let name = format!("{prefix}{}_error", goal.quantity.name());
            self.put(format!("{name}.rms"), row.unit, miss.rms);
            self.put(format!("{name}.peak"), row.unit, miss.largest);
        }
    }

    /// What the run cost.
    fn ended(&mut self, ended: &Ended) {
        let counts = ended.counts;
        if let Some(steps) = ended.steps {
            self.put("run.step", "s", steps.step);
            if let Some([compared, greatest]) = steps.chosen {
                self.put("run.step_error", "", greatest);
                self.put("run.step_compared", "s", compared);
            }
        }
        let counts = [
            ("steps", counts.explicit_steps + counts.implicit_steps),
            ("rejected_steps", counts.rejected_steps),
            ("evaluations", counts.evaluations),
        ];
        counts.into_iter().for_each(|(name, count)| self.put(format!("run.{name}"), "", count as f64));
    }

    fn events(&mut self, counts: &BTreeMap<EventKind, u64>) {
        self.events = counts.iter().map(|(kind, count)| (kind.name(), *count)).collect();
    }
}

fn of_actuator(of: &ViewFigures<Rig, observation::Observation>) -> Summary {
    let (mut summary, seen) = (Summary::default(), &of.observation);
    let (last, extremes) = (&seen.last, &seen.extremes);
    let (actuator, atmosphere) = (of.rig.actuator(), of.rig.actuator().air().atmosphere().0);
    let longest = actuator.limits().max_length();
    summary.range("length", "m", last.length, extremes.length);
    summary.put("contraction.final", "", (longest - last.length) / longest);
    summary.range("velocity", "m/s", last.velocity, extremes.velocity);
    summary.range("tension", "N", last.tension, extremes.tension);
    summary.gauge("gauge_pressure", last.pressure.0, extremes.pressure, atmosphere);
    summary.range("temperature", "K", last.temperature, extremes.temperature);
    summary.put("air_mass.final", "kg", last.air_mass);
    if let Some(ripple) = &seen.ripple {
        // Of a run that has not settled they would be those of a swing.
        if ripple.settled {
            summary.put("length.ripple", "m", ripple.peak_to_peak);
            summary.put("length.mean", "m", ripple.mean);
        }
        summary.put("length.settled", "", f64::from(u8::from(ripple.settled)));
        summary.put("length.travel", "m", ripple.travel);
        summary.put("length.periods", "", ripple.periods as f64);
        if let Some(drift) = ripple.drift {
            summary.put("length.drift", "m", drift);
        }
    }
    summary.air_used(&seen.ended);
    if seen.ended.draws {
        summary.air("", &seen.air);
    }
    summary.ledger(&seen.ended.ledger, seen.ended.draws);
    if let Some(closed) = &of.control {
        summary.goals(closed.goals.iter().map(|goal| (String::new(), goal)));
        summary.put("control.samples", "", closed.samples as f64);
    }
    summary.ended(&seen.ended);
    summary.events(&seen.events);
    summary
}

fn of_joint(of: &ViewFigures<JointRig, joint::observation::Observation>) -> Summary {
    let (mut summary, seen) = (Summary::default(), &of.observation);
    let last = &seen.last;
    summary.range("angle", "rad", last.angle, seen.joint[0]);
    summary.range("angular_velocity", "rad/s", last.angular_velocity, seen.joint[1]);
    summary.range("torque", "N*m", last.torque, seen.joint[2]);
    for (index, name) in NAMES.into_iter().enumerate() {
        let (its, [length, tension, pressure]) = (&last.actuators[index], seen.actuators[index]);
        let atmosphere = of.rig.driven()[index].actuator.air().atmosphere().0;
        summary.range(&format!("{name}.length"), "m", its.length, length);
        summary.range(&format!("{name}.tension"), "N", its.tension, tension);
        summary.gauge(&format!("{name}.gauge_pressure"), its.pressure.0, pressure, atmosphere);
    }
    summary.air_used(&seen.ended);
    if seen.ended.draws {
        NAMES.iter().zip(&seen.air).for_each(|(name, air)| summary.air(&format!("{name}."), air));
    }
    summary.ledger(&seen.ended.ledger, seen.ended.draws);
    if let Some(closed) = &of.control {
        let whose = |goal: &Goal| goal.whose.map_or(String::new(), |index| format!("{}.", NAMES[index]));
        summary.goals(closed.goals.iter().map(|goal| (whose(goal), goal)));
        summary.put("control.samples", "", closed.samples as f64);
    }
    summary.ended(&seen.ended);
    summary.events(&seen.events);
    summary
}

fn of_plant(of: &PlantFigures) -> Summary {
    let (mut summary, seen) = (Summary::default(), &of.observation);
    for row in seen.rows.iter().filter(|row| !row.key.is_empty()) {
        summary.range(&row.key, row.unit, row.last, row.range);
    }
    summary.air_used(&seen.ended);
    summary.ledger(&seen.ended.ledger, seen.ended.draws);
    if let Some(closed) = &of.control {
        let named = closed.names.iter().zip(&closed.goals);
        summary.goals(named.map(|(name, goal)| (format!("{name}."), goal)));
        summary.put("control.samples", "", closed.samples.iter().sum::<u64>() as f64);
    }
    summary.ended(&seen.ended);
    summary.events(&seen.events);
    summary
}

#[cfg(test)]
mod tests {
    use crate::record::Values;
    use crate::run::Ready;
    use crate::settle::End;
    use crate::sweep::rows::{Outcome, UNCHECKED, simulate_rows};
    use crate::units::ending;
    use mckibben_scenario::Document;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// Of one actuator, a joint, a plant with controllers: every number is finite and has a unique name, and the energy
    /// closes.
    #[test]
    fn every_kind_of_run_has_numbers_with_names() {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let cases = [
            ("paper/fig-12", "length.settled"),
            ("antagonistic-joint", "agonist.gauge_pressure.max"),
            ("plant/controlled", "air.used"),
        ];
        for (file, known) in cases {
            let path = examples.join(format!("{file}.toml"));
            let mut document = Document::load(&path).unwrap();
            document.set_text("run.duration", "\"0.2 s\"").unwrap();
            let finished = Ready::of(&document).unwrap().run(&document, End::Duration, &mut |_| Ok(())).unwrap().0;
            let summary = finished.figures().unwrap().summary();
            let names: BTreeSet<&str> = summary.numbers.iter().map(|number| number.name.as_str()).collect();
            assert_eq!(names.len(), summary.numbers.len(), "{file}");
            assert!(names.contains(known), "{file}: {names:?}");
            assert!(summary.numbers.iter().all(|number| number.value.is_finite()), "{file}");
            let value = |name: &str| summary.numbers.iter().find(|number| number.name == name).unwrap().value;
            assert!(value("energy.residual").abs() < 1e-6 * value("energy.gas_work").abs().max(1e-3), "{file}");
            let sum = |of: &str, names: &str| names.split(' ').map(|name| value(&format!("{of}.{name}"))).sum::<f64>();
            let sinks =
                "to_load stored viscous coulomb slip relaxation exchanged taut_braid slack effectiveness residual";
            assert!((value("energy.gas_work") - sum("energy", sinks)).abs() < 1e-9, "{file}");
            let parts = "kinetic potential joints belt driven";
            let load = value("energy.to_load");
            assert!((load - sum("energy", parts)).abs() < 1e-6 * load.abs().max(1e-3), "{file}");
            let ends = "left_inside exhaust leaked others throttled mixing heat residual";
            let supplied = sum("exergy", "drawn compressed");
            assert!((supplied - value("energy.gas_work") - sum("exergy", ends)).abs() < 1e-9 * supplied, "{file}");
            assert!(value("air.residual").abs() < 1e-6 * value("air.used").abs().max(1e-9), "{file}");
        }
    }

    /// A muscle that is filled takes up the air that it holds at the end, through however many manifolds it came.
    #[test]
    fn air_that_comes_through_manifolds_is_used_once() {
        let manifold = |name: &str, from: &str| {
            format!(
                "[supplies.{name}]\nfrom = \"{from}\"\nreservoir_volume = \"20 cm^3\"\ninlet.flow_area = \"5 mm^2\"\n"
            )
        };
        let [first, second] = [manifold("one", "supply"), manifold("two", "one")];
        let used = [("supply", String::new()), ("one", first.clone()), ("two", first + &second)].map(|(feed, manifolds)| {
            let text = format!(
                "[supply]\ngauge_pressure = \"4 bar\"\n{manifolds}[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
                 [command]\nkind = \"fill\"\n[air]\nprocess = \"isothermal\"\n[load]\nkind = \"isometric\"\n\
                 [initial]\nlength = \"9 cm\"\n[actuators.a]\npreset = \"colbrunn-2001\"\nsupply = \"{feed}\"\n\
                 [run]\nduration = \"2 s\"\n"
            );
            let document = Document::parse(&text, "fill.toml").unwrap();
            let finished = Ready::of(&document).unwrap().run(&document, End::Duration, &mut |_| Ok(())).unwrap().0;
            let numbers = finished.figures().unwrap().summary().numbers;
            numbers.iter().find(|number| number.name == "air.used").unwrap().value
        });
        assert!(used[0] > 3e-5 && used.iter().all(|its| (its / used[0] - 1.0).abs() < 1e-6), "{used:?}");
    }

    /// The number of a name of the run of a text; none where it has none.
    fn number_of(text: &str, name: &str) -> Option<f64> {
        let document = Document::parse(text, "file.toml").unwrap();
        let finished = Ready::of(&document).unwrap().run(&document, End::Duration, &mut |_| Ok(())).unwrap().0;
        let numbers = finished.figures().unwrap().summary().numbers;
        numbers.iter().find(|number| number.name == name).map(|number| number.value)
    }

    /// The atmosphere is as warm as the coldest supply, in whatever order the file has them.
    #[test]
    fn exergy_does_not_depend_on_the_order_of_supplies() {
        let part = |name: &str, kelvin| {
            format!("[supplies.{name}]\ngauge_pressure = \"4 bar\"\ntemperature = \"{kelvin} K\"\n")
        };
        let [hot, cold] = [part("hot", 330), part("cold", 270)];
        let of = |supplies: String, name: &str| {
            let text = format!(
                "{supplies}[air]\nprocess = \"energy-balance\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
                 [command]\nkind = \"fill\"\n[load]\nkind = \"isometric\"\n[initial]\nlength = \"3.4 in\"\n\
                 [actuators.a]\npreset = \"colbrunn-2001\"\nsupply = \"hot\"\n\
                 [actuators.b]\npreset = \"colbrunn-2001\"\nsupply = \"cold\"\n[run]\nduration = \"0.1 s\"\n"
            );
            number_of(&text, name).unwrap()
        };
        for name in ["exergy.drawn", "exergy.left_inside", "exergy.throttled", "exergy.mixing"] {
            let [one, other] = [format!("{hot}{cold}"), format!("{cold}{hot}")].map(|supplies| of(supplies, name));
            assert!(one > 0.0 && (one / other - 1.0).abs() < 1e-6, "{name}: {one} and {other}");
        }
        assert_eq!(of(format!("{hot}{cold}"), "exergy.reference_temperature"), 270.0);
    }

    /// A muscle whose pressure is given takes in air as one with a valve does: alone, with a name, behind a hose and together with a
    /// valve, in the summary and in a sweep.
    #[test]
    fn air_that_comes_in_at_a_given_pressure_is_used() {
        let pressure = "pressure = { time = [\"0 s\", \"0.1 s\"], gauge_pressure = [\"0 bar\", \"2 bar\"] }\n";
        let valve = "supply = { gauge_pressure = \"4 bar\" }\nvalve = { kind = \"two-way\", flow_area = \"1 mm^2\" }\n\
                     command = { kind = \"fill\" }\n";
        let hose =
            pressure.replace("{ time", "{ at = \"hose\", time") + "hose = { length = \"1 m\", diameter = \"2 mm\" }\n";
        let common = "load = { kind = \"isometric\" }\ninitial = { length = \"3.4 in\" }\n\
                      run = { duration = \"0.3 s\", engine = \"event-located\" }\nactuator = { preset = \"colbrunn-2001\" }\n";
        let named = |name: &str, its: &str| format!("[actuators.{name}]\n{its}");
        let used = |parts: &[&str]| {
            let text = format!("{common}{}", parts.concat());
            let used = number_of(&text, "air.used").unwrap();
            let vary = "[sweep]\nreductions = [\"air.used\"]\n[sweep.vary]\n\"air.heat_capacity_ratio\" = [1.4]\n";
            let sweep = Document::parse(&format!("{text}{vary}"), "sweep.toml").unwrap().sweep().unwrap().unwrap();
            let rows = simulate_rows(&sweep, None, 0..1, UNCHECKED).unwrap();
            let [Outcome::Reduced(values)] = &rows.outcomes[..] else { panic!("{rows:?}") };
            assert!((values[0].unwrap() / used - 1.0).abs() < 1e-9, "{values:?} for {used} kg");
            used
        };
        let [given, drawn, behind] = [pressure, valve, hose.as_str()].map(|its| used(&[&named("p", its)]));
        let [alone, both] = [used(&[pressure]), used(&[&named("p", pressure), &named("v", valve)])];
        assert!(given > 5e-6 && drawn > given, "{given} and {drawn} kg");
        // At the end the muscle has the pressure that is given in front of the hose.
        assert!((behind / given - 1.0).abs() < 1e-3, "{behind} for {given} kg");
        assert!((alone / given - 1.0).abs() < 1e-6, "{alone} for {given} kg");
        assert!((both / (given + drawn) - 1.0).abs() < 1e-5, "{both} for {given} + {drawn} kg");
    }

    /// A load that swings under pulses: friction jumps where the velocity turns, and its tension has its peak just before.
    const SWING: &str = "[supply]\ngauge_pressure = \"6.313 bar\"\n[actuator]\npreset = \"colbrunn-2001\"\n\
                         friction.viscoelastic = { relaxation_time = [\"20 ms\"], stiffness_ratio = [0.2] }\n\
                         [valve]\nkind = \"three-way\"\nflow_area = \"1.8 mm^2\"\nopening_delay = \"2.371 ms\"\n\
                         [command]\nkind = \"pwm\"\nfrequency = \"38.57 Hz\"\nduty = 0.5094\n\
                         [load]\nkind = \"hanging-mass\"\nmass = \"4.525 kg\"\n[actuators.a]\n\
                         [initial]\ngauge_pressure = \"0.7014 bar\"\n[run]\nduration = \"0.15 s\"\n";

    /// No sample lies outside the extremes, nor does what stands just before an event. The interval of the samples divides none of
    /// those at which the observers would read without it.
    #[test]
    fn extremes_contain_every_sample_and_both_sides_of_every_event() {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let load = |file: &str| Document::load(examples.join(file)).unwrap();
        let cases = [
            ("a plant", Document::parse(SWING, "swing.toml").unwrap()),
            ("one", load("paper/fig-12.toml")),
            ("a joint", load("antagonistic-joint.toml")),
            ("a chain", load("plant/arm.toml")),
        ];
        for (case, mut document) in cases {
            document.set_text("run.duration", "\"0.15 s\"").unwrap();
            document.set_text("run.sample_interval", "\"0.1 ms\"").unwrap();
            let finished = Ready::of(&document).unwrap().run(&document, End::Duration, &mut |_| Ok(())).unwrap().0;
            let numbers = finished.figures().unwrap().summary().numbers;
            let value = |name: &str| numbers.iter().find(|number| number.name == name).unwrap().value;
            let before: Vec<f64> = finished.log().times.iter().map(|time| time * (1.0 - 1e-12)).collect();
            let mut compared = 0;
            for (columns, part) in [(finished.columns(), 0.0), (finished.columns_at(&before), 1e-9)] {
                for column in columns.unwrap() {
                    let Values::Numbers(values) = column.values else { continue };
                    let is_it = |name: &str, unit| format!("{name}{}", ending(unit)) == column.name;
                    let of = |number: &&super::Number| {
                        number.name.strip_suffix(".max").is_some_and(|name| is_it(name, number.unit))
                    };
                    let Some(number) = numbers.iter().find(of) else { continue };
                    let name = number.name.trim_end_matches(".max");
                    let [least, greatest] = ["min", "max"].map(|end| value(&format!("{name}.{end}")));
                    let near = part * least.abs().max(greatest.abs());
                    let outside = values.iter().find(|value| **value < least - near || **value > greatest + near);
                    assert_eq!(outside, None, "{case}: {name} from {least} to {greatest}");
                    compared += 1;
                }
            }
            assert!(compared >= 6, "{case}: {compared}");
        }
    }

    /// A muscle with a name used as much air as it does without: what its valve let in, whatever stands behind that.
    #[test]
    fn the_air_that_is_used_is_what_valves_let_in() {
        let used = |file: &str, actuators: &str| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
            // What muscles alike draw beside this one is no air of it, and a plant has none of them.
            let text = std::fs::read_to_string(path).unwrap().replace("actuators = 4\n", "") + actuators;
            let mut document = Document::parse(&text, "file.toml").unwrap();
            document.set_text("run.duration", "\"0.5 s\"").unwrap();
            let finished = Ready::of(&document).unwrap().run(&document, End::Duration, &mut |_| Ok(())).unwrap().0;
            let numbers = finished.figures().unwrap().summary().numbers;
            numbers.iter().find(|number| number.name == "air.used").unwrap().value
        };
        for file in
            ["line/tank.toml", "paper/fig-12.toml", "valves/pressure-regulator.toml", "valves/proportional-spool.toml"]
        {
            let (alone, named) = (used(file, ""), used(file, "\n[actuators.muscle]\n"));
            assert!(alone > 1e-6 && (named - alone).abs() < 1e-6 * alone, "{file}: {named} for {alone} kg");
        }
    }
}
