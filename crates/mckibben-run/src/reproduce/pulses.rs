//! Figs. 11–13: a mass moved by a pulsed valve, 100 psi, 1, 5 and 15 lb, at 25 Hz and, as the text says, at 50 Hz.
//!
//! The ripple is the largest minus the smallest length over the last 0.4 s, which are whole periods at both
//! frequencies. A light mass is thrown at first, because (10) lets it fly while the tendon is slack. How high and how
//! often depends on the volume of the hose, which the paper does not give, so that is varied. Were the tendon still
//! slack in the last 0.4 s, there would be no ripple to speak of, and none would be reported.

use super::files;
use super::units::{ALL, INCH, LB, assumed};
use crate::failure::Failure;
use crate::report::{Data, Finding, Plate, Section, Table, Verdict, number};
use mckibben_plot::{Axis, Colour, Dash, Figure, Panel, Series};
use mckibben_scenario::Experiment;

/// The interval at the end over which the ripple is measured, in s, and the interval between its samples.
const TAIL: f64 = 0.4;
const FINE: f64 = 1e-4;
/// How much of the tail is drawn, in s, and how much of the beginning: more where the mass is thrown.
const DRAWN: f64 = 0.2;
const BEGINNING: f64 = 2.0;
const BEGINNING_THROWN: f64 = 6.0;
/// Volumes of the hose in cm³ with which Fig. 11 is repeated; the first is the assumed one.
const HOSES: [f64; 4] = [3.0, 10.0, 20.0, 40.0];

/// The files of a figure: 25 Hz, 50 Hz.
const FIGURES: [(&str, &str, [&str; 2]); 3] = [
    ("fig-11", "Fig. 11", ["fig-11.toml", "fig-11-50hz.toml"]),
    ("fig-12", "Fig. 12", ["fig-12.toml", "fig-12-50hz.toml"]),
    ("fig-13", "Fig. 13", ["fig-13.toml", "fig-13-50hz.toml"]),
];
/// Half the range of a panel of what settles, in ripples, and at least in inches.
const SETTLED: f64 = 1.5;
const LEAST_SETTLED: f64 = 0.02;
const FREQUENCIES: [f64; 2] = [25.0, 50.0];

/// One simulated experiment.
struct Pulsed {
    pounds: f64,
    /// Rows of time, length, velocity, pressure, valve open.
    rows: Vec<Vec<f64>>,
    /// Time and length in the tail.
    tail: Vec<(f64, f64)>,
    /// The shortest length of the actuator in m: below, the tendon is slack.
    min_length: f64,
}

/// The section on Figs. 11–13.
pub(super) fn section() -> Result<Section, Failure> {
    let mut pairs = Vec::new();
    let mut inputs = Vec::new();
    for (_, _, names) in FIGURES {
        let pair = names.map(|name| files::experiment(name).and_then(|e| Pulsed::simulate(&e)));
        let [slow, fast] = pair;
        pairs.push([slow?, fast?]);
        for name in names {
            inputs.push(files::shown(name)?);
        }
    }
    let hoses = HOSES.map(with_hose).into_iter().collect::<Result<Vec<_>, _>>()?;
    let figures = FIGURES.iter().zip(&pairs);
    let mut plates: Vec<Plate> = figures.map(|((stem, label, _), pair)| plate(stem, label, pair)).collect();
    plates.insert(1, hoses_plate(&hoses));
    plates.push(ripples(&pairs));
    Ok(Section {
        id: "figs-11-13",
        label: "Figs. 11–13",
        title: "A mass moved by a pulsed valve",
        paragraphs: vec![
            "The valve joins the muscle to 100 psi and to the atmosphere in turn, 50 % commanded at 25 Hz, and \
             lifts 1, 5 and 15 lb from rest on the taut braid. Where the paper set the simulated duty to the \
             measured 43 % and 35 %, the delays of the valve do it here (42.5 % and 35 %). The efficiency of the \
             flow is the paper’s 85 %."
                .into(),
            "The paper’s text states one thing about these curves that can be checked without them: at 50 Hz “the high \
             frequency vibration is of a lower magnitude”. So it is here at all three loads."
                .into(),
            "At 1 lb the simulated muscle at first throws the mass: one pulse accelerates it to more than 2 m/s, the \
             tendon goes slack below L_min, and by (10) nothing holds it until it falls back. The model has no \
             ceiling, so the mass even passes the upper attachment (length below zero), where a real one would \
             strike. That is the model as the paper writes it, started from rest with the assumed hose volume of 3 \
             cm³; a larger volume slows the rise of pressure, and the throws are lower and fewer. After them the \
             mass hangs on the muscle with a ripple like the others. The real rig had hoses whose losses the paper \
             names as not modelled, so nothing follows from this for its Fig. 11."
                .into(),
        ],
        plates,
        tables: vec![table(&pairs), hoses_table(&hoses)],
        findings: findings(&pairs),
        files: inputs,
    })
}

