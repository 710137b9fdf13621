//! The instants that are known beforehand: a seat moves or arrives, a regulated pressure takes another
//! course, or a motion or a pressure that is given turns a corner. Both engines and the batches ask here.

use super::pressure_course::PressureCourse;
use super::rig::Actuation;
use crate::load::{Line, Motion};
#[cfg(feature = "alloc")]
use crate::numbered::Row;
use crate::scalar::Real;
use crate::valve::{Openings, Ports, RegulatorClock, SeatClock, SpoolClock, is_due};
#[cfg(feature = "alloc")]
use crate::valve::{Request, Solenoid};

/// Where the instants of a rig come from: what drives its valve, and the corners of a motion or a pressure that is given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timetable<'a, S> {
    pub(crate) actuation: Option<&'a Actuation<S>>,
    pub(crate) motion: Option<&'a Motion<S>>,
    pub(crate) pressure: Option<&'a PressureCourse<S>>,
}

/// How far along its timetable a rig is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress<S> {
    clock: SeatClock<S>,
    spool: SpoolClock<S>,
    /// How many instants of the spool have been passed.
    spool_passed: u64,
    /// Of a pressure regulator whose pressure is a known function of time and no state.
    regulator: Option<RegulatorClock<S>>,
    pub(crate) corners_passed: usize,
    /// Rows of a pressure that is given.
    pub(crate) rows_passed: usize,
}

impl<S: Real> Progress<S> {
    /// Before the first instant.
    pub(crate) fn none() -> Self {
        let (clock, spool) = (SeatClock::released(), SpoolClock::resting());
        Self { clock, spool, spool_passed: 0, regulator: None, corners_passed: 0, rows_passed: 0 }
    }

    /// The same with the clock of a pressure regulator.
    pub(crate) fn regulated(self, regulator: Option<RegulatorClock<S>>) -> Self {
        Self { regulator, ..self }
    }

    /// A number that differs once the openings are another function of time.
    #[cfg(feature = "alloc")]
    pub(crate) fn openings_counted(&self) -> u64 {
        self.clock.strokes_counted() + self.spool_passed
    }

    /// Leaves of a command what has not been passed up to `time` and comes before `before`, both in s.
    #[cfg(feature = "alloc")]
    pub(crate) fn settle(&mut self, actuation: &mut Actuation<S>, time: S, before: S) {
        let Actuation { solenoid, command } = actuation;
        let passed = match (solenoid.spool(), solenoid.regulator(), &mut self.regulator) {
            (Some(_), ..) => self.spool.passed(),
            (None, Some(_), Some(clock)) => clock.passed(),
            (None, ..) => self.clock.passed(),
        };
        command.keep(core::mem::take(passed), before);
        if solenoid.has_seats() {
            // Coils that have been driven without a seat that moved.
            self.clock.advance(time, solenoid, command);
        }
    }

    /// Drops of a command all that has been passed up to `time` in s; coils that no seat has followed are passed as well.
    #[cfg(feature = "alloc")]
    pub(crate) fn forget_passed(&mut self, actuation: &mut Actuation<S>, time: S) {
        let Actuation { solenoid, command } = actuation;
        if solenoid.has_seats() && self.clock.next_motion(solenoid, command, time).is_none() {
            self.clock.advance(time, solenoid, command);
        }
        let passed = if solenoid.spool().is_some() { self.spool.passed() } else { self.clock.passed() };
        command.keep(core::mem::take(passed), S::constant(f64::INFINITY));
    }

    /// Something is asked of a valve at `time` in s beside its command.
    #[cfg(feature = "alloc")]
    pub(crate) fn ask(&mut self, time: S, solenoid: &Solenoid<S>, request: Request) {
        self.clock.ask(time, solenoid, request);
    }
}

#[cfg(feature = "alloc")]
impl Progress<f64> {
    /// The seats as numbers in a row: what progresses where there is neither a spool nor a pressure regulator in their place,
    /// and neither motion nor pressure is given.
    pub(super) fn each_number_of_seats(&mut self, row: &mut impl Row) {
        self.clock.each_number(row);
    }

