//! The symbol of each kind of event: one table for every figure of the project.
//!
//! Opposites share a shape, filled where something begins to hold and hollow where it ends: stick and break-away, taut and free
//! again, slack taken up and slack.

use mckibben::simulation::EventKind;
use mckibben_plot::{Marks, Symbol};

/// Every kind of event with its symbol, and whether that is filled; those of the motion first, then those of the air, then those
/// of the commands.
pub(crate) const SYMBOLS: [(EventKind, Symbol, bool); 28] = [
    (EventKind::Stick, Symbol::Circle, true),
    (EventKind::BreakAway, Symbol::Circle, false),
    (EventKind::Slack, Symbol::TriangleDown, false),
    (EventKind::Tight, Symbol::TriangleDown, true),
    (EventKind::Taut, Symbol::Square, true),
    (EventKind::TautEnd, Symbol::Square, false),
    (EventKind::Rebound, Symbol::SquareCross, false),
    (EventKind::StopReached, Symbol::TriangleRight, true),
    (EventKind::StopLeft, Symbol::TriangleRight, false),
    (EventKind::StopRebound, Symbol::TriangleLeft, false),
    (EventKind::TendonLoose, Symbol::Hourglass, false),
    (EventKind::TendonTight, Symbol::Hourglass, true),
    (EventKind::TensionZero, Symbol::Triangle, false),
    (EventKind::TensionBack, Symbol::Triangle, true),
    (EventKind::Reversal, Symbol::Diamond, false),
    (EventKind::Slip, Symbol::Diamond, true),
    (EventKind::Corner, Symbol::Plus, false),
    (EventKind::MomentArm, Symbol::ChevronLeft, false),
    (EventKind::ForceMap, Symbol::DiamondPlus, false),
    (EventKind::Press, Symbol::CircleCross, false),
    (EventKind::Effectiveness, Symbol::CirclePlus, false),
    (EventKind::Flow, Symbol::Cross, false),
    (EventKind::Regime, Symbol::Bowtie, false),
    (EventKind::Compressor, Symbol::Bowtie, true),
    (EventKind::Regulator, Symbol::TriangleLeft, true),
    (EventKind::SetPoint, Symbol::Star, false),
    (EventKind::Sample, Symbol::ChevronRight, false),
    (EventKind::Valve, Symbol::ChevronUp, false),
];

/// The symbol of a kind of event, and whether it is filled. A kind that this table does not know yet has the last there is.
pub(crate) fn of(kind: EventKind) -> (Symbol, bool) {
    let found = SYMBOLS.iter().find(|(known, ..)| *known == kind);
    found.map_or((Symbol::ChevronDown, false), |(_, symbol, filled)| (*symbol, *filled))
}

/// Marks of a kind of event at points.
pub(crate) fn marks(kind: EventKind, label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Marks {
    let (symbol, filled) = of(kind);
    Marks { filled, ..Marks::at(label, symbol, x, y) }
}

/// Marks of a valve that opens, or closes.
pub(crate) fn valve(opens: bool, label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Marks {
    Marks::at(label, if opens { of(EventKind::Valve).0 } else { Symbol::ChevronDown }, x, y)
}

/// What an event is of: it decides on which curve its mark stands.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Side {
    /// What moves.
    Motion,
    /// The air.
    Air,
}

/// What a kind of event is of.
pub(crate) fn side(kind: EventKind) -> Side {
    match kind {
        EventKind::Flow
        | EventKind::Effectiveness
        | EventKind::Press
        | EventKind::Regime
        | EventKind::Compressor
        | EventKind::Regulator
        | EventKind::SetPoint
        | EventKind::Valve => Side::Air,
        _ => Side::Motion,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_kinds_share_a_symbol_and_none_has_that_of_a_closing_valve() {
        for (index, (kind, symbol, filled)) in SYMBOLS.iter().enumerate() {
            assert_ne!(*symbol, Symbol::ChevronDown, "{kind:?}");
            for (other, its, its_filled) in &SYMBOLS[index + 1..] {
                assert_ne!(kind, other);
                assert!((symbol, filled) != (its, its_filled), "{kind:?} and {other:?}");
            }
        }
    }
}
