//! The laws of force other than the paper's: transcriptions, limiting cases, virtual work, energy, derivatives,
//! secants, and both engines on each.

use crate::common;
use crate::common::laws;
use crate::common::steps::RigSteps;

use common::accounts::Audited;
use common::{INCH, PSI, Paper, assert_close, assert_within, slope};
use laws::{
    BLADDER, BOLEN, COEFFICIENTS, END_FACTOR, MEMBRANE, MODULUS, SHAPE, TAPER, THREADS, WALL, all, bladder, extensible,
    martens_boblan, polynomial, tapered, tondu_lopez, walled,
};
use mckibben::force::{
    Bladder, BladderForm, Bolen, Characteristic, EndFactor, ExtensibleBraid, IdealBraid, LengthLimits, MAX_POWERS,
    MartensBoblan, Polynomial, Sarosi, StaticForce, Statics, Taper, Wall,
};
use mckibben::load::{Load, Motion};
use mckibben::simulation::{InitialLength, Method};
use mckibben::{Braid, Dual, Error, GaugePressure};
use std::f64::consts::PI;

/// Lengths in m and gauge pressures in Pa of the paper's actuator.
fn places() -> impl Iterator<Item = (f64, f64)> {
    (0..60).map(|n| (common::between(n, 0, 2.4, 3.84) * INCH, common::between(n, 1, -2.0, 95.0) * PSI))
}

/// A pressure at which a law may be evaluated.
fn at(gauge: f64) -> GaugePressure<f64> {
    GaugePressure(gauge)
}

#[test]
fn tondu_and_lopez_transcribed() {
    let paper = Paper::sealed();
    let ([limit, rise, decay], [radius, a, b]) = (END_FACTOR, COEFFICIENTS);
    let falling = EndFactor::falling(limit, rise, decay).expect("a factor");
    let law = tondu_lopez(&paper, falling, Some(laws::coefficients()));
    // The braid's own coefficients, from its angle at the longest length.
    let angle = (paper.max_length / paper.thread_length).acos();
    let of_braid = tondu_lopez(&paper, falling, None);
    let own = [0.5 * paper.braid().diameter(paper.max_length), 3.0 / angle.tan().powi(2), 1.0 / angle.sin().powi(2)];
    for (length, gauge) in places() {
        let contraction = (paper.max_length - length) / paper.max_length;
        let factor = rise * (-gauge / decay).exp() + limit;
        let literal =
            |[radius, a, b]: [f64; 3]| PI * radius * radius * gauge * (a * (1.0 - factor * contraction).powi(2) - b);
        let size = PI * radius * radius * gauge.abs() * (a + b);
        assert_within(law.force(length, at(gauge)), literal([radius, a, b]), 1e-14 * size);
        assert_within(of_braid.force(length, at(gauge)), literal(own), 1e-13 * size);
    }
}

#[test]
fn without_taper_tondu_and_lopez_is_the_ideal_braid() {
    let paper = Paper::sealed();
    let law = tondu_lopez(&paper, EndFactor::constant(1.0).expect("a factor"), None);
    let ideal = IdealBraid { braid: paper.braid() };
    for (length, gauge) in places() {
        let size = gauge.abs() * 1e-4;
        assert_within(law.force(length, at(gauge)), ideal.force(length, at(gauge)), 1e-13 * size);
    }
    // With a factor k the largest contraction is (1 − √(b/a))/k.
    let (factor, [_, a, b]) = (1.17, COEFFICIENTS);
    let law = tondu_lopez(&paper, EndFactor::constant(factor).expect("a factor"), Some(laws::coefficients()));
    let shortest = paper.max_length * (1.0 - (1.0 - (b / a).sqrt()) / factor);
    assert_within(law.force(shortest, at(60.0 * PSI)), 0.0, 1e-12);
}

#[test]
fn sarosi_transcribed_in_kilopascals_and_percent() {
    let law = Sarosi::new(0.3, [-4.35e-3, 287.0, -0.33, -9.2e-3, 0.302, -298.0]).expect("a law");
    let literal = |p: f64, k: f64| (-4.35 * p + 287.0) * (-0.33 * k).exp() + (-9.2 * k * p) + 302.0 * p - 298.0;
    for (kilopascals, percent) in [(100.0, 0.0), (350.0, 4.0), (500.0, 17.5), (0.0, 9.0), (600.0, -2.0)] {
        let force: f64 = law.force(0.3 * (1.0 - percent / 100.0), at(1e3 * kilopascals));
        assert_within(force, literal(kilopascals, percent), 1e-12 * 302.0 * 600.0);
    }
}

