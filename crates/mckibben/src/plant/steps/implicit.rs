//! The linear system of a stable step: `(I − rA) k = f`, with `r = γh`.
//!
//! A holds what is stiff: how tensions answer to lengths and velocities, a mass to its spring, joints to their damping and contacts,
//! the ends of actuators on tendons with their sealed air, bristles and viscoelastic branches to both, and the pressures of the network
//! to each other. Air and mechanisms do not answer to each other within a stage, nor does weight to angles; the method is of order 2
//! whatever matrix stands in for the Jacobian.
//!
//! ```text
//! end on a tendon    k_L = (f_L + r (u_x k_x + u_v k_ẋ))/(1 − r u_L)                  u = L̇(x, ẋ, L)
//! bristles           k_z = (f_z + r z_v k_ẋ)/(1 − r z_z)
//! branches           k_z = (f_z + (r/τ) k_L)/(1 + r/τ)
//! tension            φ = K k_x + D k_ẋ + o                                         both put in
//! mechanism          k_q = f_q + r k_v
//!                    [M + r C + r² S + Σ Jᵀ (r D + r² K) J] k_v = M f_v − r S f_q − r Σ Jᵀ (K J f_q + o)
//! its air            f_P + P_L (k_L − f_L) for f_P
//! given pressure     k_m = f_m/(1 + r λ)                                          λ: (γ − 1) h T_wall/(γ P V) of an energy balance
//! network            by elimination on its tree
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, L, z | distance and length of an actuator, deflection of its bristles | m |
//! | K, D | how its tension answers to distance and rate, with its end and its bristles | N/m, N·s/m |
//! | P_L | how the pressure of an end's sealed air answers to its length: `−κ P V′/V` | Pa/m |
//! | S, C | stiffness and damping of springs, joints and contacts ([`Chain::stiffness`](crate::mechanism::chain::Chain)): positive semidefinite | … |
//! | J, M | gradients of the distances, inertia | … |

use super::super::dense;
use super::super::evaluation::{Evaluation, System};
use super::super::formulas::Formulas;
use super::super::{MechanismIndices, Plant};
use crate::air::Process;
use crate::dual::Dual;
use crate::friction::{Deflections, Viscoelastic};
use crate::mechanism::Mechanism;
use crate::network::NodeKind;
use crate::network::flow::AroundNetwork;
use crate::network::implicit::{Answers, Elimination, NodeResponse};
use crate::scalar::{Mask, Over, Scalar, Work};
use alloc::vec;
use alloc::vec::Vec;

/// How much of itself a volume, by the index of its air, grows within γh where the fall of pressure is not taken implicitly.
const SLOW_GROWTH: f64 = 0.25;

/// How the tension of an actuator answers.
#[derive(Clone, Copy, Debug)]
struct TensionResponse<R> {
    stiffness: R,
    damping: R,
    /// How the tension responds to what its end or its bristles would do without the rest.
    by_own: R,
    /// `1/(1 − r u_L)` or `1/(1 − r z_z)`, and `r u_x`, `r u_v` or `r z_v`.
    share: R,
    by_distance: R,
    by_rate: R,
    /// `1/(1 − r z_z)` of bristles in addition to an end on a tendon.
    beside: R,
    /// How the tension answers to the sums over viscoelastic branches; zero of an end on a tendon, whose balance has them as they
    /// are.
    by_sums: [R; 2],
    /// How the pressure of the sealed air answers to the length of an end.
    sealed: R,
}

/// The system of a plant.
#[derive(Clone, Debug)]
pub(super) struct Implicit<R> {
    gamma_h: R,
    network: Elimination<R>,
    tensions: Vec<TensionResponse<R>>,
    /// `1/(1 + r λ)` of the mass of air at a pressure that is given, which heat drives to that of the wall.
    given_mass: Vec<R>,
    /// Of each mechanism one after the other: M, S, C and the factored matrix.
    mass: Vec<R>,
    stiffness: Vec<R>,
    damping: Vec<R>,
    factors: Vec<R>,
    /// Where each begins.
    begins: Vec<usize>,
    work: Vec<R>,
}

