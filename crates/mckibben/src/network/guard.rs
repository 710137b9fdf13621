//! Where the formulas of a network end: the guards of its branches and nodes.
//!
//! | guard | ends |
//! |---|---|
//! | zone | a piece of an orifice's flow law, by the ratio of its pressures |
//! | regime | a piece of a lumped hose's law, by its drive |
//! | sonic | the speed of sound in a cell of a distributed hose, by its flow and the pressure behind it |
//! | switch | a compressor's run or rest, by the reservoir's pressure |
//! | poppet | feeding, rest or relieving of a regulator, by its error |
//! | limit | a regulator's outlet that its inlet limits, or does not |
//! | empty | a reservoir that a regulator draws empty |
//! | rate limit | a proportional regulator's largest rate, by its pressure |

use super::flow::NetworkState;
use super::mode::NetworkMode;
use super::{Branch, BranchKind, Network, NodeKind};
use crate::engine::GuardForm;
use crate::line::{FlowRegime, Poppet};
use crate::scalar::{Over, Real};
use crate::simulation::EventKind;
use crate::valve::{Approach, FlowLaw, FlowZone};

/// Why a formula of a network ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkGuard {
    /// The pressures of an orifice leave the zone of its flow law.
    Zone {
        /// Which branch.
        branch: usize,
        /// Whether the pressure at the second node rises out of the zone, not falls.
        up: bool,
    },
    /// The drive through a lumped hose leaves its regime.
    Regime {
        /// Which branch.
        branch: usize,
        /// Towards the larger drive.
        up: bool,
    },
    /// The flow in a cell of a distributed hose comes to the speed of sound.
    Sonic {
        /// Which branch.
        branch: usize,
        /// The way that it goes.
        forwards: bool,
    },
    /// The flow in a cell of a distributed hose falls below the speed of sound.
    Slower {
        /// Which branch.
        branch: usize,
    },
    /// The reservoir comes to a pressure at which its compressor switches.
    Switch {
        /// The compressor's branch.
        branch: usize,
    },
    /// A regulator's error leaves a piece of its law.
    Poppet {
        /// The outlet.
        node: usize,
        /// Towards the larger error.
        up: bool,
    },
    /// The inlet of a regulator comes to limit its outlet, or ceases to.
    Limit {
        /// The outlet.
        node: usize,
    },
    /// A regulator draws its reservoir empty, faster than its outlet follows.
    Empty {
        /// The outlet.
        node: usize,
    },
    /// The rate of a regulated pressure falls below its limit.
    RateLimit {
        /// The port.
        node: usize,
    },
}

/// What a few steps may err in a flow, in widths of a border.
const FEW_STEPS: f64 = 10.0;
/// Part of its outlet's pressure at which the reservoir of a regulator counts as empty.
const EMPTY: f64 = 1e-3;
/// Part of a bound between two regimes by which it is passed at least: their slopes agree there.
const LEAST_BAND: f64 = 1e-6;

