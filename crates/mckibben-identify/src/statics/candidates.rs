//! Every law of static force with the parameters that are identifiable from a force map.
//!
//! What is not separately identifiable from a map is not estimated separately: the radius of Tondu & Lopez stands
//! before both of its coefficients, so it keeps the value that the geometry gives it; the effectiveness stands before
//! 1/n², so either the turns are looked for or the effectiveness.
//!
//! | candidate | looked for |
//! |---|---|
//! | `ideal-braid` | b, n |
//! | `ideal-braid + effectiveness` | b and the coefficients of the effectiveness over pressure, the turns as given |
//! | `ideal-braid +` a bladder of three forms | b, n, K₀ and, unless it is linear, s |
//! | `ideal-braid + saturating bladder + rest` | b, n, K₀, s and the length L₀ from which contraction counts |
//! | `tondu-lopez` | a, b, k |
//! | `tondu-lopez +` a bladder of three forms | a, b, k, K₀ and, unless it is linear, s |
//! | `extensible-braid` | b, n, K |
//! | `martens-boblan` | b, n and the modulus over the length, with fewer coefficients than there are lengths |
//! | `bolen` | largest force and the three numbers of the shape, which take up the largest contraction |
//! | `sarosi` | six coefficients |
//! | `polynomial` | coefficients of two polynomials in contraction, as many as the lengths carry |
//!
//! A map that is drawn through the points has no parameter to estimate and is no candidate.

use super::{Candidate, ForceMap};
use crate::adjustable::Adjustable;
use crate::least_squares::Unknown;
use mckibben::Braid;
use mckibben::force::Coefficients;
use mckibben_scenario::{
    Bladder, BladderForm, Effectiveness, Force, Place, PlaceError, Scenario, TonduLopezCoefficients,
};

/// The most coefficients of either polynomial.
const MOST_COEFFICIENTS: usize = 5;

/// What a force map says of itself, for starts and bounds.
struct Sizes {
    tension: f64,
    gauge_pressure: f64,
    contraction: f64,
    lengths: usize,
}

/// A law that is being set up.
struct Draft {
    name: String,
    scenario: Scenario,
    unknowns: Vec<(String, Unknown)>,
    starts: Vec<Vec<f64>>,
}

/// Every candidate for a muscle, whose lengths must be above those of the map.
///
/// # Errors
/// Never for a scenario that reads well; the places of the laws are in the tests.
pub fn all(base: &Scenario, map: &ForceMap) -> Result<Vec<Candidate>, PlaceError> {
    let longest = base.actuator.max_length;
    let held = || map.held();
    let shortest = held().fold(f64::INFINITY, |least, point| least.min(point.length));
    let sizes = Sizes {
        tension: map.largest(),
        gauge_pressure: held().fold(0.0, |most, point| point.gauge_pressure.max(most)),
        contraction: (1.0 - shortest / longest).clamp(0.01, 0.9),
        lengths: super::held_out::Grouping::Lengths.groups(map).len(),
    };
    let ideal = Draft::ideal(base);
    let tondu_lopez = Draft::tondu_lopez(base);
    let mut drafts = vec![Draft::effectiveness(base, &sizes)];
    let forms = [BladderForm::Linear, BladderForm::Saturating, BladderForm::Exponential];
    drafts.extend(forms.iter().map(|form| ideal.in_bladder(*form, &sizes)));
    let bladder = ideal.in_bladder(BladderForm::Saturating, &sizes);
    drafts.push(bladder.of_its_own_rest(map.held().fold(0.0, |longest, point| point.length.max(longest))));
    drafts.insert(0, ideal);
    drafts.extend(forms.iter().map(|form| tondu_lopez.in_bladder(*form, &sizes)));
    drafts.insert(6, tondu_lopez);
    drafts.push(Draft::extensible(base, &sizes));
    drafts.push(Draft::martens_boblan(base, &sizes));
    drafts.push(Draft::bolen(base, &sizes));
    drafts.push(Draft::sarosi(base, &sizes));
    drafts.push(Draft::polynomial(base, &sizes));
    drafts.into_iter().map(Draft::candidate).collect()
}

impl Draft {
    /// The muscle by a law, with nothing else that pulls.
    fn of(base: &Scenario, name: &str, force: Force) -> Self {
        let mut scenario = base.clone();
        scenario.actuator.force = force;
        (scenario.actuator.bladder, scenario.actuator.taper, scenario.actuator.wall_thickness) = (None, None, 0.0);
        scenario.actuator.effectiveness = Effectiveness::Constant(1.0);
        Self { name: name.to_owned(), scenario, unknowns: Vec::new(), starts: Vec::new() }
    }

    /// With one more unknown.
    fn seek(mut self, path: &str, unknown: Unknown) -> Self {
        self.unknowns.push((path.to_owned(), unknown));
        self
    }

