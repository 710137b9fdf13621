//! An elastic tendon in series: where the actuator's end goes.
//!
//! ```text
//! T = k max(0, x − ℓ − L)          F(L, L̇, P) = T
//!
//! with viscous friction      L̇ by F(L, L̇, P) = T
//! without                    L̇ by ∂F/∂L L̇ + ∂F/∂P Ṗ(L̇) = k (ẋ − L̇), and L kept to F(L, P) = T
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x | distance that actuator and tendon span together | m |
//! | L, P | length and absolute pressure of the actuator: states | m, Pa |
//! | k, ℓ | `stiffness` and `rest_length` of the [tendon](crate::load::SeriesTendon) | N/m, m |
//! | F | tension of the actuator (12) | N |
//!
//! Nothing has a mass between actuator and tendon, so that the actuator's length is a state whose rate follows from the
//! balance of both tensions. Without viscous friction the balance holds the length itself: its rate is that by which the
//! balance stays, and every state that is kept is brought back to it by a Newton step, with the air sealed or at the pressure that
//! is given. Bristles of LuGre's law and viscoelastic branches count with their rates.
//!
//! Source: balance of forces at an end without mass. Checked by `tests/plant_reference.rs` against an independent program and by
//! `tests/plant_linear.rs`.

use super::Plant;
use super::evaluation::{Evaluation, System, Unit};
use super::formulas::Formulas;
use super::mode::PlantMode;
use crate::actuator::Actuator;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::friction::Deflections;
use crate::load::SeriesTendon;
use crate::scalar::{Differentiable, Mask, Over, Real, Scalar, Work};

/// Part of a length by which a difference over it is taken.
const DIFFERENCE: f64 = 1e-4;
/// A velocity in m/s at which no force falls any more.
const FAST: f64 = 1e6;
/// Newton steps in search of a velocity, and the part of it to which it is found.
const MOST_SEARCHED: u32 = 100;
const SEARCHED: f64 = 1e-9;

/// Tension in N of a tendon between a distance and an actuator length (m) where it is not loose; in a mode that has it tight also
/// below zero.
#[inline(always)]
pub fn tension<R: Scalar, T: Over<R>>(tendon: &SeriesTendon<R>, loose: R::Mask, distance: T, length: T) -> T {
    let tight = T::of(tendon.stiffness()) * (distance - length - T::of(tendon.rest_length()));
    T::select(loose, T::zero(), tight)
}

/// Where the velocity of an end follows from the balance at once: by viscous friction, or by that of the braid where it is taut.
#[inline(always)]
pub fn is_damped<R: Scalar>(actuator: &Actuator<R>, taut: R::Mask) -> R::Mask {
    (taut & R::zero().lt(actuator.limits().damping())) | R::zero().lt(actuator.friction().viscous())
}

/// An actuator on a tendon.
struct End<'a, R: Scalar, F> {
    system: &'a System<R>,
    i: usize,
    tendon: &'a SeriesTendon<R>,
    mode: &'a F,
}

/// Its force less the tendon's at a velocity, and how that grows. They have many callers, and are compiled once.
struct ExcessAt<'a, R: Scalar, T, F> {
    end: &'a End<'a, R, F>,
    at: (&'a Unit<T>, &'a Chamber<T>),
    deflections: Deflections<T>,
    velocity: T,
}

struct Growth<'a, R: Scalar, T, F>(ExcessAt<'a, R, T, F>);

/// Enters the velocity and the tension of an end, compiled once: few actuators have one.
struct EnterEnd<'a, R: Scalar, T, F> {
    system: &'a System<R>,
    i: usize,
    mode: &'a F,
    deflections: Deflections<T>,
    at: (&'a mut Unit<T>, &'a mut Chamber<T>),
}

impl<R: Scalar, T: Differentiable<R>, F: Formulas<R>> Work for EnterEnd<'_, R, T, F> {
    type Output = ();

    #[inline(always)]
    fn done(self) {
        let Self { system, i, mode, deflections, at: (unit, chamber) } = self;
        let mounted = &system.plant.actuators[i];
        let Some(tendon) = &mounted.tendon else { return };
        unit.velocity = system.end_velocity(i, tendon, mode, (unit, chamber), deflections);
        unit.tension = tension(tendon, mode.is_loose(i), unit.distance, unit.length);
        let slack = R::Mask::splat(false);
        *chamber = mounted.actuator.chamber(unit.length, unit.velocity, chamber.pressure, chamber.mass, slack);
    }
}

impl<R: Scalar> System<R> {
    /// Enters the velocity and the tension of an actuator on a tendon.
    #[inline(always)]
    pub(crate) fn enter_end<T: Differentiable<R>>(
        &self,
        i: usize,
        mode: &impl Formulas<R>,
        deflections: Deflections<T>,
        at: (&mut Unit<T>, &mut Chamber<T>),
    ) {
        T::apart(EnterEnd { system: self, i, mode, deflections, at });
    }

