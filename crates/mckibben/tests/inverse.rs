//! The static model inverted: (3) solved for the pressure, round trips, implicit derivatives, the joint's stiffness
//! against a displaced joint, and what is refused.

use crate::common::laws as of_force;
use crate::common::{ATMOSPHERE, PSI, Paper, ROOM, assert_close, assert_within, between, slope};
use mckibben::air::Process;
use mckibben::control::{AntagonisticPair, Held};
use mckibben::force::Effectiveness;
use mckibben::{Actuator, Dual, GaugePressure, Over};
use std::f64::consts::PI;

const BOTH: [Held; 2] = [Held::Pressures, Held::AirMasses];

fn table() -> Effectiveness {
    Effectiveness::table(&[0.0, 1e5, 3e5, 6e5], &[0.5, 0.8, 0.86, 0.9]).expect("a table")
}

fn laws() -> [Effectiveness; 3] {
    let polynomial = Effectiveness::polynomial(&[0.7, 6e-7, -4e-13]).expect("a polynomial");
    [Effectiveness::Constant(0.9), polynomial, table()]
}

fn actuator(effectiveness: Effectiveness) -> Actuator {
    Paper::sealed().with(|paper| paper.effectiveness = effectiveness).actuator()
}

/// Tension at rest without friction.
fn tension(actuator: &Actuator, length: f64, gauge: f64) -> f64 {
    actuator.tension_sliding(length, 0.0, gauge + ATMOSPHERE, 0.0)
}

#[test]
fn with_a_constant_effectiveness_it_is_equation_3_solved_for_the_pressure() {
    let paper = Paper::sealed().with(|paper| paper.effectiveness = Effectiveness::Constant(0.8));
    let (actuator, b, n) = (paper.actuator(), paper.thread_length, paper.turns);
    for row in 0..100 {
        let (length, force) = (between(row, 0, 0.0650, 0.0970), between(row, 1, 0.0, 80.0));
        let expected = 4.0 * PI * n * n * force / (0.8 * b * b * (3.0 * length * length / (b * b) - 1.0));
        let gauge = actuator.holding_pressure(force, length).expect("a pressure");
        assert_close(gauge.0, expected, 1e-13);
    }
}

#[test]
fn the_pressure_gives_the_force_and_no_lower_one_does() {
    for law in laws() {
        let actuator = actuator(law);
        for row in 0..200 {
            let (length, gauge) = (between(row, 0, 0.0650, 0.0985), between(row, 1, 0.0, 7e5));
            let force = tension(&actuator, length, gauge);
            let found = actuator.holding_pressure(force, length).expect("a pressure").0;
            assert_within(tension(&actuator, length, found), force, 1e-12 * (1.0 + force));
            let lower = (0..50).map(|part| found * f64::from(part) / 50.0);
            assert!(lower.into_iter().all(|lower| tension(&actuator, length, lower) <= force + 1e-9));
        }
    }
}

