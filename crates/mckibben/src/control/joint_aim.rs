//! A joint at an angle with a stiffness: the two pressures, or the two masses of air, that the static model needs.
//!
//! ```text
//! τ = M g d sin(θ − θ₀) − W        what the actuators must hold at θ
//! (P₁, P₂) from τ and K            the pair inverted, between 0 and P_max
//! m = P V(L)/(R T)                 of each, at its length at θ
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | θ | `angle` | rad |
//! | K | `stiffness` of the two actuators about the joint, without the limb's weight | N·m/rad |
//! | P_max | `highest`, at most the supply's | Pa, gauge |
//!
//! For [`FeedForward`] K is the stiffness at these pressures, for [`AirMass`] that with the valves shut. Where no two
//! pressures up to P_max give both, they come as near as they can: to the torque first. Friction and whatever the model does
//! not know stay as errors of the angle.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 2.1: stiffness and position of a joint by the masses of air of its two
//! actuators. How their controller gets there is not in the paper. Checked by `tests/joint_control.rs`.

use super::{
    AirMass, AntagonisticPair, Drive, FeedForward, Held, JointController, JointMeasurement, Quantity, Regulator,
    RegulatorMemory, SetPoint,
};
use crate::actuator::Actuator;
use crate::dual::Dual;
use crate::error::Error;
use crate::load::Joint;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Real;

/// An angle and a stiffness, and the model that says which pressures give them.
#[derive(Clone, Debug, PartialEq)]
pub struct JointAim<S = f64> {
    actuators: [Actuator<S>; 2],
    joint: Joint<S>,
    angle: SetPoint<S>,
    stiffness: SetPoint<S>,
    highest: GaugePressure<S>,
}

impl JointAim {
    /// A joint at an angle in rad with a stiffness in N·m/rad, by the model of agonist and antagonist, with gauge pressures
    /// up to `highest`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the highest pressure is above zero; [`Error::Inconsistent`] for an angle at which an
    /// actuator is slack, does not pull, or is taut; [`Error::NotImplemented`] for a law of force other than the ideal braid's.
    pub fn new(
        actuators: [Actuator; 2],
        joint: Joint,
        [angle, stiffness]: [SetPoint; 2],
        highest: GaugePressure,
    ) -> Result<Self, Error> {
        parameter::HIGHEST_GAUGE_PRESSURE.check(highest.0)?;
        let aim = Self { actuators, joint, angle, stiffness, highest };
        // Between two angles at which both braids pull they pull as well.
        aim.angle.ends().into_iter().try_for_each(|angle| aim.pair(angle).map(drop))?;
        Ok(aim)
    }
}

impl<R: Real> JointAim<R> {
    /// The two actuators at an angle in rad.
    fn pair(&self, angle: R) -> Result<AntagonisticPair<'_, R>, Error> {
        let leverage = self.joint.leverage(Dual::<R, 1>::variable(angle, 0));
        let (lengths, arms) = (leverage.lengths.map(|length| length.value), leverage.arms.map(|arm| arm.value));
        let pair = AntagonisticPair::new(self.actuators.each_ref(), lengths, arms)?;
        pair.with_arm_slopes(leverage.arms.map(|arm| arm.slope[0]))
    }

    /// The gauge pressures of agonist and antagonist that the model requests at a time in s.
    pub fn pressures(&self, time: R, held: Held) -> [GaugePressure<R>; 2] {
        let angle = self.angle.at(time);
        let torque = -self.joint.other_torque(angle, R::zero());
        match self.pair(angle) {
            Ok(pair) => pair.pressures_within(torque, self.stiffness.at(time), held, self.highest),
            // All angles between the ends of the set point have been tried by way of these.
            Err(_) => [GaugePressure(R::zero()); 2],
        }
    }

    /// The masses of air in kg that the model requests at a time in s, at a temperature in K.
    pub fn masses(&self, time: R, temperature: R) -> [R; 2] {
        let (pressures, lengths) = (self.pressures(time, Held::AirMasses), self.joint.lengths(self.angle.at(time)));
        [0, 1].map(|i| self.actuators[i].air_mass(pressures[i], lengths[i], temperature))
    }
}

/// What the valves are to do for what is wanted of agonist and antagonist and measured of them.
fn regulate<R: Real>(
    regulator: &Regulator<R>,
    time: R,
    [wanted, measured]: [[R; 2]; 2],
    memory: &mut [RegulatorMemory<R>; 2],
) -> [Drive<R>; 2] {
    [0, 1].map(|i| regulator.regulate(time, [wanted[i], measured[i]], true, &mut memory[i]))
}

impl<R: Real> JointController<R> for FeedForward<JointAim<R>, R> {
    type Memory = [RegulatorMemory<R>; 2];

    fn begin(&self) -> Self::Memory {
        [self.regulator.begin(); 2]
    }

    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut Self::Memory) -> [Drive<R>; 2] {
        let wanted = self.aim.pressures(seen.time, Held::Pressures).map(|pressure| pressure.0);
        let measured = seen.actuators.map(|actuator| actuator.pressure.0);
        regulate(&self.regulator, seen.time, [wanted, measured], memory)
    }

    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        self.aim.pressures(seen.time, Held::Pressures).map(|pressure| Some((Quantity::Pressure, pressure.0)))
    }
}

impl<R: Real> JointController<R> for AirMass<JointAim<R>, R> {
    type Memory = [RegulatorMemory<R>; 2];

    fn begin(&self) -> Self::Memory {
        [self.regulator.begin(); 2]
    }

    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut Self::Memory) -> [Drive<R>; 2] {
        let wanted = self.aim.masses(seen.time, self.temperature);
        let measured = seen.actuators.map(|actuator| actuator.air_mass);
        regulate(&self.regulator, seen.time, [wanted, measured], memory)
    }

    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        self.aim.masses(seen.time, self.temperature).map(|mass| Some((Quantity::AirMass, mass)))
    }
}
