//! Dimensions: the exponents of length, mass, time, temperature and angle.
//!
//! Angle is kept apart from pure numbers on purpose: it makes `rpm` an angular speed, so that it cannot be taken for
//! a frequency in Hz and be wrong by 2π without a word.
//!
//! | base | SI unit |
//! |---|---|
//! | length | m |
//! | mass | kg |
//! | time | s |
//! | temperature | K |
//! | angle | rad |

use std::fmt;

/// Exponents of length, mass, time, temperature and angle.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub struct Dimension([i8; 5]);

/// Largest exponent in size that a unit expression may reach.
const LARGEST: i32 = 30;

/// SI base units in the order of the exponents.
const BASES: [&str; 5] = ["m", "kg", "s", "K", "rad"];

impl Dimension {
    /// The exponents of m, kg, s, K and rad.
    pub fn exponents(self) -> [i8; 5] {
        self.0
    }

    /// A pure number.
    pub const NONE: Self = Self::new(0, 0, 0, 0, 0);
    /// m
    pub const LENGTH: Self = Self::new(1, 0, 0, 0, 0);
    /// kg
    pub const MASS: Self = Self::new(0, 1, 0, 0, 0);
    /// s
    pub const TIME: Self = Self::new(0, 0, 1, 0, 0);
    /// K
    pub const TEMPERATURE: Self = Self::new(0, 0, 0, 1, 0);
    /// rad
    pub const ANGLE: Self = Self::new(0, 0, 0, 0, 1);
    /// m²
    pub const AREA: Self = Self::new(2, 0, 0, 0, 0);
    /// m³
    pub const VOLUME: Self = Self::new(3, 0, 0, 0, 0);
    /// Hz
    pub const FREQUENCY: Self = Self::new(0, 0, -1, 0, 0);
    /// m/s
    pub const VELOCITY: Self = Self::new(1, 0, -1, 0, 0);
    /// m/s²
    pub const ACCELERATION: Self = Self::new(1, 0, -2, 0, 0);
    /// N
    pub const FORCE: Self = Self::new(1, 1, -2, 0, 0);
    /// Pa
    pub const PRESSURE: Self = Self::new(-1, 1, -2, 0, 0);
    /// J
    pub const ENERGY: Self = Self::new(2, 1, -2, 0, 0);
    /// W
    pub const POWER: Self = Self::new(2, 1, -3, 0, 0);
    /// N/m
    pub const STIFFNESS: Self = Self::new(0, 1, -2, 0, 0);
    /// N·s/m
    pub const DAMPING: Self = Self::new(0, 1, -1, 0, 0);
    /// rad/s
    pub const ANGULAR_SPEED: Self = Self::new(0, 0, -1, 0, 1);
    /// kg·m²
    pub const INERTIA: Self = Self::new(2, 1, 0, 0, 0);
    /// N·m/rad
    pub const ANGULAR_STIFFNESS: Self = Self::new(2, 1, -2, 0, -1);
    /// N·m·s/rad
    pub const ANGULAR_DAMPING: Self = Self::new(2, 1, -1, 0, -1);
    /// m³/s
    pub const VOLUME_FLOW: Self = Self::new(3, 0, -1, 0, 0);
    /// kg/s, of which N·s/m is another name.
    pub const MASS_FLOW: Self = Self::DAMPING;
    /// m³/(s·Pa)
    pub const CONDUCTANCE: Self = Self::new(4, -1, 1, 0, 0);
    /// W/K
    pub const HEAT_TRANSFER: Self = Self::new(2, 1, -3, -1, 0);
    /// J/(kg·K)
    pub const SPECIFIC_GAS_CONSTANT: Self = Self::new(2, 0, -2, -1, 0);

    /// The dimension with these exponents.
    pub const fn new(length: i8, mass: i8, time: i8, temperature: i8, angle: i8) -> Self {
        Self([length, mass, time, temperature, angle])
    }

    /// Dimension of `self` times `other` to the `power`, or `None` when an exponent leaves ±30.
    pub fn times(self, other: Self, power: i32) -> Option<Self> {
        let mut exponents = self.0;
        for (exponent, factor) in exponents.iter_mut().zip(other.0) {
            let sum = i32::from(factor).checked_mul(power)?.checked_add(i32::from(*exponent))?;
            *exponent = i8::try_from(sum).ok().filter(|_| sum.abs() <= LARGEST)?;
        }
        Some(Self(exponents))
    }