#[test]
fn martens_and_boblan_transcribed_stress_by_stress() {
    let paper = Paper::sealed();
    let law = martens_boblan(&paper);
    let ideal = IdealBraid { braid: paper.braid() };
    let (rest, [c0, c1, c2, c3]) = (paper.max_length, MODULUS);
    let widest: f64 = paper.braid().diameter(rest);
    for (length, gauge) in places() {
        let diameter: f64 = paper.braid().diameter(length);
        let widening = slope(1e-6, |h| paper.braid().diameter(length + h));
        let modulus = c0 + c1 * length + c2 * length * length + c3 * length * length * length;
        let (axial, hoop) = (modulus * (length - rest) / rest, modulus * (diameter - widest) / widest);
        let membrane = hoop * PI * MEMBRANE * length * widening - axial * PI * diameter * MEMBRANE;
        assert_within(law.force(length, at(gauge)), ideal.force(length, at(gauge)) + membrane, 1e-8 * 60.0);
    }
    // Without contraction the membrane is limp, and one of no thickness is none.
    for gauge in [-1e4, 0.0, 3e5] {
        assert_eq!(law.force(rest, at(gauge)), ideal.force(rest, at(gauge)));
    }
    let thin = MartensBoblan::new(&paper.braid(), rest, 1e-15, MODULUS).expect("a law");
    assert!(thin.membrane(0.07).abs() < 1e-9);
}

#[test]
fn the_membrane_is_the_derivative_of_its_energy() {
    let paper = Paper::sealed();
    let law = martens_boblan(&paper);
    assert_eq!(law.stored_energy(paper.max_length), 0.0);
    for (length, _) in places() {
        let tension = law.force(length, at(0.0));
        let dual: Dual<f64, 1> = law.stored_energy(Dual::variable(length, 0));
        assert_within(slope(1e-5, |h| law.stored_energy(length + h)), tension, 1e-8 * 10.0);
        assert_within(dual.slope[0], tension, 1e-11 * 10.0);
    }
}

#[test]
fn stretched_threads_take_the_length_of_least_energy() {
    let paper = Paper::sealed();
    let law = ExtensibleBraid::new(paper.braid(), THREADS).expect("a law");
    let (thread, per_turns) = (paper.thread_length, 1.0 / (4.0 * PI * paper.turns * paper.turns));
    for (length, gauge) in places() {
        let volume = |b: f64| length * (b * b - length * length) * per_turns;
        let energy = |b: f64| 0.5 * THREADS * (b - thread) * (b - thread) - gauge * volume(b);
        // A parabola through three places has its least place in closed form, and the energy is one.
        let h = 1e-3;
        let [low, middle, high] = [energy(thread - h), energy(thread), energy(thread + h)];
        let least = thread - 0.5 * h * (high - low) / (high - 2.0 * middle + low);
        assert_within(law.thread_length(length, at(gauge)), least, 1e-9);
        assert_close(law.volume(length, at(gauge)), volume(least), 1e-6);
        // The tension is the slope of that least energy over length.
        let relaxed = |h: f64| {
            let b = law.thread_length(length + h, at(gauge));
            let volume = (length + h) * (b * b - (length + h) * (length + h)) * per_turns;
            0.5 * THREADS * (b - thread) * (b - thread) - gauge * volume
        };
        assert_within(law.force(length, at(gauge)), slope(1e-5, relaxed), 1e-6);
    }
}

#[test]
fn stiff_threads_are_the_ideal_braid_and_soft_ones_pull_less() {
    let paper = Paper::sealed();
    let ideal = IdealBraid { braid: paper.braid() };
    let (stiff, soft) = (extensible(&paper, 1e15), extensible(&paper, THREADS));
    for (length, gauge) in places() {
        assert_within(stiff.force(length, at(gauge)), ideal.force(length, at(gauge)), 1e-9);
        assert!(soft.force(length, at(gauge)) <= ideal.force(length, at(gauge)));
        assert_eq!(soft.force(length, at(0.0)), 0.0);
    }
}

