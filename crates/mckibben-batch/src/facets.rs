//! What actuators that stick on a chain of several joints can hold, watched of several plants side by side.
//!
//! What is held is a torque R over the coordinates. Along the normal z of each facet of what can be held it lies between two bounds
//! (`plant/sliding.rs` of the core). The list of facets differs from plant to plant: each that any of them has is evaluated once
//! for all, and counts where it is watched. A bound has to be kept by a margin, so that no rounding decides.
//!
//! ```text
//! R = τ − h − Σ Jᵀ F − M q̈        F of those that do not stick        Σ min(λ F_least, λ F_most) ≤ zᵀR ≤ Σ max(λ F_least, λ F_most)
//! λ = zᵀ J                         the lever of one that sticks
//! ```

use crate::held::Held;
use crate::watch::holdable;
use crate::wide::Wide;
use mckibben::internals::{Evaluation, Facet, Formulas, System, dot};
use mckibben::mechanism::chain::MAX_JOINTS;
use mckibben::scalar::{Mask, Work};

/// The rank up to which normals are known here.
const HIGHEST_RANK: usize = 3;

/// A facet that is watched in some lanes.
#[derive(Clone, Debug)]
struct WatchedFacet<W> {
    mechanism: usize,
    facet: Facet,
    /// 1 where it is watched, 0 elsewhere.
    flag: W,
    any: bool,
}

/// All facets that are watched in any lane.
#[derive(Clone, Debug)]
pub(crate) struct Facets<W> {
    watched: Vec<WatchedFacet<W>>,
    /// The least and the largest tension in N of each actuator.
    bounds: Vec<[W; 2]>,
    any: bool,
}

/// The check of all facets at the end of a step, in a separate function: few steps need it.
struct Look<'a, W: Wide> {
    facets: &'a mut Facets<W>,
    system: &'a System<W>,
    time: W,
    end: &'a [W],
    held: &'a Held<W>,
    at: &'a mut Evaluation<W>,
}

impl<W: Wide> Facets<W> {
    /// Nothing is watched, of a plant of so many actuators.
    #[inline(always)]
    pub(crate) fn new(actuators: usize) -> Self {
        Self { watched: Vec::new(), bounds: vec![[W::zero(); 2]; actuators], any: false }
    }

    /// Ceases to watch a lane.
    pub(crate) fn leave(&mut self, lane: usize) {
        for watched in &mut self.watched {
            watched.flag.mark(lane, false);
        }
    }

    /// Watches a facet of a row; whether that can be done here.
    pub(crate) fn enter(&mut self, lane: usize, mechanism: usize, facet: &Facet) -> bool {
        if facet.span.len() > HIGHEST_RANK {
            return false;
        }
        let is_it = |its: &WatchedFacet<W>| its.mechanism == mechanism && its.facet == *facet;
        let place = self.watched.iter().position(is_it).unwrap_or_else(|| {
            let new = WatchedFacet { mechanism, facet: facet.clone(), flag: W::from_lanes(|_| 0.0), any: false };
            match self.watched.iter().position(WatchedFacet::is_free) {
                Some(free) => {
                    self.watched[free] = new;
                    free
                }
                None => {
                    self.watched.push(new);
                    self.watched.len() - 1
                }
            }
        });
        self.watched[place].flag.mark(lane, true);
        true
    }

    /// Takes up what has been entered.
    pub(crate) fn update(&mut self) {
        for watched in &mut self.watched {
            watched.any = !watched.is_free();
        }
        self.any = self.watched.iter().any(|watched| watched.any);
    }

    /// Where all that is watched is held at the end of a step.
    #[inline(always)]
    pub(crate) fn hold(
        &mut self,
        system: &System<W>,
        (time, end): (W, &[W]),
        held: &Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        match self.any {
            true => W::apart(Look { facets: self, system, time, end, held, at }),
            false => W::Mask::splat(true),
        }
    }
}

impl<W: Wide> WatchedFacet<W> {
    /// Whether no lane watches it.
    fn is_free(&self) -> bool {
        !self.flag.is_marked()
    }
}

impl<W: Wide> Work for Look<'_, W> {
    type Output = W::Mask;

    #[inline(always)]
    fn done(self) -> W::Mask {
        let Self { facets, system, time, end, held, at } = self;
        let mut within = W::Mask::splat(true);
        system.evaluate(time, end, held, at);
        for m in 0..system.assemblies.len() {
            let is_of_mechanism = |watched: &WatchedFacet<W>| watched.any && watched.mechanism == m;
            if !facets.watched.iter().any(is_of_mechanism) {
                continue;
            }
            let frozen = held.is_frozen(m);
            for &i in &system.plant.indices().members[m] {
                // No mode says whether what rests would push.
                let unit = &mut at.units[i];
                unit.tension = W::select(frozen, unit.tension.larger(W::zero()), unit.tension);
            }
            system.enter_load(m, end, held, at);
            for &i in &system.plant.indices().members[m] {
                let (least, most) = holdable(system, i, end, held, at);
                facets.bounds[i] = [least, most];
            }
            for watched in &facets.watched {
                if is_of_mechanism(watched) {
                    let is_held = holds(system, &watched.facet, &facets.bounds, at);
                    within = within & (watched.flag.le(W::zero()) | is_held);
                }
            }
        }
        within
    }
}

/// Where the load, entered as forces, lies between what can be held along the normal of a facet.
#[inline(always)]
fn holds<W: Wide>(
    system: &System<W>,
    Facet { span, along, block }: &Facet,
    bounds: &[[W; 2]],
    at: &Evaluation<W>,
) -> W::Mask {
    let zero = W::zero();
    // The weights of the span are orthogonal to the products of its gradients with those along the facet.
    let mut products = [[zero; HIGHEST_RANK]; HIGHEST_RANK];
    for (row, &f) in products.iter_mut().zip(along) {
        for (product, &b) in row.iter_mut().zip(span) {
            *product = dot(system.gradient(f, &at.gradient), system.gradient(b, &at.gradient));
        }
    }
    let [p, q, _] = products;
    let weights = match span.len() {
        1 => [W::one(), zero, zero],
        2 => [p[1], -p[0], zero],
        _ => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]],
    };
    let mut normal = [zero; MAX_JOINTS];
    for (&b, weight) in span.iter().zip(weights) {
        for (entry, its) in normal.iter_mut().zip(system.gradient(b, &at.gradient)) {
            *entry = *entry + weight * *its;
        }
    }
    let (mut least, mut most, mut size, mut along_normal) = (zero, zero, zero, zero);
    let coordinates = system.gradient(span[0], &at.gradient).len();
    for (entry, load) in normal.iter().zip(&at.force[..coordinates]) {
        let part = *entry * *load;
        along_normal = along_normal + part;
        size = size + part.magnitude();
    }
    for &i in block {
        let gradient = system.gradient(i, &at.gradient);
        let lever = dot(gradient, &normal[..gradient.len()]);
        let [low, high] = [lever * bounds[i][0], lever * bounds[i][1]];
        least = least + low.smaller(high);
        most = most + low.larger(high);
        size = size + low.magnitude() + high.magnitude();
    }
    let margin = W::constant(W::MARGIN) * size;
    (least + margin).le(along_normal) & along_normal.le(most - margin)
}
