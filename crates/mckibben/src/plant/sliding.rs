//! Which actuators slide and which stick, and when a sticking one lets go.
//!
//! A mechanism whose rates are zero, or some of whose actuators come to rest, is decided by the box problem of [`holding`]:
//! each actuator at rest can hold any tension between two bounds, and the rest accelerates. Those whose distances do
//! not accelerate stick. While they do, their tensions are not known one by one, but what they hold together is: a
//! torque `R = J_Sᵀ F`. It can be held as long as it lies in the zonotope of all `J_Sᵀ F` with tensions within their
//! bounds.
//!
//! ```text
//! facet z:    J_f z = 0 for rank − 1 independent rows f of J_S
//! guard:      max_F zᵀ(R − J_Sᵀ F) ≥ 0   and   max_F −zᵀ(R − J_Sᵀ F) ≥ 0
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | J_S | gradients of the distances of the actuators that stick | m per unit of the coordinate |
//! | F | their tensions, each between the least and the largest that it can hold | N |
//! | R | what they hold together: the force on each coordinate | N or N·m |
//! | z | normal of a facet of the zonotope | – |
//!
//! Each facet gives two guards, smooth while the mode lasts. With one coordinate there is one facet: the least and the
//! largest force that can be held. Actuators that share no coordinate are separate blocks.
//!
//! Source: the complementarity problem of set-valued friction, after Moreau (see [`holding`]). Checked by
//! `tests/plant_reference.rs`, against a program that decides by brute force which actuators stick, and by
//! `tests/joint.rs`.

use super::Mounted;
use super::dense::{dot, factor, solve};
use super::evaluation::{Evaluation, System};
use super::holding;
use super::mode::PlantMode;
use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::scalar::{Differentiable, Over, Real, Scalar};
use crate::simulation::{LengthRegime, Sliding};
use alloc::vec;
use alloc::vec::Vec;

/// The most facets that actuators which stick together may have: each is two guards.
pub(super) const MOST_FACETS: usize = 512;
/// Part of an entry below which it is rounding.
const ROUNDING: f64 = 1e-9;
/// Part of the longest length of an actuator below which its arm between two points is that of a dead centre.
const DEAD_CENTRE: f64 = 1e-3;

/// A facet of what sticking actuators can hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Sticking actuators of the block whose gradients are independent.
    pub span: Vec<usize>,
    /// Those in whose directions the facet lies: one fewer.
    pub along: Vec<usize>,
    /// All sticking actuators of the block.
    pub block: Vec<usize>,
}

impl<R: Real> System<R> {
    /// The least and the largest tension in N that an actuator without a tendon can hold at rest.
    pub(crate) fn holdable<T: Over<R>>(&self, i: usize, state: &[T], mode: &PlantMode<R>, length: T) -> (T, T) {
        let of_actuator = &mode.actuators[i];
        if of_actuator.mode.length_regime == LengthRegime::Slack {
            return (T::zero(), T::zero());
        }
        let member = &self.wires[i].member;
        let remembered = (&of_actuator.trace, self.deflections(i, state));
        let sliding_state = member.sliding_state([length, T::zero()], &of_actuator.mode, remembered);
        let pressure = state[self.plant.places.actuators[i].pressure];
        member.actuator.holdable(length, pressure, of_actuator.on_stop, sliding_state)
    }