/// Force and volume of one potential: what a cycle costs the gas the load gains.
#[test]
fn an_extensible_braid_loses_nothing_against_its_own_volume() {
    let paper = Paper::sealed();
    let law = ExtensibleBraid::new(paper.braid(), THREADS).expect("a law");
    for (length, gauge) in places() {
        let [end, pressure] = [Dual::<f64, 2>::variable(length, 0), Dual::variable(gauge, 1)];
        let (force, volume) = (law.force(end, GaugePressure(pressure)), law.volume(end, GaugePressure(pressure)));
        assert_within(force.slope[1], -volume.slope[0], 1e-12 * 1e-3);
    }
    // Around a circle in length and pressure: the trapezoidal rule is exact for what is periodic.
    let count = 256;
    let (mut of_load, mut of_gas) = (0.0, 0.0);
    for step in 0..count {
        let (sine, cosine) = (2.0 * PI * f64::from(step) / f64::from(count)).sin_cos();
        let (length, gauge) = (0.085 + 0.008 * cosine, 3e5 + 2e5 * sine);
        let [length_rate, gauge_rate] = [-0.008 * sine, 2e5 * cosine];
        let [end, pressure] =
            [Dual { value: length, slope: [length_rate] }, Dual { value: gauge, slope: [gauge_rate] }];
        let volume: Dual<f64, 1> = law.volume(end, GaugePressure(pressure));
        of_load += -law.force(length, at(gauge)) * length_rate;
        of_gas += gauge * volume.slope[0];
    }
    assert!(of_gas.abs() > 10.0, "{of_gas}");
    assert_close(of_load, of_gas, 1e-12);
}

/// Above 54.7° a braid pushes: wound almost at right angles it is a piston, and against a spring it stands where a quadratic
/// says.
#[test]
fn an_extensile_braid_pushes() {
    let (gauge, turns, thread) = (3e5, 8.0, 0.6);
    let law = IdealBraid { braid: Braid::new(thread, turns).expect("a braid") };
    let area = |length: f64| 0.25 * PI * law.braid.diameter(length).powi(2);
    for degrees in [56.0_f64, 65.0, 75.0, 89.9] {
        let angle = degrees.to_radians();
        let length = thread * angle.cos();
        let push = -gauge * area(length) * (3.0 * angle.cos().powi(2) - 1.0) / angle.sin().powi(2);
        assert!(push > 0.0);
        assert_close(-law.force(length, at(gauge)), push, 1e-12);
    }
    let flat = thread * 89.9_f64.to_radians().cos();
    assert_close(-law.force(flat, at(gauge)), gauge * area(flat), 1e-4);
    // A spring that is compressed from 0.15 m on: P (b² − 3L²)/(4πn²) = k (L − 0.15).
    let (stiffness, start) = (4000.0, 0.15);
    let c = gauge / (4.0 * PI * turns * turns);
    let (p, q) = (stiffness / (3.0 * c), -(stiffness * start + c * thread * thread) / (3.0 * c));
    let stands = -0.5 * p + (0.25 * p * p - q).sqrt();
    assert!(stands > start + 0.002 && stands < law.braid.neutral_length(), "{stands}");
    assert_close(-law.force(stands, at(gauge)), stiffness * (stands - start), 1e-10);
}

#[test]
fn bolen_transcribed_and_its_two_ends() {
    let [force, pressure, contraction] = BOLEN;
    let law = Bolen::new(0.2, force, pressure, contraction, SHAPE).expect("a law");
    let [s0, s1, s2] = SHAPE;
    for (length, gauge) in places() {
        let x = (0.2 - length) / 0.2 / contraction;
        let literal = force * (s0 * ((-s1 * x).exp() - 1.0) + gauge / pressure * (-s2 * x * x).exp());
        assert_within(law.force(length, at(gauge)), literal, 1e-13 * force);
    }
    assert_eq!(law.force(0.2, at(pressure)), force);
    // s₀ (1 − e^(−s₁)) = e^(−s₂) makes the force vanish at the largest contraction.
    let closed = [(-s2).exp() / (1.0 - (-s1).exp()), s1, s2];
    let law = Bolen::new(0.2, force, pressure, contraction, closed).expect("a law");
    assert_within(law.force(0.2 * (1.0 - contraction), at(pressure)), 0.0, 1e-13 * force);
}

#[test]
fn a_polynomial_transcribed_power_by_power() {
    let law = Polynomial::new(0.3, &[2e-3, -1e-2, 3e-2, -7e-2, 0.2, -0.3], &[5.0, 300.0, -2e3, 6e3, -9e3, 4e3])
        .expect("a law");
    for (place, (_, gauge)) in places().enumerate() {
        let length = common::between(place, 3, 0.2, 0.31);
        let e = (0.3 - length) / 0.3;
        let pulls = 2e-3 - 1e-2 * e + 3e-2 * e.powi(2) - 7e-2 * e.powi(3) + 0.2 * e.powi(4) - 0.3 * e.powi(5);
        let resists = 5.0 + 300.0 * e - 2e3 * e.powi(2) + 6e3 * e.powi(3) - 9e3 * e.powi(4) + 4e3 * e.powi(5);
        assert_within(law.force(length, at(gauge)), gauge * pulls - resists, 1e-14 * (gauge.abs() + 300.0));
        // What resists gives back what it takes.
        let energy: Dual<f64, 1> = law.stored_energy(Dual::variable(length, 0));
        assert_within(energy.slope[0], -resists, 1e-12 * 300.0);
    }
    assert_eq!(law.stored_energy::<f64>(0.3), 0.0);
}