impl<R: Scalar> Implicit<R> {
    pub(super) fn new(plant: &Plant<R>) -> Self {
        let zero = R::zero();
        let counts = plant.indices().mechanisms.iter().map(|here| here.coordinates);
        let mut begins = Vec::new();
        let mut size = 0;
        for count in counts.clone() {
            begins.push(size);
            size += count * count;
        }
        let most = counts.max().unwrap_or(0);
        Self {
            gamma_h: zero,
            network: Elimination::new(plant),
            tensions: vec![TensionResponse::none(); plant.actuators().len()],
            given_mass: vec![R::one(); plant.actuators().len()],
            mass: vec![zero; size],
            stiffness: vec![zero; size],
            damping: vec![zero; size],
            factors: vec![zero; size],
            begins,
            work: vec![zero; 2 * most],
        }
    }

    /// Takes on the numbers of another plant of equal structure.
    #[inline(always)]
    pub(super) fn adapt(&mut self, plant: &Plant<R>) {
        self.network.adapt(plant.network());
    }

    /// Sets the numbers of a stage for γh in s, at a state where the plant has been evaluated.
    #[inline(always)]
    pub(super) fn factor(
        &mut self,
        system: &System<R>,
        span: (R, R),
        state: &[R],
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
    ) {
        R::apart(Factor { implicit: self, system, span, state, mode, at });
    }

    #[inline(always)]
    fn factor_mechanism(
        &mut self,
        system: &System<R>,
        m: usize,
        state: &[R],
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
    ) {
        let here = system.plant.places.mechanisms[m];
        let (count, from) = (here.coordinates, self.begins[m]);
        if !(!mode.is_frozen(m)).any() || !system.plant.mechanisms[m].is_dynamic() {
            return;
        }
        let r = self.gamma_h;
        let all = from..from + count * count;
        system.mass_matrix(m, &at.directions, &mut self.mass[all.clone()]);
        self.factors[all.clone()].copy_from_slice(&self.mass[all.clone()]);
        match &system.plant.mechanisms[m] {
            Mechanism::Chain(_) => {
                let (stiffness, damping) = (&mut self.stiffness[all.clone()], &mut self.damping[all.clone()]);
                mode.stiff_torques(system, m, here.of(state), (&mut *stiffness, &mut *damping));
                let answers = stiffness.iter().zip(&*damping);
                for (factor, (stiffness, damping)) in self.factors[all].iter_mut().zip(answers) {
                    *factor = *factor + r * (*damping + r * *stiffness);
                }
            }
            Mechanism::Mass(mass) => {
                if let Some(spring) = mass.spring() {
                    self.stiffness[from] = spring.stiffness;
                    self.factors[from] = self.factors[from] + r * r * spring.stiffness;
                }
            }
            _ => {}
        }
        for &i in &system.plant.places.members[m] {
            let gradient = system.gradient(i, &at.gradient);
            let TensionResponse { stiffness, damping, .. } = self.tensions[i];
            let both = r * (damping + r * stiffness);
            for row in 0..count {
                for column in 0..count {
                    let place = from + row * count + column;
                    self.factors[place] = self.factors[place] + both * gradient[row] * gradient[column];
                }
            }
        }
        dense::factor(&mut self.factors[from..from + count * count], count);
    }

    /// Writes the slopes that have `right` for their right side.
    #[inline(always)]
    pub(super) fn solve(
        &mut self,
        system: &System<R>,
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
        right: &[R],
        slopes: &mut [R],
    ) {
        R::apart(Solve { implicit: self, system, mode, at, right, slopes });
    }