#[test]
fn every_force_law_is_inverted_with_its_derivatives() {
    let paper = Paper::sealed();
    for (name, law) in of_force::all(&paper).into_iter().chain([("map", of_force::measured(&paper))]) {
        let change = |rig: &mut Paper| (rig.characteristic, rig.effectiveness) = (Some(law.clone()), table());
        let actuator = paper.clone().with(change).actuator();
        let mut pulling = 0;
        for row in 0..100 {
            let (length, gauge) = (between(row, 0, 0.072, 0.0975), between(row, 1, 1e5, 6e5));
            let force = tension(&actuator, length, gauge);
            if force == 0.0 {
                continue;
            }
            pulling += 1;
            let found = actuator.holding_pressure(force, length).expect("a pressure").0;
            assert_within(tension(&actuator, length, found), force, 1e-11 * (1.0 + force));
            assert!(found <= gauge * (1.0 + 1e-9), "{name}: {found} is not the least, {gauge} gives it too");
            let wide = actuator.map(|_, number| Dual::<f64, 2>::of(number));
            let dual = wide.holding_pressure(Dual::variable(force, 0), Dual::variable(length, 1)).expect("a pressure");
            let solve = |force, length| actuator.holding_pressure(force, length).expect("a pressure").0;
            assert_close(dual.0.slope[0], slope(1e-4 * force, |h| solve(force + h, length)), 1e-4);
            assert_close(dual.0.slope[1], slope(1e-6, |h| solve(force, length + h)), 1e-3);
        }
        assert!(pulling > 50, "{name} pulls at {pulling} places only");
    }
    // A bladder pushes without pressure; it takes some to hold nothing.
    let stiff = of_force::bladder(&paper, mckibben::force::BladderForm::Linear);
    let actuator = paper.clone().with(|rig| rig.characteristic = Some(stiff.clone())).actuator();
    let none = actuator.holding_pressure(0.0, 0.08).expect("the pressure at which the bladder is held");
    assert_within(actuator.static_force(0.08, none.0 + ATMOSPHERE), 0.0, 1e-10);
    assert!(none.0 > 1e3, "{none:?}");
    let error = AntagonisticPair::new([&actuator; 2], [0.08; 2], [0.015; 2]).expect_err("not the ideal braid");
    assert!(error.to_string().contains("than the ideal braid's"), "{error}");
}

#[test]
fn the_least_pressure_is_located_near_a_peak() {
    // Eff P = P − P²/1 MPa has its peak, 250 kPa, at 500 kPa.
    let actuator = actuator(Effectiveness::polynomial(&[1.0, -1e-6]).expect("a polynomial"));
    let length = 0.09;
    let area = actuator.pull_area(length);
    for share in [0.1, 0.9, 0.999, 1.0 - 1e-9] {
        let force = share * 250e3 * area;
        let expected = 500e3 * (1.0 - (1.0 - share).sqrt());
        let gauge = actuator.holding_pressure(force, length).expect("a pressure").0;
        assert_within(gauge, expected, 1e-7 * expected / (1.0 - share).sqrt());
    }
    let message = actuator.holding_pressure(1.001 * 250e3 * area, length).expect_err("above the peak").to_string();
    assert!(message.contains("controller.force = ") && message.contains("must not be more than"), "{message}");
    let most: f64 =
        message.split("effectiveness, = ").nth(1).expect("a bound").split(' ').next().unwrap().parse().unwrap();
    assert_close(most, 250e3 * area, 1e-9);
}

#[test]
fn derivatives_are_those_of_the_implicit_function() {
    for law in laws() {
        let actuator = actuator(law);
        let wide = actuator.map(|_, number| Dual::<f64, 2>::of(number));
        for row in 0..20 {
            let (length, force) = (between(row, 0, 0.0700, 0.0970), between(row, 1, 5.0, 60.0));
            let gauge =
                wide.holding_pressure(Dual::variable(force, 0), Dual::variable(length, 1)).expect("a pressure").0;
            let at = |force: f64, length: f64| actuator.holding_pressure(force, length).expect("a pressure").0;
            assert_close(gauge.value, at(force, length), 1e-13);
            assert_close(gauge.slope[0], slope(1e-3, |h| at(force + h, length)), 1e-7);
            assert_close(gauge.slope[1], slope(1e-6, |h| at(force, length + h)), 1e-7);
        }
    }
}

#[test]
fn the_taut_braid_carries_its_part() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let length = paper.max_length + 1e-4;
    let braid = tension(&actuator, length, 0.0);
    assert_close(braid, paper.limit_stiffness * 1e-4, 1e-9);
    let gauge = actuator.holding_pressure(braid + 10.0, length).expect("a pressure").0;
    assert_close(gauge, 10.0 / actuator.pull_area(length), 1e-12);
    assert_eq!(actuator.holding_pressure(braid, length).map(|gauge| gauge.0.abs() < 1e-9), Ok(true));
}

