//! What follows when a guard of a joint has come down through zero.

use super::mode::{Contact, End, JointEventKind, JointGuard, Turning};
use super::system::{ANGLE, JointPhase, JointSystem, VELOCITY};
use crate::error::Error;
use crate::scalar::Real;
use crate::simulation::member::Member;
use crate::simulation::mode::{EventKind, Extent, Guard};
use crate::simulation::system::HybridSystem;

impl<R: Real> JointSystem<'_, R> {
    /// What follows when a guard has come down through zero; the memories of the hysteresis are taken on after it.
    pub(super) fn pass_guard<const N: usize>(
        &self,
        guard: JointGuard,
        time: R,
        state: &mut [R; N],
        phase: &mut JointPhase<R>,
    ) -> Result<JointEventKind, Error> {
        let JointPhase { mode, traces, .. } = phase;
        let of_joint = |kind| Ok(JointEventKind { actuator: None, kind });
        let stop = |end: End| self.joint().stops().ends[end.index()];
        match guard {
            JointGuard::Of(i, guard) => self.cross_member(i, guard, time, state, phase),
            JointGuard::ArmDown(i) | JointGuard::ArmUp(i) => {
                let (up, piece) = (guard == JointGuard::ArmUp(i), mode.arm_pieces[i]);
                let (first, last) = self.joint().tendons()[i].arm.piece_bounds(piece);
                state[ANGLE] = if up { last } else { first }.unwrap_or(state[ANGLE]);
                mode.arm_pieces[i] = if up { piece + 1 } else { piece.saturating_sub(1) };
                Ok(JointEventKind { actuator: Some(i), kind: EventKind::MomentArm })
            }
            JointGuard::Reach(end) => {
                state[ANGLE] = stop(end).unwrap_or(state[ANGLE]);
                mode.contact = Contact::Pressed(end);
                of_joint(EventKind::StopReached)
            }
            JointGuard::Press(end) => {
                mode.contact = Contact::Pressed(end);
                of_joint(EventKind::StopReached)
            }
            JointGuard::Rebound(end) => {
                mode.contact = Contact::Rebound(end);
                of_joint(EventKind::StopRebound)
            }
            JointGuard::Leave(end) => {
                state[ANGLE] = stop(end).unwrap_or(state[ANGLE]);
                mode.contact = Contact::None;
                of_joint(EventKind::StopLeft)
            }
            JointGuard::Rest => {
                state[VELOCITY] = R::zero();
                self.enter_turning(state, mode, traces);
                of_joint(if mode.turning == Turning::Stuck { EventKind::Stick } else { EventKind::Reversal })
            }
            JointGuard::BreakForward | JointGuard::BreakBackward => {
                self.head(state, mode, traces, if guard == JointGuard::BreakForward { 1.0 } else { -1.0 });
                of_joint(EventKind::BreakAway)
            }
        }
    }

    /// Crosses a guard of an actuator.
    fn cross_member<const N: usize>(
        &self,
        i: usize,
        guard: Guard,
        time: R,
        state: &mut [R; N],
        phase: &mut JointPhase<R>,
    ) -> Result<JointEventKind, Error> {
        let JointPhase { mode, traces, .. } = phase;
        let pieces = mode.arm_pieces;
        let of_member = |kind| Ok(JointEventKind { actuator: Some(i), kind });
        if let Some((limit, _)) = self.limit_angle(i, guard)
            && guard != Guard::ThreadLength
        {
            state[ANGLE] = limit;
        }
        match guard {
            Guard::ThreadLength => Err(Error::Stopped {
                time: time.value(),
                reason: "the joint pulled a braid straight",
                quantity: "joint angle",
                value: state[ANGLE].value(),
                unit: "rad",
                remedy: "lighten the load, stiffen actuator.limit.stiffness or give the joint stops",
            }),
            Guard::Slack | Guard::Tight if self.rests_on_the_shortest(i, state, mode, traces) => {
                state[VELOCITY] = R::zero();
                mode.actuators[i].extent = Extent::Free;
                self.turn(state, mode, traces, Turning::Stuck);
                Ok(JointEventKind { actuator: None, kind: EventKind::Stick })
            }
            Guard::Slack | Guard::Tight => {
                let slack = guard == Guard::Slack;
                mode.actuators[i].extent = if slack { Extent::Slack } else { Extent::Free };
                let remembered = self.remembered(i, state, traces);
                self.members[i].enter_clamp(self.ends(i, state, pieces), &mut mode.actuators[i], remembered);
                of_member(if slack { EventKind::Slack } else { EventKind::Tight })
            }
            Guard::Taut | Guard::Untaut => {
                let taut = guard == Guard::Taut;
                mode.actuators[i].extent = if taut { Extent::Taut } else { Extent::Free };
                let remembered = self.remembered(i, state, traces);
                self.members[i].enter_clamp(self.ends(i, state, pieces), &mut mode.actuators[i], remembered);
                of_member(if taut { EventKind::Taut } else { EventKind::Untaut })
            }
            Guard::Slip => of_member(EventKind::Slip),
            Guard::RateLimit => {
                phase.port[i].settle();
                of_member(EventKind::Regulator)
            }
            _ => match Member::<R>::cross(guard, &mut mode.actuators[i]) {
                Some(kind) => of_member(kind),
                None => Err(self.stuck(time, state, phase)),
            },
        }
    }
}