impl<R: Real> Network<R> {
    /// Calls `add` with the guards of a mode. `place` says which state the pressure of a node is, if it is one.
    pub(crate) fn guards(
        &self,
        mode: &NetworkMode<R>,
        band: f64,
        place: impl Fn(usize) -> Option<usize>,
        mut add: impl FnMut(NetworkGuard, GuardForm<R>),
    ) {
        let linear = |index: Option<usize>, bound: R, above: bool| {
            index.map_or(GuardForm::Function, |index| GuardForm::on(index, bound, above))
        };
        for (index, Branch { from, to, kind }) in self.branches.iter().enumerate() {
            let of_branch = &mode.branches[index];
            match kind {
                BranchKind::Path { law, .. } | BranchKind::Check { law } => {
                    for up in [false, true] {
                        let Some(ratio) = self.zone_ratio(index, law, of_branch.zone, band, up) else { continue };
                        let fixed = matches!(self.nodes[*from].kind, NodeKind::Atmosphere | NodeKind::Source);
                        let form = match place(*to) {
                            Some(place) if fixed => linear(Some(place), ratio * self.constant(*from), !up),
                            _ => GuardForm::Function,
                        };
                        add(NetworkGuard::Zone { branch: index, up }, form);
                    }
                }
                BranchKind::Loss(_) => {
                    for (up, bound) in [false, true].into_iter().zip(of_branch.regime.bounds()) {
                        if bound.is_some() {
                            add(NetworkGuard::Regime { branch: index, up }, GuardForm::Function);
                        }
                    }
                }
                BranchKind::Compressor => {
                    if let NodeKind::Reservoir(reservoir) = &self.nodes[*to].kind
                        && let Some([starts, stops]) = reservoir.switch_pressures()
                    {
                        let bound = if of_branch.runs { stops } else { starts };
                        add(NetworkGuard::Switch { branch: index }, linear(place(*to), bound, !of_branch.runs));
                    }
                }
                BranchKind::Inertia(_) => match of_branch.sonic {
                    Some(_) => add(NetworkGuard::Slower { branch: index }, GuardForm::Function),
                    None => {
                        for forwards in [true, false] {
                            add(NetworkGuard::Sonic { branch: index, forwards }, GuardForm::Function);
                        }
                    }
                },
                BranchKind::Leak(_) => {}
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            let of_node = &mode.nodes[index];
            if let NodeKind::Outlet { inlet: Some(inlet), .. } = &node.kind {
                add(NetworkGuard::Limit { node: index }, GuardForm::Function);
                if let NodeKind::Reservoir(_) = self.nodes[*inlet].kind {
                    add(NetworkGuard::Empty { node: index }, GuardForm::Function);
                }
            }
            match &node.kind {
                NodeKind::Outlet { regulator, .. } if regulator.dead_band().value() > 0.0 => {
                    if of_node.poppet != Poppet::Raises {
                        add(NetworkGuard::Poppet { node: index, up: true }, GuardForm::Function);
                    }
                    if of_node.poppet != Poppet::Lowers {
                        add(NetworkGuard::Poppet { node: index, up: false }, GuardForm::Function);
                    }
                }
                NodeKind::Port { .. } => {
                    if let Some((bound, lasts_above)) = self.limit_end(index, mode) {
                        add(NetworkGuard::RateLimit { node: index }, linear(place(index), bound, lasts_above));
                    }
                }
                _ => {}
            }
        }
    }

    /// By how much in Pa a regulator's error is passed: what passing its outlet's pressure by the band makes of it, droop
    /// included. Below that the error is that of the steps.
    fn error_band<T: Over<R>>(&self, node: usize, mode: &NetworkMode<R>, band: f64) -> T {
        let NodeKind::Outlet { regulator, .. } = &self.nodes[node].kind else { return T::zero() };
        let mut steepness = R::zero();
        for (branch, of_branch) in self.branches.iter().zip(&mode.branches) {
            let (BranchKind::Path { law, .. } | BranchKind::Check { law }, Some(zone)) = (&branch.kind, of_branch.zone)
            else {
                continue;
            };
            if branch.from == node {
                let steepest = if zone == FlowZone::ChokedIn { zone } else { FlowZone::LaminarIn };
                steepness = steepness + law.conductance() * law.in_zone(steepest, R::one);
            }
        }
        let by_droop = regulator.droop() * steepness / self.nodes[node].temperature.sqrt();
        T::constant(FEW_STEPS * band) * T::of(self.atmosphere) * T::of(by_droop)
            + T::constant(band) * T::of(self.atmosphere)
    }

    /// Absolute pressure in Pa of a node that does not change.
    fn constant(&self, node: usize) -> R {
        match self.nodes[node].kind {
            NodeKind::Atmosphere => self.atmosphere,
            _ => self.absolute(self.nodes[node].gauge),
        }
    }

    /// The ratio of the far to the near pressure that ends a zone on one side, passed by the band.
    fn zone_ratio(&self, branch: usize, law: &FlowLaw<R>, zone: Option<FlowZone>, band: f64, up: bool) -> Option<R> {
        // A subsonic piece ends before the pressures are equal, where its root would.
        let band = band.min(0.1 * (1.0 - law.laminar_ratio().value()));
        let Some(zone) = zone else {
            // A check valve opens again where the pressures have come the other way round.
            let shut = matches!(self.branches[branch].kind, BranchKind::Check { .. });
            return (shut && !up).then(|| R::constant(1.0 - band));
        };
        let (low, high) = law.bounds(zone, R::one());
        let passed = |bound: R, factor: f64| bound * R::constant(factor);
        if up { high.map(|bound| passed(bound, 1.0 + band)) } else { low.map(|bound| passed(bound, 1.0 - band)) }
    }

    /// Where the rate of a port falls below its limit: the absolute pressure in Pa, and whether the mode lasts above it.
    fn limit_end(&self, node: usize, mode: &NetworkMode<R>) -> Option<(R, bool)> {
        let NodeKind::Port { regulator, .. } = &self.nodes[node].kind else { return None };
        let (approach, set) = (mode.nodes[node].approach?, self.set_point(node, mode)?);
        Some((regulator.limit_end(approach, set)?, approach == Approach::Falls))
    }

    /// Value of a guard at pressures and flows.
    pub(crate) fn guard<T: Over<R>>(
        &self,
        guard: NetworkGuard,
        mode: &NetworkMode<R>,
        band: f64,
        at: &NetworkState<T>,
    ) -> T {
        let pressures = |branch: usize| {
            let Branch { from, to, .. } = self.branches[branch];
            [at.nodes[from].pressure, at.nodes[to].pressure]
        };
        let value = match guard {
            NetworkGuard::Zone { branch, up } => match &self.branches[branch].kind {
                BranchKind::Path { law, .. } | BranchKind::Check { law } => {
                    self.zone_ratio(branch, law, mode.branches[branch].zone, band, up).map(|ratio| {
                        let [near, far] = pressures(branch);
                        let bound = T::of(ratio) * near;
                        if up { bound - far } else { far - bound }
                    })
                }
                _ => None,
            },
            NetworkGuard::Regime { branch, up } => match &self.branches[branch].kind {
                BranchKind::Loss(hose) => {
                    let sign = if up { 1.0 } else { -1.0 };
                    mode.branches[branch].regime.bounds()[usize::from(up)].map(|bound| {
                        let [near, far] = pressures(branch);
                        let passed = bound + sign * band.max(LEAST_BAND) * bound.abs();
                        (T::constant(passed) - hose.tube().drive(near, far)) * T::constant(sign)
                    })
                }
                _ => None,
            },
            NetworkGuard::Switch { branch } => match &self.nodes[self.branches[branch].to].kind {
                NodeKind::Reservoir(reservoir) => reservoir.switch_pressures().map(|[starts, stops]| {
                    let [_, pressure] = pressures(branch);
                    if mode.branches[branch].runs { T::of(stops) - pressure } else { pressure - T::of(starts) }
                }),
                _ => None,
            },
            NetworkGuard::Poppet { node, up } => match &self.nodes[node].kind {
                NodeKind::Outlet { regulator, .. } => {
                    self.outlet_error(node, mode.nodes[node].limited, at).map(|error| {
                        // From feeding to rest at the upper end of the dead band, from rest to relieving at the lower, and back.
                        let rests = mode.nodes[node].poppet == Poppet::Rests;
                        let bound = if rests == up { 1.0 } else { -1.0 };
                        let sign = T::constant(if up { 1.0 } else { -1.0 });
                        let width: T = self.error_band(node, mode, band);
                        (T::of(regulator.dead_band()) * T::constant(bound) - error) * sign + width
                    })
                }
                _ => None,
            },
            NetworkGuard::Limit { node } => self.inlet_margin(node, at).map(|margin| {
                let width: T = self.error_band(node, mode, band);
                if mode.nodes[node].limited { width - margin } else { width + margin }
            }),
            NetworkGuard::Empty { node } => match self.nodes[node].kind {
                NodeKind::Outlet { inlet: Some(inlet), .. } => {
                    Some(at.nodes[inlet].pressure - T::constant(EMPTY) * at.nodes[node].pressure)
                }
                _ => None,
            },
            NetworkGuard::Sonic { .. } | NetworkGuard::Slower { .. } => None,
            NetworkGuard::RateLimit { node } => self.limit_end(node, mode).map(|(bound, lasts_above)| {
                let above = at.nodes[node].pressure - T::of(bound);
                if lasts_above { above } else { -above }
            }),
        };
        value.unwrap_or(T::one())
    }

    /// Crosses a guard: the formula that holds after it, and what the log calls it.
    pub(crate) fn cross(&self, guard: NetworkGuard, mode: &mut NetworkMode<R>) -> EventKind {
        let step = |place: usize, up: bool| if up { place + 1 } else { place.wrapping_sub(1) };
        match guard {
            NetworkGuard::Zone { branch, up } => {
                let is_check = matches!(self.branches[branch].kind, BranchKind::Check { .. });
                let zone = &mut mode.branches[branch].zone;
                *zone = match zone {
                    Some(zone) => {
                        let place = FlowZone::RISING.iter().position(|other| other == zone).unwrap_or(0);
                        let next = FlowZone::RISING.get(step(place, up)).copied().unwrap_or(*zone);
                        Some(next).filter(|next| !is_check || next.is_inward())
                    }
                    None => Some(FlowZone::LaminarIn),
                };
                EventKind::Flow
            }
            NetworkGuard::Regime { branch, up } => {
                let regime = &mut mode.branches[branch].regime;
                let place = FlowRegime::RISING.iter().position(|other| other == regime).unwrap_or(0);
                *regime = FlowRegime::RISING.get(step(place, up)).copied().unwrap_or(*regime);
                EventKind::Regime
            }
            NetworkGuard::Switch { branch } => {
                mode.branches[branch].runs = !mode.branches[branch].runs;
                EventKind::Compressor
            }
            NetworkGuard::Poppet { node, up } => {
                let poppet = &mut mode.nodes[node].poppet;
                let towards = if up { Poppet::Raises } else { Poppet::Lowers };
                *poppet = if *poppet == Poppet::Rests { towards } else { Poppet::Rests };
                EventKind::Regulator
            }
            NetworkGuard::Limit { node } => {
                mode.nodes[node].limited = !mode.nodes[node].limited;
                EventKind::Regulator
            }
            NetworkGuard::Sonic { branch, forwards } => {
                mode.branches[branch].sonic = Some(forwards);
                EventKind::Flow
            }
            NetworkGuard::Slower { branch } => {
                mode.branches[branch].sonic = None;
                EventKind::Flow
            }
            // It ends a run.
            NetworkGuard::Empty { .. } => EventKind::Regulator,
            NetworkGuard::RateLimit { node } => {
                mode.nodes[node].approach = Some(Approach::Settles);
                EventKind::Regulator
            }
        }
    }
}
