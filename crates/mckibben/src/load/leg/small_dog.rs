//! A leg whose numbers are assumed, to begin with.

use super::{Belt, Leg, Range, Segment, Strand};

impl Leg {
    /// A leg of the size of a small dog's on a belt, for actuators like the paper's. Nobody measured it: every number is
    /// assumed.
    pub fn small_dog() -> Self {
        let range = |low: f64, high: f64| Range {
            ends: [low.to_radians(), high.to_radians()],
            damping: 0.02,
            stop_stiffness: 50.0,
            stop_damping: 0.3,
        };
        let pair = |hip: f64, knee: f64, rest_length: f64| {
            [1.0, -1.0].map(|way| Strand { arms: [way * hip, way * knee], rest_length })
        };
        let ([hip_forward, hip_back], [knee_forward, knee_back]) = (pair(0.018, 0.0, 0.080), pair(0.0, 0.015, 0.078));
        let [both_forward, both_back] = pair(0.008, 0.008, 0.080);
        Self {
            segments: [
                Segment { length: 0.22, mass: 0.40, distance: 0.09, inertia: 1.6e-3 },
                Segment { length: 0.22, mass: 0.22, distance: 0.10, inertia: 0.9e-3 },
            ],
            gravity: 9.806_65,
            ranges: [range(-60.0, 60.0), range(-100.0, -5.0)],
            strands: [hip_forward, hip_back, knee_forward, knee_back, both_forward, both_back],
            belt: Some(Belt {
                depth: 0.432,
                velocity: -0.35,
                stiffness: 2e4,
                damping: 80.0,
                friction: 0.6,
                slipping_speed: 0.02,
            }),
        }
    }
}