/// The ideal braid in a linear bladder is a polynomial of degree 2 and 1, in force, stiffness, energy and motion.
#[test]
fn a_polynomial_holds_the_ideal_braid_and_a_linear_bladder() {
    let paper = Paper::sealed();
    let (longest, thread) = (paper.max_length, paper.thread_length);
    let per_turns = 1.0 / (4.0 * PI * paper.turns * paper.turns);
    let squared = longest * longest * per_turns;
    let pressure = [3.0 * squared - thread * thread * per_turns, -6.0 * squared, 3.0 * squared];
    let (law, expected) = (polynomial(&paper, &pressure, &[0.0, BLADDER[0]]), bladder(&paper, BladderForm::Linear));
    for (place, (length, gauge)) in places().enumerate() {
        let size = gauge.abs() * 1e-4 + BLADDER[0];
        assert_within(law.force(length, at(gauge)), expected.force(length, at(gauge)), 1e-14 * size);
        let from = common::between(place, 2, 2.4, 3.8) * INCH;
        let [of_law, of_braid]: [f64; 2] =
            [law.secant_stiffness(length, from, at(gauge)), expected.secant_stiffness(length, from, at(gauge))];
        assert_within(of_law, of_braid, 1e-13 * size / longest);
        assert_within(law.stored_energy(length), expected.stored_energy(length), 1e-15 * size);
    }
    let run = |law| cycle(&paper).with(|rig| rig.characteristic = Some(law)).run(0.37, 1e-11).audit();
    let (audit, of_braid) = (run(law), run(expected));
    assert!(audit.effectiveness_loss.abs() < 1e-9 * audit.turnover(), "{audit:?}");
    assert_close(audit.bladder_storage, of_braid.bladder_storage, 1e-9);
}

/// Half the diameter of the braid of a rig in m.
fn radius(paper: &Paper, length: f64) -> f64 {
    0.5 * paper.braid().diameter::<f64>(length)
}

#[test]
fn a_taper_is_two_cones_and_pulls_by_virtual_work() {
    let paper = Paper::sealed();
    let [end, ratio] = TAPER;
    let ideal = || Characteristic::from(IdealBraid { braid: paper.braid() });
    for (law, wall) in [(tapered(&paper, ideal(), TAPER), 0.0), (tapered(&paper, walled(&paper), TAPER), WALL)] {
        for (length, gauge) in places() {
            let (middle, cone) = (radius(&paper, length), ratio * (radius(&paper, length) - end));
            // Simpson's rule is exact for the square of a radius that rises in proportion.
            let bore = |share: f64| PI * (end + share * (middle - end) - wall).powi(2);
            let of_cone = cone * (bore(0.0) + 4.0 * bore(0.5) + bore(1.0)) / 6.0;
            let volume = 2.0 * of_cone + (length - 2.0 * cone) * bore(1.0);
            assert_close(law.volume(length), volume, 1e-13);
            let by_work = -gauge * slope(1e-5, |h| law.volume(length + h));
            assert_within(law.force(length, at(gauge)), by_work, 1e-9 * gauge.abs() * 1e-4);
            if wall == 0.0 {
                let per_turns = 1.0 / (4.0 * PI * paper.turns * paper.turns);
                let thread = paper.thread_length;
                let bracket = 3.0 * length * length - thread * thread - 4.0 * ratio * length * (middle - end);
                assert_within(law.force(length, at(gauge)), gauge * per_turns * bracket, 1e-13 * gauge.abs() * 1e-4);
            }
        }
        // The model ends where the bore is half as wide as in the fittings; it has room until there.
        let stop = law.end_length();
        assert_close(radius(&paper, stop) - wall, 0.5 * (end - wall), 1e-12);
        assert!((0..=100).all(|n| law.volume::<f64>(2.4 * INCH + (stop - 2.4 * INCH) * f64::from(n) / 100.0) > 0.0));
    }
    let pushed = walled(&paper).with_taper(end, ratio, [2.4 * INCH, paper.max_length]).expect("a taper");
    let other_way = tapered(&paper, ideal(), TAPER).with_wall(WALL, paper.max_length).expect("a wall");
    assert_eq!(pushed, other_way);
}

