//! The words that a key accepts, each an enumeration with its spelling and meaning in one place.

/// One word that is valid for a key.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Choice {
    /// As it is written in a scenario file.
    pub name: &'static str,
    /// What it means, as one sentence.
    pub meaning: &'static str,
}

/// An enumeration that is written as a word.
pub(crate) trait Word: Copy + 'static {
    const CHOICES: &'static [Choice];

    fn from_name(name: &str) -> Option<Self>;
}

macro_rules! words {
    ($($(#[$attribute:meta])* $name:ident { $($variant:ident = $text:literal, $meaning:literal;)+ })+) => { $(
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
        pub enum $name { $(#[doc = $meaning] $variant,)+ }

        impl $name {
            /// Every word with its meaning.
            pub const CHOICES: &'static [Choice] = &[$(Choice { name: $text, meaning: $meaning }),+];

            /// As it is written in a scenario file.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $text),+ }
            }
        }

        impl Word for $name {
            const CHOICES: &'static [Choice] = $name::CHOICES;

            fn from_name(name: &str) -> Option<Self> {
                match name { $($text => Some(Self::$variant),)+ _ => None }
            }
        }
    )+ };
}

words! {
    /// How the actuator's air changes its state.
    ProcessKind {
        Isentropic = "isentropic", "No heat passes the wall, with the paper's temperature of the inflowing air.";
        Isothermal = "isothermal", "The air keeps its temperature.";
        Polytropic = "polytropic", "Between the two, with an exponent of its own.";
        EnergyBalance = "energy-balance", "The first law, with the supply's temperature and heat through the wall.";
    }
    /// How a valve joins the actuator to supply and exhaust.
    ValveKind {
        ThreeWay = "three-way", "Joined to the supply when energised and to the exhaust when not.";
        FillHoldExhaust = "fill-hold-exhaust", "A pair of two-way valves that can also close.";
    }
    /// How finely a hose is resolved.
    HoseKind {
        Lumped = "lumped", "A second volume behind a friction loss, and a delay.";
        Distributed = "distributed", "A line of cells with waves; by the event-located engine.";
    }
    /// Whose temperature the air that leaves the actuator has in the flow law.
    ExhaustTemperature {
        Actuator = "actuator", "The actuator's own temperature.";
        Ambient = "ambient", "The temperature of the supply, as the paper writes it.";
    }
    /// What a valve is told to do.
    CommandState {
        Fill = "fill", "Join the actuator to the supply.";
        Hold = "hold", "Close the actuator; not with a three-way valve.";
        Exhaust = "exhaust", "Join the actuator to the exhaust.";
    }
    /// What makes the valve's command.
    CommandKind {
        Pwm = "pwm", "Pulse-width modulation; the pulse starts each period.";
        Fill = "fill", "Joined to the supply all the time.";
        Hold = "hold", "Closed all the time; not with a three-way valve.";
        Exhaust = "exhaust", "Joined to the exhaust all the time.";
        Table = "table", "A list of times and what is commanded from each on.";
    }
    /// What the actuator pulls on.
    LoadKind {
        HangingMass = "hanging-mass", "A mass that hangs from the actuator.";
        ConstantForce = "constant-force", "A mass that a constant force pulls.";
        Isometric = "isometric", "The length is fixed at `initial.length`.";
        PrescribedMotion = "prescribed-motion", "The length is a given function of time: a sinusoid or a table.";
        AntagonisticJoint = "antagonistic-joint", "A joint that this actuator and a second one, `[antagonist]`, turn against each other.";
    }
    /// How the simulation goes through time.
    Engine {
        EventLocated = "event-located", "Adaptive, high order, every switching instant located: the reference.";
        FixedStep = "fixed-step", "Bounded cost per step, valve edges honoured inside the step.";
    }
    /// The formula of the fixed-step engine.
    Method {
        Stable = "stable", "Pressure is stepped so that any step a robot simulator uses is stable.";
        Rk4 = "rk4", "The classical Runge-Kutta formula of order 4, as in the paper.";
    }
    /// How the rows of a sweep are chosen.
    DesignKind {
        Grid = "grid", "Every combination, the last key changing first.";
        Random = "random", "Independent draws.";
        LatinHypercube = "latin-hypercube", "One draw in each of as many equal strata of every key as there are rows.";
        Sobol = "sobol", "The Sobol' sequence with Owen's scrambling: even in many dimensions at once.";
    }
    /// What a sweep records of each row.
    RecordKind {
        Reductions = "reductions", "A few numbers, those of `sweep.reductions`.";
        Samples = "samples", "What holds at `sweep.sample_times`.";
        Trajectories = "trajectories", "What holds at every `run.sample_interval`.";
    }
    /// How the values of a range are spaced.
    Spacing {
        Linear = "linear", "Evenly.";
        Logarithmic = "logarithmic", "Evenly in the logarithm.";
    }
}
