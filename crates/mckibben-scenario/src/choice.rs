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
        Polytropic = "polytropic", "Between the two, with a given exponent.";
        EnergyBalance = "energy-balance", "The first law, with the supply's temperature and heat through the wall.";
    }
    /// What the actuators of a plant move.
    MechanismKind {
        Mass = "mass", "A mass in translation, which all its actuators pull the same way.";
        Chain = "chain", "Revolute joints in a planar chain of segments.";
        Prescribed = "prescribed", "A distance between the attachments that is given over time.";
        Fixed = "fixed", "A distance between the attachments that stays.";
    }
    /// What a supply is fed through.
    InletKind {
        Open = "open", "An orifice that lets air through both ways.";
        Check = "check-valve", "A check valve: air comes in and does not go back.";
    }
    /// Where a pressure that is given over time stands.
    PressurePlace {
        Muscle = "muscle", "In the actuator.";
        Hose = "hose", "At the end of the hose that a valve would open into, where a sensor at the valve reads it.";
    }
    /// Where friction with a memory starts.
    FrictionStart {
        Relaxed = "relaxed", "The hysteresis adds nothing.";
        Loading = "loading", "As after a long way of lengthening: all of the hysteresis adds to the tension.";
        Unloading = "unloading", "As after a long way of shortening: all of the hysteresis takes from the tension.";
    }
    /// The output of a five-way valve.
    ValveOutput {
        A = "a", "The output that the command fills.";
        B = "b", "The other, which is filled where the command exhausts.";
    }
    /// The law of hysteresis.
    HysteresisLaw {
        MaxwellSlip = "maxwell-slip", "Elastic elements that slip: the stop operators of Prandtl and Ishlinskii.";
        BoucWen = "bouc-wen", "A loop with rounded corners, by Bouc and Wen with exponent one; gamma = 0 is Dahl's law.";
        LuGre = "lugre", "Bristles whose friction falls with velocity and whose motion is damped.";
    }
    /// The law of static force.
    ForceLaw {
        IdealBraid = "ideal-braid", "Virtual work of the gas on the braid: the paper's law.";
        TonduLopez = "tondu-lopez", "The ideal braid with a factor on the contraction for the taper of the ends.";
        Sarosi = "sarosi", "A surface of six coefficients through measured forces.";
        MartensBoblan = "martens-boblan", "The ideal braid in a rubber membrane: fluidic muscles.";
        ExtensibleBraid = "extensible-braid", "The ideal braid of threads that stretch.";
        Bolen = "bolen", "A normalized surface for all muscles of a diameter.";
        Polynomial = "polynomial", "A surface polynomial in contraction and affine in pressure.";
        Map = "map", "A smooth monotone surface through tensions measured on a grid.";
    }
    /// How the bladder's resistance grows with contraction.
    BladderForm {
        Linear = "linear", "In proportion to contraction.";
        Saturating = "saturating", "Up to a largest force.";
        Exponential = "exponential", "Ever more steeply.";
    }
    /// How a valve joins the actuator to supply and exhaust.
    ValveKind {
        TwoWay = "two-way", "Joined to the supply when energised and sealed when not.";
        ThreeWay = "three-way", "Joined to the supply when energised and to the exhaust when not.";
        ThreeWayNormallyOpen = "three-way-normally-open", "Joined to the exhaust when energised and to the supply when not.";
        FiveWay = "five-way", "5/2: fills output A and exhausts B when energised, and the other way round when not.";
        FiveWayClosed = "five-way-closed", "5/3: as 5/2 with a coil for each way; shut when neither is energised.";
        FiveWayExhausted = "five-way-exhausted", "5/3 that exhausts both outputs when neither coil is energised.";
        FiveWayPressurised = "five-way-pressurised", "5/3 that fills both outputs when neither coil is energised.";
        FillHoldExhaust = "fill-hold-exhaust", "A pair of two-way valves that can also close.";
        ProportionalSpool = "proportional-spool", "A spool that follows commanded positions and uncovers each flow path by its share.";
        PressureRegulator = "pressure-regulator", "A proportional pressure regulator: open all the time to a pressure that follows set points.";
    }
    /// How finely a hose is resolved.
    HoseKind {
        Lumped = "lumped", "A second volume behind a friction loss, and a delay.";
        Distributed = "distributed", "A line of cells with waves.";
    }
    /// Whose temperature the air that leaves the actuator has in the flow law.
    ExhaustTemperature {
        Actuator = "actuator", "The actuator's own temperature.";
        Ambient = "ambient", "The temperature of the supply, as the paper writes it.";
    }
    /// The kinds of command to a valve.
    CommandState {
        Fill = "fill", "Join the actuator to the supply.";
        Hold = "hold", "Close the actuator; not with a three-way valve.";
        Exhaust = "exhaust", "Join the actuator to the exhaust; not with a two-way valve.";
    }
    /// What makes the valve's command.
    CommandKind {
        Pwm = "pwm", "Pulse-width modulation; the pulse starts each period.";
        Fill = "fill", "Joined to the supply all the time.";
        Hold = "hold", "Closed all the time; not with a three-way valve.";
        Exhaust = "exhaust", "Joined to the exhaust all the time; not with a two-way valve.";
        Table = "table", "A list of times and what is commanded from each on.";
        SetPoints = "set-points", "A list of times and the gauge pressure from each on, of a pressure regulator.";
        Positions = "positions", "A list of times and the position from each on, of a proportional spool.";
        Controllers = "controllers", "What the controller decides, `[controller]`.";
    }
    /// The law of a controller.
    ControllerKind {
        BangBang = "bang-bang", "Fill or exhaust outside a dead band about the set point.";
        Pid = "pid", "Pulses whose duty cycle is proportional, integral and derivative action on the error.";
        FeedForward = "feed-forward", "Regulates the pressure that the static model needs for a force at a length.";
        AirMass = "air-mass", "Regulates the mass of air that the static model needs for a force at a length.";
    }
    /// What lies between the rows of a set point given as a table.
    SetPointTable {
        Steps = "steps", "Each value from its time on.";
        Lines = "lines", "Straight lines.";
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
    /// What the statistics of a sweep are taken over.
    StatisticsOver {
        Run = "run", "The run, from its start to `run.duration`.";
        Orbit = "orbit", "The periodic orbit or the equilibrium that the run settles to behind its end.";
    }
    /// How the values of a range are spaced.
    Spacing {
        Linear = "linear", "Evenly.";
        Logarithmic = "logarithmic", "Evenly in the logarithm.";
    }
}

impl ValveKind {
    /// Whether it has two outputs in opposition.
    pub fn has_two_outputs(self) -> bool {
        matches!(self, Self::FiveWay | Self::FiveWayClosed | Self::FiveWayExhausted | Self::FiveWayPressurised)
    }

    /// Whether it has a third position, so that a pulse and what lies between pulses are to be chosen.
    pub(crate) fn has_three_positions(self) -> bool {
        self == Self::FillHoldExhaust || (self.has_two_outputs() && self != Self::FiveWay)
    }
}