    /// The rate L̇ in m/s of the length of an actuator on a tendon.
    #[inline(always)]
    pub fn end_velocity<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        mode: &impl Formulas<R>,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> T {
        let end = End { system: self, i, tendon, mode };
        let (stuck, damped) = (mode.is_stuck(i), mode.is_damped(self, i));
        let mut velocity = T::zero();
        if (!stuck & damped).any() {
            velocity = end.damped_velocity(at, deflections);
        }
        if (!stuck & !damped).any() {
            velocity = T::select(damped, velocity, end.kept_velocity(at, deflections));
        }
        T::select(stuck, T::zero(), velocity)
    }

    /// How the rate of an end's length answers at what it is, to the distance in 1/s, to its rate, and to the length in 1/s: by the
    /// balance of both tensions,
    ///
    /// ```text
    /// with viscous friction      ∂L̇/∂x = k/F_v      ∂L̇/∂L = −(F_L + F_P P_L + k)/F_v
    /// without                    ∂L̇/∂ẋ = k/G_v      ∂L̇/∂L = −G_L/G_v          G = F_L L̇ + F_P Ṗ(L̇) − k (ẋ − L̇)
    /// ```
    ///
    /// P_L is how the pressure of the sealed air changes with the length. G has first derivatives of F; how it changes with the length is a difference, which is enough for a stable step.
    #[inline(always)]
    pub(super) fn end_answers(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        mode: &impl Formulas<R>,
        at: (&Unit<R>, &Chamber<R>),
        sealed: R,
        deflections: Deflections<R>,
    ) -> [R; 3] {
        let ((unit, chamber), zero, damped) = (at, R::zero(), mode.is_damped(self, i));
        let tight = R::select(mode.is_loose(i), zero, tendon.stiffness());
        let [mut by_distance, mut by_rate, mut by_length] = [zero; 3];
        if damped.any() {
            let pressure = Dual { value: chamber.pressure, slope: [sealed, zero] };
            let ends: [Dual<R, 2>; 3] = [Dual::variable(unit.length, 0), Dual::variable(unit.velocity, 1), pressure];
            let [per_length, per_velocity] = mode.signed_force(&self.wires[i], ends, deflections.constant()).slope;
            by_distance = R::select(damped, tight / per_velocity, zero);
            by_length = R::select(damped, -(per_length + tight) / per_velocity, zero);
        }
        if (!damped).any() {
            let end = End { system: self, i, tendon, mode };
            let [velocity, slope] = end.kept_from_rest(at, deflections);
            let further = unit.length * R::constant(DIFFERENCE);
            let longer = Unit { length: unit.length + further, ..*unit };
            let growth = end.growth((&longer, chamber), deflections, velocity);
            by_rate = R::select(damped, zero, tight / slope);
            by_length = R::select(damped, by_length, -growth / (further * slope));
        }
        [by_distance, by_rate, by_length]
    }