    /// Decides how the actuators of a mechanism slide that may be at rest: those whose distance changes no faster than `slow`
    /// times their rest band count as resting.
    pub(crate) fn settle(&self, m: usize, time: R, state: &mut [R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let places = &self.plant.places;
        let here = places.mechanisms[m];
        if !self.plant.mechanisms[m].is_dynamic() {
            return self.follow_motion(m, time, state, mode, at);
        }
        mode.mechanisms[m].frozen = false;
        mode.mechanisms[m].basis.clear();
        mode.mechanisms[m].facets.clear();
        self.enter_distances(time, state, mode, at);
        let at_rest = state[here.rate(0)..here.rate(0) + here.coordinates].iter().all(|rate| rate.value() == 0.0);
        let mut resting = Vec::new();
        for &i in &places.members[m] {
            if places.actuators[i].length.is_some() {
                continue;
            }
            let slow = at_rest || (self.is_slow(i, at) && !self.is_at_dead_centre(i, at));
            mode.actuators[i].mode.sliding = self.sliding_towards(i, at.units[i].rate.value());
            let holds = self.wires[i].member.actuator.friction().has_coulomb() || mode.actuators[i].on_stop;
            if slow && mode.actuators[i].mode.length_regime != LengthRegime::Slack {
                if holds {
                    resting.push(i);
                }
                // What rests slides nowhere until it is known where.
                mode.actuators[i].mode.sliding = Sliding::Stuck;
            }
        }
        self.solve_rest(m, time, state, mode, at, &resting, at_rest);
    }

    /// Whether the distance of an actuator changes as slowly as at rest.
    fn is_slow(&self, i: usize, at: &Evaluation<R>) -> bool {
        at.units[i].rate.value().abs() <= 1.01 * self.rest_band(i)
    }

    /// Whether the two points of an actuator pass each other at a dead centre, where its distance rests and its mechanism moves
    /// on: it has no arm to hold it by.
    pub(crate) fn is_at_dead_centre(&self, i: usize, at: &Evaluation<R>) -> bool {
        let is_short = |entry: &R| entry.value().abs() < DEAD_CENTRE * self.wires[i].member.longest;
        self.plant.actuators[i].coupling.has_dead_centres() && self.gradient(i, &at.gradient).iter().all(is_short)
    }

    /// Solves for what the resting actuators of a mechanism hold, and sets how all of them slide.
    #[allow(clippy::too_many_arguments)]
    fn solve_rest(
        &self,
        m: usize,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
        resting: &[usize],
        at_rest: bool,
    ) {
        let places = &self.plant.places;
        let here = places.mechanisms[m];
        let count = here.coordinates;
        // What cannot hold pulls with its force at rest.
        for &i in &places.members[m] {
            let friction = self.wires[i].member.actuator.friction();
            // An end on a tendon sticks or slides whatever the mechanism does.
            let is_own = places.actuators[i].length.is_none();
            if is_own && mode.actuators[i].mode.sliding == Sliding::Stuck && !resting.contains(&i) {
                mode.actuators[i].mode.sliding =
                    if friction.has_direction() { Sliding::Held } else { Sliding::Frictionless };
            }
        }
        self.clamp_all(m, time, state, mode, at);
        self.evaluate(time, state, mode, at);
        self.enter_force(m, state, mode, at);
        let mut matrix = vec![R::zero(); count * count];
        self.mass_matrix(m, &at.directions, &mut matrix);
        factor(&mut matrix, count);
        let mut acceleration: Vec<R> = at.force[..count].to_vec();
        solve(&matrix, count, &mut acceleration);
        let values = |numbers: &[R]| numbers.iter().map(|number| number.value()).collect::<Vec<f64>>();
        let size = resting.len();
        let mut rows = Vec::with_capacity(size);
        for &i in resting {
            let mut row = self.gradient(i, &at.gradient).to_vec();
            solve(&matrix, count, &mut row);
            rows.push(values(&row));
        }
        let gradients: Vec<Vec<f64>> = resting.iter().map(|&i| values(self.gradient(i, &at.gradient))).collect();
        let mut weights = vec![0.0; size * size];
        for a in 0..size {
            for b in 0..size {
                weights[a * size + b] = dot(&gradients[a], &rows[b]);
            }
        }
        let free = values(&acceleration);
        let pull: Vec<f64> = resting
            .iter()
            .enumerate()
            .map(|(a, &i)| dot(&gradients[a], &free) + self.bending(i, state, mode).value())
            .collect();
        let bounds: Vec<[f64; 2]> = resting
            .iter()
            .map(|&i| {
                let (least, most) = self.holdable(i, state, mode, at.units[i].length);
                // A border must be passed by the band before what rests moves.
                [
                    (least.value() - self.wires[i].member.force_band).max(0.0),
                    most.value() + self.wires[i].member.force_band,
                ]
            })
            .collect();
        let least: Vec<f64> = bounds.iter().map(|[least, _]| *least).collect();
        let most: Vec<f64> = bounds.iter().map(|[_, most]| *most).collect();
        let held = holding::solve(&weights, &pull, &least, &most);
        let mut motion = free.clone();
        if let Some(held) = &held {
            for (row, tension) in rows.iter().zip(&held.tension) {
                for (motion, entry) in motion.iter_mut().zip(row) {
                    *motion -= entry * tension;
                }
            }
        }
        let accelerates = |a: usize| held.as_ref().map_or(pull[a], |held| held.acceleration[a]);
        let sticking: Vec<usize> = (0..size).filter(|&a| accelerates(a) == 0.0).map(|a| resting[a]).collect();
        self.stick(m, state, mode, at, &sticking);
        let frozen = mode.mechanisms[m].frozen;
        for &i in &places.members[m] {
            if places.actuators[i].length.is_some() || mode.actuators[i].mode.length_regime == LengthRegime::Slack {
                continue;
            }
            let heading = match resting.iter().position(|&it| it == i) {
                _ if frozen => {
                    mode.actuators[i].mode.sliding = Sliding::Stuck;
                    continue;
                }
                Some(_) if sticking.contains(&i) => {
                    mode.actuators[i].mode.sliding = Sliding::Stuck;
                    continue;
                }
                Some(a) => accelerates(a),
                None if matches!(mode.actuators[i].mode.sliding, Sliding::Held | Sliding::Frictionless)
                    && (at_rest || self.is_slow(i, at)) =>
                {
                    // Its rate is rounding as likely as not.
                    let gradient = values(self.gradient(i, &at.gradient));
                    dot(&gradient, &motion) + self.bending(i, state, mode).value()
                }
                None => at.units[i].rate.value(),
            };
            self.head(i, mode, heading);
        }
        self.clamp_all(m, time, state, mode, at);
    }

    /// Lets go what can no longer be held: what sticks and moves along the normal of the facet slides that way, the others go
    /// on sticking.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn release(
        &self,
        m: usize,
        facet: usize,
        positive: bool,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        let places = &self.plant.places;
        self.enter_distances(time, state, mode, at);
        let Facet { span, along, .. } = &mode.mechanisms[m].facets[facet];
        let normal = self.normal(span, along, places.mechanisms[m].coordinates, at);
        // The force along the normal is below zero whatever is held, or above it.
        let sign = if positive { -1.0 } else { 1.0 };
        let mut sticking = Vec::new();
        let mut headings = Vec::new();
        for &i in &places.members[m] {
            if places.actuators[i].length.is_some() || mode.actuators[i].mode.sliding != Sliding::Stuck {
                continue;
            }
            let gradient = self.gradient(i, &at.gradient);
            let heading = sign * dot(gradient, &normal).value();
            let size = Scalar::sqrt(dot(gradient, gradient).value() * dot(&normal, &normal).value());
            if Scalar::magnitude(heading) > ROUNDING * size {
                headings.push((i, heading));
            } else if self.wires[i].member.actuator.friction().has_coulomb() || mode.actuators[i].on_stop {
                sticking.push(i);
            }
        }
        for &(i, heading) in &headings {
            self.head(i, mode, heading);
        }
        self.stick(m, state, mode, at, &sticking);
        self.clamp_all(m, time, state, mode, at);
    }

