//! Fig. 10: commanded against actual duty cycle, measured from the motion of the poppet.
//!
//! The poppet of the scenario's valve is followed from instant to instant (`PoppetClock`) over whole periods, and the time
//! that it stands open is added up; the formula `d − (t_open − t_close) f` is drawn beside it for reference only.

use super::files;
use crate::failure::Failure;
use crate::report::{Data, Finding, Plate, Section, Verdict, number};
use mckibben::simulation::Actuation;
use mckibben::valve::PoppetClock;
use mckibben_plot::{Axis, Colour, Dash, Figure, Marks, Panel, Series, Symbol};
use mckibben_scenario::Document;

/// The paper's frequencies in Hz with the actual duty that it measured at 50 %, in %.
const STATED: [(f64, f64); 2] = [(25.0, 43.0), (50.0, 35.0)];
/// Periods that pass before the measurement, and periods that are measured.
const SETTLE: f64 = 4.0;
const MEASURED: f64 = 10.0;
/// Steps of the commanded duty from 0 to 1.
const STEPS: usize = 1000;
/// Steps from one drawn point to the next.
const DRAWN: usize = 20;

/// The section on Fig. 10.
pub(super) fn section() -> Result<Section, Failure> {
    let name = "fig-10.toml";
    let document = files::document(name)?;
    let mut panel = Panel::new(Axis::new("actual duty cycle", "%").starting_at(-3.0).ending_at(103.0));
    let mut data = Data::new(&["frequency_hz", "commanded_duty", "actual_duty", "formula"]);
    let mut findings = Vec::new();
    let half: Vec<f64> = STATED.iter().map(|_| 50.0).collect();
    for (place, (frequency, stated)) in STATED.into_iter().enumerate() {
        let colour = Colour::Category(place);
        let mut rows = Vec::new();
        for step in 0..=STEPS {
            let commanded = step as f64 / STEPS as f64;
            let actuation = actuation(&document, frequency, commanded)?;
            let lost = (actuation.delays.0 - actuation.delays.1) * frequency;
            rows.push([frequency, commanded, actuation.actual(frequency), commanded - lost]);
        }
        data.rows.extend(rows.iter().map(|row| row.to_vec()));
        let percent =
            |column: usize| -> Vec<f64> { rows.iter().step_by(DRAWN).map(|row| 100.0 * row[column]).collect() };
        let lost = 100.0 * (rows[0][1] - rows[0][3]);
        let line = Series::line(format!("{frequency} Hz: formula"), vec![lost, 100.0], vec![0.0, 100.0 - lost]);
        panel = panel
            .series(line.colour(colour).dash(Dash::Dashed))
            .series(Series::points(format!("{frequency} Hz: seat"), percent(1), percent(2)).colour(colour));
        findings.extend(found(&rows, frequency, stated));
    }
    panel = panel
        .series(
            Series::line("as commanded", vec![0.0, 100.0], vec![0.0, 100.0]).colour(Colour::Neutral).dash(Dash::Dotted),
        )
        .marks(Marks::at("stated by the paper", Symbol::Diamond, half, STATED.map(|(_, actual)| actual).to_vec()));
    let figure = Figure::new(Axis::new("commanded duty cycle", "%").starting_at(-3.0).ending_at(103.0))
        .size_mm(120.0, 72.0)
        .panel(panel);
    let caption = "Fig. 10 of the paper: how long the seat is open, as a share of the period, against what is \
                   commanded. Dots: measured on the simulated seat; dashed: d − (t_open − t_close) f; diamonds: the \
                   two values that the paper states.";
    Ok(Section {
        id: "fig-10",
        label: "Fig. 10",
        title: "Commanded and actual duty cycle",
        paragraphs: vec![
            "The seat opens 4 ms after the coil is energised and closes 1 ms after it is released, the paper’s \
             measured delays. A pulse shorter than the first never opens the valve and a gap shorter than the second \
             never shuts it: two dead ends. Nothing here is assumed beyond the delays being the same in every period."
                .into(),
        ],
        plates: vec![Plate { stem: "fig-10", caption: caption.into(), figure, data }],
        findings,
        files: vec![files::shown(name)?],
        ..Section::default()
    })
}

/// A valve under one command.
struct Driven {
    actuation: Actuation,
    delays: (f64, f64),
}

fn actuation(document: &Document, frequency: f64, duty: f64) -> Result<Driven, Failure> {
    let mut document = document.clone();
    document.set_text("command.frequency", &format!("\"{frequency} Hz\""))?;
    document.set_text("command.duty", &format!("{duty:?}"))?;
    let scenario = document.scenario()?;
    let rig = scenario.rig().map_err(files::stopped)?;
    match (rig.actuation(), &scenario.valve) {
        (Some(actuation), Some(valve)) => {
            let delays = (valve.opening_delay, valve.closing_delay);
            Ok(Driven { actuation: actuation.clone(), delays })
        }
        _ => Err(Failure::stopped("the scenario of Fig. 10 has no valve")),
    }
}

impl Driven {
    /// The share of time that the poppet stands open.
    fn actual(&self, frequency: f64) -> f64 {
        let Actuation { solenoid, command } = &self.actuation;
        let (from, until) = (SETTLE / frequency, (SETTLE + MEASURED) / frequency);
        let mut clock = PoppetClock::released();
        clock.advance(0.0, solenoid, command);
        let (mut now, mut open) = (0.0_f64, 0.0);
        while now < until {
            let is_open = clock.ports(solenoid).supply;
            let next = clock.next_motion(solenoid, command, until).unwrap_or(until);
            if is_open {
                open += (next.max(from) - now.max(from)).max(0.0);
            }
            clock.advance(next, solenoid, command);
            now = next;
        }
        open / (until - from)
    }
}

fn found(rows: &[[f64; 4]], frequency: f64, stated: f64) -> Vec<Finding> {
    let at_half = rows[STEPS / 2][2] * 100.0;
    let reason = format!("{} points from what was measured", number(at_half - stated, 1));
    // The paper states whole percents, "approximately" for the delays: a difference of one percent is agreement.
    let agrees = (at_half - stated).abs() < 1.0;
    let verdict = if agrees { Verdict::Agrees(reason) } else { Verdict::Differs(reason) };
    let opens = rows.iter().find(|row| row[2] > 0.0).map_or(f64::NAN, |row| row[1]);
    let full = rows.iter().find(|row| row[2] > 1.0 - 1e-9).map_or(f64::NAN, |row| row[1]);
    let dead = |words: String, value: f64, stated: &str, is: f64| {
        let within = (value - is).abs() <= 1.0 / STEPS as f64 + 1e-9;
        let reason = format!(
            "follows from the stated delay: {} %, to the step of {} %",
            number(100.0 * is, 1),
            100.0 / STEPS as f64
        );
        let verdict = if within { Verdict::Agrees(reason) } else { Verdict::Differs(reason) };
        Finding::new(words, 100.0 * value, 1, "%").against(stated, verdict)
    };
    vec![
        Finding::new(format!("Actual duty at 50 %, {frequency} Hz"), at_half, 1, "%")
            .against(format!("{stated} %"), verdict),
        dead(
            format!("Least duty that opens the valve, {frequency} Hz"),
            opens,
            "a pulse of less than 4 ms “will not open the valve”",
            0.004 * frequency,
        ),
        dead(
            format!("Least duty that never closes it, {frequency} Hz"),
            full,
            "less than 1 ms for closing “will never fully close the valve”",
            1.0 - 0.001 * frequency,
        ),
    ]
}
