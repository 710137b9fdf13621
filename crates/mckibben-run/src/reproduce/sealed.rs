//! Figs. 4–6: force over length with a constant mass of air, 0 to 15 lb and back in steps of 1 lb.

use super::files;
use super::quasi_static::SealedMuscle;
use super::units::{INCH, INSIDE, LBF, PSI, assumed};
use crate::failure::Failure;
use crate::report::{Data, Finding, Plate, Section, Table, Verdict, number};
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Panel, Series};
use mckibben_scenario::Experiment;

/// The load grows by this much from weight to weight, in lbf.
const STEP: f64 = 1.0;
/// Points of the curve between two weights.
const BETWEEN: usize = 10;

/// A point of a loop: load in N, length in m, absolute pressure in Pa.
type Point = (f64, f64, f64);

/// A loop of load and length.
struct Loop {
    psi: f64,
    points: Vec<Point>,
}

/// The section on Figs. 4–6.
pub(super) fn section() -> Result<Section, Failure> {
    let names = ["fig-04-45psi.toml", "fig-04-60psi.toml", "fig-04-75psi.toml", "fig-04-90psi.toml"];
    let experiments = names.map(files::experiment).into_iter().collect::<Result<Vec<_>, _>>()?;
    let reduced_names = ["fig-06-60psi.toml", "fig-06-90psi.toml"];
    let reduced = reduced_names.map(files::experiment).into_iter().collect::<Result<Vec<_>, _>>()?;
    let loops: Vec<Loop> = experiments.iter().map(Loop::follow).collect();
    let named: Vec<(&Experiment, &Loop)> =
        experiments.iter().zip(&loops).filter(|(_, l)| l.psi == 60.0 || l.psi == 90.0).collect();
    Ok(Section {
        id: "figs-4-6",
        label: "Figs. 4–6",
        title: "Force over length with a constant mass of air",
        paragraphs: vec![
            "The actuator is inflated, unloaded and fully contracted, to its nominal pressure and sealed; weights \
             are hung on it pound by pound up to 15 lb and taken off again. Where Coulomb friction holds the load \
             within F_s ± Q k_sec, nothing moves; beyond, the end creeps along W = F_s + Q k_sec on the way out and \
             W = F_s − Q k_sec on the way back, with the pressure that the sealed air has at each length. That \
             balance is solved exactly, in the limit of slow loading: it needs no assumption on how a weight is laid \
             down, and a simulation started at any of its points stays there."
                .into(),
            "The paper names 60 and 90 psi; 45 and 75 psi are chosen for the other two tests. The air is taken at \
             constant temperature, because hanging weights by hand takes many times longer than the air needs to \
             exchange its heat; the table shows the isentropic limit beside it."
                .into(),
            "The effectiveness of (9) was fitted to data that the paper’s text does not give. Fig. 6 here shows an \
             assumed law, 0.75 at 30 psi to 0.92 at 120 psi, as an example of what the term does."
                .into(),
        ],
        plates: vec![
            loops_plate(&loops),
            width_plate(&experiments, &loops),
            prediction_plate(&named),
            effectiveness_plate(&named, &reduced),
        ],
        tables: vec![numbers(&experiments, &loops)],
        findings: findings(&experiments, &loops, &reduced),
        files: names.iter().chain(&reduced_names).map(|name| files::shown(name)).collect::<Result<_, _>>()?,
    })
}

impl Loop {
    /// From the unloaded muscle to the scenario's weight and back.
    fn follow(experiment: &Experiment) -> Self {
        let mut muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        let heaviest = heaviest(experiment);
        let count = (heaviest / LBF / STEP * BETWEEN as f64).round() as usize;
        let loads = (0..=count).chain((0..count).rev()).map(|i| heaviest * i as f64 / count as f64);
        let points = loads.map(|load| {
            let length = muscle.load_slowly(load);
            (load, length, muscle.pressure(length))
        });
        Self { points: points.collect(), psi: nominal(experiment) }
    }

    /// The way out and the way back, each with the turning point.
    fn halves(&self) -> (&[Point], &[Point]) {
        let turn = self.points.len() / 2;
        (&self.points[..=turn], &self.points[turn..])
    }

    /// Lengths in m at a load in lbf, on the way out and on the way back.
    fn lengths_at(&self, pounds: f64) -> (f64, f64) {
        let place = (pounds / STEP * BETWEEN as f64).round() as usize;
        (self.points[place].1, self.points[self.points.len() - 1 - place].1)
    }

    /// The work lost in one round in J, by the trapezoidal rule.
    fn loss(&self) -> f64 {
        self.points.windows(2).map(|w| 0.5 * (w[0].0 + w[1].0) * (w[1].1 - w[0].1)).sum()
    }

    fn curve(&self, label: String, colour: Colour) -> Series {
        let (x, y) = (self.points.iter().map(|p| p.1 / INCH), self.points.iter().map(|p| p.0 / LBF));
        Series::line(label, x.collect(), y.collect()).colour(colour).dash(Dash::Solid)
    }
}

