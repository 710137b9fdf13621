//! Laws of force against two measured muscles: published coefficients, and fits by SciPy.
//!
//! Measurements: Martens & Boblan, Actuators 6(4), 33 (2017), doi:10.3390/act6040033, Tables A1 and A2, CC BY 4.0. Where the
//! tables say 0 N the muscle was slack, which is no measurement of force: those places are left out. Errors are parts of the
//! largest force. The fits are SciPy's `least_squares` and `lstsq` on formulas written in NumPy, and so are their errors.

use crate::common::assert_close;
use mckibben::force::{
    Bladder, BladderForm, Bolen, Characteristic, IdealBraid, Law, MartensBoblan, Polynomial, Sarosi, StaticForce,
};
use mckibben::{Braid, GaugePressure};
use std::f64::consts::PI;

/// Gauge pressure in Pa, tensions in N at the first of [`Muscle::lengths`].
const DMSP_20_300: &[(f64, &[f64])] = &[
    (65_000.0, &[54.9]),
    (85_000.0, &[113.4]),
    (110_000.0, &[179.0]),
    (135_000.0, &[241.8]),
    (146_250.0, &[273.3, 21.1]),
    (157_500.0, &[300.2, 42.9]),
    (168_750.0, &[331.0, 70.3]),
    (180_000.0, &[355.6, 93.7]),
    (197_500.0, &[402.5, 131.0, 27.7]),
    (215_000.0, &[446.5, 165.2, 61.6]),
    (232_500.0, &[495.9, 204.1, 92.7]),
    (250_000.0, &[543.4, 244.7, 122.0]),
    (281_250.0, &[623.5, 309.7, 170.2, 42.8]),
    (312_500.0, &[708.8, 380.4, 221.0, 80.6]),
    (343_750.0, &[787.9, 443.7, 277.4, 118.7]),
    (375_000.0, &[870.9, 518.9, 328.0, 157.6]),
    (450_000.0, &[1065.2, 676.4, 462.3, 252.1, 65.5]),
    (525_000.0, &[1268.9, 837.5, 587.8, 352.3, 124.7]),
    (600_000.0, &[1460.1, 1004.0, 714.8, 443.5, 188.1]),
    (675_000.0, &[1653.5, 1164.3, 840.7, 535.8, 253.3]),
];

/// Measured forces of the thinner muscle.
const DMSP_10_250: &[(f64, &[f64])] = &[
    (68_750.0, &[32.1667]),
    (132_500.0, &[84.8333]),
    (196_250.0, &[139.5]),
    (260_000.0, &[195.6667]),
    (285_000.0, &[217.6667, 17.0]),
    (310_000.0, &[239.6667, 35.1667]),
    (335_000.0, &[261.6667, 52.6667]),
    (360_000.0, &[283.8333, 71.3333]),
    (402_187.0, &[321.5, 101.5, 22.8333]),
    (441_375.0, &[359.0, 132.3333, 46.1667]),
    (486_562.0, &[396.6667, 162.5, 69.3333]),
    (528_750.0, &[434.3333, 193.6667, 92.1667]),
    (559_062.0, &[461.6667, 216.3333, 109.3333, 11.5]),
    (589_375.0, &[488.3333, 238.1667, 126.3333, 23.3333]),
    (619_688.0, &[515.8333, 261.0, 142.6667, 35.0]),
    (650_000.0, &[542.5, 282.8333, 158.6667, 46.0]),
];

struct Muscle {
    tensions: &'static [(f64, &'static [f64])],
    /// In m.
    lengths: &'static [f64],
    /// Length and diameter at rest in m.
    rest: [f64; 2],
    /// Correction of the braid angle in rad, and modulus, as published.
    angle: f64,
    modulus: [f64; 4],
}

const THICK: Muscle = Muscle {
    tensions: DMSP_20_300,
    lengths: &[0.296, 0.282, 0.267, 0.25, 0.237],
    rest: [0.3, 0.02],
    angle: -0.073,
    modulus: [93.232e6, -715.29e6, 1.5483e9, -502.95e6],
};

const THIN: Muscle = Muscle {
    tensions: DMSP_10_250,
    lengths: &[0.25, 0.234, 0.219, 0.204],
    rest: [0.25, 0.01],
    angle: -0.1,
    modulus: [74.085e6, -689.2e6, 1.837e9, -848.79e6],
};

impl Muscle {
    fn braid(&self, angle: f64) -> Braid {
        let [length, diameter] = self.rest;
        Braid::new(length / angle.cos(), length * angle.tan() / (PI * diameter)).expect("a braid")
    }