    /// The actuator's force less the tendon's in N, as the end begins to slide.
    #[inline(always)]
    pub fn excess<T: Over<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        mode: &impl Formulas<R>,
        [distance, length, pressure]: [T; 3],
        deflections: Deflections<T>,
    ) -> T {
        mode.signed_force(&self.wires[i], [length, T::zero(), pressure], deflections)
            - tension(tendon, mode.is_loose(i), distance, length)
    }

    /// `dP/dt` in Pa/s while the length changes at a velocity in m/s; where it is given over time, that whatever the length does.
    #[inline(always)]
    pub(crate) fn air_rate<T: Over<R>>(&self, i: usize, (unit, chamber): (&Unit<T>, &Chamber<T>), velocity: T) -> T {
        if self.wires[i].is_given {
            return unit.pressure_rate;
        }
        let actuator = &self.wires[i].member.actuator;
        let slack = R::Mask::splat(false);
        let moving = actuator.chamber(unit.length, velocity, chamber.pressure, chamber.mass, slack);
        actuator.air().pressure_rate_by(&moving, &unit.flow, || unit.warmth)
    }

    /// How the pressure of the sealed air answers to the length in Pa/m, `−κ P V′/V`; not at all where it is given over time.
    #[inline(always)]
    pub(crate) fn sealed_pressure(&self, i: usize, length: R, chamber: &Chamber<R>) -> R {
        if self.wires[i].is_given {
            return R::zero();
        }
        let actuator = &self.wires[i].member.actuator;
        let slack = R::Mask::splat(false);
        let moving = actuator.chamber(length, R::one(), chamber.pressure, chamber.mass, slack);
        actuator.air().pressure_rate_by(&moving, &Flow::none(), R::zero)
    }

    /// By how much in N/s the stiffness of an end without viscous friction, that of its sealed air and of its tendon, keeps it
    /// below a velocity in m/s; below zero where it jumps: it goes faster, or nothing brings it back to its balance.
    #[inline(always)]
    pub fn hold_of_end<T: Differentiable<R>>(
        &self,
        i: usize,
        tendon: &SeriesTendon<R>,
        mode: &impl Formulas<R>,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
        fastest: f64,
    ) -> T {
        let end = End { system: self, i, tendon, mode };
        let at_rest = end.growth(at, deflections, T::zero());
        (end.growth(at, deflections, T::one()) - at_rest) * T::constant(fastest) - at_rest.magnitude()
    }

    /// Brings the length of an actuator on a tendon to where both tensions are equal, with the air sealed, where nothing but
    /// the balance holds it.
    #[inline(always)]
    pub fn keep_balance(&self, i: usize, time: R, state: &mut [R], mode: &impl Formulas<R>, at: &mut Evaluation<R>) {
        let here = self.wires[i].places;
        let (Some(tendon), Some(place)) = (&self.plant.actuators[i].tendon, here.length) else { return };
        let kept = !mode.is_stuck(i) & !mode.is_damped(self, i);
        if !kept.any() {
            return;
        }
        self.enter_distances(time, state, mode, at);
        let unit = &at.units[i];
        let per_length = self.sealed_pressure(i, unit.length, &at.chambers[i]);
        let distance = Dual::<R, 1> { value: unit.distance, slope: [R::zero()] };
        let length = Dual::variable(state[place], 0);
        let pressure = Dual { value: state[here.pressure], slope: [per_length] };
        let deflections = self.deflections(i, state).constant();
        let excess = self.excess(i, tendon, mode, [distance, length, pressure], deflections);
        let step = excess.value / excess.slope[0];
        // What is not a number is no step.
        let is_one = kept & step.magnitude().lt(R::constant(f64::INFINITY));
        state[place] = R::select(is_one, state[place] - step, state[place]);
        state[here.pressure] = R::select(is_one, state[here.pressure] - step * per_length, state[here.pressure]);
    }
}

impl<R: Scalar, F: Formulas<R>> End<'_, R, F> {
    /// The actuator's force less the tendon's in N at a velocity in m/s, and how it grows with that.
    #[inline(always)]
    fn excess_at<T: Differentiable<R>>(
        &self,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
        velocity: T,
    ) -> [T; 2] {
        T::apart(ExcessAt { end: self, at, deflections, velocity })
    }

    /// The rate in N/s at which the actuator's force outgrows the tendon's, as the end slides at a velocity.
    #[inline(always)]
    fn growth<T: Differentiable<R>>(&self, at: (&Unit<T>, &Chamber<T>), deflections: Deflections<T>, velocity: T) -> T {
        T::apart(Growth(ExcessAt { end: self, at, deflections, velocity }))
    }

    /// The rate at which both tensions are equal.
    #[inline(always)]
    fn damped_velocity<T: Differentiable<R>>(&self, at: (&Unit<T>, &Chamber<T>), deflections: Deflections<T>) -> T {
        if let Some(velocity) = self.mode.searched_velocity(self.system, self.i, at, deflections) {
            return velocity;
        }
        self.damped_from_rest(at, deflections)
    }

    /// That rate where the force is a straight line over it.
    #[inline(always)]
    fn damped_from_rest<T: Differentiable<R>>(&self, at: (&Unit<T>, &Chamber<T>), deflections: Deflections<T>) -> T {
        let [value, slope] = self.excess_at(at, deflections, T::zero());
        -value / slope
    }

    /// The rate at which both tensions stay equal.
    #[inline(always)]
    fn kept_velocity<T: Differentiable<R>>(&self, at: (&Unit<T>, &Chamber<T>), deflections: Deflections<T>) -> T {
        if let Some(velocity) = self.mode.searched_velocity(self.system, self.i, at, deflections) {
            return velocity;
        }
        self.kept_from_rest(at, deflections)[0]
    }

    /// That rate where the growth is a straight line over it, and its slope.
    #[inline(always)]
    fn kept_from_rest<T: Differentiable<R>>(&self, at: (&Unit<T>, &Chamber<T>), deflections: Deflections<T>) -> [T; 2] {
        let at_rest = self.growth(at, deflections, T::zero());
        let slope = self.growth(at, deflections, T::one()) - at_rest;
        [-at_rest / slope, slope]
    }
}

