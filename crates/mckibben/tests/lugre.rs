//! LuGre's friction, against its closed forms, Dahl's law, and its raw equations by the classical Runge–Kutta method.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, GRAVITY, LB, Paper, assert_close, assert_within, between, runge_kutta, slope};
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Hysteresis, LuGre, Memory};
use mckibben::load::{Load, Motion};
use mckibben::simulation::{Method, simulate};
use mckibben::valve::{Command, Ports, Request};
use mckibben::{AbsolutePressure, ActuatorState, Dual, Error, Over};
use std::f64::consts::PI;

const GAUGE: f64 = 4e5;
const MIDDLE: f64 = 0.08;
const WIDTH: f64 = 1e-4;
const REACH: f64 = 5e-5;
const RATIO: f64 = 1.6;
const STRIBECK: f64 = 5e-3;
const DAMPING: f64 = 8e-3;

fn law() -> Hysteresis {
    bristles(REACH, RATIO, STRIBECK, DAMPING)
}

fn bristles(reach: f64, ratio: f64, velocity: f64, damping: f64) -> Hysteresis {
    let law = LuGre::new(WIDTH, reach).and_then(|law| law.with_velocity(ratio, velocity, damping));
    Hysteresis::LuGre(law.expect("a law"))
}

/// A muscle that nothing but its bristles damps, at a pressure that does not change.
fn muscle(hysteresis: Hysteresis) -> Paper {
    Paper::sealed().process(Process::Isothermal).friction(0.0, 0.0).gauge(GAUGE).with(|rig| {
        rig.external_volume = 1e6;
        rig.hysteresis = Some(hysteresis);
    })
}

fn moved_along(paper: Paper, time: Vec<f64>, length: Vec<f64>) -> Paper {
    let motion = Motion::table(time, length, paper.thread_length).expect("a path");
    paper.with(|rig| rig.load = Load::Prescribed(motion))
}

/// Secant stiffness (13) of the ideal braid in N/m at a length and a gauge pressure.
fn secant(paper: &Paper, length: f64, gauge: f64) -> f64 {
    3.0 * gauge * (length + paper.thread_length / 3.0_f64.sqrt()) / (4.0 * PI * paper.turns * paper.turns)
}

fn falls(velocity: f64) -> f64 {
    (-(velocity / STRIBECK) * (velocity / STRIBECK)).exp()
}

/// `g(v)/σ₀`: the deflection in steady sliding.
fn steady(velocity: f64) -> f64 {
    REACH * (1.0 + (RATIO - 1.0) * falls(velocity))
}

#[test]
fn steady_sliding_is_stribeck_s_curve_in_both_engines_whatever_the_step() {
    for velocity in [1e-4, 2e-3, 5e-3, 8e-3, 0.05, -2e-3, -0.02] {
        let way = 60.0 * REACH * f64::signum(velocity);
        let duration = way / velocity;
        let paper = moved_along(muscle(law()), vec![0.0, duration], vec![MIDDLE, MIDDLE + way]);
        let expected = WIDTH * (1.0 + (RATIO - 1.0) * falls(velocity)) * f64::signum(velocity);
        let width = |tension: f64, length: f64| {
            let resting: f64 = paper.actuator().static_force(length, ATMOSPHERE + GAUGE);
            (tension - resting) / secant(&paper, length, GAUGE)
        };
        let sample = paper.run(duration, 1e-10).at(duration);
        assert_within(width(sample.tension, sample.length), expected, 1e-9 * WIDTH);
        let (rig, start) = (paper.rig(), paper.start());
        // Of ż = v − |v| z/g a step leaves R(−|v| h/g) of what z lacks: the method's stability function.
        let gamma = 1.0 + 0.5_f64.sqrt();
        let left = |z: f64| (1.0 + (1.0 - 2.0 * gamma) * z) / (1.0 - gamma * z).powi(2);
        for steps in [1_u32, 7, 300] {
            let mut stepper = RigSteps::new(&rig, start, Method::Stable);
            for step in 1..=steps {
                stepper.advance_to(duration * f64::from(step) / f64::from(steps)).expect("a step");
            }
            let lacks = steady(velocity) * left(-way.abs() / f64::from(steps) / steady(velocity)).powi(steps as i32);
            // At the end of its path the motion rests, so that nothing is damped.
            let expected = expected - f64::signum(velocity) * WIDTH / REACH * lacks;
            let sample = stepper.sample();
            assert_within(width(sample.tension, sample.length), expected, 1e-9 * WIDTH);
        }
    }
}