#[test]
fn without_cones_a_taper_is_the_ideal_braid() {
    let paper = Paper::sealed();
    let ideal = || Characteristic::from(IdealBraid { braid: paper.braid() });
    assert_eq!(tapered(&paper, ideal(), [TAPER[0], 0.0]), ideal());
    let lost = |ratio: f64, length, gauge| {
        let law = tapered(&paper, ideal(), [TAPER[0], ratio]);
        ideal().force(length, at(gauge)) - law.force(length, at(gauge))
    };
    for (length, gauge) in places().filter(|place| place.1 > 0.0) {
        let one = lost(1.0, length, gauge);
        assert!(one > 0.0);
        for ratio in [1e-6, 0.1, 3.0] {
            assert_within(lost(ratio, length, gauge), ratio * one, 1e-13 * gauge * 1e-4);
        }
    }
}

/// An unswollen end: the taper starts as an end factor and then takes less than it.
#[test]
fn a_taper_begins_as_an_end_factor() {
    let paper = Paper::sealed();
    let (longest, gauge) = (paper.max_length, 60.0 * PSI);
    let end = radius(&paper, longest);
    let tangent = (longest / paper.thread_length).acos().tan();
    for ratio in [0.3, 1.0, 2.5] {
        let law = tapered(&paper, IdealBraid { braid: paper.braid() }.into(), [end, ratio]);
        let factor = 1.0 + 2.0 / 3.0 * ratio * end / longest / (tangent * tangent);
        let other = tondu_lopez(&paper, EndFactor::constant(factor).expect("a factor"), None);
        let [tapers, contracts]: [Dual<f64, 1>; 2] =
            [&law, &other].map(|law| law.force(Dual::variable(longest, 0), GaugePressure(Dual::of_value(gauge))));
        assert_close(tapers.value, contracts.value, 1e-12);
        assert_close(tapers.slope[0], contracts.slope[0], 1e-12);
        for contraction in [0.02, 0.1, 0.2, 0.3] {
            let length = longest * (1.0 - contraction);
            assert!(law.force(length, at(gauge)) > other.force(length, at(gauge)));
        }
    }
}

#[test]
fn a_wall_is_the_law_of_chou_and_hannaford_over_the_braid_angle() {
    let paper = Paper::sealed();
    let law = walled(&paper);
    let widest = paper.thread_length / (paper.turns * PI);
    for (length, gauge) in places() {
        let angle = (length / paper.thread_length).acos();
        let (sine, cosine) = (angle.sin(), angle.cos());
        let thin = 0.25 * PI * widest * widest * gauge * (3.0 * cosine * cosine - 1.0);
        let thick = PI * gauge * (widest * WALL * (2.0 * sine - 1.0 / sine) - WALL * WALL);
        assert_within(law.force(length, at(gauge)), thin + thick, 1e-13 * gauge.abs() * widest * widest * 4.0);
        let bore = widest * sine - 2.0 * WALL;
        assert_close(law.volume(length), 0.25 * PI * bore * bore * length, 1e-13);
        // Virtual work.
        let by_work = -gauge * slope(1e-5, |h| law.volume(length + h));
        assert_within(law.force(length, at(gauge)), by_work, 1e-9 * gauge.abs() * 1e-4);
    }
    let closed = law.wall().expect("a wall").closed_length();
    assert_close(paper.braid().diameter::<f64>(closed), 2.0 * WALL, 1e-12);
    let none = mckibben::force::Characteristic::from(IdealBraid { braid: paper.braid() })
        .with_wall(0.0, paper.max_length)
        .expect("no wall");
    assert_eq!(none, IdealBraid { braid: paper.braid() }.into());
}