    fn martens_boblan(&self, angle: f64, modulus: [f64; 4]) -> Characteristic {
        let braid = self.braid(angle);
        let law = MartensBoblan::new(&braid, self.rest[0], 1.8e-3, modulus).expect("a law");
        Characteristic::new(braid, Law::MartensBoblan(law))
    }

    /// The ideal braid in a saturating bladder, its force and scale fitted.
    fn braid_and_bladder(&self, [thread, turns, force, scale]: [f64; 4]) -> Characteristic {
        let bladder = Bladder::new(BladderForm::Saturating, self.rest[0], force, scale).expect("a bladder");
        Characteristic::from(IdealBraid { braid: Braid::new(thread, turns).expect("a braid") }).with_bladder(bladder)
    }

    /// A polynomial whose coefficients of pressure are fitted over bar.
    fn polynomial(&self, pressure: &[f64], passive: &[f64]) -> Polynomial {
        let pressure: Vec<f64> = pressure.iter().map(|a| a / 1e5).collect();
        Polynomial::new(self.rest[0], &pressure, passive).expect("a law")
    }

    /// Largest and root-mean-square error of a law as parts of the largest force.
    fn errors(&self, law: &impl StaticForce<f64>) -> [f64; 2] {
        self.errors_at(law, |_| true)
    }

    /// Errors at the lengths that are kept.
    fn errors_at(&self, law: &impl StaticForce<f64>, keep: impl Fn(f64) -> bool) -> [f64; 2] {
        let (mut largest, mut worst, mut squares, mut count) = (0.0_f64, 0.0_f64, 0.0, 0.0);
        for (gauge, tensions) in self.tensions {
            for (length, tension) in self.lengths.iter().zip(*tensions) {
                largest = largest.max(*tension);
                if !keep(*length) {
                    continue;
                }
                let off = law.force(*length, GaugePressure(*gauge)) - tension;
                worst = worst.max(off.abs());
                squares += off * off;
                count += 1.0;
            }
        }
        [worst / largest, f64::sqrt(squares / count) / largest]
    }
}

/// Degrees of the braid at rest before its correction.
const ANGLE: f64 = 28.6;

#[test]
fn martens_and_boblan_are_as_near_to_their_measurements_as_they_state() {
    // Stated: below 4.4 % and below 2.35 %; the coefficients are printed to five digits.
    for (muscle, stated) in [(THIN, 0.044), (THICK, 0.024)] {
        let angle = ANGLE.to_radians() + muscle.angle;
        let [worst, _] = muscle.errors(&muscle.martens_boblan(angle, muscle.modulus));
        assert!(worst < stated, "{worst}");
        // The same numbers with the correction in degrees, or with the other sign of it, are far off.
        for other in [ANGLE + muscle.angle, ANGLE - muscle.angle.to_degrees()] {
            let [worst, _] = muscle.errors(&muscle.martens_boblan(other.to_radians(), muscle.modulus));
            assert!(worst > 0.1, "{worst}");
        }
    }
}

#[test]
fn a_fit_of_the_modulus_is_the_one_of_an_independent_solver() {
    let angle = ANGLE.to_radians() + THICK.angle;
    let modulus = [645_268_303.613_751_9, -6_988_779_239.724_438, 25_251_819_595.853_39, -30_281_336_975.906_025];
    let errors = THICK.errors(&THICK.martens_boblan(angle, modulus));
    assert_close(errors[0], 0.015_424_573_119_797_945, 1e-7);
    assert_close(errors[1], 0.005_286_500_646_782_357, 1e-7);
    // It is the least: each coefficient moved either way is worse.
    for place in 0..4 {
        for factor in [0.999, 1.001] {
            let mut moved = modulus;
            moved[place] *= factor;
            assert!(THICK.errors(&THICK.martens_boblan(angle, moved))[1] > errors[1]);
        }
    }
    let angle = ANGLE.to_radians() + THIN.angle;
    let modulus = [34_794_258.734_616_764, -144_030_223.303_539_75, -675_784_760.668_845_8, 2_998_056_763.174_229_6];
    let errors = THIN.errors(&THIN.martens_boblan(angle, modulus));
    assert_close(errors[0], 0.042_635_940_022_629_285, 1e-7);
    assert_close(errors[1], 0.019_608_696_221_104_414, 1e-7);
}