    #[inline(always)]
    fn solve_mechanism(
        &mut self,
        system: &System<R>,
        (m, here): (usize, MechanismIndices),
        moves: R::Mask,
        at: &Evaluation<R>,
        right: &[R],
        slopes: &mut [R],
    ) {
        let (r, count, from) = (self.gamma_h, here.coordinates, self.begins[m]);
        let (positions, rates) = here.of(right);
        for row in 0..count {
            let its = from + row * count..from + (row + 1) * count;
            let by_positions = dense::dot(&self.stiffness[its.clone()], positions);
            self.work[row] = dense::dot(&self.mass[its], rates) - r * by_positions;
        }
        for &i in &system.plant.places.members[m] {
            let gradient = system.gradient(i, &at.gradient);
            let response = &self.tensions[i];
            let mut own = match system.own_place(i) {
                Some(place) => response.by_own * right[place],
                None => R::zero(),
            };
            if let Some(law) = system.wires[i].member.actuator.friction().viscoelastic() {
                for (branch, place) in system.wires[i].places.branches().enumerate() {
                    let [share, _] = relaxation(law, branch, r);
                    own = own + response.by_branch(law, branch) * share * right[place];
                }
            }
            let force = response.stiffness.multiply_add(dense::dot(gradient, positions), own);
            for (sum, entry) in self.work.iter_mut().zip(gradient) {
                *sum = *sum - r * *entry * force;
            }
        }
        dense::solve(&self.factors[from..from + count * count], count, &mut self.work[..count]);
        for k in 0..count {
            let (position, rate) = (here.position(k), here.rate(k));
            slopes[rate] = R::select(moves, self.work[k], right[rate]);
            slopes[position] = R::select(moves, r.multiply_add(self.work[k], right[position]), right[position]);
        }
    }

    /// The viscoelastic branches of an actuator, once its length has been solved for.
    #[inline(always)]
    fn solve_branches(
        &mut self,
        system: &System<R>,
        (i, here): (usize, MechanismIndices),
        (mode, at): (&impl Formulas<R>, &Evaluation<R>),
        right: &[R],
        slopes: &mut [R],
    ) {
        let wire = &system.wires[i];
        let Some(law) = wire.member.actuator.friction().viscoelastic() else { return };
        let grows = match wire.places.length {
            Some(place) => slopes[place],
            None => dense::dot(system.gradient(i, &at.gradient), here.of(slopes).0),
        };
        let grows = R::select(mode.is_slack(i), R::zero(), grows);
        for (branch, place) in wire.places.branches().enumerate() {
            let [share, by_length] = relaxation(law, branch, self.gamma_h);
            slopes[place] = right[place] * share + by_length * grows;
        }
    }

    /// The end of an actuator on a tendon with the right side of its pressure, or its bristles.
    #[inline(always)]
    fn solve_own(
        &mut self,
        system: &System<R>,
        (i, here): (usize, MechanismIndices),
        at: &Evaluation<R>,
        right: &[R],
        slopes: &mut [R],
    ) {
        let Some(place) = system.own_place(i) else { return };
        let gradient = system.gradient(i, &at.gradient);
        let (positions, rates) = here.of(slopes);
        let TensionResponse { share, by_distance, by_rate, .. } = self.tensions[i];
        let answer = by_distance * dense::dot(gradient, positions) + by_rate * dense::dot(gradient, rates);
        slopes[place] = (right[place] + answer) * share;
        let its = &system.plant.places.actuators[i];
        if its.length.is_none() {
            return;
        }
        let further = slopes[place] - right[place];
        slopes[its.pressure] = self.tensions[i].sealed.multiply_add(further, right[its.pressure]);
        if let Some(bristles) = its.bristles {
            slopes[bristles] = right[bristles] * self.tensions[i].beside;
        }
    }
}

/// Setting the numbers of a stage, in a separate function: it is long, and every stage needs it.
struct Factor<'a, R: Scalar, F> {
    implicit: &'a mut Implicit<R>,
    system: &'a System<R>,
    span: (R, R),
    state: &'a [R],
    mode: &'a F,
    at: &'a Evaluation<R>,
}

impl<R: Scalar, F: Formulas<R>> Work for Factor<'_, R, F> {
    type Output = ();

    #[inline(always)]
    fn done(self) {
        let Self { implicit, system, span, state, mode, at } = self;
        let (_, gamma_h) = span;
        implicit.gamma_h = gamma_h;
        for (i, wire) in system.wires.iter().enumerate() {
            if wire.is_answered || system.own_place(i).is_some() {
                implicit.tensions[i] = system.tension_response(i, gamma_h, state, mode, at);
            }
            if wire.is_given {
                let air = system.plant.actuators[i].actuator.air();
                implicit.given_mass[i] = R::one() / (R::one() + gamma_h * air.given_mass_settling(&at.chambers[i]));
            }
        }
        for m in 0..system.assemblies.len() {
            implicit.factor_mechanism(system, m, state, mode, at);
        }
        if !system.wires.is_empty() {
            let answers = AtInstant { system, span, state, mode, at };
            implicit.network.factor(&system.plant.network, mode.flows(), gamma_h, &answers);
        }
    }
}