#[test]
fn a_bladder_is_the_derivative_of_its_energy() {
    let paper = Paper::sealed();
    let [force, scale] = BLADDER;
    type Form = (BladderForm, fn(f64, f64) -> f64);
    let forms: [Form; 3] = [
        (BladderForm::Linear, |e, _| -e),
        (BladderForm::Saturating, |e, s| -(1.0 - (-e / s).exp())),
        (BladderForm::Exponential, |e, s| -((e / s).exp() - 1.0)),
    ];
    for (form, literal) in forms {
        let bladder = Bladder::new(form, paper.max_length, force, scale).expect("a bladder");
        assert_eq!(bladder.tension::<f64>(paper.max_length), 0.0);
        assert_eq!(bladder.stored_energy::<f64>(paper.max_length), 0.0);
        for (length, _) in places() {
            let contraction = (paper.max_length - length) / paper.max_length;
            let expected = force * literal(contraction, scale);
            assert_within(bladder.tension(length), expected, 1e-13 * force * (contraction / scale).exp());
            let by_energy: f64 = slope(1e-5, |h| bladder.stored_energy(length + h));
            assert_within(by_energy, expected, 1e-8 * force * (contraction / scale).exp());
            assert!(bladder.stored_energy::<f64>(length) > 0.0);
        }
    }
    // Over a contraction much larger than any, both curved forms are the linear one with K₀/s.
    let linear = Bladder::new(BladderForm::Linear, 0.1, 1.0, 1.0).expect("a bladder");
    for form in [BladderForm::Saturating, BladderForm::Exponential] {
        let wide = Bladder::new(form, 0.1, 1e6, 1e6).expect("a bladder");
        assert_close(wide.tension::<f64>(0.07), linear.tension(0.07), 1e-6);
    }
}

#[test]
fn dual_numbers_give_the_derivatives_of_every_law() {
    let paper = Paper::sealed();
    for (name, law) in all(&paper) {
        for (length, gauge) in places() {
            let force: Dual<f64, 2> = law.force(Dual::variable(length, 0), GaugePressure(Dual::variable(gauge, 1)));
            let by_length = slope(1e-5, |h| law.force(length + h, at(gauge)));
            let by_pressure = slope(100.0, |h| law.force(length, at(gauge + h)));
            assert_eq!(force.value, law.force(length, at(gauge)), "{name}");
            assert_within(force.slope[0], by_length, 1e-7 * 1e4);
            assert_within(force.slope[1], by_pressure, 1e-9 * 1e-3);
        }
    }
}

#[test]
fn the_secant_is_the_quotient_and_the_derivative_where_there_is_none() {
    let paper = Paper::sealed();
    for (name, law) in all(&paper) {
        for (place, (length, gauge)) in places().enumerate() {
            let from = common::between(place, 2, 2.4, 3.8) * INCH;
            let secant: f64 = law.secant_stiffness(length, from, at(gauge));
            let quotient = (law.force(length, at(gauge)) - law.force(from, at(gauge))) / (length - from);
            let rounding = 1e-13 * 200.0 / (length - from).abs();
            assert!((secant - quotient).abs() <= rounding, "{name}: {secant} is not {quotient}");
            let here: f64 = law.secant_stiffness(from, from, at(gauge));
            let tangent: Dual<f64, 1> = law.force(Dual::variable(from, 0), GaugePressure(Dual::of_value(gauge)));
            assert_close(here, tangent.slope[0], 1e-12);
        }
    }
}

/// A dual constant, without naming the trait at every use.
trait OfValue {
    fn of_value(value: f64) -> Self;
}

impl OfValue for Dual<f64, 1> {
    fn of_value(value: f64) -> Self {
        mckibben::Over::of(value)
    }
}

/// The derivative by a parameter passes through everything that follows from it.
#[test]
fn derivatives_by_parameters_reach_every_law() {
    use mckibben::parameter as p;
    let gauge = 50.0 * PSI;
    let rows = [
        &p::TURNS,
        &p::THREAD_LENGTH,
        &p::MAX_LENGTH,
        &p::END_FACTOR,
        &p::INITIAL_RADIUS,
        &p::WALL_THICKNESS,
        &p::TAPER_END_RADIUS,
        &p::TAPER_LENGTH_RATIO,
        &p::MEMBRANE_THICKNESS,
        &p::THREAD_STIFFNESS,
        &p::MAX_CONTRACTION,
    ];
    let paper = Paper::sealed();
    for (name, law) in all(&paper) {
        let actuator = paper.clone().with(|rig| rig.characteristic = Some(law.clone())).actuator();
        let length = 3.3 * INCH;
        let pressure = gauge + actuator.air().atmosphere().0;
        for row in rows {
            let mut seen = 0.0;
            let dual = actuator.map(|of, value| {
                let hit = of.key == row.key;
                seen = if hit { value } else { seen };
                Dual::<f64, 1> { value, slope: [f64::from(u8::from(hit))] }
            });
            let force = dual.static_force(Dual::of_value(length), Dual::of_value(pressure));
            let moved = |h: f64| {
                let moved = actuator.map(|of, value| if of.key == row.key { value + h } else { value });
                moved.static_force(length, pressure)
            };
            let expected = slope(1e-4 * f64::max(seen, 1e-6), moved);
            assert!(
                (force.slope[0] - expected).abs() <= 1e-6 * expected.abs() + 1e-9,
                "{name}: d/d {} is {} and not {expected}",
                row.key,
                force.slope[0]
            );
        }
    }
}