impl Pulsed {
    fn simulate(experiment: &Experiment) -> Result<Self, Failure> {
        let run = files::run(experiment)?;
        let rows = run.samples(experiment.run.sample_interval).map(|s| {
            let open = if s.ports.supply { 1.0 } else { 0.0 };
            vec![s.time, s.length, s.velocity, s.pressure.0, open]
        });
        let end = run.duration();
        let count = (TAIL / FINE).round() as usize;
        let tail = (0..=count).map(|i| {
            let time = end - TAIL + i as f64 * FINE;
            (time, run.at(time).length)
        });
        let mass = experiment.rig.load().inertia().map_or(f64::NAN, |inertia| inertia.mass);
        Ok(Self {
            pounds: (mass / LB * 1e6).round() / 1e6,
            rows: rows.collect(),
            tail: tail.collect(),
            min_length: experiment.rig.actuator().limits().min_length(),
        })
    }

    /// Whether a length in m is deeper in the slack than a touch.
    fn is_slack(&self, length: f64) -> bool {
        length < self.min_length - 1e-4
    }

    /// Whether the mass flies in the tail.
    fn is_thrown(&self) -> bool {
        self.tail.iter().any(|(_, x)| self.is_slack(*x))
    }

    /// The last time in s at which the tendon is slack; zero when it never is.
    fn last_slack(&self) -> f64 {
        self.rows.iter().rev().find(|row| self.is_slack(row[1])).map_or(0.0, |row| row[0])
    }

    /// The smallest length of all in m.
    fn highest(&self) -> f64 {
        self.rows.iter().map(|row| row[1]).fold(f64::INFINITY, f64::min)
    }

    /// The ripple in inches as words, or that there is none.
    fn ripple_words(&self) -> String {
        if self.is_thrown() { "thrown".into() } else { format!("{} in", number(self.ripple() / INCH, 4)) }
    }

    /// The rows of the beginning, for a figure.
    fn beginning(&self) -> &[Vec<f64>] {
        let until = if self.highest() < 0.0 { BEGINNING_THROWN } else { BEGINNING };
        &self.rows[..self.rows.partition_point(|row| row[0] <= until)]
    }

    /// Largest minus smallest length in the tail, in m.
    fn ripple(&self) -> f64 {
        let (least, most) = self.tail.iter().fold((f64::MAX, f64::MIN), |(l, m), (_, x)| (l.min(*x), m.max(*x)));
        most - least
    }

    /// Mean length in the tail, in m.
    fn mean(&self) -> f64 {
        self.tail.iter().map(|(_, x)| x).sum::<f64>() / self.tail.len() as f64
    }
}