    /// With thread length and turns looked for.
    fn seek_braid(self) -> Self {
        let (thread, turns) = (self.scenario.actuator.thread_length, self.scenario.actuator.turns);
        let longest = self.scenario.actuator.max_length;
        self.seek("actuator.thread_length", Unknown::new("b", "m", thread).between(1.0005 * longest, 4.0 * longest))
            .seek("actuator.turns", Unknown::new("n", "", turns).between(1e-2 * turns, 1e2 * turns))
    }

    fn ideal(base: &Scenario) -> Self {
        Self::of(base, "ideal-braid", Force::IdealBraid).seek_braid()
    }

    /// As many coefficients as pressures let: a constant, a slope and a curvature.
    fn effectiveness(base: &Scenario, sizes: &Sizes) -> Self {
        let mut draft = Self::of(base, "ideal-braid + effectiveness", Force::IdealBraid).seek_braid();
        // The turns and the effectiveness are one factor.
        draft.unknowns.pop();
        draft.scenario.actuator.effectiveness = Effectiveness::Polynomial(vec![0.9, 0.0, 0.0]);
        for power in 0..3 {
            let size = sizes.gauge_pressure.powi(-power);
            let bounded = Unknown::new(format!("e{power}"), "", if power == 0 { 0.9 } else { 0.0 });
            let path = format!("actuator.effectiveness.polynomial[{power}]");
            draft = draft.seek(&path, bounded.between(-20.0 * size, 20.0 * size));
        }
        draft
    }

    fn in_bladder(&self, form: BladderForm, sizes: &Sizes) -> Self {
        let mut scenario = self.scenario.clone();
        let scale = 0.3 * sizes.contraction;
        scenario.actuator.bladder = Some(Bladder { form, force: 0.1 * sizes.tension, scale });
        let word = match form {
            BladderForm::Linear => "linear",
            BladderForm::Saturating => "saturating",
            BladderForm::Exponential => "exponential",
        };
        let name = format!("{} + {word} bladder", self.name);
        let (unknowns, starts) = (self.unknowns.clone(), Vec::new());
        let draft = Self { name, scenario, unknowns, starts };
        let force = Unknown::new("K0", "N", 0.1 * sizes.tension).between(0.0, 10.0 * sizes.tension);
        let mut draft = draft.seek("actuator.bladder.force", force);
        if form != BladderForm::Linear {
            draft = draft.seek("actuator.bladder.scale", Unknown::new("s", "", scale).between(2e-3, 5.0));
            draft.start_elsewhere("actuator.bladder.scale", &[0.1 * sizes.contraction, sizes.contraction]);
        }
        draft
    }

    /// With the length looked for at which the bladder is at rest, at or above the longest at which it pulled.
    fn of_its_own_rest(self, longest: f64) -> Self {
        let name = format!("{} + rest", self.name);
        let rest = self.scenario.actuator.max_length.max(1.001 * longest);
        let mut draft = Self { name, ..self }
            .seek("actuator.max_length", Unknown::new("L0", "m", rest).between(longest, 1.3 * longest));
        draft.scenario.actuator.max_length = rest;
        draft
    }

    fn tondu_lopez(base: &Scenario) -> Self {
        let actuator = &base.actuator;
        let braid = Braid::new(actuator.thread_length, actuator.turns);
        let of = braid.map(|braid| Coefficients::of(&braid, actuator.max_length));
        let Coefficients { radius, a, b } = of.unwrap_or(Coefficients { radius: 0.01, a: 10.0, b: 1.0 });
        let coefficients = Some(TonduLopezCoefficients { radius, a, b });
        let law = Force::TonduLopez { end_factor: 1.0, end_factor_rise: 0.0, end_factor_pressure: 1e5, coefficients };
        Self::of(base, "tondu-lopez", law)
            .seek("actuator.force.a", Unknown::new("a", "", a).between(1e-3 * a, 1e2 * a))
            .seek("actuator.force.b", Unknown::new("b", "", b).between(1e-3 * b, 1e2 * b))
            .seek("actuator.force.end_factor", Unknown::new("k", "", 1.0).between(0.2, 5.0))
    }

    fn extensible(base: &Scenario, sizes: &Sizes) -> Self {
        let stiffness = 1e2 * sizes.tension / base.actuator.max_length;
        let law = Force::ExtensibleBraid { thread_stiffness: 10.0 * stiffness };
        let unknown = Unknown::new("K", "N/m", 10.0 * stiffness).between(0.1 * stiffness, 1e5 * stiffness);
        Self::of(base, "extensible-braid", law).seek_braid().seek("actuator.force.thread_stiffness", unknown)
    }