/// The ends move to and fro on a sealed muscle whose air keeps its temperature.
fn cycle(paper: &Paper) -> Paper {
    let motion = Motion::sinusoid(3.4 * INCH, 0.3 * INCH, 2.0, 0.0, paper.thread_length).expect("a motion");
    paper.clone().gauge(60.0 * PSI).friction(0.0, 0.0).with(|rig| {
        rig.load = Load::Prescribed(motion);
        rig.length = InitialLength::At(3.4 * INCH);
    })
}

#[test]
fn virtual_work_and_a_bladder_lose_nothing_and_other_laws_do() {
    let paper = Paper::sealed();
    for (name, law) in all(&paper) {
        let conservative =
            !["tondu", "sarosi", "bolen", "extensible", "polynomial"].iter().any(|other| name.contains(other));
        let audit = cycle(&paper).with(|rig| rig.characteristic = Some(law)).run(0.37, 1e-10).audit();
        assert!(audit.residual().abs() < 1e-9 * audit.turnover(), "{name}: {audit:?}");
        let share = audit.effectiveness_loss.abs() / audit.turnover();
        assert_eq!(share < 1e-9, conservative, "{name}: {share}");
        if ["bladder", "martens", "polynomial"].iter().any(|storing| name.contains(storing)) {
            assert!(audit.bladder_storage.abs() > 1e-3 * audit.turnover(), "{name}: {audit:?}");
        }
    }
}

/// Around a rectangle in pressure and length, whose corners are apart by two isobars, the work of a law that does not
/// follow from virtual work differs from the gas's by the integral of the difference: here in closed form for the end
/// factor.
#[test]
fn a_cycle_of_tondu_and_lopez_takes_what_the_difference_of_the_volumes_says() {
    let paper = Paper::sealed();
    let factor = 1.2;
    let law = tondu_lopez(&paper, EndFactor::constant(factor).expect("a factor"), None);
    let (low, high, rise) = (3.1 * INCH, 3.7 * INCH, 30.0 * PSI);
    let work = |gauge: f64| {
        let count = 2000;
        let width = (high - low) / f64::from(count);
        // Simpson's rule is exact for the square of a length.
        let value = |x: f64| law.force(x, at(gauge));
        (0..count)
            .map(|n| low + width * f64::from(n))
            .map(|x| width / 6.0 * (value(x) + 4.0 * value(x + 0.5 * width) + value(x + width)))
            .sum::<f64>()
    };
    let cycle = work(30.0 * PSI + rise) - work(30.0 * PSI);
    let middle = |length: f64| paper.max_length - factor * (paper.max_length - length);
    let volume = |length: f64| paper.braid().volume(middle(length)) / factor;
    assert_close(cycle, rise * (volume(low) - volume(high)), 1e-11);
    let gas = rise * (paper.braid().volume::<f64>(low) - paper.braid().volume::<f64>(high));
    assert!((cycle / gas - 1.0).abs() > 0.05, "{cycle} {gas}");
}