#[test]
fn what_no_pressure_gives_is_refused_by_name_value_and_bound() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let refused = |force, length| actuator.holding_pressure(force, length).expect_err("refused").to_string();
    let cases = [
        (-1.0, 0.09, ["controller.force = -1 N", "at least 0", "a tendon can only pull"]),
        (f64::NAN, 0.09, ["controller.force = NaN N", "at least 0", "a tendon can only pull"]),
        (10.0, 0.06, ["controller.length = 0.06 m", "must be greater than actuator.min_length", "longer length"]),
        (10.0, 0.2, ["controller.length = 0.2 m", "must be less than actuator.thread_length", "shorter length"]),
        (1.0, paper.max_length + 1e-4, ["controller.force = 1 N", "taut braid alone", "shorter length"]),
    ];
    for (force, length, parts) in cases {
        let message = refused(force, length);
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
    let short = Paper::sealed().with(|paper| paper.min_length = Some(0.05)).actuator();
    let message = short.holding_pressure(10.0, 0.06).expect_err("it pushes").to_string();
    assert!(message.contains("thread_length/sqrt(3)"), "{message}");
    let idle = self::actuator(Effectiveness::Constant(0.0));
    assert!(idle.holding_pressure(1.0, 0.09).is_err());
    assert_eq!(idle.holding_pressure(0.0, 0.09).map(|gauge| gauge.0), Ok(0.0));
}

#[test]
fn within_bounds_there_is_always_a_pressure() {
    let actuator = actuator(table());
    let highest = GaugePressure(100.0 * PSI);
    let within = |force: f64, length: f64| actuator.holding_pressure_within(force, length, highest).0;
    assert_eq!(within(10.0, 0.05), highest.0);
    assert_eq!(within(0.0, 0.05), 0.0);
    assert_eq!(within(1e6, 0.09), highest.0);
    assert_eq!(within(1.0, 0.0985), 0.0);
    assert_eq!(within(20.0, 0.09), actuator.holding_pressure(20.0, 0.09).expect("a pressure").0);
}

#[test]
fn masses_of_air_are_those_of_the_perfect_gas() {
    let paper = Paper::sealed();
    let (b, n, length) = (paper.thread_length, paper.turns, 0.09);
    let volume = length * (b * b - length * length) / (4.0 * PI * n * n) + paper.external_volume;
    let mass = paper.actuator().air_mass(GaugePressure(3e5), length, ROOM);
    assert_close(mass, (3e5 + ATMOSPHERE) * volume / (paper.gas_constant * ROOM), 1e-13);
}

/// Two unlike actuators on unlike pulleys.
struct Limb {
    actuators: [Actuator; 2],
    rest: [f64; 2],
    arm: [f64; 2],
}

impl Limb {
    fn new(laws: [Effectiveness; 2], process: Process) -> Self {
        let long = Paper::sealed().process(process).with(|paper| {
            (paper.effectiveness, paper.external_volume) = (laws[1], 8e-6);
            (paper.thread_length, paper.turns, paper.max_length) = (0.15, 2.1, 0.13);
        });
        let first = Paper::sealed().process(process).with(|paper| paper.effectiveness = laws[0]);
        Self { actuators: [first.actuator(), long.actuator()], rest: [0.088, 0.11], arm: [0.012, 0.015] }
    }

    fn lengths(&self, angle: f64) -> [f64; 2] {
        [self.rest[0] - self.arm[0] * angle, self.rest[1] + self.arm[1] * angle]
    }

    fn pair(&self, angle: f64) -> AntagonisticPair<'_> {
        AntagonisticPair::new(self.actuators.each_ref(), self.lengths(angle), self.arm).expect("a pair")
    }

    /// Torque when the joint is turned from `angle` by `turn`, the pressures kept or following their volumes.
    fn displaced(&self, angle: f64, turn: f64, gauge: [f64; 2], held: Held) -> f64 {
        let (from, to) = (self.lengths(angle), self.lengths(angle + turn));
        let pull = |i: usize| {
            let actuator = &self.actuators[i];
            let volume = |length: f64| -> f64 { actuator.volume(length) };
            let compression = match held {
                Held::Pressures => 1.0,
                Held::AirMasses => (volume(from[i]) / volume(to[i])).powf(actuator.air().index()),
            };
            let pressure = (gauge[i] + ATMOSPHERE) * compression;
            self.arm[i] * tension(actuator, to[i], pressure - ATMOSPHERE)
        };
        pull(0) - pull(1)
    }
}