    /// Its membrane as thick as its source has it, where the muscle says nothing else: the modulus takes up what is not.
    fn martens_boblan(base: &Scenario, sizes: &Sizes) -> Self {
        let longest = base.actuator.max_length;
        let membrane_thickness = match base.actuator.force {
            Force::MartensBoblan { membrane_thickness, .. } => membrane_thickness,
            _ => 1.8e-3,
        };
        let mut draft = Self::of(
            base,
            "martens-boblan",
            Force::MartensBoblan { membrane_thickness, modulus: [1e7, 0.0, 0.0, 0.0] },
        )
        .seek_braid();
        for power in 0..(sizes.lengths as i32 - 1).clamp(1, 4) {
            let size = 1e8 * longest.powi(-power);
            let start = if power == 0 { 1e7 } else { 0.0 };
            let unknown = Unknown::new(format!("c{power}"), "", start).between(-1e4 * size, 1e4 * size);
            draft = draft.seek(&format!("actuator.force.modulus[{power}]"), unknown);
        }
        draft
    }

    /// From the shape that its source gives muscles of 20 mm.
    fn bolen(base: &Scenario, sizes: &Sizes) -> Self {
        let law = Force::Bolen {
            max_force: 1.2 * sizes.tension,
            max_pressure: sizes.gauge_pressure,
            max_contraction: (1.1 * sizes.contraction).min(0.9),
            shape: [0.2607, 6.398, 1.303],
        };
        let most = Unknown::new("F_max", "N", 1.2 * sizes.tension).between(0.2 * sizes.tension, 20.0 * sizes.tension);
        // Contraction enters over its largest, and so does the shape: one of the two is enough.
        let mut draft = Self::of(base, "bolen", law).seek("actuator.force.max_force", most);
        for (place, start) in [0.2607, 6.398, 1.303].into_iter().enumerate() {
            let unknown = Unknown::new(format!("s{place}"), "", start).between(1e-3, 100.0);
            draft = draft.seek(&format!("actuator.force.shape[{place}]"), unknown);
        }
        draft
    }

    fn sarosi(base: &Scenario, sizes: &Sizes) -> Self {
        let (force, pressure) = (sizes.tension, sizes.gauge_pressure);
        let percent = 100.0 * sizes.contraction;
        let starts = [
            0.05 * force / pressure,
            0.2 * force,
            -3.0 / percent,
            -0.8 * force / pressure / percent,
            force / pressure,
            -0.1 * force,
        ];
        let mut draft = Self::of(base, "sarosi", Force::Sarosi(starts));
        for (place, start) in starts.into_iter().enumerate() {
            let name = format!("a{}", place + 1);
            let unknown = match place {
                2 => Unknown::new(name, "", start).between(-100.0 / percent, 0.0),
                _ => Unknown::new(name, "", start).between(-1e3 * start.abs(), 1e3 * start.abs()),
            };
            draft = draft.seek(&format!("actuator.force.coefficients[{place}]"), unknown);
        }
        draft.start_elsewhere("actuator.force.coefficients[2]", &[-10.0 / percent, -1.0 / percent]);
        draft
    }

    /// One coefficient less of either polynomial than there are lengths, so that the map is not merely drawn through.
    fn polynomial(base: &Scenario, sizes: &Sizes) -> Self {
        let count = sizes.lengths.saturating_sub(1).clamp(1, MOST_COEFFICIENTS);
        let law = Force::Polynomial { pressure: vec![0.0; count], passive: vec![0.0; count] };
        let mut draft = Self::of(base, "polynomial", law);
        for (list, size) in [("pressure", sizes.tension / sizes.gauge_pressure), ("passive", sizes.tension)] {
            for power in 0..count {
                let largest = 1e4 * size * sizes.contraction.powi(-(power as i32));
                let start = if power == 0 && list == "pressure" { size } else { 0.0 };
                let letter = if list == "pressure" { "a" } else { "b" };
                let unknown = Unknown::new(format!("{letter}{power}"), "", start).between(-largest, largest);
                draft = draft.seek(&format!("actuator.force.{list}_coefficients[{power}]"), unknown);
            }
        }
        draft
    }

    /// More starts: the first with another value at one place.
    fn start_elsewhere(&mut self, path: &str, values: &[f64]) {
        let first: Vec<f64> = self.unknowns.iter().map(|(_, unknown)| unknown.start).collect();
        let Some(place) = self.unknowns.iter().position(|(of, _)| of == path) else { return };
        for value in values {
            let mut start = first.clone();
            start[place] = *value;
            self.starts.push(start);
        }
    }

    fn candidate(self) -> Result<Candidate, PlaceError> {
        let Self { name, mut scenario, unknowns, starts } = self;
        let places =
            unknowns.iter().map(|(path, _)| Place::find(path, &mut scenario)).collect::<Result<Vec<_>, _>>()?;
        let named = |(path, unknown): (String, Unknown)| Unknown { name: path, ..unknown };
        let unknowns: Vec<Unknown> = unknowns.into_iter().map(named).collect();
        Ok(Candidate { name, adjustable: Adjustable::new(scenario, places, [true; 2]), unknowns, starts })
    }
}