impl<R: Scalar, T: Differentiable<R>, F: Formulas<R>> Work for ExcessAt<'_, R, T, F> {
    type Output = [T; 2];

    #[inline(always)]
    fn done(self) -> [T; 2] {
        let Self { end, at: (unit, chamber), deflections, velocity } = self;
        let tension = tension(end.tendon, end.mode.is_loose(end.i), unit.distance, unit.length);
        let deflections = deflections.along(T::zero(), [T::zero(); 2]);
        let ends = [unit.length.along(T::zero()), velocity.along(T::one()), chamber.pressure.along(T::zero())];
        let [force, slope] = T::split(end.mode.signed_force(&end.system.wires[end.i], ends, deflections));
        [force - tension, slope]
    }
}

impl<R: Scalar, T: Differentiable<R>, F: Formulas<R>> Work for Growth<'_, R, T, F> {
    type Output = T;

    #[inline(always)]
    fn done(self) -> T {
        let ExcessAt { end, at, deflections, velocity } = self.0;
        let ((unit, chamber), wire) = (at, &end.system.wires[end.i]);
        let direction = T::of(end.mode.direction(end.i));
        let stiffness = T::select(end.mode.is_loose(end.i), T::zero(), T::of(end.tendon.stiffness()));
        let length = unit.length.along(velocity);
        let pressure = chamber.pressure.along(end.system.air_rate(end.i, at, velocity));
        let friction = wire.member.actuator.friction();
        let bristle_rate = match (friction.lugre(), deflections.bristles) {
            (Some(law), Some(bent)) => law.rate(bent, velocity, direction),
            _ => T::zero(),
        };
        let sum_rates = match (friction.viscoelastic(), deflections.branches) {
            (Some(law), Some(sums)) => law.sum_rates(unit.length, &sums),
            _ => [T::zero(); 2],
        };
        let deflections = deflections.along(bristle_rate, sum_rates);
        let ends = [length, T::zero().along(T::zero()), pressure];
        let force = end.mode.signed_force(wire, ends, deflections);
        T::split(force)[1] - stiffness * (unit.rate - velocity)
    }
}

impl<R: Real> End<'_, R, PlantMode<R>> {
    /// The rate at which both tensions are equal, where dry friction falls with velocity.
    fn damped_where_friction_falls<T: Differentiable<R>>(
        &self,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> T {
        let excess = |velocity: T| self.excess_at(at, deflections, velocity);
        // Above its solution the force rises to a straight line; zero lies below, as the end slides.
        let direction = self.mode.actuators[self.i].mode.sliding.direction();
        let fast = T::constant(direction * FAST);
        let [value, slope] = excess(fast);
        let mut most = fast - value / slope;
        let sign = T::constant(direction);
        if (sign * most).le(T::zero()) || T::zero().le(sign * excess(T::zero())[0]) {
            return self.damped_from_rest(at, deflections);
        }
        let (mut least, mut velocity) = (T::zero(), most);
        let mut left = None;
        for _ in 0..MOST_SEARCHED {
            let [value, slope] = excess(velocity);
            let below = (sign * value).lt(T::zero());
            least = T::select(below, velocity, least);
            most = T::select(below, most, velocity);
            let next = velocity - value / slope;
            let within = (sign * least).le(sign * next) & (sign * next).le(sign * most);
            let next = T::select(within, next, T::constant(0.5) * (least + most));
            let found = (next - velocity).magnitude().le(T::constant(SEARCHED) * next.magnitude());
            velocity = next;
            // Each step more carries one derivative more.
            left = match left {
                None if found => Some(2),
                Some(0) => break,
                Some(steps) => Some(steps - 1),
                None => None,
            };
        }
        velocity
    }

    /// The rate at which both tensions stay equal, where the bristles' force falls with velocity.
    fn kept_where_friction_falls<T: Differentiable<R>>(
        &self,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> T {
        let [mut velocity, slope] = self.kept_from_rest(at, deflections);
        for _ in 0..MOST_SEARCHED {
            let step = self.growth(at, deflections, velocity) / slope;
            velocity = velocity - step;
            if step.magnitude().le(T::constant(SEARCHED * SEARCHED)) {
                break;
            }
        }
        velocity
    }
}

impl<R: Real> System<R> {
    /// The velocity in m/s of an end on a tendon where dry friction falls with velocity, so that it is searched for.
    pub(super) fn searched_velocity<T: Differentiable<R>>(
        &self,
        i: usize,
        mode: &PlantMode<R>,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> Option<T> {
        let Plant { actuators, .. } = &*self.plant;
        let (friction, tendon) = (actuators[i].actuator.friction(), actuators[i].tendon.as_ref()?);
        let end = End { system: self, i, tendon, mode };
        let bristles_fall = friction.lugre().is_some_and(|law| law.falls());
        if mode.is_damped(self, i) {
            (friction.coulomb().falls() || bristles_fall).then(|| end.damped_where_friction_falls(at, deflections))
        } else {
            (bristles_fall && deflections.bristles.is_some()).then(|| end.kept_where_friction_falls(at, deflections))
        }
    }
}
