//! The printed summary of a sweep.

use super::{SweepArguments, Target};
use crate::describe;
use crate::terminal::{self, FAINT, HEADING, NOTABLE, styled};
use mckibben_run::quantities::{count, counted, digits, given, quantity};
use mckibben_run::sweep::counts::SweepCounts;
use mckibben_run::sweep::plan::{Plan, Shard};
use mckibben_run::sweep::step::Choice;
use mckibben_run::sweep::warned::Warned;
use mckibben_run::text::{Alignment, Side};
use mckibben_run::units::units;
use mckibben_scenario::Sweep;
use std::fmt::Write as _;
use std::time::Duration;

/// The summary.
pub(super) fn summary(
    arguments: &SweepArguments,
    plan: &Plan,
    (sweep, choice): (&Sweep, Option<&Choice>),
    totals: &SweepCounts,
    (kept, written, elapsed): (u64, u64, Duration),
) -> String {
    let seconds = elapsed.as_secs_f64();
    let mut text =
        format!("{}  {}\n", styled(HEADING, arguments.file.display()), styled(FAINT, counted(plan.rows, "run")));
    let line = |name: &str, what: &str| terminal::entry(name, 8, what);
    let varied: Vec<&str> = sweep.axes().iter().map(|axis| axis.path.as_str()).collect();
    text.push_str(&line("varied", &format!("{} ({})", varied.join(", "), sweep.design().name())));
    for of in sweep.left_out() {
        text.push_str(&line("left out", &of.to_string()));
    }
    let first = match sweep.plant(0) {
        Some(first) => first.ok().map(|first| first.run),
        None => sweep.scenario(0).ok().map(|first| first.run),
    };
    if sweep.axes().iter().any(|axis| axis.path == "run.engine") {
        text.push_str(&line("engine", "that of each run: `run.engine` varies"));
    } else if let Some(run) = first {
        text.push_str(&line("engine", &describe::engine(&run)));
    }
    if let Some(choice) = choice {
        text.push_str(&line("step", &step_of(choice)));
    }
    let new = totals.runs() - kept;
    if kept > 0 {
        text.push_str(&line("kept", &format!("{} of parts that were finished before", counted(kept, "run"))));
    }
    let rate = if seconds > 0.0 { digits(new as f64 / seconds) } else { String::new() };
    text.push_str(&line("cost", &format!("{} in {}, {rate} runs/s", counted(new, "run"), quantity(seconds, "s"))));
    if arguments.shard != Shard::WHOLE {
        let share = format!("{}: {} of {}", arguments.shard, count(totals.runs()), counted(plan.rows, "run"));
        text.push_str(&line("shard", &share));
    }
    text.push_str(&ranges(totals));
    text.push_str(&failures(totals));
    text.push_str(&warnings(totals));
    let mut files = String::new();
    if let Some(path) = &arguments.output {
        let is_folder = matches!(Target::of(arguments), Ok(Target::Folder(_)));
        let parts = counted(written, "part");
        if !is_folder {
            files.push_str(&terminal::wrote(path, ""));
        } else if written > 0 {
            files.push_str(&terminal::wrote(path, &format!(", {parts}")));
        }
    }
    if let Some(path) = &arguments.plot {
        files.push_str(&terminal::wrote(path, ""));
    }
    if !files.is_empty() {
        text.push('\n');
    }
    text + &files
}

/// The longest step, and on what ground it was taken.
fn step_of(Choice { step, accuracy, reached, unreached }: &Choice) -> String {
    let tried = match reached.len() {
        1 => "1 run needs".to_owned(),
        many => format!("{many} runs spread over the sweep need"),
    };
    let beside = match unreached.as_slice() {
        [] => String::new(),
        rows => {
            let rows: Vec<String> = rows.iter().map(u64::to_string).collect();
            format!("; not reached with any step in run {}", rows.join(", "))
        }
    };
    format!("at most {}, the least that {tried} for an accuracy of {accuracy:e}{beside}", given(*step, "s"))
}

/// The range of each reduction as a table.
fn ranges(totals: &SweepCounts) -> String {
    let known = || totals.ranges();
    if known().next().is_none() {
        return String::new();
    }
    // Room for eight characters of digits and prefix before the longest unit.
    let width = known().map(|(reduction, _)| 8 + reduction.unit.len()).max().unwrap_or(0).max(12);
    let mut rows = vec![["", "least", "mean", "greatest", ""].map(str::to_owned)];
    for (reduction, spread) in known() {
        let values = [spread.least, spread.sum / spread.runs as f64, spread.greatest];
        let [least, mean, greatest] = values.map(formatter(&reduction.name, &values, reduction.unit));
        let missing = totals.runs() - totals.failed() - spread.runs;
        let note = if missing > 0 { format!("none in {}", counted(missing, "run")) } else { String::new() };
        rows.push([reduction.name.clone(), least, mean, greatest, note]);
    }
    let right = (Side::Right, width);
    let columns =
        Alignment::new([(Side::Left, 0), right, right, right, (Side::Left, 0)]).fit(rows.iter().map(|row| &row[..]));
    let mut text = format!("\n{}\n", styled(HEADING, "Reductions"));
    for (place, [name, least, mean, greatest, note]) in rows.into_iter().enumerate() {
        let note = if note.is_empty() { note } else { styled(FAINT, note) };
        let line = columns.line(&[name, least, mean, greatest, note]);
        let line = if place == 0 { styled(FAINT, line) } else { line };
        put(&mut text, format_args!("  {line}\n"));
    }
    text
}

/// The runs that failed, with the first reasons.
fn failures(totals: &SweepCounts) -> String {
    if totals.failed() == 0 {
        return String::new();
    }
    let heading = format!("{} of {} failed", count(totals.failed()), counted(totals.runs(), "run"));
    let mut text = format!("\n{}\n", styled(NOTABLE, heading));
    for (row, reason) in totals.reasons() {
        let reason = reason.split_whitespace().collect::<Vec<_>>().join(" ");
        put(&mut text, format_args!("{}\n", terminal::wrap(&format!("run {row}: {reason}"), "  ")));
    }
    if totals.reasons().count() as u64 != totals.failed() {
        text.push_str("  the column `error` has the others\n");
    }
    text
}

/// The warnings of the runs, each code with its first run.
fn warnings(totals: &SweepCounts) -> String {
    let mut text = String::new();
    for (code, Warned { runs, first, text: warning }) in totals.warned().iter() {
        let of = if *runs == 1 { "1 run".to_owned() } else { format!("{} runs, the first", count(*runs)) };
        put(&mut text, format_args!("{}\n", terminal::wrap(&format!("{code}: {of} {first}: {warning}"), "  ")));
    }
    if text.is_empty() { text } else { format!("\n{}\n{text}", styled(NOTABLE, "Warnings")) }
}

/// Values of a reduction in one unit.
fn formatter(name: &str, values: &[f64], unit: &str) -> impl Fn(f64) -> String + use<> {
    let units = units().for_name(name);
    // What has no unit takes no prefix.
    let shown = if unit.is_empty() { units.shown(unit, 0.0) } else { units.common(unit, values.iter().copied()) };
    move |value| shown.with(&digits(shown.number(value)))
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(arguments);
}