/// The weight of the scenario's mass in N.
fn heaviest(experiment: &Experiment) -> f64 {
    experiment.rig.load().inertia().map_or(0.0, |inertia| inertia.pull)
}

/// The nominal gauge pressure in psi.
fn nominal(experiment: &Experiment) -> f64 {
    (experiment.rig.actuator().gauge(experiment.start.pressure.0).0 / PSI * 100.0).round() / 100.0
}

fn frame(caption: String, panel: Panel) -> Figure {
    Figure::new(Axis::new("length", "in")).caption(caption).size_mm(120.0, 62.0).panel(panel)
}

fn loops_plate(loops: &[Loop]) -> Plate {
    let mut panel = Panel::new(Axis::new("force", "lbf").starting_at(0.0));
    let mut data = Data::new(&["nominal_gauge_pressure_pa", "load_n", "length_m", "absolute_pressure_pa"]);
    for (place, each) in loops.iter().enumerate() {
        let colour = Colour::Ramp(place as f64 / (loops.len() - 1) as f64);
        let weights = each.halves().0.iter().step_by(BETWEEN);
        let (x, y) = (weights.clone().map(|p| p.1 / INCH).collect(), weights.map(|p| p.0 / LBF).collect());
        panel = panel.series(each.curve(format!("{} psi", each.psi), colour));
        panel = panel.series(Series::points("", x, y).colour(colour));
        data.rows.extend(each.points.iter().map(|p| vec![each.psi * PSI, p.0, p.1, p.2]));
    }
    let caption = "Fig. 4 of the paper: load over length at four nominal pressures, out along the upper branch and \
                   back along the lower, which the paper’s Q sets only a few thousandths of an inch apart. \
                   Dots: each pound.";
    Plate { stem: "fig-04", caption: caption.into(), figure: frame(assumed(INSIDE), panel), data }
}

fn width_plate(experiments: &[Experiment], loops: &[Loop]) -> Plate {
    let mut panel = Panel::new(Axis::new("shift by friction", "10⁻³ in"));
    let mut data = Data::new(&["nominal_gauge_pressure_pa", "load_n", "length_m", "frictionless_length_m"]);
    for (place, (experiment, each)) in experiments.iter().zip(loops).enumerate() {
        let muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        let rows: Vec<[f64; 3]> = each.points.iter().map(|p| [p.0, p.1, muscle.balance(p.0)]).collect();
        data.rows.extend(rows.iter().map(|row| vec![each.psi * PSI, row[0], row[1], row[2]]));
        let x = rows.iter().map(|row| row[0] / LBF).collect();
        let y = rows.iter().map(|row| (row[1] - row[2]) / (1e-3 * INCH)).collect();
        let colour = Colour::Ramp(place as f64 / (loops.len() - 1) as f64);
        panel = panel.series(Series::line(format!("{} psi", each.psi), x, y).colour(colour).dash(Dash::Solid));
    }
    let figure = Figure::new(Axis::new("load", "lbf").starting_at(0.0).ending_at(15.0))
        .caption(assumed(INSIDE))
        .size_mm(120.0, 44.0)
        .panel(panel.legend(Legend::Above));
    let caption = "The hysteresis of the same loops: length less the length at which the same load is balanced without \
                   friction. Below zero on the way out, above on the way back; where the load turns, nothing moves.";
    Plate { stem: "fig-04-hysteresis", caption: caption.into(), figure, data }
}

fn prediction_plate(named: &[(&Experiment, &Loop)]) -> Plate {
    let mut panel = Panel::new(Axis::new("force", "lbf").starting_at(0.0).ending_at(16.0));
    let mut data = Data::new(&["nominal_gauge_pressure_pa", "length_m", "sealed_force_n", "constant_pressure_force_n"]);
    for (place, (experiment, each)) in named.iter().enumerate() {
        let colour = Colour::Category(place);
        let muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        let actuator = experiment.rig.actuator();
        let (shortest, longest) = (actuator.limits().min_length(), actuator.limits().max_length());
        let lengths: Vec<f64> = (0..=120).map(|i| shortest + (longest - shortest) * f64::from(i) / 120.0).collect();
        let sealed: Vec<f64> = lengths.iter().map(|length| muscle.frictionless(*length)).collect();
        let constant: Vec<f64> =
            lengths.iter().map(|length| actuator.static_force(*length, experiment.start.pressure.0)).collect();
        for ((length, sealed), constant) in lengths.iter().zip(&sealed).zip(&constant) {
            data.rows.push(vec![each.psi * PSI, *length, *sealed, *constant]);
        }
        // A curve ends where it leaves the loads of the experiment.
        let curve = |label: String, force: &[f64]| {
            let inside = || lengths.iter().zip(force).filter(|(_, force)| **force <= 15.5 * LBF);
            let (x, y) = (inside().map(|p| p.0 / INCH).collect(), inside().map(|p| p.1 / LBF).collect());
            Series::line(label, x, y).colour(colour)
        };
        panel = panel
            .series(each.curve(format!("{} psi: with friction", each.psi), colour))
            .series(curve(format!("{} psi: constant pressure (6)", each.psi), &constant).dash(Dash::Dotted))
            .series(curve("constant air mass (3)".into(), &sealed).colour(Colour::Neutral).dash(Dash::Dashed));
    }
    let caption = "Fig. 5 of the paper without its measurements, which are not at hand: the prediction of (3) at 60 \
                   and 90 psi with a constant mass of air, the same with the pressure kept constant, and the \
                   loop with friction.";
    Plate { stem: "fig-05", caption: caption.into(), figure: frame(assumed(INSIDE), panel), data }
}