/// A law of every other kind, fitted by SciPy, with the errors that SciPy finds for it: figures of docs/validation.md.
#[test]
fn other_laws_are_as_near_as_an_independent_solver_finds() {
    let sarosi = |muscle: &Muscle, [a1, a2, a3, a4, a5, a6]: [f64; 6]| {
        // Fitted over bar.
        let law = Sarosi::new(muscle.rest[0], [a1 / 1e5, a2, a3, a4 / 1e5, a5 / 1e5, a6]).expect("a law");
        muscle.errors(&law)
    };
    // The shape is that of the law's source; the largest force and contraction are fitted.
    let bolen = |muscle: &Muscle, force, contraction, shape| {
        muscle.errors(&Bolen::new(muscle.rest[0], force, 620e3, contraction, shape).expect("a law"))
    };
    let ideal = |muscle: &Muscle, thread, turns| {
        muscle.errors(&IdealBraid { braid: Braid::new(thread, turns).expect("a braid") })
    };
    // Ends as wide as the braid at its longest.
    let tapered = |muscle: &Muscle, fitted, ratio| {
        let law = muscle.braid_and_bladder(fitted);
        let end = 0.5 * law.braid.diameter::<f64>(muscle.rest[0]);
        muscle.errors(&law.with_taper(end, ratio, [muscle.lengths[4], muscle.rest[0]]).expect("a taper"))
    };
    let polynomial =
        |muscle: &Muscle, pressure: &[f64], passive: &[f64]| muscle.errors(&muscle.polynomial(pressure, passive));
    let found = [
        sarosi(&THICK, [12.789_031, 419.482_937, -0.566_647, -8.701_305, 267.671_99, -309.603_102]),
        sarosi(&THIN, [-3.051_497, 168.234_804, -0.424_554, -2.902_061, 91.404_163, -201.026_675]),
        bolen(&THICK, 1569.9815, 0.246, [0.2607, 6.398, 1.303]),
        bolen(&THIN, 502.4724, 0.2075, [0.5822, 4.142, 0.5368]),
        THICK.errors(&THICK.braid_and_bladder([0.346_12, 2.079_39, 328.005_44, 0.027_95])),
        THIN.errors(&THIN.braid_and_bladder([0.263_79, 3.388_93, 194.8234, 0.039_81])),
        ideal(&THICK, 0.400_34, 1.9581),
        ideal(&THIN, 0.3578, 2.522_27),
        tapered(&THICK, [0.326_427_5, 2.162_191, 321.8567, 0.026_923_75], 1.422_19),
        polynomial(
            &THICK,
            &[276.7584, -1117.272, 1952.611, -4480.471],
            &[2.525_869, 9572.347, -103_091.9, 454_326.9, -690_983.7],
        ),
        polynomial(&THIN, &[88.347_77, -181.3061, -1193.828, 3760.12], &[32.773_29, 4518.141, -38_611.54, 103_353.6]),
    ];
    let expected = [
        [0.010_856_258_670_803_844, 0.003_746_968_869_460_433],
        [0.007_771_637_096_774_245, 0.002_030_921_037_328_056],
        [0.056_933_818_188_51, 0.023_302_888_790_211_87],
        [0.043_411_991_972_647_536, 0.019_654_242_495_096_785],
        [0.015_312_619_727_280_89, 0.008_008_745_552_356_78],
        [0.044_246_112_142_290_22, 0.019_805_023_456_849_567],
        [0.130_977_719_092_122_1, 0.069_790_101_953_689_43],
        [0.206_855_001_308_429_8, 0.090_823_443_987_390_46],
        [0.016_657_696_307_149_878, 0.007_944_582_829_837_038],
        [0.003_343_184_362_015_709, 0.001_715_728_554_833_346_5],
        [0.007_743_591_013_824_888_5, 0.001_951_093_805_816_953_4],
    ];
    for (found, expected) in found.into_iter().zip(expected) {
        assert_close(found[0], expected[0], 1e-9);
        assert_close(found[1], expected[1], 1e-9);
    }
}

/// Fits without one length, held to that length: figures of docs/validation.md.
struct HeldOut {
    length: f64,
    /// Coefficients of the pressure's polynomial over bar, and passive ones in N.
    pressure: [f64; 3],
    passive: &'static [f64],
    /// Of the braid in a saturating bladder: thread length, turns, force and scale.
    braid: [f64; 4],
    /// Root-mean-square errors at that length, the polynomial's and the braid's.
    errors: [f64; 2],
}

