//! Random rigs: any geometry, process, valve, command, load, friction and start that a scenario admits.
#![allow(dead_code)]

use crate::common::{ATMOSPHERE, GRAVITY, Paper};
use mckibben::Actuator;
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Coulomb, Hysteresis, LuGre, MaxwellSlip, Memory, Viscoelastic};
use mckibben::load::{Load, Motion};
use mckibben::simulation::InitialLength;
use mckibben::valve::{Command, ExhaustTemperature, FlowStandard, Request, ValveKind};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// One rig and how it is run.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) paper: Paper,
    pub(crate) duration: f64,
    pub(crate) tolerance: f64,
}

fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.log10()..high.log10()).prop_map(|power| 10.0_f64.powf(power))
}

/// Geometry: thread, turns, stretched share, shortest share, stiffness and damping of the taut braid, external volume.
fn geometry() -> impl Strategy<Value = Paper> {
    (
        decades(0.01, 0.6),
        0.8..6.0_f64,
        0.7..0.97_f64,
        prop::option::of(0.3..0.68_f64),
        decades(1e4, 1e7),
        0.0..300.0_f64,
        decades(1e-8, 1e-3),
    )
        .prop_map(|(b, turns, longest, shortest, stiffness, damping, external)| {
            Paper::sealed().with(|rig| {
                (rig.thread_length, rig.turns, rig.max_length) = (b, turns, longest * b);
                rig.min_length = shortest.map(|share| share * b);
                (rig.limit_stiffness, rig.limit_damping) = (stiffness, damping);
                rig.external_volume = external;
            })
        })
}

fn process() -> impl Strategy<Value = Process> {
    let balance = (prop::option::of(decades(1e-3, 10.0)), 250.0..350.0_f64).prop_map(|(transfer, wall)| {
        Process::EnergyBalance { heat_transfer: transfer.unwrap_or(0.0), wall_temperature: wall }
    });
    prop_oneof![
        2 => Just(Process::Isentropic),
        1 => Just(Process::Isothermal),
        1 => (0.8..1.6_f64).prop_map(|index| Process::Polytropic { index }),
        2 => balance,
    ]
}

fn command() -> impl Strategy<Value = (ValveKind, Option<Command>)> {
    let request = || prop::sample::select(vec![Request::Fill, Request::Exhaust]);
    let any = || prop::sample::select(vec![Request::Fill, Request::Hold, Request::Exhaust]);
    let pwm = |(f, d, pulse, rest)| Command::pwm(f, d, pulse, rest).expect("a command");
    prop_oneof![
        1 => Just((ValveKind::ThreeWay, None)),
        2 => request().prop_map(|one| (ValveKind::ThreeWay, Some(Command::Constant(one)))),
        4 => (1.0..200.0_f64, 0.0..1.0_f64, request(), request())
            .prop_map(move |all| (ValveKind::ThreeWay, Some(pwm(all)))),
        3 => (1.0..100.0_f64, 0.0..1.0_f64, any(), any())
            .prop_map(move |all| (ValveKind::FillHoldExhaust, Some(pwm(all)))),
    ]
}

/// Supply, flow path and delays.
fn valve(paper: Paper) -> impl Strategy<Value = Paper> {
    let standard = prop_oneof![
        decades(1e-8, 2e-5).prop_map(|flow_area| FlowStandard::Orifice { flow_area }),
        (decades(1e-10, 1e-7), 0.0..0.6_f64).prop_map(|(sonic_conductance, critical_ratio)| FlowStandard::Iso6358 {
            sonic_conductance,
            critical_ratio
        }),
    ];
    let gauge = prop_oneof![4 => 0.0..1e6_f64, 1 => -0.95 * ATMOSPHERE..0.0, 1 => Just(0.0)];
    let outflow = prop::sample::select(vec![ExhaustTemperature::Actuator, ExhaustTemperature::Ambient]);
    (command(), standard, gauge, 250.0..350.0_f64, outflow, 0.0..5e-3_f64, 0.0..5e-3_f64).prop_map(
        move |((kind, command), standard, gauge, kelvin, outflow, open, close)| {
            paper.clone().with(|rig| {
                (rig.kind, rig.command, rig.standard, rig.exhaust_temperature) = (kind, command, standard, outflow);
                (rig.supply_gauge, rig.supply_temperature, rig.delays) = (gauge, kelvin, (open, close));
                // One in four has a separate flow path to the atmosphere, stated by Kv, of another size.
                if kelvin.fract() < 0.25 {
                    let kv = 1e-6 * 10.0_f64.powf(8.0 * kelvin.fract());
                    rig.exhaust = Some(FlowStandard::Kv { kv, pressure_drop_ratio: 0.4 + 1.5 * kelvin.fract() });
                }
            })
        },
    )
}

