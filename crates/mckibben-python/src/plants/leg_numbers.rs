//! The numbers of a leg by their paths: those of its structure, and where it begins.

use mckibben::load::leg::{Leg, LegState};

/// A leg and where it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posed {
    pub(super) leg: Leg,
    pub(super) state: LegState,
}

impl Posed {
    /// The leg whose numbers are assumed, bent a little.
    pub(super) fn assumed() -> Self {
        Self { leg: Leg::small_dog(), state: LegState { angles: [0.1, -0.5], rates: [0.0; 2] } }
    }

    /// The number at a path, in SI.
    pub(super) fn number(&mut self, path: &str) -> Option<&mut f64> {
        let (part, name) = path.split_once('.').unwrap_or((path, ""));
        let Self { leg, state } = self;
        if let Some(strand) = part.strip_prefix("strands[").and_then(|rest| rest.strip_suffix(']')) {
            let strand = leg.strands.get_mut(strand.parse::<usize>().ok()?)?;
            return match name {
                "hip_arm" => Some(&mut strand.arms[0]),
                "knee_arm" => Some(&mut strand.arms[1]),
                "rest_length" => Some(&mut strand.rest_length),
                _ => None,
            };
        }
        match part {
            "gravity" if name.is_empty() => Some(&mut leg.gravity),
            "thigh" | "shank" => {
                let segment = &mut leg.segments[usize::from(part == "shank")];
                match name {
                    "length" => Some(&mut segment.length),
                    "mass" => Some(&mut segment.mass),
                    "distance" => Some(&mut segment.distance),
                    "inertia" => Some(&mut segment.inertia),
                    _ => None,
                }
            }
            "hip" | "knee" => {
                let joint = usize::from(part == "knee");
                let range = &mut leg.ranges[joint];
                match name {
                    "min_angle" => Some(&mut range.ends[0]),
                    "max_angle" => Some(&mut range.ends[1]),
                    "damping" => Some(&mut range.damping),
                    "stop_stiffness" => Some(&mut range.stop_stiffness),
                    "stop_damping" => Some(&mut range.stop_damping),
                    "angle" => Some(&mut state.angles[joint]),
                    "angular_velocity" => Some(&mut state.rates[joint]),
                    _ => None,
                }
            }
            "belt" => {
                let belt = leg.belt.as_mut()?;
                match name {
                    "depth" => Some(&mut belt.depth),
                    "velocity" => Some(&mut belt.velocity),
                    "stiffness" => Some(&mut belt.stiffness),
                    "damping" => Some(&mut belt.damping),
                    "friction" => Some(&mut belt.friction),
                    "slipping_speed" => Some(&mut belt.slipping_speed),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}

/// What the message says of a path that is no number of a leg.
pub(super) const KNOWN: &str = "leg.gravity, leg.thigh.mass (length, distance, inertia; so of the shank), leg.hip.min_angle \
    (max_angle, damping, stop_stiffness, stop_damping, angle, angular_velocity; so of the knee), leg.strands[0].hip_arm \
    (knee_arm, rest_length), leg.belt.depth (velocity, stiffness, damping, friction, slipping_speed)";
