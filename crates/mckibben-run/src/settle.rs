//! Where a run settles: `simulate --settle` goes on behind its end to the periodic orbit, and reports what repeats there.
//!
//! The orbit is found by [`mckibben::plant::PlantRun::settle`]; here it is read, column by column, over one period. Its mean and
//! its ripple are those that a run of many hundred periods would come to, without the swing of the start in them.
//!
//! Checked by the tests below, and by the program's `tests/settle.rs`.

use crate::closed_loop::Goals;
use crate::engine::{self, Reached, Stepping, Subject};
use crate::failure::Failure;
use crate::joint::pair::Pair;
use crate::plant;
use crate::progress::Progress;
use crate::quantities::{counted, given};
use crate::record::Field;
use crate::run::Ready;
use crate::single_actuator::SingleActuator;
use crate::table::{Cell, Kind};
use crate::units::stem;
use crate::warnings::Warning;
use mckibben::Error;
use mckibben::plant::{Orbit, PlantRun, PlantSample, PlantView};
use mckibben::simulation::{Readable as _, Reading};
use mckibben_scenario::{Document, PlantExperiment, Run};
use std::convert::Infallible;

/// Instants of a period at which it is read at least.
const POINTS: u32 = 1000;
/// Periods after which the search for an orbit ends.
pub const MOST_PERIODS: u64 = 3000;
/// The interval in s at which a plant without pulses is looked at.
const LOOK: f64 = 0.05;
/// Columns of a run that say nothing about an orbit, or twice.
const LEFT_OUT: [&str; 2] = ["time", "absolute_pressure"];

/// What repeats on the orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// How the run came there, or that it did not.
    pub orbit: Orbit,
    /// Each column of numbers over a period; none where the run has not settled.
    pub rows: Vec<Settling>,
}

/// A column over a period of the orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Settling {
    /// The name of the column without its unit, such as `length` or `flexor.gauge_pressure`.
    pub name: String,
    /// Its unit in SI.
    pub unit: String,
    /// Mean over a period.
    pub mean: f64,
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub greatest: f64,
}

impl Settling {
    /// Greatest less least value; zero where that is no more than what the search leaves.
    pub fn ripple(&self) -> f64 {
        const LEFT: f64 = 1e-7;
        let ripple = self.greatest - self.least;
        if ripple > LEFT * self.greatest.abs().max(self.least.abs()) { ripple } else { 0.0 }
    }
}

impl Ready {
    /// Runs it, and goes on behind the end to its periodic orbit, or its equilibrium where nothing is pulsed. `reached` is called with
    /// the time in s now and then, and may end it by an error such as [`Error::Interrupted`].
    ///
    /// # Errors
    /// [`Failure::input`] where pulses have no common period; what the core finds, shown in the document; and those of `reached`.
    pub fn settle(self, document: &Document, reached: &mut Reached<'_>) -> Result<Settled, Failure> {
        let settled = match self {
            Self::Actuator(of) => of_subject(&SingleActuator::from(&*of), reached),
            Self::Controlled(of) => of_subject(&SingleActuator::from(&*of), reached),
            Self::Joint(of) => of_subject(&Pair::from(&*of), reached),
            Self::ControlledJoint(of) => of_subject(&Pair::from(&*of), reached),
            Self::Plant(of) => of_plant(&of, reached),
        };
        settled.map_err(|error| Failure::of_core(&error, document))
    }
}

/// Runs a subject to its orbit, and keeps nothing on the way.
fn of_subject<S: Subject>(of: &S, reached: &mut Reached<'_>) -> Result<Settled, Error> {
    let view = of.view()?;
    let stepping = Stepping::of(of.plan(), || of.stepping())?;
    let goals = Goals::new(of.goals().unwrap_or_default().into());
    let (end, _) = engine::stream(of, (&view, stepping.how), &goals, &mut |step| reached(step.end()))?;
    let fields = S::fields(view.rig(), &Goals::default());
    read((end.run, of.plan()), &fields, |sample| view.sample(sample), reached)
}

/// Runs a plant to its orbit, and keeps nothing on the way.
fn of_plant(of: &PlantExperiment, reached: &mut Reached<'_>) -> Result<Settled, Error> {
    let mut follower = plant::control::Follower::new(of);
    let made = plant::stream(of, &mut follower, &mut |step| reached(step.end()))?;
    let fields = plant::columns::fields(of, &Goals::default(), &[]);
    read((made.run, &of.run), &fields, PlantSample::clone, reached)
}

/// Why a run that did not settle has no numbers of an orbit, as a warning of it; none where it settled.
pub(crate) fn unsettled(orbit: &Orbit) -> Option<Warning> {
    let Orbit { period, periods, residual, settled, .. } = orbit;
    let text = || {
        format!(
            "the run has no orbit, and so no statistics over one: after {} of {} behind its end the states still change \
             by {residual:.1e} of their size a period; take a longer `run.duration` or more damping, or statistics over \
             the run",
            counted(*periods, "period"),
            given(*period, "s"),
        )
    };
    (!settled).then(|| Warning { code: "not-settled", part: String::new(), text: text() })
}

