//! The discrete state of an actuator on its load: which formulas hold.

use crate::force::Piece;
#[cfg(feature = "alloc")]
use crate::friction::ThreadContact;
use crate::valve::{FlowZone, Ports};

/// Where the distance between the attachments lies, (10) and (14).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthRegime {
    /// Below the shortest length: the tendon is slack.
    Slack,
    /// Between the limits, or at rest on the lower one.
    Free,
    /// Beyond the longest length: the braid is taut and pulls.
    Taut,
    /// Beyond the longest length, coming back so fast that the taut braid does not pull.
    Rebound,
}

/// How the ends move, which decides the Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sliding {
    /// The ends move apart: friction adds to the tension.
    Lengthening,
    /// The ends move together: friction takes from the tension.
    Shortening,
    /// Friction holds the load at rest.
    Stuck,
    /// The load itself is held at rest; friction is indeterminate and taken as zero.
    Held,
    /// There is no Coulomb friction to decide.
    Frictionless,
}

impl Sliding {
    /// −1, 0 or +1: the factor of the Coulomb term.
    #[inline(always)]
    pub fn direction(self) -> f64 {
        match self {
            Self::Lengthening => 1.0,
            Self::Shortening => -1.0,
            Self::Stuck | Self::Held | Self::Frictionless => 0.0,
        }
    }
}

/// Which formulas hold, as an event log reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// Which flow paths of the valve are open.
    pub ports: Ports,
    /// The piece of the flow law on the open path to the supply.
    pub supply_zone: Option<FlowZone>,
    /// The piece of the flow law on the open path to the atmosphere.
    pub exhaust_zone: Option<FlowZone>,
    /// The piece of a tabulated effectiveness; 0 for the other forms.
    pub effectiveness_piece: usize,
    /// Whether the gauge pressure presses the threads together, so that there is friction; yes where there is no dry
    /// friction.
    pub pressed: bool,
    /// The piece of a measured force map; none other has any.
    pub force_piece: Piece,
    /// Slack, free or taut.
    pub length_regime: LengthRegime,
    /// The direction of sliding, or sticking.
    pub sliding: Sliding,
    /// Whether the sum of forces is kept at zero because a tendon cannot push.
    pub clamped: bool,
}

impl Mode {
    /// Whether the gas presses the threads together.
    #[cfg(feature = "alloc")]
    pub(crate) fn touch(&self) -> ThreadContact {
        if self.pressed { ThreadContact::Pressed } else { ThreadContact::Apart }
    }
}

/// What happened at an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum EventKind {
    /// A valve poppet moved.
    Valve,
    /// A prescribed motion, or a pressure that is given over time, turned a corner.
    Corner,
    /// The velocity came to zero and friction holds the load.
    Stick,
    /// The velocity came to zero and changed its sign.
    Reversal,
    /// The load broke away from rest.
    BreakAway,
    /// An element of the hysteresis began to slip.
    Slip,
    /// The tendon went slack.
    Slack,
    /// The slack was taken up.
    Tight,
    /// The braid became taut.
    Taut,
    /// The taut braid stopped pulling while it came back.
    Rebound,
    /// The length fell back below its longest.
    TautEnd,
    /// A tendon in series came loose.
    TendonLoose,
    /// A tendon in series pulls again.
    TendonTight,
    /// The tension came to zero: a tendon cannot push.
    TensionZero,
    /// The tension rose from zero.
    TensionBack,
    /// The flow went to another piece of its law (choked, subsonic, near equal pressure, reversed).
    Flow,
    /// The pressure passed a row of a tabulated effectiveness.
    Effectiveness,
    /// The gauge pressure passed zero: friction of the threads begins or ends there.
    Press,
    /// The length or the pressure passed a line of a measured force map; the outer ones are its hull.
    ForceMap,
    /// The flow through the hose became laminar, turbulent, or something between.
    Regime,
    /// The compressor started or stopped.
    Compressor,
    /// The regulator's poppet entered or left its dead band, or the rate of a regulated pressure fell below its limit.
    Regulator,
    /// A set point of a pressure regulator took effect.
    SetPoint,
    /// A driver took a sample and decided.
    Sample,
    /// The angle of a joint passed a row of a table of moment arms.
    MomentArm,
    /// A joint came to a stop, or pressed it again.
    StopReached,
    /// A stop ceased to press while the joint came back.
    StopRebound,
    /// The joint left a stop.
    StopLeft,
}

impl EventKind {
    /// The name in an event log.
    pub fn name(self) -> &'static str {
        match self {
            Self::Valve => "valve",
            Self::Corner => "corner",
            Self::Stick => "stick",
            Self::Reversal => "reversal",
            Self::BreakAway => "break-away",
            Self::Slip => "slip",
            Self::Slack => "slack",
            Self::Tight => "tight",
            Self::Taut => "taut",
            Self::Rebound => "rebound",
            Self::TautEnd => "taut-end",
            Self::TendonLoose => "tendon-loose",
            Self::TendonTight => "tendon-tight",
            Self::TensionZero => "tension-zero",
            Self::TensionBack => "tension-back",
            Self::Flow => "flow",
            Self::Effectiveness => "effectiveness",
            Self::Press => "press",
            Self::ForceMap => "force-map",
            Self::Regime => "regime",
            Self::Compressor => "compressor",
            Self::Regulator => "regulator",
            Self::SetPoint => "set-point",
            Self::Sample => "sample",
            Self::MomentArm => "moment-arm",
            Self::StopReached => "stop",
            Self::StopRebound => "stop-rebound",
            Self::StopLeft => "stop-left",
        }
    }
}

/// Why a mode ends: the name of a guard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// The braid is about to be straight: the thread length is reached.
    ThreadLength,
    /// The distance falls below the shortest length.
    Slack,
    /// The distance rises above the shortest length.
    Tight,
    /// The distance rises above the longest length.
    Taut,
    /// The distance falls below the longest length.
    TautEnd,
    /// The taut braid's force comes down to zero while it rebounds.
    Rebound,
    /// The taut braid's force rises from zero again.
    Retaut,
    /// The velocity comes to zero.
    Rest,
    /// An element of the hysteresis comes to where it slips.
    Slip,
    /// The load exceeds what friction can hold and lengthens the actuator.
    BreakLonger,
    /// The actuator exceeds what friction can hold and shortens.
    BreakShorter,
    /// The stretch of a tendon in series falls to zero.
    TendonLoose,
    /// The stretch of a tendon in series rises from zero.
    TendonTight,
    /// The sum of forces comes down to zero.
    TensionZero,
    /// The sum of forces rises from zero.
    TensionBack,
    /// The pressure leaves the piece of the effectiveness downwards.
    PieceDown,
    /// The pressure leaves the piece of the effectiveness upwards.
    PieceUp,
    /// The gauge pressure falls below zero.
    PressDown,
    /// The gauge pressure rises above zero.
    PressUp,
    /// The length leaves the piece of a force map downwards.
    MapShorter,
    /// The length leaves the piece of a force map upwards.
    MapLonger,
    /// The pressure leaves the piece of a force map downwards.
    MapDown,
    /// The pressure leaves the piece of a force map upwards.
    MapUp,
}