fn plate(stem: &'static str, label: &str, pair: &[Pulsed; 2]) -> Plate {
    let all = || pair.iter().flat_map(|each| each.beginning().iter().map(|row| row[1] / INCH));
    let (least, most) = all().fold((f64::MAX, f64::MIN), |(l, m), x| (l.min(x), m.max(x)));
    let rim = 0.04 * (most - least);
    let mut figure = Figure::new(Axis::new("time", "s")).caption(assumed(ALL)).size_mm(120.0, 38.0);
    let mut data =
        Data::new(&["frequency_hz", "time_s", "length_m", "velocity_m_s", "absolute_pressure_pa", "supply_open"]);
    for (place, (each, frequency)) in pair.iter().zip(FREQUENCIES).enumerate() {
        data.rows.extend(each.rows.iter().map(|row| [&[frequency], row.as_slice()].concat()));
        let column = |i: usize, unit: f64| each.beginning().iter().map(|row| row[i] / unit).collect();
        let axis = Axis::new(format!("length, {frequency} Hz"), "in").starting_at(least - rim).ending_at(most + rim);
        let series =
            Series::line("", column(0, 1.0), column(1, INCH)).colour(Colour::Category(place)).dash(Dash::Solid);
        let panel = Panel::new(axis).series(series.clone());
        if least >= 0.0 {
            figure = figure.panel(panel);
            continue;
        }
        // The settled ripple is too small to be seen next to the first swing: a second panel shows it over its own range.
        let (mean, ripple) = (each.mean() / INCH, each.ripple() / INCH);
        let around = (SETTLED * ripple).max(LEAST_SETTLED);
        let axis = Axis::new("settled part", "in").starting_at(mean - around).ending_at(mean + around);
        figure = figure.panel(panel.horizontal(0.0, "upper attachment"));
        figure = figure.panel(Panel::new(axis).series(series).height_mm(24.0));
    }
    let caption = format!(
        "{label} of the paper: length over time, 100 psi, {} lb, 50 % commanded; above at 25 Hz as in the paper, \
         below at 50 Hz. The paper’s curves are not at hand.",
        pair[0].pounds
    );
    Plate { stem, caption, figure, data }
}

/// Fig. 11 at 25 Hz with another volume of the hose, in cm³.
fn with_hose(volume: f64) -> Result<(f64, Pulsed), Failure> {
    let mut document = files::document(FIGURES[0].2[0])?;
    document.set_text("actuator.external_volume", &format!("\"{volume} cm^3\""))?;
    Ok((volume, Pulsed::simulate(&document.experiment()?)?))
}

fn hoses_plate(hoses: &[(f64, Pulsed)]) -> Plate {
    let mut panel = Panel::new(Axis::new("length", "in"));
    let mut data =
        Data::new(&["external_volume_m3", "time_s", "length_m", "velocity_m_s", "absolute_pressure_pa", "supply_open"]);
    for (place, (volume, each)) in hoses.iter().enumerate() {
        data.rows.extend(each.rows.iter().map(|row| [&[volume * 1e-6], row.as_slice()].concat()));
        let column = |i: usize, unit: f64| each.beginning().iter().map(|row| row[i] / unit).collect();
        let colour = Colour::Ramp(place as f64 / (hoses.len() - 1) as f64);
        panel = panel.series(Series::line(format!("{volume} cm³"), column(0, 1.0), column(1, INCH)).colour(colour));
    }
    panel = panel.horizontal(0.0, "upper attachment");
    let figure = Figure::new(Axis::new("time", "s"))
        .caption(assumed(&["b", "n", "Eff", "K_braid", "C_braid"]) + " V_ext is varied.")
        .size_mm(120.0, 52.0)
        .panel(panel);
    let caption = "Fig. 11 again, 1 lb at 25 Hz, with several volumes of hose, which the paper does not give.";
    Plate { stem: "fig-11-hose", caption: caption.into(), figure, data }
}

fn hoses_table(hoses: &[(f64, Pulsed)]) -> Table {
    let rows = hoses.iter().map(|(volume, each)| {
        vec![
            format!("{volume} cm³"),
            format!("{} in", number(each.highest() / INCH, 2)),
            format!("{} s", number(each.last_slack(), 2)),
            each.ripple_words(),
        ]
    });
    Table {
        caption: "Fig. 11 at 25 Hz over the assumed volume outside: the smallest length of all, which is below zero \
                  above the upper attachment and below 2.495 in with a slack tendon; when the tendon is slack for \
                  the last time; the ripple at the end."
            .into(),
        head: ["V_ext", "Smallest length", "Last slack", "Ripple"].map(String::from).to_vec(),
        rows: rows.collect(),
    }
}