/// Dry friction of another scale that falls with velocity, now and then.
fn falling() -> impl Strategy<Value = Option<Coulomb>> {
    let numbers = (decades(1e-7, 1e-3), 0.0..2.0_f64, decades(1e-8, 1e-5), 1.0..2.0_f64, decades(1e-3, 0.1));
    let law = |(width, force, per_pressure, ratio, velocity)| {
        let law = Coulomb::new(width).and_then(|law| law.with_force(force, per_pressure));
        law.and_then(|law| law.with_stribeck(ratio, velocity)).expect("a law")
    };
    prop_oneof![4 => Just(None), 1 => numbers.prop_map(move |numbers| Some(law(numbers)))]
}

/// A law of hysteresis, now and then.
fn elements() -> impl Strategy<Value = Option<Hysteresis>> {
    let some = prop::collection::vec((decades(1e-6, 1e-2), decades(1e-3, 3.0)), 1..=12).prop_map(|pairs| {
        let (reach, ratio): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        Some(Hysteresis::MaxwellSlip(MaxwellSlip::new(&reach, &ratio).expect("elements")))
    });
    let rounded = (decades(1e-7, 1e-3), decades(1e2, 1e5), -0.9..1.0_f64).prop_map(|(width, beta, part)| {
        Some(Hysteresis::BoucWen(BoucWen::new(width, beta, part * beta).expect("a law")))
    });
    let numbers = (decades(1e-6, 1e-2), decades(1e-3, 3.0), 1.0..2.0_f64, decades(1e-3, 0.1), 0.0..9.0_f64);
    let bristles = numbers.prop_map(|(reach, stiffness, ratio, velocity, damping)| {
        let law = LuGre::new(stiffness * reach, reach);
        let law = law.and_then(|law| law.with_velocity(ratio, velocity, damping * reach / velocity));
        Some(Hysteresis::LuGre(law.expect("a law")))
    });
    prop_oneof![9 => Just(None), 3 => some, 1 => rounded, 1 => bristles]
}

/// Structural damping and viscoelastic branches, now and then.
fn creeping() -> impl Strategy<Value = (f64, Option<Viscoelastic>)> {
    let branch =
        (prop_oneof![Just(0.0), decades(1.0, 1e4)], prop_oneof![Just(0.0), decades(1e-3, 3.0)], decades(1e-4, 10.0));
    let branches = prop::collection::vec(branch, 1..=6).prop_map(|branches| {
        let of = |part: fn(&(f64, f64, f64)) -> f64| branches.iter().map(part).collect::<Vec<f64>>();
        let law = Viscoelastic::new(&of(|its| its.0), &of(|its| its.1), &of(|its| its.2));
        Some(law.expect("branches"))
    });
    (prop_oneof![5 => Just(0.0), 1 => decades(1e-5, 1e-2)], prop_oneof![5 => Just(None), 1 => branches])
}

/// Load and start.
fn load(paper: Paper) -> impl Strategy<Value = Paper> {
    let kind = prop_oneof![
        5 => decades(1e-3, 50.0).prop_map(|mass| Load::HangingMass { mass, gravity: GRAVITY }),
        1 => (decades(1e-3, 50.0), -20.0..100.0_f64).prop_map(|(mass, force)| Load::ConstantForce { mass, force }),
        3 => Just(Load::Isometric),
        1 => (0.3..0.7_f64, 0.0..0.25_f64, 0.5..20.0_f64).prop_map({
            let b = paper.thread_length;
            move |(mean, swing, f)| Load::Prescribed(Motion::sinusoid(mean * b, swing * b, f, 0.3, b).expect("a motion"))
        }),
    ];
    let start = prop_oneof![1 => Just(None), 2 => (0.3..1.02_f64).prop_map(Some)];
    let gauge = prop_oneof![3 => 0.0..7e5_f64, 1 => -0.9 * ATMOSPHERE..0.0, 1 => Just(0.0)];
    let friction = (prop_oneof![Just(0.0), decades(0.01, 30.0)], prop_oneof![Just(0.0), decades(1e-7, 3e-3)]);
    let laws = (falling(), elements(), creeping());
    (kind, start, gauge, -1.0..1.0_f64, friction, process(), laws).prop_map(
        move |(
            load,
            start,
            gauge,
            velocity,
            (viscous, width),
            process,
            (coulomb, hysteresis, (structural, branches)),
        )| {
            paper.clone().with(|rig| {
                rig.length = match (&load, start) {
                    (Load::HangingMass { .. } | Load::ConstantForce { .. }, None) => InitialLength::Equilibrium,
                    (_, share) => InitialLength::At(share.unwrap_or(0.9) * rig.max_length),
                };
                // A braid stiff enough to carry the load with room to spare.
                let weight = match load {
                    Load::HangingMass { mass, gravity } => mass * gravity,
                    Load::ConstantForce { force, .. } => force.abs(),
                    _ => 0.0,
                };
                rig.limit_stiffness = rig.limit_stiffness.max(20.0 * weight / (rig.thread_length - rig.max_length));
                (rig.load, rig.gauge, rig.velocity, rig.process) = (load, gauge, velocity, process);
                (rig.viscous, rig.coulomb_width) = (viscous, width);
                (rig.coulomb, rig.hysteresis) = (coulomb, hysteresis);
                (rig.structural, rig.viscoelastic) = (structural, branches);
            })
        },
    )
}