fn effectiveness_plate(named: &[(&Experiment, &Loop)], reduced: &[Experiment]) -> Plate {
    let mut panel = Panel::new(Axis::new("force", "lbf").starting_at(0.0));
    let mut data = Data::new(&["nominal_gauge_pressure_pa", "load_n", "length_m", "length_with_effectiveness_m"]);
    for (place, ((_, ideal), experiment)) in named.iter().zip(reduced).enumerate() {
        let colour = Colour::Category(place);
        let effective = Loop::follow(experiment);
        for (a, b) in ideal.points.iter().zip(&effective.points) {
            data.rows.push(vec![ideal.psi * PSI, a.0, a.1, b.1]);
        }
        panel = panel
            .series(ideal.curve(format!("{} psi: ideal", ideal.psi), colour).dash(Dash::Dashed))
            .series(effective.curve(format!("{} psi: with Eff", ideal.psi), colour));
    }
    let caption = "Fig. 6 of the paper as an example: the loops at 60 and 90 psi without effectiveness and with an \
                   assumed law. The paper’s own law is not in its text.";
    let foot =
        format!("{} Eff here: an assumed example, 0.75 at 30 psi to 0.92 at 120 psi.", assumed(&["b", "n", "V_ext"]));
    Plate { stem: "fig-06", caption: caption.into(), figure: frame(foot, panel), data }
}

fn numbers(experiments: &[Experiment], loops: &[Loop]) -> Table {
    let mut table = Table {
        caption:
            "The loops in numbers. Width: difference of length between the way back and the way out at 8 lb; loss: \
                  work lost in one round."
                .into(),
        head: [
            "Nominal",
            "Length at 15 lb",
            "the same, isentropic",
            "Pressure at 15 lb",
            "Width at 8 lb",
            "Loss",
            "Left at 0 lb",
        ]
        .map(String::from)
        .to_vec(),
        rows: Vec::new(),
    };
    for (experiment, each) in experiments.iter().zip(loops) {
        let (_, back) = each.halves();
        let top = back[0];
        let mut quick = SealedMuscle::with_index(
            &experiment.rig,
            &experiment.start,
            experiment.rig.actuator().air().heat_capacity_ratio(),
        );
        quick.load_slowly(heaviest(experiment));
        let (out, home) = each.lengths_at(8.0);
        let (first, last) = each.lengths_at(0.0);
        let gauge = experiment.rig.actuator().gauge(top.2).0;
        let inches = |length: f64| format!("{} in", number(length / INCH, 3));
        table.rows.push(vec![
            format!("{} psi", each.psi),
            inches(top.1),
            inches(quick.length()),
            format!("{} psi", number(gauge / PSI, 1)),
            format!("{} in", number((home - out) / INCH, 4)),
            format!("{} in·lbf", number(each.loss() / (LBF * INCH), 3)),
            format!("{} in", number((last - first) / INCH, 4)),
        ]);
    }
    table
}

fn findings(experiments: &[Experiment], loops: &[Loop], reduced: &[Experiment]) -> Vec<Finding> {
    let curves = || Verdict::NotComparable("the figure’s curves are not at hand".into());
    let mut findings: Vec<Finding> = loops
        .iter()
        .map(|each| {
            let words = format!("Length at 15 lb, {} psi nominal", each.psi);
            Finding::new(words, each.lengths_at(15.0).0 / INCH, 3, "in").against("", curves())
        })
        .collect();
    let least = loops.iter().map(Loop::loss).fold(f64::INFINITY, f64::min);
    findings.push(Finding::new("Least work lost in one round", least / (LBF * INCH), 3, "in·lbf").against(
        "“closed curves … show the hysteresis of the actuators”",
        Verdict::Agrees("by friction as put in; open by Q at 0 lb, which friction holds; no area is stated".into()),
    ));
    for (experiment, full) in reduced.iter().zip(loops.iter().filter(|l| l.psi == 60.0 || l.psi == 90.0)) {
        let effective = SealedMuscle::new(&experiment.rig, &experiment.start);
        let length = full.lengths_at(8.0).0;
        let plain = experiments.iter().find(|e| nominal(e) == full.psi);
        let ratio = plain.map_or(f64::NAN, |e| {
            effective.frictionless(length) / SealedMuscle::new(&e.rig, &e.start).frictionless(length)
        });
        findings.push(
            Finding::new(format!("Force with over without effectiveness, {} psi", full.psi), ratio, 3, "").against(
                "“the model predicts a higher force output than what was measured”",
                Verdict::Input("an assumed example".into()),
            ),
        );
    }
    findings
}