fn limbs() -> impl Iterator<Item = Limb> {
    let processes = [Process::Isentropic, Process::Isothermal, Process::Polytropic { index: 1.2 }];
    processes.into_iter().flat_map(|process| {
        let [constant, polynomial, table] = laws();
        [[constant, constant], [table, constant], [polynomial, table]].map(|laws| Limb::new(laws, process))
    })
}

#[test]
fn two_pressures_give_the_torque_and_the_stiffness_of_the_displaced_joint() {
    for limb in limbs() {
        for (row, held) in (0..12).flat_map(|row| BOTH.map(|held| (row, held))) {
            let angle = between(row, 0, -0.3, 0.7);
            let gauge = [between(row, 1, 5e3, 6e5), between(row, 2, 5e3, 6e5)];
            let torque = limb.displaced(angle, 0.0, gauge, held);
            let stiffness = -slope(1e-4, |turn| limb.displaced(angle, turn, gauge, held));
            let found = limb.pair(angle).pressures(torque, stiffness, held).expect("two pressures");
            for i in 0..2 {
                assert_within(found[i].0, gauge[i], 1e-5 * (gauge[0] + gauge[1]));
            }
            // What the pair says of itself agrees to rounding.
            let pair = limb.pair(angle);
            assert_within(pair.torque(found), torque, 1e-12 * (1.0 + torque.abs()));
            assert_close(pair.stiffness(found, held), stiffness, 1e-7);
            let again = pair.pressures(pair.torque(found), pair.stiffness(found, held), held).expect("two pressures");
            for i in 0..2 {
                assert_within(again[i].0, found[i].0, 1e-10 * (gauge[0] + gauge[1]));
            }
        }
    }
}

#[test]
fn at_constant_pressure_it_is_cramer_s_rule_on_3_and_7() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let (b, n, arm, length) = (paper.thread_length, paper.turns, 0.01, 0.085);
    let pair = AntagonisticPair::new([&actuator; 2], [length; 2], [arm; 2]).expect("a pair");
    // Alike at the same length: τ = r a (P₁ − P₂) and K = r² k (P₁ + P₂).
    let a = (3.0 * length * length - b * b) / (4.0 * PI * n * n);
    let k = 3.0 * length / (2.0 * PI * n * n);
    let (torque, stiffness) = (0.1, 0.7);
    let (difference, sum) = (torque / (arm * a), stiffness / (arm * arm * k));
    let found = pair.pressures(torque, stiffness, Held::Pressures).expect("two pressures");
    assert_close(found[0].0, 0.5 * (sum + difference), 1e-12);
    assert_close(found[1].0, 0.5 * (sum - difference), 1e-12);
}

#[test]
fn derivatives_of_the_two_pressures_are_exact() {
    for limb in limbs() {
        let wide = limb.actuators.each_ref().map(|actuator| actuator.map(|_, number| Dual::<f64, 2>::of(number)));
        let lengths = limb.lengths(0.2);
        for held in BOTH {
            let pair =
                AntagonisticPair::new(wide.each_ref(), lengths.map(Dual::of), limb.arm.map(Dual::of)).expect("one");
            let gauge = [GaugePressure(2.9e5), GaugePressure(2e5)];
            let narrow = limb.pair(0.2);
            let (torque, stiffness) = (narrow.torque(gauge), narrow.stiffness(gauge, held));
            let found =
                pair.pressures(Dual::variable(torque, 0), Dual::variable(stiffness, 1), held).expect("pressures");
            for i in 0..2 {
                assert_close(found[i].0.value, gauge[i].0, 1e-10);
                let at = |torque, stiffness| narrow.pressures(torque, stiffness, held).expect("pressures")[i].0;
                assert_close(found[i].0.slope[0], slope(1e-4, |h| at(torque + h, stiffness)), 1e-6);
                assert_close(found[i].0.slope[1], slope(1e-4, |h| at(torque, stiffness + h)), 1e-6);
            }
        }
    }
}

