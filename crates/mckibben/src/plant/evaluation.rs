//! Everything that a plant does at an instant: distances, flows, tensions, accelerations, and with them the rates of all
//! states.
//!
//! ```text
//! mechanism  →  distances x, ẋ            J = ∂x/∂q
//! air        →  chambers, flows ṁ         (19)(21)(23)
//! tendon     →  L̇ by the balance of both tensions
//! actuator   →  tension F (12), dP/dt
//! mechanism  →  M q̈ = τ − h − Σ Jᵀ F      (16), with what friction holds at rest
//! ```
//!
//! It is done once for rates, samples, guards and audits alike, by the formulas of a [`PlantMode`], over any scalar.

use super::mode::{ActuatorMode, PlantMode};
use super::{Mounted, Plant};
use crate::air::{Chamber, Flow};
use crate::line::split;
use crate::mechanism::chain::Contacts;
use crate::mechanism::{Coupling, Mechanism};
use crate::network::flow::{NetworkState, Surroundings};
use crate::scalar::{Differentiable, Over, Real, Scalar};
use crate::simulation::member::Member;
use crate::simulation::{Extent, Sliding};
use alloc::vec;
use alloc::vec::Vec;

/// An actuator at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unit<T> {
    /// Between the attachments in m, and its rate in m/s.
    pub(crate) distance: T,
    pub(crate) rate: T,
    /// Of the actuator in m, and its rate in m/s: those of the distance without a tendon, as long as it is not slack.
    pub(crate) length: T,
    pub(crate) velocity: T,
    /// In N; of a sticking actuator without a tendon not known here.
    pub(crate) tension: T,
    pub(crate) flow: Flow<T>,
    pub(crate) warmth: T,
    pub(crate) pressure_rate: T,
    pub(crate) mass_rate: T,
}

/// A plant at an instant, and room for what is computed on the way.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation<T> {
    pub(crate) units: Vec<Unit<T>>,
    pub(crate) chambers: Vec<Chamber<T>>,
    pub(crate) network: NetworkState<T>,
    /// `J`: the gradient of each actuator's distance over the coordinates of its mechanism.
    pub(crate) gradient: Vec<T>,
    /// Accelerations of all coordinates.
    pub(crate) acceleration: Vec<T>,
    /// Forces on the coordinates of one mechanism, and its mass matrix.
    pub(crate) force: Vec<T>,
    pub(crate) matrix: Vec<T>,
}

impl<T: Scalar> Evaluation<T> {
    /// Room for a plant.
    pub(crate) fn new<R: Scalar>(plant: &Plant<R>) -> Self
    where
        T: Over<R>,
    {
        let zero = T::zero();
        let unit = Unit {
            distance: zero,
            rate: zero,
            length: zero,
            velocity: zero,
            tension: zero,
            flow: Flow::none(),
            warmth: zero,
            pressure_rate: zero,
            mass_rate: zero,
        };
        let actuators = plant.actuators.len();
        let coordinates = plant.places.mechanisms.iter().map(|places| places.coordinates);
        let most = coordinates.clone().max().unwrap_or(0);
        Self {
            units: vec![unit; actuators],
            chambers: vec![Chamber::new(T::one(), T::one(), T::one(), zero); actuators],
            network: NetworkState::new(&plant.network),
            gradient: vec![zero; plant.places.gradients],
            acceleration: vec![zero; coordinates.sum()],
            force: vec![zero; most],
            matrix: vec![zero; most * most],
        }
    }
}

/// A plant with what its events are told from rounding by.
#[derive(Clone, Debug)]
pub(crate) struct System<'a, R: Real> {
    pub(crate) plant: &'a Plant<R>,
    pub(crate) members: Vec<Member<'a, R>>,
    /// First acceleration of each mechanism among those of all.
    pub(crate) first_coordinate: Vec<usize>,
    /// Relative width of a border between agreeing formulas.
    pub(crate) band: f64,
    /// Usual arms of the actuators, and usual torques on each mechanism.
    pub(crate) arms: Vec<f64>,
    pub(crate) usual_torque: Vec<f64>,
}