const HELD_OUT_OF_THICK: &[HeldOut] = &[
    HeldOut {
        length: 0.296,
        pressure: [273.5341, -985.5032, 507.9012],
        passive: &[139.2918, 4561.484, -38_512.57, 101_910.8],
        braid: [0.351_715_4, 2.051_527, 303.3243, 0.013_676_05],
        errors: [0.051_657_754_724_897_33, 0.044_532_903_938_253_17],
    },
    HeldOut {
        length: 0.282,
        pressure: [275.4658, -1021.598, 651.9718],
        passive: &[31.446_09, 6741.471, -52_973.97, 133_415.3],
        braid: [0.350_194_1, 2.061_57, 309.8784, 0.028_904_85],
        errors: [0.014_092_440_456_729_532, 0.017_012_673_903_910_935],
    },
    HeldOut {
        length: 0.267,
        pressure: [274.9306, -992.9822, 522.4745],
        passive: &[15.595_84, 8049.65, -65_058.62, 162_865.1],
        braid: [0.343_907_2, 2.089_921, 337.4631, 0.029_136_28],
        errors: [0.010_641_260_677_085_504, 0.006_481_554_231_149_905],
    },
    HeldOut {
        length: 0.25,
        pressure: [275.4012, -1007.767, 449.7474],
        passive: &[11.0172, 8575.214, -75_126.01, 195_833.9],
        braid: [0.349_056_5, 2.064_161, 330.914, 0.028_734_47],
        errors: [0.016_591_676_762_127_17, 0.019_428_305_074_039_993],
    },
    HeldOut {
        length: 0.237,
        pressure: [276.2049, -1061.958, 948.0337],
        passive: &[10.533_94, 8701.916, -79_739.75, 230_102.0],
        braid: [0.335_954_9, 2.135_931, 342.0553, 0.030_783_59],
        errors: [0.046_277_246_427_251_74, 0.028_865_186_457_525_54],
    },
];

const HELD_OUT_OF_THIN: &[HeldOut] = &[
    HeldOut {
        length: 0.25,
        pressure: [93.838_39, -341.2165, 204.9366],
        passive: &[183.6927, 122.7189, -164.0002],
        braid: [0.290_085_9, 2.956_521, 194.9315, 0.016_032_09],
        errors: [0.239_457_841_392_692_3, 0.103_211_637_696_550_84],
    },
    HeldOut {
        length: 0.234,
        pressure: [88.347_77, -267.097, -35.711_08],
        passive: &[32.773_29, 2160.025, -6778.631],
        braid: [0.250_025, 3.497_701, 245.0665, 0.086_080_86],
        errors: [0.073_084_701_459_975_49, 0.059_888_752_465_112_47],
    },
    HeldOut {
        length: 0.219,
        pressure: [88.347_77, -225.5852, -261.3183],
        passive: &[32.773_29, 3301.049, -12_979.85],
        braid: [0.250_025, 3.491_332, 222.5494, 0.049_705_91],
        errors: [0.068_558_203_331_732_3, 0.029_820_823_881_516_415],
    },
    HeldOut {
        length: 0.204,
        pressure: [88.347_77, -211.1464, -486.9255],
        passive: &[32.773_29, 3697.927, -19_181.06],
        braid: [0.250_025, 3.490_91, 194.4938, 0.036_251_58],
        errors: [0.196_907_045_431_759_83, 0.043_974_783_172_117_775],
    },
];

/// A polynomial fits better than a braid in a bladder where there are measurements, and worse where they end.
#[test]
fn polynomials_fit_best_in_sample_and_extrapolate_worst() {
    for (muscle, held_out) in [(THICK, HELD_OUT_OF_THICK), (THIN, HELD_OUT_OF_THIN)] {
        let last = held_out.len() - 1;
        for (place, held) in held_out.iter().enumerate() {
            assert_eq!(held.length, muscle.lengths[place]);
            let polynomial = muscle.polynomial(&held.pressure, held.passive);
            let braid = muscle.braid_and_bladder(held.braid);
            let at = |keep: bool| {
                let keep = |length: f64| (length != held.length) == keep;
                [muscle.errors_at(&polynomial, keep)[1], muscle.errors_at(&braid, keep)[1]]
            };
            let (within, beyond) = (at(true), at(false));
            assert_close(beyond[0], held.errors[0], 1e-9);
            assert_close(beyond[1], held.errors[1], 1e-9);
            assert!(within[0] < within[1], "{}: {within:?}", held.length);
            if place == 0 || place == last {
                assert!(beyond[0] > 1.1 * beyond[1], "{}: {beyond:?}", held.length);
            }
        }
    }
}
