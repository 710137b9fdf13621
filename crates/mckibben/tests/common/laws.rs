//! Every law of force, on the braid of a rig, with coefficients of a usual size.
#![allow(dead_code)]

use crate::common::{INCH, PSI, Paper};
use mckibben::force::{
    Bladder, BladderForm, Bolen, Characteristic, Coefficients, EndFactor, ExtensibleBraid, ForceMap, IdealBraid, Law,
    MartensBoblan, Polynomial, Sarosi, TonduLopez,
};

/// Coefficients of Sárosi's law for pressures in Pa.
pub(crate) const SAROSI: [f64; 6] = [1e-5, 5.0, -0.2, -6e-6, 2e-4, -6.0];
/// End factor, its rise and the pressure in Pa over which it falls.
pub(crate) const END_FACTOR: [f64; 3] = [1.1, 0.4, 1e5];
/// Radius in m, a and b.
pub(crate) const COEFFICIENTS: [f64; 3] = [3.1e-3, 12.0, 4.6];
/// Thickness in m of the membrane and its modulus, for lengths in m.
pub(crate) const MEMBRANE: f64 = 0.3e-3;
pub(crate) const MODULUS: [f64; 4] = [4e6, -6e7, 3e8, 1e8];
/// Largest force in N, pressure in Pa and contraction, and shape of Bolen's law.
pub(crate) const BOLEN: [f64; 3] = [90.0, 6.2e5, 0.3];
pub(crate) const SHAPE: [f64; 3] = [0.26, 6.4, 1.3];
/// Coefficients in m² and in N of rising powers of contraction.
pub(crate) const PRESSURE: [f64; 4] = [1.2e-4, -8e-4, 9e-4, -4e-4];
pub(crate) const PASSIVE: [f64; 5] = [1.0, 40.0, -150.0, 400.0, 100.0];
/// Stiffness of the threads in N/m.
pub(crate) const THREADS: f64 = 3e4;
/// Wall thickness in m.
pub(crate) const WALL: f64 = 0.4e-3;
/// Radius in m of the braid at its fittings, and length of the cones over the radius by which they widen.
pub(crate) const TAPER: [f64; 2] = [2.8e-3, 2.0];
/// Force in N and scale of the bladder.
pub(crate) const BLADDER: [f64; 2] = [6.0, 0.07];

pub(crate) fn bladder(paper: &Paper, form: BladderForm) -> Characteristic {
    let bladder = Bladder::new(form, paper.max_length, BLADDER[0], BLADDER[1]).expect("a bladder");
    Characteristic::from(IdealBraid { braid: paper.braid() }).with_bladder(bladder)
}

pub(crate) fn tondu_lopez(paper: &Paper, end_factor: EndFactor, given: Option<Coefficients>) -> Characteristic {
    let law = TonduLopez::new(&paper.braid(), paper.max_length, end_factor, given).expect("a law");
    Characteristic::new(paper.braid(), Law::TonduLopez(law))
}

pub(crate) fn coefficients() -> Coefficients {
    let [radius, a, b] = COEFFICIENTS;
    Coefficients { radius, a, b }
}

pub(crate) fn martens_boblan(paper: &Paper) -> Characteristic {
    let law = MartensBoblan::new(&paper.braid(), paper.max_length, MEMBRANE, MODULUS).expect("a law");
    Characteristic::new(paper.braid(), Law::MartensBoblan(law))
}

pub(crate) fn extensible(paper: &Paper, stiffness: f64) -> Characteristic {
    let law = ExtensibleBraid::new(paper.braid(), stiffness).expect("a law");
    Characteristic::new(paper.braid(), Law::ExtensibleBraid(law))
}

pub(crate) fn walled(paper: &Paper) -> Characteristic {
    Characteristic::from(IdealBraid { braid: paper.braid() }).with_wall(WALL, paper.max_length).expect("a wall")
}

pub(crate) fn polynomial(paper: &Paper, pressure: &[f64], passive: &[f64]) -> Characteristic {
    let law = Polynomial::new(paper.max_length, pressure, passive).expect("a law");
    Characteristic::new(paper.braid(), Law::Polynomial(law))
}

pub(crate) fn tapered(paper: &Paper, law: Characteristic, [end_radius, length_ratio]: [f64; 2]) -> Characteristic {
    law.with_taper(end_radius, length_ratio, [2.4 * INCH, paper.max_length]).expect("a taper")
}

pub(crate) fn all(paper: &Paper) -> Vec<(&'static str, Characteristic)> {
    let [limit, rise, pressure] = END_FACTOR;
    let falling = EndFactor::falling(limit, rise, pressure).expect("an end factor");
    let sarosi = Law::Sarosi(Sarosi::new(paper.max_length, SAROSI).expect("a law"));
    let [force, pressure, contraction] = BOLEN;
    let bolen = Bolen::new(paper.max_length, force, pressure, contraction, SHAPE).expect("a law");
    let saturating =
        Bladder::new(BladderForm::Saturating, paper.max_length, BLADDER[0], BLADDER[1]).expect("a bladder");
    vec![
        ("ideal braid", IdealBraid { braid: paper.braid() }.into()),
        ("tondu-lopez", tondu_lopez(paper, falling, None)),
        ("sarosi", Characteristic::new(paper.braid(), sarosi)),
        ("martens-boblan", martens_boblan(paper)),
        ("martens-boblan and wall", martens_boblan(paper).with_wall(WALL, paper.max_length).expect("a wall")),
        ("extensible braid", extensible(paper, THREADS)),
        ("bolen", Characteristic::new(paper.braid(), Law::Bolen(bolen))),
        ("wall and saturating bladder", walled(paper).with_bladder(saturating)),
        ("exponential bladder", bladder(paper, BladderForm::Exponential)),
        ("linear bladder", bladder(paper, BladderForm::Linear)),
        ("tondu-lopez, coefficients", tondu_lopez(paper, falling, Some(coefficients()))),
        ("wall", walled(paper)),
        ("taper", tapered(paper, IdealBraid { braid: paper.braid() }.into(), TAPER)),
        ("taper, wall and saturating bladder", tapered(paper, walled(paper).with_bladder(saturating), TAPER)),
        ("polynomial", polynomial(paper, &PRESSURE, &PASSIVE)),
    ]
}

/// The ideal braid measured on a grid.
pub(crate) fn measured(paper: &Paper) -> Characteristic {
    let braid = paper.braid();
    let pressures: Vec<f64> = (0..8).map(|n| (15.0 * f64::from(n) + 5.0) * PSI).collect();
    let lengths: Vec<f64> = (0..9).map(|n| (2.5 + 0.16 * f64::from(n)) * INCH).collect();
    let tensions: Vec<f64> = pressures
        .iter()
        .flat_map(|gauge| lengths.iter().map(move |length| -gauge * braid.volume_slope::<f64>(*length)))
        .collect();
    Characteristic::new(paper.braid(), Law::Map(ForceMap::new(&pressures, &lengths, &tensions).expect("a map")))
}