impl<'a, R: Real> System<'a, R> {
    /// Gradient of an actuator's distance.
    #[inline(always)]
    pub(crate) fn gradient<'e, T>(&self, i: usize, gradient: &'e [T]) -> &'e [T] {
        let plant = self.plant;
        let from = plant.places.actuators[i].gradient;
        &gradient[from..from + plant.places.mechanisms[plant.actuators[i].mechanism].coordinates]
    }

    /// The deflection of an actuator's bristles.
    #[inline(always)]
    pub(crate) fn bristles<T: Copy>(&self, i: usize, state: &[T]) -> Option<T> {
        self.plant.places.actuators[i].bristles.map(|place| state[place])
    }

    /// Computes everything at a time in s and a state.
    pub(crate) fn evaluate<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        self.enter_distances(time, state, mode, at);
        self.enter_air(time, state, mode, at);
        for i in 0..self.members.len() {
            self.enter_actuator(i, time, state, mode, at);
        }
        for mechanism in 0..self.plant.mechanisms.len() {
            self.accelerate(mechanism, time, state, mode, at);
        }
    }

    /// Computes distances and chambers.
    pub(crate) fn enter_distances<T: Over<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        let Plant { actuators, mechanisms, places, .. } = self.plant;
        for (m, mechanism) in mechanisms.iter().enumerate() {
            let (position, rates) = places.mechanisms[m].of(state);
            let of_mechanism = &mode.mechanisms[m];
            let given = match mechanism {
                Mechanism::Prescribed(motion) => Some(motion.at(time, of_mechanism.corners_passed)),
                _ => None,
            };
            let chain = match mechanism {
                Mechanism::Chain(chain) => Some(chain),
                _ => None,
            };
            let at_rest = of_mechanism.frozen || matches!(mechanism, Mechanism::Fixed);
            for &i in &places.members[m] {
                let Mounted { actuator, coupling, .. } = &actuators[i];
                let here = &places.actuators[i];
                let pieces = &mode.arms[here.arms..here.arms + coupling.arm_count()];
                let gradient = &mut at.gradient[here.gradient..here.gradient + position.len()];
                let mut distance = coupling.distance(chain, position, pieces, gradient);
                let mut rate = T::zero();
                if let Some([length, velocity, _]) = given {
                    (distance, rate) = (length, velocity);
                } else if !at_rest {
                    for (entry, velocity) in gradient.iter().zip(rates) {
                        rate = rate + *entry * *velocity;
                    }
                }
                let of_actuator = &mode.actuators[i].mode;
                let (length, velocity) = match here.length {
                    Some(place) => (state[place], T::zero()),
                    None if of_actuator.sliding == Sliding::Stuck => (distance, T::zero()),
                    None => (distance, rate),
                };
                let slack = of_actuator.extent == Extent::Slack;
                let (pressure, mass) = (state[here.pressure], state[here.pressure + 1]);
                at.chambers[i] = actuator.chamber(length, velocity, pressure, mass, slack);
                let unit = &mut at.units[i];
                (unit.distance, unit.rate, unit.length, unit.velocity) = (distance, rate, length, velocity);
            }
        }
    }

    /// What the network sees of the rest.
    #[inline(always)]
    pub(crate) fn around<'s, T>(&'s self, chambers: &'s [Chamber<T>], state: &'s [T]) -> Surroundings<'s, T> {
        let places = &self.plant.places;
        Surroundings {
            chambers,
            keeps_heat: &places.keeps_heat,
            state,
            nodes: &places.nodes,
            branches: &places.branches,
        }
    }

    /// Computes the flows, and those into each chamber.
    pub(crate) fn enter_air<T: Over<R>>(&self, time: T, state: &[T], mode: &PlantMode<R>, at: &mut Evaluation<T>) {
        let Some(first) = self.plant.actuators.first() else { return };
        let air = first.actuator.air();
        let network = &self.plant.network;
        network.flows(time, self.around(&at.chambers, state), air, &mode.network, &mut at.network);
        for (unit, chamber) in at.units.iter_mut().zip(&self.plant.places.chambers) {
            (unit.flow, unit.warmth) = match chamber {
                Some(node) => {
                    let node = &at.network.nodes[*node];
                    (Flow { inward: node.inward, outward: node.outward }, node.warmth)
                }
                None => (Flow::none(), T::zero()),
            };
        }
    }

    /// Computes tension and air of an actuator.
    fn enter_actuator<T: Differentiable<R>>(
        &self,
        i: usize,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        let (mounted, of_actuator) = (&self.plant.actuators[i], &mode.actuators[i]);
        let bristles = self.bristles(i, state);
        if let Some(tendon) = &mounted.tendon {
            let velocity = self.end_velocity(i, tendon, of_actuator, (&at.units[i], &at.chambers[i]), bristles);
            let unit = &mut at.units[i];
            unit.velocity = velocity;
            unit.tension = super::tendon::tension(tendon, of_actuator, unit.distance, unit.length);
            let Chamber { pressure, mass, .. } = at.chambers[i];
            at.chambers[i] = mounted.actuator.chamber(unit.length, velocity, pressure, mass, false);
        } else {
            let unit = &mut at.units[i];
            let ends = [unit.length, unit.velocity, state[self.plant.places.actuators[i].pressure]];
            unit.tension = match of_actuator.mode.sliding {
                Sliding::Stuck => T::zero(),
                _ => self.members[i].tension(ends, &of_actuator.mode, (&of_actuator.trace, bristles)),
            };
        }
        let (unit, chamber) = (&mut at.units[i], &at.chambers[i]);
        let air = mounted.actuator.air();
        if let Some(course) = &mounted.pressure {
            let [_, rate] = course.at(time, of_actuator.rows_passed);
            unit.pressure_rate = rate;
            unit.flow = split(air.flow_for(chamber, rate));
        } else {
            unit.pressure_rate = air.pressure_rate_by(chamber, &unit.flow, || unit.warmth);
        }
        unit.mass_rate = unit.flow.net();
    }

    /// Computes the accelerations of a mechanism.
    fn accelerate<T: Differentiable<R>>(
        &self,
        m: usize,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        let places = &self.plant.places.mechanisms[m];
        let first = self.first_coordinate[m];
        let accelerations = first..first + places.coordinates;
        let of_mechanism = &mode.mechanisms[m];
        if of_mechanism.frozen {
            return at.acceleration[accelerations].fill(T::zero());
        }
        match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => {
                self.enter_force(m, state, mode, at);
                at.acceleration[first] = at.force[0] * T::of(mass.per_mass());
            }
            Mechanism::Chain(chain) => {
                self.enter_force(m, state, mode, at);
                let count = places.coordinates;
                let (position, _) = places.of(state);
                let matrix = &mut at.matrix[..count * count];
                chain.mass_matrix(position, matrix);
                if let [inertia] = matrix {
                    at.acceleration[first] = at.force[0] / *inertia;
                } else {
                    super::dense::factor(matrix, count);
                    let acceleration = &mut at.acceleration[accelerations];
                    acceleration.copy_from_slice(&at.force[..count]);
                    super::dense::solve(&at.matrix[..count * count], count, acceleration);
                    if !of_mechanism.basis.is_empty() {
                        self.hold(m, state, mode, at);
                    }
                }
            }
            Mechanism::Prescribed(motion) => {
                let [_, _, acceleration] = motion.at(time, of_mechanism.corners_passed);
                at.acceleration[first] = acceleration;
            }
            Mechanism::Fixed | Mechanism::External { .. } => at.acceleration[accelerations].fill(T::zero()),
        }
    }

    /// Generalised forces on a mechanism, of all but sticking actuators without a tendon: `τ − h − Σ Jᵀ F`.
    pub(crate) fn enter_force<T: Over<R>>(&self, m: usize, state: &[T], mode: &PlantMode<R>, at: &mut Evaluation<T>) {
        let places = &self.plant.places;
        let (position, rates) = places.mechanisms[m].of(state);
        let of_mechanism = &mode.mechanisms[m];
        let force = &mut at.force[..position.len()];
        match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => force[0] = mass.force(position[0]),
            Mechanism::Chain(chain) => {
                let contacts = Contacts { stops: &of_mechanism.stops, foot: of_mechanism.foot };
                chain.torques(position, rates, contacts, force);
            }
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => force.fill(T::zero()),
        }
        for &i in &places.members[m] {
            let gradient = self.gradient(i, &at.gradient);
            for (force, entry) in force.iter_mut().zip(gradient) {
                *force = *force - *entry * at.units[i].tension;
            }
        }
    }

    /// Takes from the accelerations of a mechanism what sticking actuators hold.
    ///
    /// ```text
    /// λ = W⁻¹ (J q̈₀ + J̇ q̇)      W = J M⁻¹ Jᵀ      q̈ = q̈₀ − M⁻¹ Jᵀ λ
    /// ```
    fn hold<T: Differentiable<R>>(&self, m: usize, state: &[T], mode: &PlantMode<R>, at: &mut Evaluation<T>) {
        let count = self.plant.places.mechanisms[m].coordinates;
        let first = self.first_coordinate[m];
        let basis = &mode.mechanisms[m].basis;
        let held = basis.len();
        // Rows M⁻¹ Jᵀ, the matrix W and the right-hand side: what is small is made where it is needed.
        let mut rows: Vec<T> = Vec::with_capacity(held * count);
        for &i in basis {
            let from = rows.len();
            rows.extend_from_slice(self.gradient(i, &at.gradient));
            super::dense::solve(&at.matrix[..count * count], count, &mut rows[from..]);
        }
        let mut weights = vec![T::zero(); held * held];
        let mut pulls = vec![T::zero(); held];
        for (a, &i) in basis.iter().enumerate() {
            let gradient = self.gradient(i, &at.gradient);
            for b in 0..held {
                weights[a * held + b] = super::dense::dot(gradient, &rows[b * count..(b + 1) * count]);
            }
            let acceleration = &at.acceleration[first..first + count];
            pulls[a] = super::dense::dot(gradient, acceleration) + self.bending(i, m, state, mode);
        }
        super::dense::factor(&mut weights, held);
        super::dense::solve(&weights, held, &mut pulls);
        for (b, pull) in pulls.iter().enumerate() {
            for k in 0..count {
                at.acceleration[first + k] = at.acceleration[first + k] - rows[b * count + k] * *pull;
            }
        }
    }

    /// `J̇ q̇` of an actuator in m/s²: what its distance accelerates by at constant rates.
    pub(crate) fn bending<T: Differentiable<R>>(&self, i: usize, m: usize, state: &[T], mode: &PlantMode<R>) -> T {
        let Mounted { coupling, .. } = &self.plant.actuators[i];
        let Mechanism::Chain(chain) = &self.plant.mechanisms[m] else { return T::zero() };
        if coupling.constant_gradient().is_some() {
            return T::zero();
        }
        let (position, rates) = self.plant.places.mechanisms[m].of(state);
        let along: Vec<T::Dual> = position.iter().zip(rates).map(|(q, v)| q.along(*v)).collect();
        let mut gradient: Vec<T::Dual> = along.clone();
        let from = self.plant.places.actuators[i].arms;
        let pieces = &mode.arms[from..from + coupling.arm_count()];
        let _ = Coupling::distance(coupling, Some(chain), &along, pieces, &mut gradient);
        let mut sum = T::zero();
        for (entry, rate) in gradient.into_iter().zip(rates) {
            sum = sum + T::split(entry)[1] * *rate;
        }
        sum
    }

    /// The rates of all states at a time in s.
    pub(crate) fn rates<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
        rates: &mut [T],
    ) {
        self.evaluate(time, state, mode, at);
        let Plant { mechanisms, network, places, .. } = self.plant;
        for (m, mechanism) in mechanisms.iter().enumerate() {
            let here = &places.mechanisms[m];
            for k in 0..here.coordinates {
                rates[here.position(k)] = match mechanism {
                    _ if mode.mechanisms[m].frozen => T::zero(),
                    Mechanism::Fixed => T::zero(),
                    Mechanism::Prescribed(_) => at.units[places.members[m][0]].rate,
                    _ => state[here.rate(k)],
                };
                rates[here.rate(k)] = at.acceleration[self.first_coordinate[m] + k];
            }
        }
        for (i, here) in places.actuators.iter().enumerate() {
            let unit = &at.units[i];
            rates[here.pressure] = unit.pressure_rate;
            rates[here.pressure + 1] = unit.mass_rate;
            if let Some(place) = here.length {
                rates[place] = unit.velocity;
            }
            if let Some(place) = here.bristles {
                rates[place] = self.bristle_rate(i, state[place], unit.velocity, &mode.actuators[i]);
            }
        }
        for (node, place) in places.nodes.iter().enumerate() {
            if let Some(place) = place {
                rates[*place] = network.node_rate(node, &mode.network, &at.network);
            }
        }
        for (branch, place) in places.branches.iter().enumerate() {
            if let Some(place) = place {
                rates[*place] = network.branch_rate(branch, &at.network);
            }
        }
    }

    /// The rate of an actuator's bristles in m/s.
    #[inline(always)]
    fn bristle_rate<T: Over<R>>(&self, i: usize, deflection: T, velocity: T, of_actuator: &ActuatorMode<R>) -> T {
        match self.members[i].lugre() {
            Some(law) if of_actuator.mode.extent != Extent::Slack => {
                law.rate(deflection, velocity, T::constant(of_actuator.mode.sliding.direction()))
            }
            _ => T::zero(),
        }
    }
}
