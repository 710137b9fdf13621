//! How an actuator spans a mechanism: the distance between its attachments and its gradient.
//!
//! ```text
//! direct     x = q_k
//! arms       x = ℓ − Σ_j s_j e_j(θ_j)              ∂x/∂θ_j = −s_j r_j(θ_j),   s_j = ±1
//! points     x = |p_a − p_b|                       ∂x/∂θ_j = u · ∂(p_a − p_b)/∂θ_j,   u = (p_a − p_b)/x
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | ℓ | `rest_length`, the distance at angles zero | m |
//! | r, e | moment arm and excursion ([`MomentArm`]) | m |
//! | p | an [`Attachment`] on a segment or on the ground | m |
//!
//! An actuator with arms about several joints spans all of them. Points on segments give a distance whose gradient is exact
//! by the chain's kinematics.
//!
//! Source: virtual work. Checked by `tests/plant_span.rs`: the law of cosines, finite differences; arms by
//! `tests/moment_arm.rs`.

use super::Mechanism;
use super::chain::{Chain, MAX_JOINTS};
use super::parameter::ATTACHMENT;
use crate::convert::Convert;
use crate::error::Error;
use crate::load::MomentArm;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// A moment arm about one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm<S = f64> {
    /// Which joint, from 0.
    pub joint: usize,
    /// +1 where the actuator's tension turns the joint towards greater angles, −1 where it turns it back.
    pub sign: f64,
    /// The arm over the angle.
    pub arm: MomentArm<S>,
}

/// A point on a segment of a chain, or on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment<S = f64> {
    /// The segment, from 0; the ground where there is none.
    pub segment: Option<usize>,
    /// Place in m: along the segment from the joint above and across it, or on the ground along the direction in which
    /// gravity pulls and across it; from the first joint.
    pub place: [S; 2],
}

/// The pieces of moment arms that hold. A trait, not a function: that would be compiled separately, without the
/// instructions of a batch.
pub(crate) trait ArmPieces<S: Scalar> {
    /// Arm in m and excursion in m of a moment arm, by its number, at an angle in rad.
    fn arm<T: Over<S>>(&self, number: usize, arm: &MomentArm<S>, angle: T) -> [T; 2];
}

/// The pieces that the angles themselves lie in.
struct Anywhere;

impl<S: Scalar> ArmPieces<S> for Anywhere {
    #[inline(always)]
    fn arm<T: Over<S>>(&self, _: usize, arm: &MomentArm<S>, angle: T) -> [T; 2] {
        arm.at(angle)
    }
}

/// Pieces by their numbers.
impl<S: Scalar> ArmPieces<S> for &[usize] {
    #[inline(always)]
    fn arm<T: Over<S>>(&self, number: usize, arm: &MomentArm<S>, angle: T) -> [T; 2] {
        arm.in_piece(self[number], angle)
    }
}

/// How an actuator spans its mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Coupling<S = f64> {
    /// The distance is a coordinate of the mechanism.
    Direct {
        /// Which, from 0.
        coordinate: usize,
    },
    /// By moment arms about joints.
    Arms {
        /// The distance in m at angles zero.
        rest_length: S,
        /// One for each joint that the actuator spans.
        arms: Vec<Arm<S>>,
    },
    /// Between two points.
    Points([Attachment<S>; 2]),
}

impl Coupling {
    /// A tendon over pulleys or moment arms.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Table`] for a number outside its range.
    pub fn arms(rest_length: f64, arms: Vec<Arm>) -> Result<Self, Error> {
        parameter::REST_LENGTH.check(rest_length)?;
        for Arm { arm, .. } in &arms {
            arm.check()?;
        }
        Ok(Self::Arms { rest_length, arms })
    }

    /// Distance in m between the attachments with a mechanism at coordinates in m or rad, as many as it has.
    pub fn span(&self, mechanism: &Mechanism, position: &[f64]) -> f64 {
        let chain = if let Mechanism::Chain(chain) = mechanism { Some(chain) } else { None };
        self.distance_at(chain, position, &mut vec![0.0; position.len()])
    }
}

impl<S: Scalar> Coupling<S> {
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Coupling<T> {
        match self {
            Self::Direct { coordinate } => Coupling::Direct { coordinate: *coordinate },
            Self::Arms { rest_length, arms } => {
                let arms = arms
                    .iter()
                    .map(|Arm { joint, sign, arm }| Arm { joint: *joint, sign: *sign, arm: arm.convert(convert) })
                    .collect();
                Coupling::Arms { rest_length: convert.parameter(&parameter::REST_LENGTH, *rest_length), arms }
            }
            Self::Points(ends) => Coupling::Points(ends.map(|Attachment { segment, place }| Attachment {
                segment,
                place: place.map(|number| convert.parameter(&ATTACHMENT, number)),
            })),
        }
    }

    /// The coordinates that it spans, of so many.
    pub(crate) fn spans(&self, coordinates: usize) -> Vec<usize> {
        match self {
            Self::Direct { coordinate } => vec![*coordinate],
            Self::Arms { arms, .. } => arms.iter().map(|arm| arm.joint).collect(),
            Self::Points(_) => (0..coordinates).collect(),
        }
    }

    /// Whether its gradient is the same at all coordinates.
    pub(crate) fn is_linear(&self) -> bool {
        match self {
            Self::Direct { .. } => true,
            Self::Arms { arms, .. } => arms.iter().all(|arm| matches!(arm.arm, MomentArm::Pulley(_))),
            Self::Points(_) => false,
        }
    }