/// Where a run ends.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum End {
    /// At `run.duration`.
    #[default]
    Duration,
    /// At `run.duration` as far as it is observed and written; it goes on behind that to its orbit, which is read.
    Orbit,
}

impl End {
    /// Goes on with a run from its end, where that is wanted.
    ///
    /// # Errors
    /// What the core finds.
    pub(crate) fn go_on<T>(
        self,
        (run, plan): (PlantRun, &Run),
        fields: &[Field<T>],
        sample: impl Fn(&PlantSample) -> T,
    ) -> Result<Option<Settled>, Error> {
        match self {
            Self::Duration => Ok(None),
            Self::Orbit => read((run, plan), fields, sample, &mut |_| Ok(())).map(Some),
        }
    }
}

/// Takes a run from its end to its orbit: by the event-located engine, also where it took fixed steps.
///
/// # Errors
/// What the core finds.
pub(crate) fn to_orbit(run: &mut PlantRun, plan: &Run) -> Result<Orbit, Error> {
    watched_to_orbit(run, plan, &mut |_| Ok(()))
}

/// Takes a run to its orbit as [`to_orbit`] does; `reached` is called with the time in s behind each period, and may end it.
fn watched_to_orbit(run: &mut PlantRun, plan: &Run, reached: &mut Reached<'_>) -> Result<Orbit, Error> {
    run.set_stepping(plan.relative_tolerance)?;
    let progress = Progress::begin("settling", Some(MOST_PERIODS));
    let mut periods = 0;
    run.settle(LOOK, MOST_PERIODS, &mut |time| {
        periods += 1;
        progress.at(periods);
        reached(time)
    })
}

/// A sample of a run on its orbit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnOrbit<'s> {
    /// The period that it is of, from 0.
    pub(crate) period: u32,
    /// Its weight in s in an integral over time; zero where it is only looked at.
    pub(crate) weight: f64,
    pub(crate) sample: &'s PlantSample,
}

