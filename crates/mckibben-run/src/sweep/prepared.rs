//! A sweep that is ready to be done: by the threads of this process, or part by part wherever there is a processor.
//!
//! A part follows from the sweep and from the step of its fixed-step engine alone, so every machine that computes it gives the same
//! bytes.

use super::counts::SweepCounts;
use super::destination::{self, Destination, Place};
use super::folder::{Folder, Manifest};
use super::plan::{Plan, Unit};
use super::rows::{self, Check, UNCHECKED};
use super::schedule;
use super::step::Choice;
use super::table::{self, LAYOUT};
use super::warned::WarnedRuns;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::record;
use crate::table::{Column, Writer};
use mckibben_scenario::{Document, Engine, StatisticsOver, Sweep};
use std::path::Path;

/// A sweep with its plan, its columns, and what is said of it in each of its files.
#[derive(Clone, Debug)]
pub struct Prepared {
    sweep: Sweep,
    plan: Plan,
    columns: Vec<Column>,
    notes: Vec<(String, String)>,
}

impl Prepared {
    /// The sweep of a document in which some values were set, given as `KEY=VALUE`; none where it has no section `[sweep]`.
    ///
    /// One of one actuator or of a joint that names no engine takes fixed steps, save over the orbit, and under a controller for which no
    /// step is given.
    ///
    /// # Errors
    /// [`Failure::input`] for what the document says and cannot be.
    pub fn of(document: &Document, set: &[String]) -> Result<Option<Self>, Failure> {
        let (mut document, mut set) = (document.clone(), set.to_vec());
        if !document.contains("run.engine") && !document.is_plant() {
            let engine = engine_by_default(&document)?.name();
            document.set_text("run.engine", &format!("\"{engine}\""))?;
            set.push(format!("run.engine={engine}"));
        }
        let Some(sweep) = document.sweep()? else { return Ok(None) };
        let plan = Plan { rows: sweep.rows(), part_rows: sweep.part_rows().max(1) };
        let columns = table::columns(&sweep);
        let notes = notes(&document, &set, &sweep);
        Ok(Some(Self { sweep, plan, columns, notes }))
    }

    /// What varies, and what is recorded.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// Its rows in parts.
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// The columns of its table.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Makes its folder, or takes up one that holds the same sweep.
    ///
    /// # Errors
    /// As [`Folder::open`].
    pub fn folder(&self, path: &Path) -> Result<Folder, Failure> {
        Folder::open(path, &Manifest::new(&self.plan, &self.sweep.fingerprint_text()))
    }

    /// Runs the rows of parts on `jobs` threads, and writes and counts them.
    ///
    /// # Errors
    /// [`Failure::output`] when they cannot be written.
    pub fn simulate(
        &self,
        choice: Option<&Choice>,
        parts: Vec<u64>,
        jobs: usize,
        place: Place,
        totals: &mut SweepCounts,
    ) -> Result<(), Failure> {
        self.simulate_checked(UNCHECKED, choice, parts, jobs, place, totals)
    }

    /// Does as [`Prepared::simulate`], until `check` ends the runs under way. Parts that are written by then stay.
    ///
    /// # Errors
    /// [`Failure::output`] when parts cannot be written, and what `check` returns.
    pub fn simulate_checked(
        &self,
        check: &Check<'_>,
        choice: Option<&Choice>,
        parts: Vec<u64>,
        jobs: usize,
        place: Place,
        totals: &mut SweepCounts,
    ) -> Result<(), Failure> {
        let mut destination = Destination::new(&self.sweep, self.plan, self.notes_with(choice), place);
        let rows_of = |part: &u64| self.plan.rows_of(*part).end - self.plan.rows_of(*part).start;
        let total = parts.iter().map(rows_of).sum();
        let progress = Progress::counted("runs", total);
        let mut done = 0;
        let units = self.plan.units(parts, self.unit(total, jobs));
        let work = |unit: &Unit| rows::simulate_rows(&self.sweep, choice, unit.rows.clone(), check);
        let written = schedule::in_order(jobs, units, work, |unit, simulated| {
            let simulated = simulated.map_err(Failure::from)?;
            destination.write(&unit, &simulated)?;
            let mut warned = WarnedRuns::default();
            for (row, outcome, warnings) in simulated.rows(unit.rows.clone()) {
                totals.see(row, outcome);
                warned.see(row, warnings);
            }
            totals.warn(&warned);
            done += simulated.outcomes.len() as u64;
            progress.at(done);
            Ok(())
        });
        match written {
            Ok(()) => destination.finish(),
            Err(failure) => Err(destination.failed(failure)),
        }
    }

    /// The bytes of a part's Parquet file, computed on one thread.
    ///
    /// # Errors
    /// As [`Prepared::simulate`], and for a part that the sweep does not have.
    pub fn part(&self, choice: Option<&Choice>, part: u64) -> Result<Vec<u8>, Failure> {
        self.plan.check_part(part)?;
        let rows = self.plan.rows_of(part);
        let mut writer = Writer::parquet(self.columns.clone(), LAYOUT, Path::new("memory"), Vec::new())?;
        let (mut failed, mut warned) = (0, WarnedRuns::default());
        let units = self.plan.units(vec![part], self.unit(rows.end - rows.start, 1));
        let work = |unit: &Unit| rows::simulate_rows(&self.sweep, choice, unit.rows.clone(), UNCHECKED);
        schedule::in_order(1, units, work, |unit, simulated| {
            let simulated = simulated.map_err(Failure::from)?;
            for (row, outcome, warnings) in simulated.rows(unit.rows) {
                failed += table::write(&self.sweep, row, (outcome, warnings), &mut writer)?;
                warned.see(row, warnings);
            }
            Ok(())
        })?;
        writer.finish(&destination::about(&self.notes_with(choice), part, rows, (failed, &warned)))
    }