    /// How many pieces of moment arms a mode keeps for it.
    pub(crate) fn arm_count(&self) -> usize {
        match self {
            Self::Arms { arms, .. } => arms.len(),
            Self::Direct { .. } | Self::Points(_) => 0,
        }
    }

    /// The distance in m at the mechanism's coordinates, and its gradient, which is zero before, by the pieces of the moment arms
    /// that hold there.
    pub(crate) fn distance_at<T: Over<S>>(&self, chain: Option<&Chain<S>>, position: &[T], gradient: &mut [T]) -> T {
        let mut directions = [[T::zero(); 2]; MAX_JOINTS];
        if let Some(chain) = chain {
            chain.enter_directions(position, &mut directions);
        }
        self.distance(chain, (position, &directions), Anywhere, gradient)
    }

    /// The distance in m at coordinates with the [directions](Chain::enter_directions) of a chain's segments. Its gradient over the
    /// coordinates (m per unit of each) is written to `gradient`, which is zero before where it spans none.
    #[inline(always)]
    pub(crate) fn distance<T: Over<S>>(
        &self,
        chain: Option<&Chain<S>>,
        (position, directions): (&[T], &[[T; 2]]),
        pieces: impl ArmPieces<S>,
        gradient: &mut [T],
    ) -> T {
        match self {
            Self::Direct { coordinate } => {
                gradient.fill(T::zero());
                gradient[*coordinate] = T::one();
                position[*coordinate]
            }
            Self::Arms { rest_length, arms } => {
                let mut distance = T::of(*rest_length);
                for (number, Arm { joint, sign, arm }) in arms.iter().enumerate() {
                    let [arm, excursion] = pieces.arm(number, arm, position[*joint]);
                    let sign = T::constant(*sign);
                    distance = distance - sign * excursion;
                    let is_first = !arms[..number].iter().any(|before| before.joint == *joint);
                    let others = if is_first { T::zero() } else { gradient[*joint] };
                    gradient[*joint] = others - sign * arm;
                }
                distance
            }
            Self::Points(ends) => match chain {
                Some(chain) => between(chain, ends, directions, gradient),
                None => T::zero(),
            },
        }
    }
}

impl<S: Real> Coupling<S> {
    /// The pieces of its moment arms at the mechanism's coordinates.
    pub(crate) fn pieces(&self, position: &[S], pieces: &mut [usize]) {
        if let Self::Arms { arms, .. } = self {
            for (Arm { joint, arm, .. }, piece) in arms.iter().zip(pieces) {
                *piece = arm.piece(position[*joint]);
            }
        }
    }

    /// The coordinate, and its value at which the distance is `distance` (m), where one coordinate alone decides, and whether
    /// the distance grows with it.
    pub(crate) fn coordinate_at(&self, distance: S) -> Option<(usize, S, bool)> {
        match self {
            Self::Direct { coordinate } => Some((*coordinate, distance, true)),
            Self::Arms { rest_length, arms } => {
                let [Arm { joint, sign, arm }] = arms.as_slice() else { return None };
                let excursion = (*rest_length - distance) * S::constant(*sign);
                Some((*joint, arm.angle_of(excursion), *sign < 0.0))
            }
            Self::Points(_) => None,
        }
    }

    /// The gradient where it is the same at all coordinates: the coordinate and its entry.
    pub(crate) fn constant_gradient(&self) -> Option<(usize, S)> {
        match self {
            Self::Direct { coordinate } => Some((*coordinate, S::one())),
            Self::Arms { arms, .. } => match arms.as_slice() {
                [Arm { joint, sign, arm: MomentArm::Pulley(radius) }] => Some((*joint, -S::constant(*sign) * *radius)),
                _ => None,
            },
            Self::Points(_) => None,
        }
    }

    /// Whether the distance may rest while the joints move; arms are above zero throughout.
    pub(crate) fn has_dead_centres(&self) -> bool {
        matches!(self, Self::Points(_))
    }
}

/// Distance in m between points that meet.
const NO_DISTANCE: f64 = 1e-15;

/// The distance between two points and its gradient.
#[inline(always)]
fn between<S: Scalar, T: Over<S>>(
    chain: &Chain<S>,
    ends: &[Attachment<S>; 2],
    directions: &[[T; 2]],
    gradient: &mut [T],
) -> T {
    let first = ends[0].from(0, chain, directions);
    let second = ends[1].from(0, chain, directions);
    let apart = [first[0] - second[0], first[1] - second[1]];
    // Points that meet have no direction, but any will do: what is so short is slack.
    let distance = (apart[0] * apart[0] + apart[1] * apart[1]).larger(T::constant(NO_DISTANCE * NO_DISTANCE)).sqrt();
    let per_distance = T::one() / distance;
    let unit = [apart[0] * per_distance, apart[1] * per_distance];
    for (joint, entry) in gradient.iter_mut().enumerate() {
        *entry = T::zero();
        for (end, sign) in ends.iter().zip([T::one(), -T::one()]) {
            // What does not turn with the joint stays.
            if end.segment.is_some_and(|segment| joint <= segment) {
                // A turn moves the point across its radius.
                let radius = end.from(joint, chain, directions);
                *entry = *entry + sign * (unit[1] * radius[0] - unit[0] * radius[1]);
            }
        }
    }
    distance
}

impl<S: Scalar> Attachment<S> {
    /// Across and up in m from a joint to the point, which is on its segment or on one behind it.
    #[inline(always)]
    fn from<T: Over<S>>(&self, joint: usize, chain: &Chain<S>, directions: &[[T; 2]]) -> [T; 2] {
        chain.reach(joint, self.segment, [T::of(self.place[0]), T::of(self.place[1])], directions)
    }
}