fn ripples(pairs: &[[Pulsed; 2]]) -> Plate {
    let mut figure = Figure::new(Axis::new("time", "s")).caption(assumed(ALL)).size_mm(120.0, 30.0);
    let mut data = Data::new(&["mass_kg", "frequency_hz", "time_s", "length_m", "length_less_mean_m"]);
    for pair in pairs.iter().filter(|pair| !pair.iter().any(Pulsed::is_thrown)) {
        let mut panel = Panel::new(Axis::new(format!("ΔL, {} lb", pair[0].pounds), "10⁻³ in"));
        for (place, (each, frequency)) in pair.iter().zip(FREQUENCIES).enumerate() {
            let mean = each.mean();
            let rows = each.tail.iter().map(|(t, x)| vec![each.pounds * LB, frequency, *t, *x, *x - mean]);
            data.rows.extend(rows);
            let from = each.tail.last().map_or(0.0, |(t, _)| *t) - DRAWN - 0.5 * FINE;
            let drawn = || each.tail.iter().filter(|(t, _)| *t >= from);
            let (x, y) = (drawn().map(|p| p.0).collect(), drawn().map(|p| (p.1 - mean) / (1e-3 * INCH)).collect());
            panel = panel.series(Series::line(format!("{frequency} Hz"), x, y).colour(Colour::Category(place)));
        }
        figure = figure.panel(panel);
    }
    let caption =
        "The ripple of Figs. 11–13 at the end: length less its mean over the last 0.4 s, of which 0.2 s are drawn.";
    Plate { stem: "fig-11-13-ripple", caption: caption.into(), figure, data }
}

fn table(pairs: &[[Pulsed; 2]]) -> Table {
    let rows = pairs.iter().flat_map(|pair| {
        pair.iter().zip(FREQUENCIES).map(|(each, frequency)| {
            vec![
                format!("{} lb, {frequency} Hz", each.pounds),
                format!("{} in", number(each.mean() / INCH, 3)),
                each.ripple_words(),
            ]
        })
    });
    Table {
        caption: "Mean length and ripple, largest less smallest length, over the last 0.4 s.".into(),
        head: ["Load and frequency", "Mean length", "Ripple"].map(String::from).to_vec(),
        rows: rows.collect(),
    }
}

fn findings(pairs: &[[Pulsed; 2]]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for ((_, label, _), [slow, fast]) in FIGURES.iter().zip(pairs) {
        let curves = || Verdict::NotComparable("the figure’s curve is not at hand".into());
        let pounds = slow.pounds;
        if slow.highest() < 0.0 {
            let words = format!("{label}: smallest length, 25 Hz, {pounds} lb");
            let why = "the mass is thrown at first; how high rests on the assumed hose volume";
            findings.push(
                Finding::new(words, slow.highest() / INCH, 1, "in").against("", Verdict::NotComparable(why.into())),
            );
        }
        if slow.is_thrown() || fast.is_thrown() {
            continue;
        }
        let words = format!("{label}: mean length at the end, 25 Hz, {pounds} lb");
        findings.push(Finding::new(words, slow.mean() / INCH, 3, "in").against("", curves()));
        let words = format!("{label}: ripple, 25 Hz, {pounds} lb");
        findings.push(Finding::new(words, slow.ripple() / INCH, 4, "in").against("", curves()));
        let ratio = fast.ripple() / slow.ripple();
        let words = format!("{} against {}; rests on the assumed actuator", fast.ripple_words(), slow.ripple_words());
        let verdict = if ratio < 1.0 { Verdict::Agrees(words) } else { Verdict::Differs(words) };
        findings.push(
            Finding::new(format!("{label}: ripple at 50 Hz over that at 25 Hz"), ratio, 3, "")
                .against("“of a lower magnitude”", verdict),
        );
    }
    findings
}