/// Solving it for one right side.
struct Solve<'a, R: Scalar, F> {
    implicit: &'a mut Implicit<R>,
    system: &'a System<R>,
    mode: &'a F,
    at: &'a Evaluation<R>,
    right: &'a [R],
    slopes: &'a mut [R],
}

impl<R: Scalar, F: Formulas<R>> Work for Solve<'_, R, F> {
    type Output = ();

    #[inline(always)]
    fn done(self) {
        let Self { implicit, system, mode, at, right, slopes } = self;
        slopes.copy_from_slice(right);
        for m in 0..system.assemblies.len() {
            let here = system.plant.places.mechanisms[m];
            let moves = !mode.is_frozen(m);
            if moves.any() && system.plant.mechanisms[m].is_dynamic() {
                implicit.solve_mechanism(system, (m, here), moves, at, right, slopes);
            }
            for &i in &system.plant.places.members[m] {
                implicit.solve_own(system, (i, here), at, right, slopes);
                implicit.solve_branches(system, (i, here), (mode, at), right, slopes);
            }
        }
        for (wire, share) in system.wires.iter().zip(&implicit.given_mass) {
            if wire.is_given {
                let place = wire.places.mass();
                slopes[place] = right[place] * *share;
            }
        }
        implicit.network.solve(implicit.gamma_h, slopes);
    }
}

/// An evaluated plant, for the response of its pressures.
struct AtInstant<'a, R: Scalar, F> {
    system: &'a System<R>,
    span: (R, R),
    state: &'a [R],
    mode: &'a F,
    at: &'a Evaluation<R>,
}

impl<R: Scalar, F: Formulas<R>> Answers<R> for AtInstant<'_, R, F> {
    #[inline(always)]
    fn node(&self, node: usize) -> NodeResponse<R> {
        self.system.response(node, self.span.1, self.at)
    }

    #[inline(always)]
    fn branch(&self, branch: usize) -> ([R; 2], R) {
        let Self { system, span, state, mode, at } = self;
        let around = AroundNetwork { chambers: &at.chambers, state };
        let air = system.wires[0].member.actuator.air();
        system.plant.network.slopes(&system.piping, branch, *span, around, air, (mode.flows(), &at.network))
    }
}

impl<R: Scalar> TensionResponse<R> {
    /// A tension that does not answer.
    fn none() -> Self {
        let (zero, one) = (R::zero(), R::one());
        Self {
            stiffness: zero,
            damping: zero,
            by_own: zero,
            share: one,
            by_distance: zero,
            by_rate: zero,
            beside: one,
            by_sums: [zero; 2],
            sealed: zero,
        }
    }
}

impl<R: Scalar> TensionResponse<R> {
    /// How the tension answers in N/m to the relaxed length of a branch.
    #[inline(always)]
    fn by_branch(&self, law: &Viscoelastic<R>, branch: usize) -> R {
        self.by_sums[0] * law.stiffness(branch) + self.by_sums[1] * law.stiffness_ratio(branch)
    }

    /// This with the viscoelastic branches put in, which relax within the stage.
    #[inline(always)]
    fn with_branches(self, law: &Viscoelastic<R>, gamma_h: R) -> Self {
        let mut stiffness = self.stiffness;
        for branch in 0..law.count() {
            let [_, by_length] = relaxation(law, branch, gamma_h);
            stiffness = stiffness + self.by_branch(law, branch) * by_length;
        }
        Self { stiffness, ..self }
    }
}

/// `1/(1 + r/τ)` and `(r/τ)/(1 + r/τ)` of a branch.
#[inline(always)]
fn relaxation<R: Scalar>(law: &Viscoelastic<R>, branch: usize, gamma_h: R) -> [R; 2] {
    let ratio = gamma_h * law.relaxation_rate(branch);
    let share = R::one() / (R::one() + ratio);
    [share, ratio * share]
}