#[test]
fn at_one_velocity_the_deflection_has_a_closed_form() {
    for velocity in [1e-3, -6e-3, 0.04] {
        let paper = moved_along(muscle(law()), vec![0.0, 1.0], vec![MIDDLE, MIDDLE + 0.1 * velocity]);
        let run = paper.run(1.0, 1e-11);
        let velocity = 0.1 * velocity;
        let mut memory = Memory::relaxed(MIDDLE);
        law().moved(&mut memory, MIDDLE, velocity);
        for part in 1..=20 {
            let way = f64::from(part) * velocity / 20.0;
            law().moved(&mut memory, MIDDLE + way, velocity);
            let expected = -steady(velocity) * (-way.abs() / steady(velocity)).exp_m1() * velocity.signum();
            assert_close(memory.elements[0], expected, 1e-12);
            let bent = run.bristles_at(f64::from(part) / 20.0).expect("bristles");
            assert_close(bent, expected, 1e-9);
        }
    }
}

#[test]
fn without_velocity_it_is_dahl_s_law() {
    // As a state in the one, in closed form in the other: the two ways to the same law.
    let dahl = Hysteresis::BoucWen(BoucWen::new(WIDTH, 1.0 / REACH, 0.0).expect("a law"));
    let bristles = Hysteresis::LuGre(LuGre::new(WIDTH, REACH).expect("a law"));
    let swing = |law| muscle(law).mass(5.0 * LB).from(0.083, 0.0);
    let [one, other] = [dahl, bristles].map(|law| swing(law).run(0.2, 1e-11));
    for k in 1..=40 {
        let time = 0.005 * f64::from(k);
        assert_within(other.at(time).length, one.at(time).length, 2e-11);
        assert_within(other.at(time).tension, one.at(time).tension, 1e-6);
    }
    // Between two lengths the loop closes: a change of the deflection decays by the way, there and back.
    let (half, mut memory) = (REACH, Memory::relaxed(MIDDLE));
    let mut at_turns = [0.0; 6];
    for turn in &mut at_turns {
        bristles.moved(&mut memory, MIDDLE + half, 1e-3);
        bristles.moved(&mut memory, MIDDLE - half, -1e-3);
        *turn = memory.elements[0];
    }
    let changes: Vec<f64> = at_turns.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for pair in changes.windows(2) {
        assert_close(pair[1] / pair[0], (-4.0 * half / REACH).exp(), 1e-6);
    }
}

/// A muscle that a choked flow fills slowly: it draws its load up by stick and slip.
struct Creep {
    paper: Paper,
    duration: f64,
}

impl Creep {
    const MASS: f64 = 5.0 * LB;
    const START: f64 = 2e5;
    const VOLUME: f64 = 0.02;
    const VISCOUS: f64 = 0.1;
    /// Force over secant stiffness, reach, static ratio, Stribeck velocity, damping time.
    const LAW: [f64; 5] = [2e-4, 1e-5, 2.0, 2e-3, 9e-3];

    fn new() -> Self {
        let [width, reach, ratio, velocity, damping] = Self::LAW;
        let law = LuGre::new(width, reach).and_then(|law| law.with_velocity(ratio, velocity, damping));
        let paper = Paper::driven(Command::Constant(Request::Fill)).process(Process::Isothermal).mass(Self::MASS);
        let paper = paper.friction(Self::VISCOUS, 0.0).gauge(Self::START).with(|rig| {
            (rig.external_volume, rig.delays) = (Self::VOLUME, (0.0, 0.0));
            rig.hysteresis = Some(Hysteresis::LuGre(law.expect("a law")));
        });
        Self { paper, duration: 3.0 }
    }