/// Takes a run that has settled through periods of its orbit, and hands on samples: at the Gauss points of each step, which integrate
/// what jumps between two steps without an error, at both ends of each step, and at [`POINTS`] instants of each period. The last is
/// at the end of the last period.
///
/// # Errors
/// What the core finds.
pub(crate) fn over_periods(
    run: &mut PlantRun,
    period: f64,
    periods: u32,
    each: &mut dyn FnMut(OnOrbit<'_>),
) -> Result<(), Error> {
    let start = run.time();
    for index in 0..periods {
        let [from, until] = [index, index + 1].map(|count| start + period * f64::from(count));
        let times = (1..POINTS).map(|point| from + (until - from) * f64::from(point) / f64::from(POINTS));
        let mut reading = Reading::new(times, until);
        let mut see = |weight, sample: &PlantSample| each(OnOrbit { period: index, weight, sample });
        run.stream_to(until, &mut |step| {
            step.quadrature(&mut see);
            let Ok(()) = reading.step(step, |sample: &PlantSample| {
                see(0.0, sample);
                Ok::<_, Infallible>(())
            });
            // What is passed within an instant has no place in the period.
            if step.holds(step.start()) {
                [step.start(), step.end()].into_iter().for_each(|time| see(0.0, &step.read(time)));
            }
            Ok(())
        })?;
        see(0.0, &run.sample());
    }
    Ok(())
}

/// Goes on from the end of a run to the orbit, and reads the columns over a period of it.
fn read<T>(
    (mut run, plan): (PlantRun, &Run),
    fields: &[Field<T>],
    sample: impl Fn(&PlantSample) -> T,
    reached: &mut Reached<'_>,
) -> Result<Settled, Error> {
    let orbit = watched_to_orbit(&mut run, plan, reached)?;
    if !orbit.settled {
        return Ok(Settled { orbit, rows: Vec::new() });
    }
    let is_shown = |field: &&Field<T>| {
        let name = stem(&field.column.name, &field.column.unit);
        field.column.kind == Kind::Number && !LEFT_OUT.contains(&name.rsplit('.').next().unwrap_or(name))
    };
    let fields: Vec<&Field<T>> = fields.iter().filter(is_shown).collect();
    let row = |field: &&Field<T>| Settling {
        name: stem(&field.column.name, &field.column.unit).to_owned(),
        unit: field.column.unit.clone(),
        mean: 0.0,
        least: f64::INFINITY,
        greatest: f64::NEG_INFINITY,
    };
    let mut rows: Vec<Settling> = fields.iter().map(row).collect();
    over_periods(&mut run, orbit.period, 1, &mut |OnOrbit { weight, sample: seen, .. }| {
        let seen = sample(seen);
        for (field, row) in fields.iter().zip(&mut rows) {
            let Cell::Number(value) = (field.cell)(&seen) else { continue };
            row.mean += weight / orbit.period * value;
            row.least = row.least.min(value);
            row.greatest = row.greatest.max(value);
        }
    })?;
    // A mean of equal values may miss them by a rounding.
    rows.iter_mut().for_each(|row| row.mean = row.mean.clamp(row.least, row.greatest));
    Ok(Settled { orbit, rows })
}

/// Pulses at fixed length, on whose orbit the flow jumps where ports open and close.
#[cfg(test)]
pub(crate) const PULSED: &str = "[supply]\ngauge_pressure = \"5 bar\"\n[valve]\nkind = \"three-way\"\nsonic_conductance = \"0.02 L/(s*bar)\"\n\
                          critical_ratio = 0.3\nopening_delay = \"2.013 ms\"\nclosing_delay = \"1.377 ms\"\n[command]\n\
                          kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5\n[load]\nkind = \"isometric\"\n\
                          [initial]\ngauge_pressure = \"1 bar\"\nlength = \"85 mm\"\n[run]\nduration = \"0.2 s\"\n";

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Of one actuator, a joint and a plant: what settles has finite rows with names of their own, and a hanging mass on its orbit
    /// is pulled by its weight on average.
    #[test]
    fn every_kind_of_run_settles() {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        for (file, known) in
            [("paper/fig-12", "tension"), ("antagonistic-joint", "angle"), ("plant/arm", "elbow.angle")]
        {
            let document = Document::load(examples.join(format!("{file}.toml"))).unwrap();
            let settled = Ready::of(&document).unwrap().settle(&document, &mut |_| Ok(())).unwrap();
            assert!(settled.orbit.settled, "{file}: {:?}", settled.orbit);
            let names: std::collections::BTreeSet<&str> = settled.rows.iter().map(|row| row.name.as_str()).collect();
            assert_eq!(names.len(), settled.rows.len(), "{file}");
            let row = settled.rows.iter().find(|row| row.name == known);
            let row = row.unwrap_or_else(|| panic!("{file}: {names:?}"));
            assert!(settled.rows.iter().all(|row| (row.least..=row.greatest).contains(&row.mean)), "{file}");
            if known == "tension" {
                let weight = 5.0 * 0.453_592_37 * 9.80665;
                assert!((row.mean - weight).abs() < 1e-3 * weight, "{row:?} for {weight} N");
            }
        }
    }

    /// Pulses at fixed length: the flow jumps where ports open and close, and on the orbit as much air leaves as comes, so its mean is
    /// zero but for what the search leaves. Of a thousand points that see no jump it would be off by half of a thousandth of the jumps.
    #[test]
    fn the_mean_of_what_jumps_is_exact() {
        for more in ["", "[actuators.a]\n"] {
            let document = Document::parse(&format!("{PULSED}{more}"), "pulsed.toml").unwrap();
            let settled = Ready::of(&document).unwrap().settle(&document, &mut |_| Ok(())).unwrap();
            let row = |name: &str| settled.rows.iter().find(|row| row.name.ends_with(name)).unwrap().clone();
            let (flow, mass) = (row("mass_flow"), row("air_mass"));
            assert!(flow.ripple() > 1e-4 && mass.ripple() > 1e-7, "{flow:?} {mass:?}");
            assert!(flow.mean.abs() < 2e-5 * flow.ripple(), "{flow:?}");
        }
    }

    /// A run without an orbit says so with its period and what still changes.
    #[test]
    fn a_run_that_does_not_settle_has_a_warning() {
        let orbit = Orbit { period: 0.04, periods: 3000, guesses: 0, residual: 2e-3, settled: false };
        let warning = unsettled(&orbit).expect("a warning");
        assert!(warning.code == "not-settled" && warning.text.contains("3000 periods of 40 ms"), "{warning}");
        assert_eq!(unsettled(&Orbit { settled: true, ..orbit }), None);
    }

    /// What `reached` fails by ends it: on the way to the end of the run, and behind it.
    #[test]
    fn it_can_be_interrupted_before_and_behind_the_end_of_the_run() {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        for file in ["paper/fig-12", "antagonistic-joint", "plant/arm"] {
            let document = Document::load(examples.join(format!("{file}.toml"))).unwrap();
            let end = Ready::of(&document).unwrap().plan().duration;
            for until in [0.5 * end, end * (1.0 + 1e-9)] {
                let mut last = 0.0;
                let settled = Ready::of(&document).unwrap().settle(&document, &mut |time| {
                    last = time;
                    if time > until { Err(Error::Interrupted { time }) } else { Ok(()) }
                });
                assert!(settled.is_err() && last > until, "{file}: {last} s of {until} s");
            }
        }
    }
}