impl<R: Scalar> System<R> {
    /// The state of an actuator that responds within a stage in addition to its mechanism: the length of an end on a
    /// tendon, or bristles.
    #[inline(always)]
    fn own_place(&self, i: usize) -> Option<usize> {
        let here = &self.plant.places.actuators[i];
        here.length.or(here.bristles)
    }

    /// The inertia of a mechanism, row by row, by the directions of all segments; that of a motion that is given counts as one.
    #[inline(always)]
    pub(crate) fn mass_matrix<T: Over<R>>(&self, m: usize, directions: &[[T; 2]], matrix: &mut [T]) {
        match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => matrix[0] = T::of(mass.mass()),
            Mechanism::Chain(chain) => {
                chain.mass_matrix(&directions[self.plant.places.mechanisms[m].accelerations()], matrix);
            }
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => matrix.fill(T::one()),
        }
    }

    /// How the tension of an actuator answers within a stage for γh in s.
    #[inline(always)]
    fn tension_response(
        &self,
        i: usize,
        gamma_h: R,
        state: &[R],
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
    ) -> TensionResponse<R> {
        let wire = &self.wires[i];
        if wire.places.length.is_some() {
            return self.end_response(i, gamma_h, state, mode, at);
        }
        let deflections = self.deflections(i, state);
        let response = self.sliding_response(i, gamma_h, deflections, mode, at);
        let Some(law) = wire.member.actuator.friction().viscoelastic() else { return response };
        let mut deflections: Deflections<Dual<R, 2>> = deflections.constant();
        if let Some(sums) = &mut deflections.branches {
            let [stiffness, ratio] = sums.relaxed;
            sums.relaxed = [Dual::variable(stiffness.value, 0), Dual::variable(ratio.value, 1)];
        }
        let (unit, pressure) = (&at.units[i], at.chambers[i].pressure);
        let ends = [unit.length, unit.velocity, pressure].map(Dual::of);
        let by_sums = mode.tension(wire, ends, deflections).slope;
        TensionResponse { by_sums, ..response }.with_branches(law, gamma_h)
    }

    /// How the tension of an actuator without a tendon answers, its viscoelastic branches as they are.
    #[inline(always)]
    fn sliding_response(
        &self,
        i: usize,
        gamma_h: R,
        deflections: Deflections<R>,
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
    ) -> TensionResponse<R> {
        let (wire, unit) = (&self.wires[i], &at.units[i]);
        let (zero, one) = (R::zero(), R::one());
        let pressure = at.chambers[i].pressure;
        let ends = [Dual::<R, 2>::variable(unit.length, 0), Dual::variable(unit.velocity, 1), Dual::of(pressure)];
        let [stiffness, damping] = mode.tension(wire, ends, deflections.constant()).slope;
        let Some(bent) = deflections.bristles else {
            return TensionResponse { stiffness, damping: damping.larger(zero), ..TensionResponse::none() };
        };
        let (ends, bending) = ([unit.length, unit.velocity, pressure].map(Dual::of), Dual::<R, 1>::variable(bent, 0));
        let [by_bristles] =
            mode.tension(wire, ends, Deflections { bristles: Some(bending), ..deflections.constant() }).slope;
        let [by_velocity, by_itself] =
            mode.bristle_rate(wire, Dual::<R, 2>::variable(bent, 1), Dual::variable(unit.velocity, 0)).slope;
        let share = one / (one - gamma_h * by_itself).larger(one);
        let by_rate = gamma_h * by_velocity;
        TensionResponse {
            stiffness,
            damping: damping.larger(zero) + by_bristles * share * by_rate,
            by_own: by_bristles * share,
            share,
            by_rate,
            ..TensionResponse::none()
        }
    }

    /// How fast in 1/s the air of an actuator comes to the temperature of its wall: `(γ − 1) h/(m R)` of an energy balance.
    #[inline(always)]
    pub(in super::super) fn heat_settling(&self, i: usize, at: &Evaluation<R>) -> R {
        let air = self.plant.actuators[i].actuator.air();
        match air.process() {
            Process::EnergyBalance { heat_transfer, .. } => {
                let excess = (air.heat_capacity_ratio() - R::one()) * heat_transfer;
                excess / (at.chambers[i].mass * air.gas_constant())
            }
            _ => R::zero(),
        }
    }

    /// How the pressure of a node answers to what comes in, and how fast it falls besides.
    ///
    /// That the pressure falls as the volume grows is implicit only where it grows fast, by more than [`SLOW_GROWTH`] within γh. An explicit
    /// step is accurate up to there, and does to the pressure on the way out what it undoes on the way back: implicit on the way out
    /// alone, shut-in air loses or gains with every cycle of the length.
    #[inline(always)]
    fn response(&self, node: usize, gamma_h: R, at: &Evaluation<R>) -> NodeResponse<R> {
        let zero = R::zero();
        let per_mass = match &self.plant.network.nodes[node].kind {
            NodeKind::Chamber { actuator } => {
                let (chamber, air) = (&at.chambers[*actuator], self.plant.actuators[*actuator].actuator.air());
                let grows = air.index() * chamber.volume_rate * chamber.mass * chamber.per_content;
                let settles = self.heat_settling(*actuator, at);
                let over_mass = chamber.pressure * chamber.volume * chamber.per_content;
                let falls = (grows - R::constant(SLOW_GROWTH) / gamma_h).larger(zero) + settles;
                let per_mass = air.index() * over_mass;
                return NodeResponse { per_mass, falls, by_mass: settles * over_mass };
            }
            NodeKind::Hose(hose) => hose.stiffness(),
            NodeKind::Reservoir(reservoir) => reservoir.pressure_rate(R::one()),
            _ => zero,
        };
        NodeResponse { per_mass, falls: zero, by_mass: zero }
    }
}