#[test]
fn both_engines_agree_on_every_law() {
    let paper = Paper::pwm(20.0, 0.5).gauge(40.0 * PSI);
    for (name, law) in all(&paper) {
        let paper = paper.clone().with(|rig| rig.characteristic = Some(law));
        let (rig, start) = (paper.rig(), paper.start());
        let located = paper.run(0.1, 1e-9).at(0.1);
        let mut stepper = RigSteps::new(&rig, start, Method::Rk4);
        for step in 1..=8000 {
            stepper.advance_to(0.1 * f64::from(step) / 8000.0).expect("a step");
        }
        let stepped = stepper.state();
        let off = ((stepped.length - located.length) / 0.1, stepped.pressure.0 / located.pressure.0 - 1.0);
        assert!(off.0.abs() < 2e-6 && off.1.abs() < 2e-5, "{name}: {off:?}");
        assert!((located.length - start.length).abs() > 1e-4, "{name} does not move");
    }
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let key = |error: Error| match error {
        Error::OutOfRange { parameter, .. } | Error::Inconsistent { parameter, .. } => parameter.key,
        other => panic!("{other}"),
    };
    let braid = Braid::new(0.11, 2.5).expect("a braid");
    assert_eq!(key(EndFactor::constant(0.0).unwrap_err()), "actuator.force.end_factor");
    assert_eq!(key(EndFactor::falling(1.0, 0.1, 0.0).unwrap_err()), "actuator.force.end_factor_pressure");
    assert_eq!(key(Wall::new(-1e-3, &braid, 0.098).unwrap_err()), "actuator.wall_thickness");
    assert_eq!(key(Wall::new(4e-3, &braid, 0.098).unwrap_err()), "actuator.wall_thickness");
    assert_eq!(key(Sarosi::new(0.1, [f64::NAN; 6]).unwrap_err()), "actuator.force.coefficients");
    assert_eq!(key(Bladder::new(BladderForm::Linear, 0.1, -1.0, 1.0).unwrap_err()), "actuator.bladder.force");
    assert_eq!(key(Bladder::new(BladderForm::Linear, 0.1, 1.0, 0.0).unwrap_err()), "actuator.bladder.scale");
    let membrane = |length, thickness, modulus| MartensBoblan::new(&braid, length, thickness, modulus).unwrap_err();
    assert_eq!(key(membrane(0.098, 0.0, MODULUS)), "actuator.force.membrane_thickness");
    assert_eq!(key(membrane(0.098, 1e-3, [0.0, 0.0, f64::INFINITY, 0.0])), "actuator.force.modulus");
    assert_eq!(key(membrane(0.11, 1e-3, MODULUS)), "actuator.max_length");
    let soft = ExtensibleBraid::new(braid, 0.0).unwrap_err();
    assert_eq!(key(soft), "actuator.force.thread_stiffness");
    let bolen = |force, pressure, contraction, shape| Bolen::new(0.1, force, pressure, contraction, shape).unwrap_err();
    assert_eq!(key(bolen(0.0, 6e5, 0.2, SHAPE)), "actuator.force.max_force");
    assert_eq!(key(bolen(90.0, -6e5, 0.2, SHAPE)), "actuator.force.max_pressure");
    assert_eq!(key(bolen(90.0, 6e5, 1.0, SHAPE)), "actuator.force.max_contraction");
    assert_eq!(key(bolen(90.0, 6e5, 0.2, [0.1, -1.0, 0.0])), "actuator.force.shape");
    let polynomial = |pressure: &[f64], passive: &[f64]| Polynomial::new(0.1, pressure, passive).unwrap_err();
    assert_eq!(key(polynomial(&[1e-3, f64::NAN], &[])), "actuator.force.pressure_coefficients");
    assert_eq!(key(polynomial(&[1e-3], &[f64::INFINITY])), "actuator.force.passive_coefficients");
    let long = [1.0; MAX_POWERS + 1];
    for (error, words) in [
        (polynomial(&[], &[1.0]), "give at least the coefficient without contraction"),
        (polynomial(&long, &[]), "keep to 6 coefficients"),
        (polynomial(&[1.0], &long), "keep to 6 coefficients"),
    ] {
        assert!(matches!(error, Error::Table { .. }) && error.to_string().contains(words), "{error}");
    }
    let lengths = [0.065, 0.098];
    let thick = Wall::new(2e-3, &braid, 0.098).expect("a wall");
    let taper = |radius, ratio, wall| Taper::new(radius, ratio, &braid, wall, lengths).unwrap_err();
    assert_eq!(key(taper(0.0, 1.0, None)), "actuator.taper.end_radius");
    assert_eq!(key(taper(2e-3, -1.0, None)), "actuator.taper.length_ratio");
    for (error, parameter, words) in [
        (taper(3.5e-3, 1.0, None), "actuator.taper.end_radius", "the braid's radius at actuator.max_length"),
        (taper(2e-3, 1.0, Some(&thick)), "actuator.taper.end_radius", "must be greater than actuator.wall_thickness"),
        (taper(2e-3, 9.0, None), "actuator.taper.length_ratio", "actuator.min_length over the braid's diameter there"),
    ] {
        assert!(error.to_string().contains(words), "{error}");
        assert_eq!(key(error), parameter);
    }
    // A braid that pushes wherever it is.
    for shortest in [None, Some(0.03)] {
        let error = LengthLimits::new(&braid, shortest, 0.06, 1e5, 0.0).unwrap_err();
        assert!(error.to_string().contains("pushes, and a tendon cannot"), "{error}");
    }
    let linear = bladder(&Paper::sealed(), BladderForm::Linear);
    assert!(linear.bladder().is_some() && linear.wall().is_none());
}