    /// Sets an actuator sliding the way that the sign of `heading` says; one on its shortest length that this would shorten
    /// falls slack.
    fn head(&self, i: usize, mode: &mut PlantMode<R>, heading: f64) {
        if heading < 0.0 && mode.actuators[i].on_stop {
            mode.actuators[i].mode.length_regime = LengthRegime::Slack;
        }
        mode.actuators[i].on_stop = false;
        mode.actuators[i].mode.sliding = self.sliding_towards(i, heading);
    }

    /// Lets actuators of a mechanism stick: finds which of them hold it, whether they hold all of it, and their facets.
    fn stick(&self, m: usize, state: &mut [R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>, sticking: &[usize]) {
        let here = self.plant.places.mechanisms[m];
        let gradient =
            |i: usize| -> Vec<f64> { self.gradient(i, &at.gradient).iter().map(|entry| entry.value()).collect() };
        let basis = independent(sticking, &gradient);
        let of_mechanism = &mut mode.mechanisms[m];
        of_mechanism.frozen = basis.len() == here.coordinates && !basis.is_empty();
        of_mechanism.facets = facets(sticking, &gradient, |i| self.spans(i, m));
        of_mechanism.basis = if of_mechanism.frozen { Vec::new() } else { basis };
        if of_mechanism.frozen {
            state[here.rate(0)..here.rate(0) + here.coordinates].fill(R::zero());
        } else {
            self.hold_rates(m, state, mode, at);
        }
    }

    /// The coordinates that an actuator spans.
    fn spans(&self, i: usize, m: usize) -> Vec<usize> {
        self.plant.actuators[i].coupling.spans(self.plant.places.mechanisms[m].coordinates)
    }

    /// Decides again which forces of a mechanism's actuators are kept from pushing.
    pub(crate) fn clamp_all(&self, m: usize, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        self.enter_distances(time, state, mode, at);
        for &i in &self.plant.places.members[m] {
            if self.plant.places.actuators[i].length.is_some() {
                continue;
            }
            let unit = &at.units[i];
            let ends = [unit.length, unit.velocity, state[self.plant.places.actuators[i].pressure]];
            let deflections = self.deflections(i, state);
            let of_actuator = &mut mode.actuators[i];
            let mut changed = of_actuator.mode;
            self.wires[i].member.enter_clamp(ends, &mut changed, (&of_actuator.trace, deflections));
            of_actuator.mode = changed;
        }
    }

    /// Sets how the actuators slide whose motion is given.
    fn follow_motion(&self, m: usize, time: R, state: &mut [R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        self.follow_rates(m, time, state, mode, at);
        self.clamp_all(m, time, state, mode, at);
    }

    /// Lets them slide the way that they move, or would move next; where that is none they are held. Whether one slides another
    /// way than before.
    pub(super) fn follow_rates(
        &self,
        m: usize,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> bool {
        let mut turned = false;
        self.enter_distances(time, state, mode, at);
        let acceleration = match &self.plant.mechanisms[m] {
            Mechanism::Prescribed(motion) => motion.at(time, mode.mechanisms[m].corners_passed)[2].value(),
            _ => 0.0,
        };
        for &i in &self.plant.places.members[m] {
            if self.plant.places.actuators[i].length.is_some() {
                continue;
            }
            let velocity = at.units[i].rate.value();
            let heading = if velocity == 0.0 { acceleration } else { velocity };
            let sliding = if heading == 0.0 { Sliding::Held } else { self.sliding_towards(i, heading) };
            let before = core::mem::replace(&mut mode.actuators[i].mode.sliding, sliding);
            turned |= before != sliding;
        }
        turned
    }

    /// Value of the guard of a facet in N times the facet's unit: positive while what sticks can hold.
    pub(crate) fn facet_guard<T: Differentiable<R>>(
        &self,
        (m, facet, positive): (usize, usize, bool),
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) -> T {
        let places = &self.plant.places;
        let of_mechanism = &mode.mechanisms[m];
        let Facet { span, along, block } = &of_mechanism.facets[facet];
        // Of what else is there nothing counts: many mechanisms at rest would cost the square of their number.
        self.enter_ends_on(m, time, state, mode, at);
        let count = places.mechanisms[m].coordinates;
        let normal = self.normal(span, along, count, at);
        // What is to be held.
        if of_mechanism.frozen {
            for &i in &places.members[m] {
                let unit = &mut at.units[i];
                unit.tension = match &self.plant.actuators[i].tendon {
                    Some(tendon) => super::tendon::tension(tendon, mode.actuators[i].loose, unit.distance, unit.length),
                    None => self.unstuck_tension(i, state, mode, unit.length),
                };
            }
            self.enter_force(m, state, mode, at);
        } else {
            self.evaluate(time, state, mode, at);
            self.enter_load(m, state, mode, at);
        }
        let load = dot(&normal, &at.force[..count]);
        let (mut most, mut band) = (load, T::zero());
        if !positive {
            most = -load;
        }
        for &j in block {
            let unit_length = at.units[j].length;
            let (least_tension, most_tension) = self.holdable(j, state, mode, unit_length);
            let lever = dot(self.gradient(j, &at.gradient), &normal);
            let lever = if positive { lever } else { -lever };
            // The tension that leaves most.
            let tension = T::select(lever.lt(T::zero()), most_tension, least_tension);
            most = most - lever * tension;
            band = band + lever.magnitude() * T::constant(self.wires[j].member.force_band);
        }
        most + band
    }

    /// Tension of an actuator that rests and holds nothing; zero for one that does.
    pub(super) fn unstuck_tension<T: Over<R>>(&self, i: usize, state: &[T], mode: &PlantMode<R>, length: T) -> T {
        let of_actuator = &mode.actuators[i];
        let m = self.plant.actuators[i].mechanism;
        if mode.mechanisms[m].facets.iter().any(|facet| facet.block.contains(&i)) {
            return T::zero();
        }
        let ends = [length, T::zero(), state[self.plant.places.actuators[i].pressure]];
        let remembered = (&of_actuator.trace, self.deflections(i, state));
        // No mode says whether what rests would push.
        self.wires[i].member.tension(ends, &of_actuator.mode, remembered).larger(T::zero())
    }

    /// The normal of a facet in coordinates of the mechanism.
    fn normal<T: Over<R>>(&self, span: &[usize], along: &[usize], count: usize, at: &Evaluation<T>) -> Vec<T> {
        let gradient = |i: usize| self.gradient(i, &at.gradient);
        let rank = span.len();
        // Rows of products: the weights of the span are orthogonal to them.
        let rows: Vec<T> =
            along.iter().flat_map(|&f| span.iter().map(move |&b| dot(gradient(f), gradient(b)))).collect();
        let weights = null_vector(&rows, rank);
        let mut normal = vec![T::zero(); count];
        for (&b, weight) in span.iter().zip(&weights) {
            for (normal, entry) in normal.iter_mut().zip(gradient(b)) {
                *normal = *normal + *weight * *entry;
            }
        }
        normal
    }
}

/// A vector that is orthogonal to `rank − 1` rows of `rank` numbers.
fn null_vector<T: Scalar>(rows: &[T], rank: usize) -> Vec<T> {
    // By cofactors: what is left out of the rows, column by column. Ranks are small.
    let mut vector = Vec::with_capacity(rank);
    for left_out in 0..rank {
        let columns: Vec<usize> = (0..rank).filter(|&column| column != left_out).collect();
        let minor = determinant(rows, rank, &columns);
        vector.push(if left_out % 2 == 0 { minor } else { -minor });
    }
    vector
}

/// The determinant of the first rows over some columns.
fn determinant<T: Scalar>(rows: &[T], width: usize, columns: &[usize]) -> T {
    let Some((_, rest)) = columns.split_first() else { return T::one() };
    let size = rest.len() + 1;
    let mut sum = T::zero();
    for (k, &column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        // Along the last of the rows.
        let minor = determinant(rows, width, &others);
        let term = rows[(size - 1) * width + column] * minor;
        sum = if (k + size).is_multiple_of(2) { sum - term } else { sum + term };
    }
    sum
}

/// Those of the actuators whose gradients are independent, the first ones first.
fn independent(actuators: &[usize], gradient: &impl Fn(usize) -> Vec<f64>) -> Vec<usize> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut chosen = Vec::new();
    for &i in actuators {
        let mut row = gradient(i);
        let size = dot(&row, &row);
        for other in &basis {
            let part = dot(&row, other);
            for (entry, other) in row.iter_mut().zip(other) {
                *entry -= part * other;
            }
        }
        let left = dot(&row, &row);
        if size > 0.0 && left > ROUNDING * size {
            let norm = Scalar::sqrt(left);
            basis.push(row.into_iter().map(|entry| entry / norm).collect());
            chosen.push(i);
        }
    }
    chosen
}

/// The actuators that share coordinates with a first one, directly or by others, in their order, and the coordinates that they
/// span. They are taken from `left`.
fn block_of(first: usize, left: &mut Vec<usize>, spans: &impl Fn(usize) -> Vec<usize>) -> (Vec<usize>, Vec<usize>) {
    let mut block = vec![first];
    let mut coordinates = spans(first);
    while let Some(place) = left.iter().position(|&i| spans(i).iter().any(|it| coordinates.contains(it))) {
        let next = left.remove(place);
        for coordinate in spans(next) {
            if !coordinates.contains(&coordinate) {
                coordinates.push(coordinate);
            }
        }
        block.push(next);
    }
    block.sort_unstable();
    (block, coordinates)
}

/// That actuators which stick on one mechanism never have more facets than a mode keeps guards for.
///
/// # Errors
/// [`Error::Table`] otherwise.
pub(super) fn check_facets(actuators: &[Mounted], mechanisms: &[Mechanism]) -> Result<(), Error> {
    for (m, mechanism) in mechanisms.iter().enumerate().filter(|(_, mechanism)| mechanism.is_dynamic()) {
        let sticks = |i: &usize| actuators[*i].mechanism == m && actuators[*i].tendon.is_none();
        let mut left: Vec<usize> = (0..actuators.len()).filter(sticks).collect();
        let spans = |i: usize| actuators[i].coupling.spans(mechanism.coordinates());
        while let Some(first) = left.pop() {
            let (block, coordinates) = block_of(first, &mut left, &spans);
            let count = directions(&block, spans, |_, _| false).len();
            // As many as there are choices of one fewer than the rank.
            let (mut choices, mut most) = (1, 1);
            for chosen in 1..coordinates.len().min(count) {
                choices = choices * (count + 1 - chosen) / chosen;
                most = most.max(choices);
            }
            if most > MOST_FACETS {
                return Err(Error::Table {
                    name: "actuators on one mechanism",
                    problem: "what they can hold as they stick together has more than 512 facets",
                    entry: block[block.len() - 1] + 1,
                    remedy: "let fewer actuators span several joints, give them tendons, or divide the mechanism",
                });
            }
        }
    }
    Ok(())
}

/// The facets of what sticking actuators can hold, block by block.
fn facets(
    sticking: &[usize],
    gradient: &impl Fn(usize) -> Vec<f64>,
    spans: impl Fn(usize) -> Vec<usize>,
) -> Vec<Facet> {
    let mut left: Vec<usize> = sticking.to_vec();
    let mut facets = Vec::new();
    while let Some(first) = left.pop() {
        let block = block_of(first, &mut left, &spans).0;
        let span = independent(&block, gradient);
        let wanted = span.len().saturating_sub(1);
        let size = |i: usize| {
            let row = gradient(i);
            dot(&row, &row)
        };
        // Of those about one joint alone, which are parallel, one lies along the facet as well as another.
        let directions = directions(&block, &spans, |a, b| size(a) > size(b));
        each_choice(&directions, wanted, &mut Vec::new(), &mut |along| {
            if independent(along, gradient).len() == wanted {
                facets.push(Facet { span: span.clone(), along: along.to_vec(), block: block.clone() });
            }
        });
    }
    facets
}

/// Those of some actuators that pull in different directions: of all about one and the same joint alone the one that is
/// `larger` than the others.
fn directions(
    actuators: &[usize],
    spans: impl Fn(usize) -> Vec<usize>,
    larger: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    for &i in actuators {
        let its = spans(i);
        let place = chosen.iter().position(|&other| its.len() == 1 && spans(other) == its);
        match place {
            Some(place) if larger(i, chosen[place]) => chosen[place] = i,
            Some(_) => {}
            None => chosen.push(i),
        }
    }
    chosen
}

/// Calls `visit` with each choice of so many of the actuators.
fn each_choice(from: &[usize], wanted: usize, chosen: &mut Vec<usize>, visit: &mut dyn FnMut(&[usize])) {
    if wanted == 0 {
        return visit(chosen);
    }
    for (place, &i) in from.iter().enumerate() {
        chosen.push(i);
        each_choice(&from[place + 1..], wanted - 1, chosen, visit);
        chosen.pop();
    }
}