    /// Rows of a unit of work: few, so that the threads end together, but as many as are stepped side by side.
    fn unit(&self, rows: u64, jobs: usize) -> u64 {
        const SHARE: u64 = 8;
        let sweep = &self.sweep;
        let least = if sweep.uses_engine(Engine::EventLocated) { 1 } else { rows::side_by_side() as u64 };
        (rows / (SHARE * jobs as u64)).clamp(least, 128) / least * least
    }

    /// What is said in each file, the step too.
    fn notes_with(&self, choice: Option<&Choice>) -> Vec<(String, String)> {
        let step = choice.map(|Choice { step, accuracy, reached, unreached }| {
            let json = serde_json::json!({
                "longest_s": step, "accuracy": accuracy, "enough_for_runs": reached, "too_long_for_runs": unreached
            });
            ("mckibben.step".to_owned(), json.to_string())
        });
        self.notes.iter().cloned().chain(step).collect()
    }
}

fn engine_by_default(document: &Document) -> Result<Engine, Failure> {
    let mut stepped = document.clone();
    stepped.set_text("run.engine", &format!("\"{}\"", Engine::FixedStep.name()))?;
    // A sweep with mistakes is read again, and reports them.
    // A controller may magnify the error of a step: the step is chosen for that error where it is recorded. Orbits are located
    // individually by steps of the event-located engine, so that no common step has to be chosen for them.
    let is_located = |of: Sweep| of.over() == StatisticsOver::Orbit || (of.has_controllers() && !of.gives_step());
    let is_located = stepped.sweep().is_ok_and(|sweep| sweep.is_some_and(is_located));
    Ok(if is_located { Engine::EventLocated } else { Engine::FixedStep })
}

/// What is said of the sweep in each of its files.
fn notes(document: &Document, set: &[String], sweep: &Sweep) -> Vec<(String, String)> {
    let of_sweep = [
        ("mckibben.sweep", sweep.fingerprint_text()),
        ("mckibben.design", sweep.design().name().to_owned()),
        ("mckibben.seed", sweep.seed().to_string()),
    ];
    let of_sweep = of_sweep.map(|(key, value)| (key.to_owned(), value));
    record::notes(document, set).into_iter().chain(of_sweep).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settle::PULSED;
    use mckibben::Error;

    /// Statistics over the orbit are those of a run that settles there alone, of a column that jumps too; as much air leaves as comes.
    #[test]
    fn means_over_orbits_are_those_of_single_runs() {
        for (more, names) in [("", ["mass_flow", "air_mass"]), ("[actuators.a]\n", ["a.mass_flow", "a.air_mass"])] {
            let reductions: Vec<String> = names.iter().map(|of| format!("\"{of}.mean\", \"{of}.ripple\"")).collect();
            let sweep = format!("[sweep]\nover = \"orbit\"\nreductions = [{}]\n", reductions.join(", "));
            let vary = "[sweep.vary]\n\"command.duty\" = [0.5]\n";
            let document = Document::parse(&format!("{PULSED}{more}{sweep}{vary}"), "pulsed.toml").expect("a document");
            let prepared = Prepared::of(&document, &[]).expect("a valid sweep").expect("a sweep");
            let mut totals = SweepCounts::new(prepared.sweep(), false);
            prepared.simulate(None, vec![0], 1, Place::Nowhere, &mut totals).expect("done");
            let found: Vec<f64> = totals.ranges().map(|(_, spread)| spread.least).collect();
            let [mean, ripple, mass, mass_ripple] = found[..] else { panic!("{found:?}") };
            assert!(ripple > 1e-4 && mean.abs() < 2e-5 * ripple, "{found:?}");
            let document = Document::parse(&format!("{PULSED}{more}"), "pulsed.toml").expect("a document");
            let settled = crate::run::Ready::of(&document).unwrap().settle(&document, &mut |_| Ok(())).unwrap();
            let row = settled.rows.iter().find(|row| row.name == names[1]).expect("a column");
            let near = |one: f64, other: f64| assert!((one - other).abs() < 1e-4 * other, "{one} {other}");
            near(mass, row.mean);
            near(mass_ripple, row.ripple());
        }
    }

    /// Runs of very many steps, of which each engine takes a few until the check ends them.
    #[test]
    fn a_check_ends_the_runs_under_way() {
        for engine in ["engine = \"fixed-step\"\nstep = \"1 ms\"", "engine = \"event-located\""] {
            let text = format!(
                "[load]\nkind = \"hanging-mass\"\n[initial]\ngauge_pressure = \"60 psi\"\nlength = \"85 mm\"\n[run]\n\
                 duration = \"1000 s\"\nsample_interval = \"1 s\"\n{engine}\n[sweep]\nreductions = [\"length.final\"]\n\
                 vary.load.mass = [\"4 lb\", \"8 lb\"]\n"
            );
            let document = Document::parse(&text, "long.toml").expect("a document");
            let prepared = Prepared::of(&document, &[]).expect("a valid sweep").expect("a sweep");
            let check = |time: f64| if time > 0.5 { Err(Error::Interrupted { time }) } else { Ok(()) };
            let mut totals = SweepCounts::new(prepared.sweep(), false);
            let ended = prepared.simulate_checked(&check, None, vec![0], 2, Place::Nowhere, &mut totals);
            let failure = ended.expect_err("the check ends the runs");
            assert!(failure.to_string().contains("interrupted at t = "), "{engine}: {failure}");
        }
    }
}