/// Any admissible rig.
pub(crate) fn cases() -> impl Strategy<Value = Case> {
    (geometry().prop_flat_map(valve).prop_flat_map(load), 0.02..0.2_f64, decades(1e-9, 1e-4))
        .prop_map(|(paper, duration, tolerance)| Case { paper, duration, tolerance })
}

/// What an audit may leave over in J, by what is known of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accounted {
    /// How many states the integrator has.
    pub(crate) states: usize,
    /// How many steps it took, and its relative tolerance.
    pub(crate) steps: (u64, f64),
    /// The energy in J of which the tolerance is a part: what changed hands, the gas's P V, what the load's force does over
    /// the length, and its kinetic energy.
    pub(crate) energy: f64,
    /// The most power in W that friction takes which falls with velocity, over what it takes at speed; and how long in s.
    pub(crate) falling: (f64, f64),
}

impl Accounted {
    /// A step errs in each state by up to the tolerance, as a part of that state; the errors of all steps add up at most.
    ///
    /// Friction that falls with velocity does so within millimetres a second, which are passed within a step: the quadrature
    /// of the audit and the error that the integrator estimates may then miss what it takes, whatever the tolerance.
    pub(crate) fn allowed(&self) -> f64 {
        let (steps, tolerance) = self.steps;
        let rounding = 1e-15 * steps.max(1) as f64 * self.energy;
        self.states as f64 * steps.max(1) as f64 * tolerance * self.energy + self.falling.0 * self.falling.1 + rounding
    }
}

/// The most power in W that the part of an actuator's friction takes which falls with velocity, at a length and a pressure.
pub(crate) fn falling_power(actuator: &Actuator, length: f64, pressure: f64) -> f64 {
    let friction = actuator.friction();
    let kinetic: f64 = actuator.coulomb_bound(length, pressure);
    let secant: f64 = actuator.secant_stiffness(length, pressure);
    let force = |velocity: f64| {
        // After a metre no law remembers where it began.
        let bristles = friction.lugre().zip(friction.hysteresis()).map_or(0.0, |(_, law)| {
            let mut memory = Memory::relaxed(0.0);
            law.moved(&mut memory, 1.0, velocity);
            secant * law.width(&memory, 1.0, velocity)
        });
        friction.coulomb().sliding(1.0, velocity, kinetic) + bristles
    };
    let fast = force(1e3);
    let powers = (0..120).map(|k| 10.0_f64.powf(-4.0 + 0.04 * f64::from(k))).map(|v| v * (force(v) - fast));
    powers.fold(0.0, f64::max)
}

/// A runner of `cases` cases that are the same in every run, unless `MCKIBBEN_CASES` and `MCKIBBEN_SEED` say otherwise.
pub(crate) fn runner(cases: u32) -> TestRunner {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u32>().ok());
    let cases = number("MCKIBBEN_CASES").unwrap_or(cases);
    let mut seed = [7; 32];
    seed[..4].copy_from_slice(&number("MCKIBBEN_SEED").unwrap_or(0).to_le_bytes());
    seeded_runner(cases, seed)
}

/// A runner of so many cases from a seed.
pub(crate) fn seeded_runner(cases: u32, seed: [u8; 32]) -> TestRunner {
    let config = Config { cases, max_shrink_iters: 300, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &seed))
}