impl<R: Scalar> System<R> {
    /// How the tension of an actuator on a tendon answers within a stage for γh in s.
    #[inline(always)]
    fn end_response(
        &self,
        i: usize,
        gamma_h: R,
        state: &[R],
        mode: &impl Formulas<R>,
        at: &Evaluation<R>,
    ) -> TensionResponse<R> {
        R::apart(EndResponse { system: self, i, gamma_h, state, mode, at })
    }
}

/// How an end answers, compiled once: few actuators have one.
struct EndResponse<'a, R: Scalar, F> {
    system: &'a System<R>,
    i: usize,
    gamma_h: R,
    state: &'a [R],
    mode: &'a F,
    at: &'a Evaluation<R>,
}

impl<R: Scalar, F: Formulas<R>> Work for EndResponse<'_, R, F> {
    type Output = TensionResponse<R>;

    #[inline(always)]
    fn done(self) -> TensionResponse<R> {
        let Self { system, i, gamma_h, state, mode, at } = self;
        let (zero, one, none) = (R::zero(), R::one(), TensionResponse::none());
        let (wire, unit) = (&system.wires[i], &at.units[i]);
        let Some(tendon) = &system.plant.actuators[i].tendon else { return none };
        let tight = R::select(mode.is_loose(i), zero, tendon.stiffness());
        let stuck = mode.is_stuck(i);
        if !(!stuck).any() {
            return TensionResponse { stiffness: tight, ..none };
        }
        let deflections = system.deflections(i, state);
        let sealed = system.sealed_pressure(i, unit.length, &at.chambers[i]);
        let [by_distance, by_rate, by_length] =
            system.end_answers(i, tendon, mode, (unit, &at.chambers[i]), sealed, deflections);
        let share = one / (one - gamma_h * by_length).larger(one);
        let (by_distance, by_rate) = (gamma_h * by_distance, gamma_h * by_rate);
        let beside = match deflections.bristles {
            Some(bent) => {
                let rate = mode.bristle_rate(wire, Dual::<R, 1>::variable(bent, 0), Dual::of(unit.velocity));
                one / (one - gamma_h * rate.slope[0]).larger(one)
            }
            None => one,
        };
        // φ = k (k_x − k_L), with k_L put in.
        TensionResponse {
            stiffness: R::select(stuck, tight, tight * (one - share * by_distance).larger(zero)),
            damping: R::select(stuck, zero, -tight * share * by_rate),
            by_own: R::select(stuck, zero, -tight * share),
            share: R::select(stuck, one, share),
            by_distance: R::select(stuck, zero, by_distance),
            by_rate: R::select(stuck, zero, by_rate),
            beside: R::select(stuck, one, beside),
            by_sums: [zero; 2],
            sealed,
        }
    }
}