    /// What a quantity of this dimension is called with its article, and values that people write.
    fn known(self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            Self::NONE => ("a pure number", "0.85"),
            Self::LENGTH => ("a length", "\"3.85 in\" or \"98 mm\""),
            Self::MASS => ("a mass", "\"5 lb\" or \"2.3 kg\""),
            Self::TIME => ("a time", "\"4 ms\" or \"2 s\""),
            Self::TEMPERATURE => ("a temperature", "\"293.15 K\" or \"20 degC\""),
            Self::ANGLE => ("an angle", "\"90 deg\" or \"1.5 rad\""),
            Self::AREA => ("an area", "\"1.8e-5 ft^2\" or \"1.7 mm^2\""),
            Self::VOLUME => ("a volume", "\"3 cm^3\" or \"5 mL\""),
            Self::FREQUENCY => ("a frequency", "\"25 Hz\""),
            Self::VELOCITY => ("a velocity", "\"0.1 m/s\""),
            Self::ACCELERATION => ("an acceleration", "\"9.80665 m/s^2\""),
            Self::FORCE => ("a force", "\"5 lbf\" or \"22 N\""),
            Self::PRESSURE => ("a pressure", "\"60 psi\" or \"400 kPa\""),
            Self::ENERGY => ("an energy or a torque", "\"1 J\" or \"1 N*m\""),
            Self::POWER => ("a power", "\"1 W\""),
            Self::STIFFNESS => ("a stiffness", "\"1.75e5 N/m\""),
            Self::DAMPING => ("a damping coefficient or a mass flow", "\"0.02 lbf*s/in\" or \"100 N*s/m\""),
            Self::ANGULAR_SPEED => ("an angular speed", "\"60 rpm\" or \"1 rad/s\""),
            Self::INERTIA => ("a moment of inertia", "\"1e-3 kg*m^2\""),
            Self::ANGULAR_STIFFNESS => ("an angular stiffness", "\"500 N*m/rad\""),
            Self::ANGULAR_DAMPING => ("an angular damping coefficient", "\"0.01 N*m*s/rad\""),
            Self::VOLUME_FLOW => ("a volume flow", "\"100 L/min ANR\""),
            Self::CONDUCTANCE => ("a sonic conductance or a leakage", "\"0.5 L/(s*bar)\""),
            Self::HEAT_TRANSFER => ("a heat transfer coefficient times an area", "\"0.5 W/K\""),
            Self::SPECIFIC_GAS_CONSTANT => ("a specific gas constant", "\"286.99 J/(kg*K)\""),
            _ => return None,
        })
    }

    /// What a quantity of this dimension is, with its article: "a pressure", or "a quantity in kg^2/s".
    pub fn noun(self) -> String {
        self.known().map_or_else(|| format!("a quantity in {self}"), |(noun, _)| noun.to_owned())
    }

    /// Values of this dimension as they stand in a scenario file, where there are usual ones.
    pub fn example(self) -> Option<&'static str> {
        self.known().map(|(_, example)| example)
    }
}

/// In SI base units, such as `kg/(m*s^2)`; a pure number is `1`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |sign: i8| -> Vec<String> {
            let of_sign = self.0.iter().zip(BASES).filter(|(e, _)| e.signum() == sign);
            of_sign
                .map(|(e, base)| if e.abs() == 1 { base.to_owned() } else { format!("{base}^{}", e.abs()) })
                .collect()
        };
        let (above, below) = (side(1), side(-1));
        let above = if above.is_empty() { "1".to_owned() } else { above.join("*") };
        match below.len() {
            0 => write!(f, "{above}"),
            1 => write!(f, "{above}/{}", below[0]),
            _ => write!(f, "{above}/({})", below.join("*")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Dimension;

    #[test]
    fn names_itself() {
        assert_eq!(Dimension::PRESSURE.to_string(), "kg/(m*s^2)");
        assert_eq!(Dimension::PRESSURE.noun(), "a pressure");
        assert_eq!(Dimension::NONE.to_string(), "1");
        assert_eq!(Dimension::FREQUENCY.to_string(), "1/s");
        assert_eq!(Dimension::new(0, 2, 0, 0, 0).noun(), "a quantity in kg^2");
    }

    #[test]
    fn products_are_bounded() {
        assert_eq!(Dimension::FORCE.times(Dimension::AREA, -1), Some(Dimension::PRESSURE));
        assert_eq!(Dimension::NONE.times(Dimension::LENGTH, 31), None);
        assert_eq!(Dimension::NONE.times(Dimension::LENGTH, i32::MIN), None);
    }
}
