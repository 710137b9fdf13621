//! Horizontal axes that figures may have, each with its name and meaning in one place.

use std::str::FromStr;

/// Horizontal axis of a figure, chosen by its name.
pub trait HorizontalAxis: Copy + FromStr<Err = String> + Send + Sync + 'static {
    /// Every choice.
    const ALL: &'static [Self];

    /// Name, such as `time`.
    fn name(self) -> &'static str;

    /// Meaning in a few words, without a full stop.
    fn meaning(self) -> &'static str;
}

macro_rules! axes {
    ($($(#[$about:meta])* $axis:ident { $($variant:ident = $name:literal, $meaning:literal;)+ })+) => { $(
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Eq, PartialEq)]
        pub enum $axis { $(#[doc = concat!($meaning, ".")] $variant,)+ }

        impl HorizontalAxis for $axis {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            fn meaning(self) -> &'static str {
                match self { $(Self::$variant => $meaning),+ }
            }
        }

        impl FromStr for $axis {
            type Err = String;

            fn from_str(name: &str) -> Result<Self, String> {
                let known = Self::ALL.iter().copied().find(|axis| axis.name() == name);
                known.ok_or_else(|| format!("give {}", [$(concat!("\"", $name, "\"")),+].join(" or ")))
            }
        }
    )+ };
}

axes! {
    /// Horizontal axis of the figure of a run.
    TrajectoryAxis {
        Time = "time", "Length, pressure and tension over time";
        Length = "length", "Tension over length: the loops of hysteresis";
    }
    /// Horizontal axis of the figure of static curves.
    CurveAxis {
        Length = "length", "Length of the actuator";
        Contraction = "contraction", "Contraction, as a share of the longest length";
    }
}

#[cfg(test)]
mod tests {
    use super::{CurveAxis, HorizontalAxis, TrajectoryAxis};

    #[test]
    fn each_name_is_that_of_one_axis() {
        assert_eq!("length".parse(), Ok(TrajectoryAxis::Length));
        assert_eq!("contraction".parse(), Ok(CurveAxis::Contraction));
        assert_eq!(TrajectoryAxis::ALL.iter().map(|axis| axis.name()).collect::<Vec<_>>(), ["time", "length"]);
        assert_eq!("width".parse::<TrajectoryAxis>(), Err("give \"time\" or \"length\"".to_owned()));
    }
}
