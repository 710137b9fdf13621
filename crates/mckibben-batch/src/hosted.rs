//! How rows in lanes go where a host moves their ends, and what they answer.

use crate::block::{Block, Workspace, write};
use crate::motion;
use crate::row::{BlockRows, Change};
use crate::span::Span;
use crate::wide::Wide;
use mckibben::scalar::Mask;
use mckibben::{Error, Response};

impl<W: Wide> Block<W> {
    /// Sends the ends off that a host moves: where a row keeps its mode in its lane, and else by the row.
    #[inline(always)]
    pub(crate) fn set_off(
        &mut self,
        Workspace { at, .. }: &mut Workspace<W>,
        rows: &mut BlockRows<'_>,
        distances: &[f64],
        span: &Span<'_>,
    ) {
        let (zero, one, length) = (W::zero(), W::one(), span.until() - span.from);
        self.update();
        let Self { system, hosts, firsts, state, end, held, lives, behind, origin, .. } = self;
        end.copy_from_slice(state);
        for (k, ([position, rate], goal)) in hosts.places.iter().zip(&mut hosts.goals).enumerate() {
            for (lane, first) in firsts.iter().enumerate() {
                goal.put(lane, distances[first + k]);
            }
            end[*rate] = (*goal - state[*position]) / W::constant(length);
        }
        let keep = hosts.turn(system, (W::constant(span.from - *origin), end), held, at) & zero.lt(*lives);
        for [_, rate] in &hosts.places {
            state[*rate] = W::select(keep, end[*rate], state[*rate]);
        }
        hosts.enter_turns(keep, held);
        *behind = W::select(keep, one, *behind);
        // What is entered is what the masks have, and of the other rows what they had.
        self.is_changed = true;
        let alone = zero.lt(self.lives) & !keep;
        if alone.any() {
            self.set_off_alone(rows, W::select(alone, one, zero), (distances, length));
        }
    }

    /// Sends the ends of those rows off that do not keep their mode.
    #[inline(never)]
    fn set_off_alone(&mut self, rows: &mut BlockRows<'_>, alone: W, (distances, length): (&[f64], f64)) {
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            if alone.lane(lane) <= 0.0 {
                continue;
            }
            self.bring(lane, row, desk);
            match row.set_off(desk, length, distances) {
                Ok(()) => {
                    write(row.steps.state(), lane, &mut self.state);
                    self.enter(lane, row);
                }
                Err(fault) => self.stop(lane, row, fault),
            }
        }
        self.sum_up(list);
    }

    /// Puts the ends that a host moves exactly to where they have come.
    #[inline(always)]
    pub(crate) fn arrive(&mut self) {
        for ([position, _], goal) in self.hosts.places.iter().zip(&self.hosts.goals) {
            self.state[*position] = *goal;
        }
        self.behind = W::one();
    }

    /// What the actuators of all rows answer with their ends at these distances and rates.
    #[inline(always)]
    pub(crate) fn answer(
        &mut self,
        Workspace { at, .. }: &mut Workspace<W>,
        rows: &mut BlockRows<'_>,
        ends: [&[f64]; 2],
        responses: &mut [Response],
    ) -> Result<(), Error> {
        let (zero, one) = (W::zero(), W::one());
        self.update();
        let Self { system, hosts, firsts, state, end, held, .. } = self;
        let time = W::constant(self.time - self.origin);
        end.copy_from_slice(state);
        for (k, places) in hosts.places.iter().enumerate() {
            for (lane, first) in firsts.iter().enumerate() {
                end[places[0]].put(lane, ends[0][first + k]);
                end[places[1]].put(lane, ends[1][first + k]);
            }
        }
        let in_lanes = hosts.can_answer(system, (time, end), held, at) & zero.lt(self.goes);
        // The masks have the ways of these rates.
        self.is_changed = true;
        let mut come = W::select(in_lanes, one, zero);
        for (lane, row) in rows.list.iter().enumerate() {
            // What has changed since, its lane does not know.
            if row.change == Change::All {
                come.put(lane, 0.0);
            }
        }
        if zero.lt(come).any() {
            let count = system.wires.len();
            system.evaluate(time, end, held, at);
            for i in 0..count {
                let answers = motion::answer(system, i, end, held, at);
                for lane in 0..firsts.len() {
                    if come.lane(lane) > 0.0 {
                        responses[count * lane + i] = motion::of_lane(&answers, lane);
                    }
                }
            }
        }
        self.answer_alone(rows, come, ends, responses)
    }

    /// What those rows answer that have not been computed in lanes.
    #[inline(never)]
    fn answer_alone(
        &mut self,
        rows: &mut BlockRows<'_>,
        come: W,
        ends: [&[f64]; 2],
        responses: &mut [Response],
    ) -> Result<(), Error> {
        let count = self.system.wires.len();
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            if row.is_alive() && come.lane(lane) <= 0.0 {
                self.bring(lane, row, desk);
                row.compute_at(desk, ends, &mut responses[count * lane..count * (lane + 1)])?;
            }
        }
        Ok(())
    }
}
