//! Friction from ring-downs whose friction is known: the linear oscillator in closed form, and the simulated muscle.

use crate::noise::{HITS, Noise, coverage, holds};
use mckibben::air::{Air, Process};
use mckibben::force::{Characteristic, Effective, Effectiveness, IdealBraid, LengthLimits};
use mckibben::friction::Friction;
use mckibben::load::Load;
use mckibben::ring_down::Form;
use mckibben::simulation::{Initial, InitialLength, Rig, simulate};
use mckibben::{Actuator, Braid, GaugePressure};
use mckibben_identify::ring_down::{Estimator, Free, Record, Restoring, RingDownError, Turns, Waveform, compare};
use std::f64::consts::PI;

/// `x″ + 2ζω x′ + ω² x = −ω² Q sgn(x′)` about a rest position, let go at rest.
#[derive(Clone, Copy)]
struct Oscillator {
    ratio: f64,
    width: f64,
    omega: f64,
    first: f64,
    rest: f64,
}

const OSCILLATOR: Oscillator = Oscillator { ratio: 0.03, width: 8e-5, omega: 31.0, first: 6e-3, rest: 0.09 };
const MASS: f64 = 2.7;

impl Oscillator {
    fn damped(&self) -> f64 {
        self.omega * (1.0 - self.ratio * self.ratio).sqrt()
    }

    fn viscous(&self) -> f64 {
        2.0 * self.ratio * MASS * self.omega
    }

    /// Solved half cycle by half cycle: each swings about a centre that friction has moved by Q.
    fn at(&self, time: f64) -> f64 {
        let (half, rate) = (PI / self.damped(), self.ratio * self.omega);
        let (mut turn, mut left) = (self.first, time);
        loop {
            if turn.abs() <= self.width || left <= 0.0 {
                return self.rest + turn;
            }
            let centre = self.width * turn.signum();
            if left < half {
                let angle = self.damped() * left;
                let shape = angle.cos() + rate / self.damped() * angle.sin();
                return self.rest + centre + (turn - centre) * (-rate * left).exp() * shape;
            }
            turn = centre - (turn - centre) * (-rate * half).exp();
            left -= half;
        }
    }

    fn turns(&self, count: usize) -> Vec<f64> {
        (0..count).map(|turn| self.at(turn as f64 * PI / self.damped())).collect()
    }
}

fn times(until: f64, interval: f64) -> Vec<f64> {
    (0..=(until / interval) as usize).map(|place| place as f64 * interval).collect()
}

fn record(time: &[f64], at: impl Fn(f64) -> f64) -> Record {
    Record::new(time.to_vec(), time.iter().map(|time| at(*time)).collect()).expect("a record")
}

fn close(value: f64, exact: f64, relative: f64, what: &str) {
    assert!((value - exact).abs() <= relative * exact.abs(), "{what}: {value:e} is not {exact:e}");
}

#[test]
fn the_velocity_reversals_are_those_of_the_closed_form() {
    // Held for a while, then let go, at uneven times.
    let uneven: Vec<f64> = times(1.3, 1e-3).iter().map(|t| t + 3e-4 * (1e3 * t * t).sin()).collect();
    let found = Turns::find(&record(&uneven, |time| OSCILLATOR.at((time - 0.15).max(0.0)))).expect("turns");
    let exact = OSCILLATOR.turns(8);
    // The first is where it was held.
    for (turn, exact) in found.turns.iter().zip(&exact[1..]) {
        let amplitude = exact - OSCILLATOR.rest;
        assert!((turn.length - exact).abs() < 1e-3 * amplitude.abs(), "{} is not {exact}", turn.length);
        assert_eq!(turn.is_peak, amplitude > 0.0);
    }
    // Friction bends the small turns to one side.
    close(found.period, 2.0 * PI / OSCILLATOR.damped(), 1e-3, "period");
    let half = PI / OSCILLATOR.damped();
    assert!((found.turns[0].time - 0.15 - half).abs() < 2e-3 * half, "{}", found.turns[0].time);
}