#[test]
fn torque_and_stiffness_that_no_two_pressures_give_are_refused() {
    let limb = Limb::new([Effectiveness::Constant(1.0); 2], Process::Isentropic);
    let pair = limb.pair(0.0);
    // All of the torque from the agonist alone: the least stiffness.
    let alone = [GaugePressure(2e5), GaugePressure(0.0)];
    for held in BOTH {
        let (torque, least) = (pair.torque(alone), pair.stiffness(alone, held));
        let message = pair.pressures(torque, 0.99 * least, held).expect_err("too soft").to_string();
        assert!(message.contains("controller.stiffness") && message.contains("must not be less than"), "{message}");
        let at_least = pair.pressures(torque, least, held).expect("two pressures");
        assert_close(at_least[0].0, 2e5, 1e-9);
        assert_within(at_least[1].0, 0.0, 1e-4);
    }
    assert!(pair.pressures(f64::NAN, 1.0, Held::Pressures).is_err());
    assert!(pair.pressures(0.0, -1.0, Held::Pressures).is_err());
    let peaked = Limb::new([Effectiveness::polynomial(&[1.0, -1e-6]).expect("a polynomial"); 2], Process::Isentropic);
    let (first, second) = (&peaked.actuators[0], &peaked.actuators[1]);
    let most = peaked.arm[0] * first.pull_area(0.088) * 250e3;
    let message = peaked.pair(0.0).pressures(1.01 * most, 5.0, Held::Pressures).expect_err("too much").to_string();
    assert!(message.contains("controller.torque") && message.contains("must not go beyond"), "{message}");
    for (lengths, arm, part) in [
        ([0.06, 0.11], [0.01; 2], "actuator.min_length"),
        ([0.0985, 0.11], [0.01; 2], "actuator.max_length"),
        ([0.088, 0.11], [0.01, 0.0], "controller.arm"),
    ] {
        let message = AntagonisticPair::new([first, second], lengths, arm).expect_err("refused").to_string();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn within_bounds_the_torque_comes_first() {
    let highest = 4e5;
    for limb in limbs().take(3) {
        let pair = limb.pair(0.1);
        for (row, held) in (0..30).flat_map(|row| BOTH.map(|held| (row, held))) {
            let (torque, stiffness) = (between(row, 0, -1.5, 1.5), between(row, 1, 0.0, 4.0));
            let found = pair.pressures_within(torque, stiffness, held, GaugePressure(highest));
            assert!(found.iter().all(|gauge| (0.0..=highest).contains(&gauge.0)), "{found:?}");
            let error = |gauge| (pair.torque(gauge) - torque).abs();
            let off = |gauge| (pair.stiffness(gauge, held) - stiffness).abs();
            // No pair of a grid comes nearer to the torque, and none that has the torque nearer to the stiffness.
            let grid = |part: i32| GaugePressure(highest * f64::from(part) / 40.0);
            for gauge in (0..=40).flat_map(|first| (0..=40).map(move |second| [grid(first), grid(second)])) {
                assert!(error(gauge) > error(found) - 1e-9, "{gauge:?} is nearer than {found:?}");
            }
            let needed = |second: GaugePressure| {
                let first = limb.actuators[0].holding_pressure(
                    (torque + limb.arm[1] * tension(&limb.actuators[1], limb.lengths(0.1)[1], second.0)) / limb.arm[0],
                    limb.lengths(0.1)[0],
                );
                first.ok().filter(|first| first.0 <= highest).map(|first| [first, second])
            };
            for gauge in (0..=40).filter_map(|part| needed(grid(part))) {
                assert!(off(gauge) > off(found) - 1e-9, "{gauge:?} is nearer than {found:?}");
            }
        }
    }
}