    /// Whether something of a command has been passed and is still in it.
    pub(crate) fn has_passed(&mut self) -> bool {
        *self.clock.passed() > 0 || *self.spool.passed() > 0
    }

    /// As numbers in a row: what progresses for a valve of a network, where the pressure that a regulator gives is a state.
    pub(crate) fn each_number_of_valve(&mut self, row: &mut impl Row) {
        self.clock.each_number(row);
        self.spool.each_number(row);
        row.count(&mut self.spool_passed);
    }
}

impl<S: Real> Timetable<'_, S> {
    /// The next instant in s, up to and with `until`, at which a seat moves or arrives, a regulated pressure takes another
    /// course, or a motion or a pressure that is given turns a corner.
    pub(crate) fn next(&self, progress: &Progress<S>, until: S) -> Option<S> {
        let seat = self.actuation.and_then(|Actuation { solenoid, command }| {
            match (solenoid.spool(), solenoid.regulator(), &progress.regulator) {
                (None, Some(_), Some(clock)) => clock.next(solenoid, command, until),
                (None, ..) => progress.clock.next_motion(solenoid, command, until),
                (Some(_), ..) => progress.spool.next(solenoid, command, until),
            }
        });
        let corner = self.corner(progress.corners_passed).filter(|corner| is_due(*corner, until));
        let row = self.row(progress.rows_passed).filter(|row| is_due(*row, until));
        [seat, corner, row].into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// Passes everything up to and with `time` (s); which passages are open then.
    pub(crate) fn pass(&self, progress: &mut Progress<S>, time: S) -> Ports {
        while self.corner(progress.corners_passed).is_some_and(|corner| is_due(corner, time)) {
            progress.corners_passed += 1;
        }
        while self.pass_row(progress, time) {}
        self.pass_seats(progress, time)
    }

    /// Passes a row of a pressure that is given, if it is due up to and with `time` (s); whether it was.
    pub(crate) fn pass_row(&self, progress: &mut Progress<S>, time: S) -> bool {
        let due = self.row(progress.rows_passed).is_some_and(|row| is_due(row, time));
        progress.rows_passed += usize::from(due);
        due
    }

    /// Passes what moves seats up to and with `time` (s), and no corner; which passages are open then.
    pub(crate) fn pass_seats(&self, progress: &mut Progress<S>, time: S) -> Ports {
        let Some(drive) = self.actuation else { return Ports::CLOSED };
        let Actuation { solenoid, command } = drive;
        if let Some(spool) = solenoid.spool() {
            progress.spool_passed += progress.spool.advance(time, spool, solenoid, command);
            return progress.spool.ports(spool);
        }
        if let (Some(regulator), Some(clock)) = (solenoid.regulator(), &mut progress.regulator) {
            clock.advance(time, regulator, solenoid, command);
        }
        progress.clock.advance(time, solenoid, command);
        progress.clock.ports(solenoid)
    }

    /// How far the passages are open and to what, until the next instant.
    pub(crate) fn openings(&self, progress: &Progress<S>) -> Openings<S> {
        let Some(Actuation { solenoid, .. }) = self.actuation else { return Openings::Whole };
        match (solenoid.spool(), solenoid.regulator(), &progress.regulator) {
            (None, Some(regulator), Some(clock)) => clock.openings(regulator),
            (None, ..) => progress.clock.openings(solenoid),
            (Some(spool), ..) => progress.spool.openings(spool),
        }
    }

    /// The straight line that a prescribed motion is on.
    pub(crate) fn line(&self, progress: &Progress<S>) -> Line<S> {
        self.motion.map_or(Line::resting(S::zero()), |motion| motion.line(progress.corners_passed))
    }

    fn corner(&self, index: usize) -> Option<S> {
        self.motion?.corner(index)
    }

    fn row(&self, index: usize) -> Option<S> {
        self.pressure?.row(index)
    }
}