    /// Length and velocity at multiples of an interval, from the raw equations alone: `P V = m R T` with a choked flow (21),
    /// and ż as its authors write it.
    fn reference(&self, start: f64, interval: f64, step: f64) -> Vec<[f64; 2]> {
        let paper = &self.paper;
        let (b, n) = (paper.thread_length, paper.turns);
        let [width, reach, ratio, stribeck, damping] = Self::LAW;
        let gamma = paper.heat_capacity_ratio;
        let choked = (gamma / paper.gas_constant * (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0))).sqrt();
        let area = 1.8e-5 * 0.3048 * 0.3048;
        let upstream = paper.supply_gauge + ATMOSPHERE;
        let flow = paper.efficiency * area * upstream * choked / paper.supply_temperature.sqrt();
        let volume = |length: f64| Self::VOLUME + length * (b * b - length * length) / (4.0 * PI * n * n);
        let content = (Self::START + ATMOSPHERE) * volume(start);
        let heat = paper.gas_constant * paper.temperature;
        let rates = |time: f64, [length, velocity, bent]: [f64; 3]| {
            let gauge = (content + heat * flow * time) / volume(length) - ATMOSPHERE;
            let fall = (-(velocity / stribeck) * (velocity / stribeck)).exp();
            let rate = velocity - velocity.abs() * bent / (reach * (1.0 + (ratio - 1.0) * fall));
            let held = secant(paper, length, gauge) * width / reach * (bent + damping * fall * rate);
            let tension =
                gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n) + held + Self::VISCOUS * velocity;
            [velocity, GRAVITY - tension / Self::MASS, rate]
        };
        let (mut state, mut samples) = ([start, 0.0, 0.0], vec![[start, 0.0]]);
        let (each, count) = ((interval / step).round() as usize, (self.duration / interval).round() as usize);
        for index in 0..each * count {
            let time = index as f64 * step;
            state = runge_kutta(state, step, |since, state| rates(time + since, state));
            if (index + 1) % each == 0 {
                samples.push([state[0], state[1]]);
            }
        }
        samples
    }
}

#[test]
fn stick_and_slip_is_that_of_the_raw_equations() {
    let creep = Creep::new();
    let (start, interval) = (creep.paper.start(), 1e-3);
    let reference = creep.reference(start.length, interval, 1e-5);
    // The kinks at the turns leave the classical method an error, which another step shows.
    let coarser = creep.reference(start.length, interval, 2e-5);
    let off = |one: &[[f64; 2]], other: &dyn Fn(usize) -> f64| {
        one.iter().enumerate().map(|(k, state)| (state[0] - other(k)).abs()).fold(0.0, f64::max)
    };
    let own = off(&reference, &|k| coarser[k][0]);
    let run = creep.paper.run(creep.duration, 1e-9);
    let error = off(&reference, &|k| run.at(k as f64 * interval).length);
    assert!(own < 1e-10 && error < 1e-10, "{own:e} {error:e}");
    // It does stick and slip: creeps on its bristles, and then goes faster than it is drawn, again and again.
    let mean = (reference[0][0] - reference[reference.len() - 1][0]) / creep.duration;
    let (mut slips, mut quick) = (0, false);
    for [_, velocity] in &reference {
        if -velocity > 4.0 * mean && !quick {
            (slips, quick) = (slips + 1, true);
        } else if velocity.abs() < 0.5 * mean {
            quick = false;
        }
    }
    assert!(slips >= 4 && mean > 0.0, "{slips} slips at a mean of {mean:e} m/s");
    // By fixed steps, with the bristles at any step.
    let rig = creep.paper.rig();
    let fixed = |method, step: f64| {
        let mut stepper = RigSteps::new(&rig, start, method);
        let mut lengths = vec![start.length];
        let stride = (interval / step).round() as usize;
        for index in 1..=stride * (reference.len() - 1) {
            stepper.advance_to(index as f64 * step).expect("a step");
            lengths.push(stepper.state().length);
        }
        off(&reference, &|k| lengths[k * stride])
    };
    let [coarse, middle, fine] = [1e-3, 5e-4, 2.5e-4].map(|step| fixed(Method::Rk4, step));
    let (stable, finer) = (fixed(Method::Stable, 1e-3), fixed(Method::Stable, 2.5e-4));
    // Of second order, but for the steps in which it turns.
    assert!(coarse / fine > 6.0 && fine < 5e-8, "{coarse:e} {middle:e} {fine:e}");
    assert!(stable / finer > 6.0 && finer < 5e-5, "{stable:e} {finer:e}");
}