#[test]
fn a_linear_oscillator_gives_its_friction_back() {
    let turns = Turns::find(&record(&times(1.5, 1e-3), |time| OSCILLATOR.at(time))).expect("turns");
    let beta = (-2.0 * PI * OSCILLATOR.ratio * OSCILLATOR.omega / OSCILLATOR.damped()).exp();
    let exact = turns.two_cycles(MASS, Form::Exact).expect("friction");
    let all = turns.all_turns(MASS).expect("friction");
    for found in [&exact, &all] {
        close(found.coulomb_width.value, OSCILLATOR.width, 5e-3, "Q");
        close(found.viscous.value, OSCILLATOR.viscous(), 5e-3, "c");
        close(found.damping_ratio.value, OSCILLATOR.ratio, 5e-3, "ζ");
        close(found.decay.value, beta, 1e-3, "β");
    }
    close(all.rest.expect("a rest position").value, OSCILLATOR.rest, 1e-5, "x₀");
    // The paper's Q is low by a known factor.
    let paper = turns.two_cycles(MASS, Form::Paper).expect("friction");
    let low = (1.0 + beta.sqrt()).powi(2) / 4.0;
    close(paper.coulomb_width.value / exact.coulomb_width.value, low, 1e-3, "ratio of Q");
    // (32) of half swings: each is the mean of two turns.
    let swings: Vec<f64> = OSCILLATOR.turns(9).windows(2).map(|pair| 0.5 * (pair[0] - pair[1]).abs()).collect();
    let equivalent = turns.equivalent_ratios().expect("ratios");
    close(equivalent[0].ratio.value, (swings[1] / swings[3]).ln() / (2.0 * PI), 1e-3, "ζ_eq");
    assert!(
        equivalent.windows(2).all(|pair| pair[0].ratio.value < pair[1].ratio.value),
        "small swings are damped more"
    );
}

/// A hundred samples a cycle with noise of 1/200 of the first amplitude, off the turns.
fn noisy(seed: u64) -> Turns {
    let time = times(1.52, 2e-3);
    let exact: Vec<f64> = time.iter().map(|time| OSCILLATOR.at(time + 0.03)).collect();
    let length = Noise::new(seed).added_to(&exact, 3e-5);
    Turns::find(&Record::new(time, length).expect("a record")).expect("turns")
}