#[test]
fn fixed_steps_are_stable_however_stiff_the_bristles() {
    // Bristles whose own vibration has periods down to 0.2 ms, at steps of up to 3 ms. They are a state of the step: one that
    // spans more of the load's swing takes them beyond what they bear.
    for reach in [1e-5, 1e-7] {
        for damping in [0.0, 0.5 * reach / STRIBECK] {
            let paper = muscle(bristles(reach, RATIO, STRIBECK, damping)).mass(5.0 * LB).friction(2.0, 0.0);
            let middle = paper.balance(5.0 * LB * GRAVITY);
            let paper = paper.from(middle + 2e-3, 0.0);
            let (rig, start) = (paper.rig(), paper.start());
            for step in [3e-4, 1e-3, 3e-3] {
                let mut stepper = RigSteps::new(&rig, start, Method::Stable);
                let mut largest = 0.0_f64;
                for index in 1..=(6.0 / step) as u32 {
                    stepper.advance_to(f64::from(index) * step).expect("a step");
                    let away = (stepper.state().length - middle).abs();
                    assert!(away < 2.2e-3, "{away:e} m after {index} steps of {step} s with {reach:e}");
                    let bent = stepper.steps.sample().actuators[0].bristles.expect("bristles");
                    // A longer step leaves them beyond for a while where the load turns within it.
                    assert!(step > 5e-4 || bent.abs() <= 1.0001 * RATIO * reach, "{bent:e}");
                    largest =
                        if f64::from(index) * step > 5.5 { largest.max(stepper.state().velocity.abs()) } else { 0.0 };
                }
                assert!(largest < 1e-3, "still {largest:e} m/s at steps of {step} s with {reach:e}, {damping:e}");
            }
        }
    }
}

#[test]
fn what_slides_never_yields_work() {
    // Fast and slow, to and fro, with the damping at its bound; what is stored comes from the deflection alone.
    let most = 4.0 * (2.0 * std::f64::consts::E).sqrt() * REACH / STRIBECK;
    for damping in [0.0, DAMPING, 0.999_999 * most] {
        for ratio in [1.0, RATIO, 5.0] {
            let law = bristles(REACH, ratio, STRIBECK, damping);
            let lengths: Vec<f64> = (0..60).map(|k| MIDDLE + between(k, 1, -4e-4, 4e-4)).collect();
            let time: Vec<f64> = (0..60).map(|k| 0.04 * k as f64).collect();
            let paper = moved_along(muscle(law), time, lengths);
            let slips: Vec<f64> = (1..24).map(|k| paper.run(0.1 * f64::from(k), 1e-8).audit().slip).collect();
            assert!(slips[0] > 0.0 && slips.windows(2).all(|pair| pair[0] < pair[1]), "{slips:?}");
            let audit = paper.run(2.36, 1e-10).audit();
            assert_within(audit.residual(), 0.0, 1e-8 * audit.turnover());
        }
    }
    // Power less what is stored, by the memory in small steps of a motion that turns and accelerates.
    let (law, mut memory) = (bristles(REACH, RATIO, STRIBECK, 0.999_999 * most), Memory::relaxed(MIDDLE));
    let (steps, period) = (200_000, 1.0);
    let stored = |memory: &Memory| 0.5 * WIDTH / REACH * memory.elements[0] * memory.elements[0];
    for step in 1..=steps {
        let at = |part: f64| {
            let phase = 2.0 * PI * (f64::from(step) - part) / f64::from(steps) / period;
            (MIDDLE + 1e-3 * phase.sin(), 2e-3 * PI * phase.cos())
        };
        let (before, from) = (stored(&memory), memory.at);
        let middle = law.width(&memory, at(0.5).0, at(0.5).1);
        law.moved(&mut memory, at(0.0).0, at(0.0).1);
        let lost = middle * (memory.at - from) - (stored(&memory) - before);
        assert!(lost > -1e-9 * WIDTH * (memory.at - from).abs(), "{lost:e} at step {step}");
    }
}