#[test]
fn intervals_of_two_cycles_hold_the_truth_in_95_of_100_trials() {
    let hits = coverage(|seed| {
        let found = noisy(seed).two_cycles(MASS, Form::Exact).expect("friction");
        [
            holds(&found.coulomb_width, OSCILLATOR.width),
            holds(&found.viscous, OSCILLATOR.viscous()),
            holds(&found.damping_ratio, OSCILLATOR.ratio),
        ]
    });
    println!("two cycles: Q, c, ζ {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn intervals_of_all_reversals_cover_the_truth_in_95_of_100_trials() {
    let hits = coverage(|seed| {
        let found = noisy(seed).all_turns(MASS).expect("friction");
        [
            holds(&found.coulomb_width, OSCILLATOR.width),
            holds(&found.viscous, OSCILLATOR.viscous()),
            holds(&found.damping_ratio, OSCILLATOR.ratio),
        ]
    });
    println!("all turns: Q, c, ζ {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

/// The paper's muscle, sealed at 60 psi, with 6 lb.
fn muscle(viscous: f64, width: f64) -> Rig {
    let inch = 0.0254;
    let braid = Braid::new(4.3218 * inch, 2.5).expect("a braid");
    let limits = LengthLimits::new(&braid, None, 3.85 * inch, 1.75e5, 100.0).expect("limits");
    let law =
        Effective { law: Characteristic::from(IdealBraid { braid }), effectiveness: Effectiveness::Constant(1.0) };
    let air = Air::standard(Process::Isentropic).expect("a gas");
    let friction = Friction::new(viscous, width).expect("a friction");
    let actuator = Actuator::new(law, limits, friction, 3e-6, air).expect("an actuator");
    Rig::new(actuator, None, Load::hanging_mass(2.72, 9.80665).expect("a load")).expect("a rig")
}

const VISCOUS: f64 = 3.5;
const WIDTH: f64 = 1.1e-4;

fn released() -> Initial {
    Initial {
        gauge_pressure: GaugePressure(4.2e5),
        temperature: 293.15,
        length: InitialLength::At(0.0905),
        velocity: 0.1,
    }
}

fn ring_down(rig: &Rig, time: &[f64]) -> Vec<f64> {
    let start = rig.start(&released()).expect("a start");
    let run = simulate(rig, start, time[time.len() - 1], 1e-10).expect("the run reaches its end");
    time.iter().map(|time| run.at(*time).length).collect()
}

#[test]
fn intervals_of_the_waveform_hold_the_truth_in_95_of_100_trials() {
    let rig = muscle(VISCOUS, WIDTH);
    let time = times(0.75, 0.01);
    let exact = ring_down(&rig, &time);
    // A guess: other friction, another pressure.
    let guess = muscle(2.0, 3e-4);
    let start = Initial { gauge_pressure: GaugePressure(4.1e5), velocity: 0.0, ..released() };
    let hits = coverage(|seed| {
        let length = Noise::new(seed).added_to(&exact, 5e-5);
        let record = Record::new(time.clone(), length).expect("a record");
        let found = Waveform::fit(&record, &guess, &start, Free::ALL, None).expect("a fit");
        let pressure = &found.fit.estimates[4];
        [
            holds(&found.coulomb_width, WIDTH),
            holds(&found.viscous, VISCOUS),
            holds(pressure, 4.2e5),
            holds(&found.fit.estimates[3], 0.1),
        ]
    });
    println!("waveform: Q, c, pressure, velocity {hits:?}");
    assert!(hits.iter().all(|hits| HITS.contains(hits)), "{hits:?}");
}

#[test]
fn estimators_of_one_muscle_agree_as_far_as_they_can() {
    let rig = muscle(VISCOUS, WIDTH);
    let time = times(1.2, 1e-3);
    let length = Noise::new(3).added_to(&ring_down(&rig, &time), 2e-5);
    let record = Record::new(time, length).expect("a record");
    let comparison = compare(&record, 2.72, Some((&rig, &released(), Free::ALL))).expect("a comparison");
    assert!(comparison.refused.is_empty(), "{:?}", comparison.refused);
    let row = |wanted| comparison.rows.iter().find(|row| row.estimator == wanted).expect("an answer");
    let (paper, exact) = (row(Estimator::PaperTwoCycles), row(Estimator::ExactTwoCycles));
    let (all, waveform) = (row(Estimator::AllTurns), row(Estimator::Waveform));
    // In its own noise the waveform is true; the muscle's spring is not linear, so the others are near only.
    let width = |row: &mckibben_identify::ring_down::Row| row.law_width.clone().expect("the actuator is known");
    assert!(holds(&width(waveform), WIDTH) && holds(&waveform.viscous, VISCOUS));
    for row in [exact, all] {
        close(width(row).value, WIDTH, 0.12, "Q");
        close(row.viscous.value, VISCOUS, 0.05, "c");
    }
    assert!(paper.coulomb_width.value < exact.coulomb_width.value);
    let size = |row: &mckibben_identify::ring_down::Row| {
        let [low, high] = row.coulomb_width.confidence_interval.expect("it is identifiable");
        high - low
    };
    // All samples are more certain than the turns alone.
    assert!(size(waveform) < 0.5 * size(exact) && size(waveform) < 0.5 * size(all));
    close(waveform.scatter.expect("a scatter"), 2e-5, 0.1, "the noise");
    assert!(all.scatter < exact.scatter && exact.scatter < paper.scatter);
}

#[test]
fn what_a_muscle_shows_is_its_width_by_secant_over_sealed_stiffness() {
    let rig = muscle(VISCOUS, WIDTH);
    // Written out at the rest length that a damped run comes to.
    let start = rig.start(&released()).expect("a start");
    let slow = muscle(60.0, 1e-9);
    let end = simulate(&slow, start, 8.0, 1e-9).expect("the run reaches its end").at(8.0);
    let springs = Restoring::at_rest(&rig, &released()).expect("springs");
    let (b, n, length, shortest) = (4.3218 * 0.0254, 2.5, end.length, 4.3218 * 0.0254 / 3_f64.sqrt());
    let gauge = end.pressure.0 - 101_325.0;
    let volume = length * (b * b - length * length) / (4.0 * PI * n * n) + 3e-6;
    let slope = (b * b - 3.0 * length * length) / (4.0 * PI * n * n);
    close(springs.secant, 3.0 * gauge * (length + shortest) / (4.0 * PI * n * n), 1e-6, "k_sec");
    let sealed = 3.0 * gauge * length / (2.0 * PI * n * n) + 1.4 * end.pressure.0 * slope * slope / volume;
    close(springs.tangent, sealed, 1e-6, "k_t");
}

/// Samples without noise left residuals that are the error of the simulation, in which no step with derivatives is level: the waveform
/// had no minimum.
#[test]
fn exact_samples_give_friction_by_every_estimator() {
    for (interval, until) in [(2e-3, 3.0), (1e-3, 1.3)] {
        let time = times(until, interval);
        let rig = muscle(VISCOUS, WIDTH);
        let record = Record::new(time.clone(), ring_down(&rig, &time)).expect("a record");
        let guess = muscle(1.5 * VISCOUS, 0.7 * WIDTH);
        let found = compare(&record, 2.72, Some((&guess, &released(), Free::ALL))).expect("turns");
        assert!(found.refused.is_empty(), "{interval}: {:?}", found.refused);
        let waveform = found.waveform.expect("a fit");
        close(waveform.coulomb_width.value, WIDTH, 1e-3, "Q of the waveform");
        close(waveform.viscous.value, VISCOUS, 1e-3, "c of the waveform");
    }
    // The linear oscillator in closed form, without a rig.
    let found = compare(&record(&times(1.3, 1e-3), |time| OSCILLATOR.at(time)), MASS, None).expect("turns");
    assert!(found.refused.is_empty(), "{:?}", found.refused);
    let all = found.rows.iter().find(|row| row.estimator == Estimator::AllTurns).expect("a row");
    close(all.coulomb_width.value, OSCILLATOR.width, 1e-3, "Q of all turns");
    close(all.viscous.value, OSCILLATOR.viscous(), 1e-3, "c of all turns");
}

fn refusal(record: &Record) -> String {
    Turns::find(record).expect_err("it is refused").to_string()
}

#[test]
fn a_record_that_identifies_no_friction_is_refused_with_a_remedy() {
    let time = times(1.5, 1e-3);
    let of = |at: &dyn Fn(f64) -> f64| record(&time, at);
    // A sensor that ends at +3 mm.
    let clipped = refusal(&of(&|t| OSCILLATOR.at(t + 0.05).min(0.093)));
    assert!(clipped.contains("saturated") && clipped.contains("0.093 m"), "{clipped}");
    // A coarse one is none such: steps of 0.1 mm.
    Turns::find(&of(&|t| (OSCILLATOR.at(t) * 1e4).round() / 1e4)).expect("turns");
    let dry = Oscillator { width: 1.1e-3, ..OSCILLATOR };
    let stuck = refusal(&of(&|t| dry.at(t)));
    assert!(stuck.contains("stuck") && stuck.contains("farther out"), "{stuck}");
    let drier = Oscillator { width: 2.5e-3, ..OSCILLATOR };
    assert!(matches!(Turns::find(&of(&|t| drier.at(t))), Err(RingDownError::Stuck { .. })));
    let short = refusal(&record(&times(0.25, 1e-3), |t| OSCILLATOR.at(t)));
    assert!(short.contains("record longer"), "{short}");
    let coarse = refusal(&record(&times(1.5, 0.03), |t| OSCILLATOR.at(t)));
    assert!(coarse.contains("samples in a cycle"), "{coarse}");
    // Noise alone, and nothing at all.
    let mut noise = Noise::new(5);
    let noisy = Record::new(time.clone(), noise.added_to(&vec![0.09; time.len()], 1e-4)).expect("a record");
    Turns::find(&noisy).expect_err("there is nothing");
    Turns::find(&of(&|_| 0.09)).expect_err("there is nothing");
    let wrong = |time: Vec<f64>, length: Vec<f64>| Record::new(time, length).expect_err("no series").to_string();
    let length = vec![0.09; time.len()];
    assert!(wrong(time[..9].to_vec(), length[..9].to_vec()).contains("9 samples"));
    assert!(wrong(time.clone(), length[1..].to_vec()).contains("one value for each time"));
    let mut twice = time.clone();
    twice[7] = twice[6];
    assert!(wrong(twice, length.clone()).contains("sample 8"));
    let mut hole = length.clone();
    hole[3] = f64::NAN;
    assert!(wrong(time.clone(), hole).contains("the length of sample 4"));
}

#[test]
fn a_rig_that_cannot_ring_down_is_refused() {
    let record = of_muscle();
    let no = |rig: &Rig| match Waveform::fit(&record, rig, &released(), Free::ALL, None) {
        Err(error) => error.to_string(),
        Ok(found) => panic!("{found:?}"),
    };
    assert!(no(&muscle(VISCOUS, 0.0)).contains("width above zero"));
    assert!(no(&muscle(VISCOUS, WIDTH).with_load(Load::Isometric)).contains("hang a mass"));
    let turns = Turns::find(&record).expect("turns");
    assert!(matches!(turns.all_turns(-1.0), Err(RingDownError::Physics(mckibben::Error::OutOfRange { .. }))));
    assert!(matches!(turns.two_cycles(0.0, Form::Exact), Err(RingDownError::Physics(_))));
}

#[test]
fn a_record_that_begins_before_the_release_has_no_waveform() {
    let (rig, time) = (muscle(VISCOUS, WIDTH), times(1.4, 1e-3));
    let later: Vec<f64> = time.iter().map(|time| (time - 0.3).max(0.0)).collect();
    let start = Initial { velocity: 0.0, ..released() };
    let state = rig.start(&start).expect("a start");
    let run = simulate(&rig, state, 1.4, 1e-10).expect("the run reaches its end");
    let length: Vec<f64> = later.iter().map(|time| run.at(*time).length).collect();
    let record = Record::new(time, Noise::new(7).added_to(&length, 2e-5)).expect("a record");
    let comparison = compare(&record, 2.72, Some((&rig, &start, Free::ALL))).expect("a comparison");
    assert_eq!(comparison.refused, [(Estimator::Waveform, RingDownError::Held { time: 0.0 })]);
    assert_eq!(comparison.rows.len(), 3);
    let other = compare(&record, 2.7, Some((&rig, &start, Free::ALL))).expect_err("two masses");
    assert!(other.to_string().contains("2.72 kg hang from the rig"), "{other}");
}

fn of_muscle() -> Record {
    let time = times(1.0, 2e-3);
    let length = ring_down(&muscle(VISCOUS, WIDTH), &time);
    Record::new(time, length).expect("a record")
}

#[test]
fn a_known_pressure_and_velocity_are_kept() {
    let found =
        Waveform::fit(&of_muscle(), &muscle(2.0, 3e-4), &released(), Free { velocity: false, pressure: false }, None)
            .expect("a fit");
    assert_eq!(found.fit.estimates.len(), 3);
    close(found.coulomb_width.value, WIDTH, 1e-4, "Q");
    close(found.viscous.value, VISCOUS, 1e-4, "c");
}

/// Of a rig with another mass the least squares have no Coulomb friction: exactly none, and a scatter far above the noise.
#[test]
fn a_wrong_mass_leaves_more_than_noise_and_a_width_of_zero() {
    let rig = muscle(VISCOUS, WIDTH);
    let time = times(0.9, 2e-3);
    let record = Record::new(time.clone(), Noise::new(7).added_to(&ring_down(&rig, &time), 2e-5)).expect("a record");
    let load = Load::hanging_mass(2.2 * 2.72, 9.80665).expect("a load");
    let wrong = Rig::new(rig.actuator().clone(), None, load).expect("a rig");
    let found = Waveform::fit(&record, &wrong, &released(), Free::ALL, None).expect("a fit");
    assert!(found.scatter > 3.0 * record.noise(), "{} for {}", found.scatter, record.noise());
    if found.coulomb_width.on_bound {
        assert_eq!(found.coulomb_width.value, 0.0);
    }
    let start = found.start(&released());
    assert_eq!(start.length, InitialLength::At(found.fit.values()[2]));
    assert_eq!([start.velocity, start.gauge_pressure.0], [found.fit.values()[3], found.fit.values()[4]]);
}