#[test]
fn stiff_bristles_are_coulomb_friction() {
    let swing = |paper: Paper| {
        let paper = paper.mass(5.0 * LB);
        let length = paper.balance(5.0 * LB * GRAVITY) + 2e-3;
        let run = paper.from(length, 0.0).run(0.1, 1e-9);
        move |time: f64| run.at(time).length
    };
    let coulomb = swing(muscle(law()).with(|rig| rig.hysteresis = None).friction(0.0, WIDTH));
    let off = |reach: f64| {
        let bent = swing(muscle(bristles(reach, 1.0, STRIBECK, 0.0)));
        (1..30).map(|k| (bent(0.003 * f64::from(k)) - coulomb(0.003 * f64::from(k))).abs()).fold(0.0, f64::max)
    };
    let (far, near) = (off(1e-5), off(1e-6));
    assert!(near < 2e-5 && near < 0.5 * far, "{far:e} {near:e}");
}

#[test]
fn derivatives_pass_through_the_bristles() {
    let swing = |reach| muscle(bristles(reach, RATIO, STRIBECK, DAMPING)).mass(5.0 * LB).from(0.083, 0.0);
    let at = |reach| swing(reach).run(0.15, 1e-12).at(0.15).length;
    let seed = |parameter: &'static mckibben::parameter::Parameter, value: f64| -> crate::common::Seeded {
        let seeded = parameter.key == mckibben::parameter::BRISTLE_REACH.key;
        if seeded { Dual::variable(value, 0) } else { Dual::of(value) }
    };
    let (rig, initial) = (swing(REACH).rig().map(seed), swing(REACH).initial().map(seed));
    let start = rig.begin(&initial).expect("a start");
    let exact = simulate(&rig, start, Dual::of(0.15), 1e-12).expect("a run").at(Dual::of(0.15)).length;
    assert_within(exact.value, at(REACH), 1e-13);
    assert_close(exact.slope[0], slope(2e-7, |change| at(REACH + change)), 1e-5);
}

#[test]
fn relaxed_bristles_are_a_spring_and_a_damper() {
    let paper = muscle(law()).friction(3.0, 0.0);
    let actuator = paper.actuator();
    let (length, pressure) = (0.085, AbsolutePressure(ATMOSPHERE + GAUGE));
    let state = ActuatorState::new(pressure, 1e-5, length);
    let response = actuator.respond(&state, length, 0.0, Ports::CLOSED);
    let stiffness = secant(&paper, length, GAUGE) * WIDTH / REACH;
    assert_close(response.per_velocity, 3.0 + stiffness * DAMPING, 1e-12);
    assert_close(response.per_length, actuator.stiffness(length, pressure) + stiffness, 1e-12);
}

#[test]
fn numbers_that_would_yield_work_are_refused() {
    let outside = |error: Error, key: &str| assert!(error.to_string().contains(key), "{error}");
    outside(LuGre::new(0.0, 1e-5).expect_err("no law"), "width");
    outside(LuGre::new(1e-4, f64::NAN).expect_err("no law"), "bristle_reach");
    let refused = |ratio, velocity, time| {
        LuGre::new(1e-4, 1e-5).and_then(|law| law.with_velocity(ratio, velocity, time)).expect_err("no law")
    };
    outside(refused(0.9, 1e-2, 0.0), "static_ratio");
    outside(refused(1.5, 0.0, 0.0), "stribeck_velocity");
    outside(refused(1.5, 1e-2, -1.0), "damping_time");
    outside(refused(1.5, 1e-2, 1e-2), "yield work");
}
