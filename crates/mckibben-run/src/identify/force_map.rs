//! A force map to every law of static force: tables, figures and words.

use super::outcome::{Outcome, WARNED};
use super::prediction::Prediction;
use super::{Material, column, gauge_pressures, saturation, units, values};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::quantities::counted;
use crate::report::{Data, Plate, Section, Table};
use mckibben::Actuator;
use mckibben_identify::least_squares::exceeds_scales;
use mckibben_identify::statics::candidates;
use mckibben_identify::statics::effectiveness::{Ratio, ratios};
use mckibben_identify::statics::held_out::{Grouping, HeldOut};
use mckibben_identify::statics::{Candidate, Errors, ForceMap, Point, StaticError, StaticFit, force};
use mckibben_identify::study::{Quantity, Recording};
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Panel, Series, Style};
use mckibben_scenario::Scenario;

/// The figures.
pub(super) const STEMS: [&str; 5] = [LAWS, HELD_OUT, FIT, RESIDUALS, EFFECTIVENESS];
const LAWS: &str = "laws";
const HELD_OUT: &str = "held-out";
const FIT: &str = "fit";
const RESIDUALS: &str = "residuals";
const EFFECTIVENESS: &str = "effectiveness";
/// A reading is astray that is so many robust deviations off the best law, and so much of the largest tension.
const ASTRAY: [f64; 2] = [5.0, 0.05];
/// Readings astray that are named.
const NAMED: usize = 3;

/// One candidate with all that is known of it.
struct Judged {
    candidate: Candidate,
    fit: StaticFit,
    held_out: Vec<HeldOut>,
}

impl Judged {
    fn numbers(&self) -> usize {
        self.candidate.unknowns.len()
    }

    /// Whether the data identify all of its parameters.
    fn is_identifiable(&self) -> bool {
        self.fit.fit.unidentifiable.is_empty()
    }

    /// The error by which laws are compared, of which there is but one: the root mean square where the groups were left out one by
    /// one, infinite where the others do not determine the law; in its sample where nothing can be left out.
    fn error(&self, by: Option<Grouping>) -> f64 {
        match by {
            Some(by) => self.held(by).map_or(f64::INFINITY, |errors| errors.root_mean_square),
            None => self.fit.errors.root_mean_square,
        }
    }

    fn held(&self, by: Grouping) -> Option<Errors> {
        self.held_out(by)?.errors()
    }

    fn held_out(&self, by: Grouping) -> Option<&HeldOut> {
        self.held_out.iter().find(|held| held.by == by)
    }
}

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    let base = material.document.scenario()?;
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    for (run, recording) in material.recordings.iter().enumerate() {
        let (of_run, their_lines) = points_of(recording, run, base.air.atmospheric_pressure)?;
        points.extend(of_run);
        lines.extend(their_lines);
    }
    units::check_signs(material, &points, &base)?;
    let place = |point: usize| match (points.get(point), lines.get(point)) {
        (Some(Point { run, .. }), Some(line)) => format!("line {line} of the run `{}`", material.recordings[*run].name),
        _ => format!("point {}", point + 1),
    };
    let map = ForceMap::new(points.clone()).map_err(|error| match error {
        StaticError::BadPoint { point, what } => {
            Failure::input(format!("{} has {what}", place(point - 1)), "mend it, or leave it out")
        }
        other => Failure::input(other.to_string(), "mend the data or the columns"),
    })?;
    saturation::check_map(material, &map, &base)?;
    let mut warnings = material.notes();
    warnings.extend(left_out(&base));
    warnings.extend(units::tensions(material, &map, &base)?);
    possible(&map, &base, &place)?;
    let deviation = deviation(&material.recordings);
    let (mut judged, unfitted) = judged(material, &map, &base, deviation)?;
    warnings.extend(unfitted.iter().map(|(names, why)| format!("{} not fitted: {why}", were(names))));
    let by = criterion(&judged);
    judged.sort_by(|a, b| b.is_identifiable().cmp(&a.is_identifiable()).then(a.error(by).total_cmp(&b.error(by))));
    let Some(best) = best(&judged, by) else {
        let why = unfitted.iter().take(NAMED).map(|(names, why)| format!("; {} not fitted: {why}", were(names)));
        let why: String = why.collect();
        let title = format!("no law could be fitted: give more points, at more lengths and pressures{why}");
        return Err(Failure::stopped(title));
    };
    warnings.extend(values::warnings(&best.fit.fit, &best.candidate.unknowns));
    let typical = best.fit.fit.typical_residual(material.search().loss);
    if let Some(deviation) = deviation
        && exceeds_scales(typical, best.fit.fit.degrees_of_freedom)
    {
        warnings.push(values::understated("tension", "N", [typical * deviation, deviation], true));
    }
    warnings.extend(material.stopped());
    warnings.extend(astray_readings(&map, best, &place));
    let text = format!("# By `mckibben identify`: {}.\n\n{}", best.candidate.name, best.fit.scenario.to_toml());
    let values = values::table(format!("{}: fitted numbers", best.candidate.name), &best.fit.fit);
    let table = comparison(&judged, by);
    let sections = sections(material, &map, &base, &judged, best, &table, &text);
    Ok(Outcome {
        title: format!("Laws of static force for {}", material.name()),
        introduction: introduction(&map, &judged, best, by, deviation),
        sections,
        table,
        values,
        predictions: prediction(&map, best).into_iter().collect(),
        correlations: best.fit.fit.correlations.clone(),
        estimates: best.fit.fit.estimates.clone(),
        warnings,
        scenarios: vec![("scenario.toml".to_owned(), text)],
        ..Outcome::default()
    })
}

/// The rows of a recording that have a pressure, a length and a tension, and their lines.
fn points_of(recording: &Recording, run: usize, atmosphere: f64) -> Result<(Vec<Point>, Vec<usize>), Failure> {
    let sheet = recording.sheets.iter().find(|sheet| sheet.column(Quantity::Tension).is_some());
    let lines = sheet.map(|sheet| sheet.lines.as_slice()).unwrap_or_default();
    let (length, tension) = (column(recording, Quantity::Length)?, column(recording, Quantity::Tension)?);
    let pressures = gauge_pressures(recording, atmosphere)?;
    let rows = pressures.iter().zip(&length.values).zip(tension.values.iter().zip(&tension.slack));
    let points = rows.map(|((gauge_pressure, length), (tension, slack))| Point {
        gauge_pressure: *gauge_pressure,
        length: *length,
        tension: *tension,
        slack: *slack,
        run,
    });
    let complete =
        |point: &Point| [point.gauge_pressure, point.length, point.tension].iter().all(|number| number.is_finite());
    Ok(points.zip(lines.iter().copied()).filter(|(point, _)| complete(point)).unzip())
}

/// The standard deviation of a tension in N, where every run knows the same.
fn deviation(recordings: &[Recording]) -> Option<f64> {
    recordings.first()?.column(Quantity::Tension)?.deviation
}

/// What the scenario says of its muscle and no law of a force map has.
fn left_out(base: &Scenario) -> Option<String> {
    let muscle = &base.actuator;
    let parts = [
        ("`actuator.bladder`", muscle.bladder.is_some()),
        ("`actuator.taper`", muscle.taper.is_some()),
        ("`actuator.wall_thickness`", muscle.wall_thickness > 0.0),
    ];
    let there: Vec<&str> = parts.into_iter().filter(|(_, is_there)| *is_there).map(|(key, _)| key).collect();
    (!there.is_empty()).then(|| {
        format!(
            "a law stands for all that pulls: {} of the scenario takes no part, and the written scenario is without; its volume is that \
             of the braid",
            there.join(", ")
        )
    })
}

/// Refuses lengths at which the muscle of the scenario cannot be, and pressures below vacuum.
fn possible(map: &ForceMap, base: &Scenario, place: &impl Fn(usize) -> String) -> Result<(), Failure> {
    let limit = base.actuator.max_length;
    let points = || map.points().iter().enumerate();
    let longest = points().filter(|(_, point)| !point.slack).max_by(|(_, a), (_, b)| a.length.total_cmp(&b.length));
    if let Some((index, point)) = longest.filter(|(_, point)| point.length > 1.05 * limit) {
        let title = format!(
            "{}: a tension was measured at {:.6} m, but the muscle of the scenario is at its longest at {limit:.6} m",
            place(index),
            point.length
        );
        return Err(Failure::input(
            title,
            "mend the length or its unit in [columns], or actuator.max_length in the scenario",
        ));
    }
    let atmosphere = base.air.atmospheric_pressure;
    match points().find(|(_, point)| point.gauge_pressure + atmosphere <= 0.0) {
        Some((index, point)) => Err(Failure::input(
            format!(
                "{}: the gauge pressure of {} Pa lies below vacuum, with the scenario's atmosphere of {atmosphere} Pa",
                place(index),
                point.gauge_pressure
            ),
            "mend the pressure or its unit in [columns], or air.atmospheric_pressure in the scenario",
        )),
        None => Ok(()),
    }
}

/// The laws that were not fitted for one reason, each in backquotes, with the verb behind them.
fn were(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
    match names.len() {
        1 => format!("{} was", first.concat()),
        count if count <= NAMED => format!("{} were", first.join(", ")),
        count => format!("{} and {} more were", first.join(", "), count - NAMED),
    }
}

/// Laws that were not fitted, and why.
type Unfitted = Vec<(Vec<String>, String)>;

/// Fits every candidate, and each of them without each group; and why others were not fitted.
fn judged(
    material: &Material,
    map: &ForceMap,
    base: &Scenario,
    deviation: Option<f64>,
) -> Result<(Vec<Judged>, Unfitted), Failure> {
    let search = material.search();
    let all = candidates::all(base, map).map_err(|error| Failure::stopped(error.to_string()))?;
    let progress = Progress::begin("fitting", Some(all.len() as u64));
    let (mut judged, mut unfitted): (Vec<Judged>, Unfitted) = (Vec::new(), Vec::new());
    for (candidate, done) in all.into_iter().zip(1..) {
        match candidate.fit(map, deviation, &search) {
            Ok(fit) => {
                let held_out = |by| candidate.held_out(map, by, &fit.fit.values(), deviation, &search);
                let held_out = Grouping::ALL.into_iter().filter_map(held_out).collect();
                judged.push(Judged { candidate, fit, held_out });
            }
            Err(error) => {
                let why = error.to_string();
                match unfitted.iter_mut().find(|(_, of)| *of == why) {
                    Some((names, _)) => names.push(candidate.name),
                    None => unfitted.push((vec![candidate.name], why)),
                }
            }
        }
        progress.at(done);
    }
    Ok((judged, unfitted))
}

/// Readings that are far off the best law, where most are not: likely slips.
fn astray_readings(map: &ForceMap, best: &Judged, place: &impl Fn(usize) -> String) -> Vec<String> {
    let Ok(driven) = best.fit.scenario.driven() else { return Vec::new() };
    let off = |point: &Point| force(&driven.actuator, point) - point.tension;
    let scatter = median_size(map.held().map(off)) / 0.6745;
    let is_far = |off: f64| scatter > 0.0 && off.abs() > ASTRAY[0] * scatter && off.abs() > ASTRAY[1] * map.largest();
    let readings = map.points().iter().enumerate().filter(|(_, point)| !point.slack);
    let mut far: Vec<(usize, f64)> =
        readings.map(|(index, point)| (index, off(point))).filter(|(_, off)| is_far(*off)).collect();
    far.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
    let words = |(index, off): &(usize, f64)| {
        format!(
            "{WARNED}{}: the tension of {:.5} N is {:.5} N off `{}`, about which the others scatter by {scatter:.3} N; look at it, and empty \
             the cell if it is a slip.",
            place(*index),
            map.points()[*index].tension,
            off.abs(),
            best.candidate.name
        )
    };
    far.iter().take(NAMED).map(words).collect()
}

/// The median of sizes; zero of none.
fn median_size(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = numbers.map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
}

/// By what the laws are compared: lengths where three or more were measured, else pressures, else runs.
fn criterion(judged: &[Judged]) -> Option<Grouping> {
    let enough = |by: Grouping, least: usize| {
        judged.iter().flat_map(|of| &of.held_out).any(|held| held.by == by && held.folds.len() >= least)
    };
    [(Grouping::Lengths, 3), (Grouping::Pressures, 3), (Grouping::Runs, 2)]
        .into_iter()
        .find(|(by, least)| enough(*by, *least))
        .map(|(by, _)| by)
}

/// Laws whose error is so many times the least are as good as the one that has it.
const AS_GOOD: f64 = 1.1;

/// The law that errs least, of those whose parameters the data identify.
fn least(judged: &[Judged], by: Option<Grouping>) -> Option<&Judged> {
    judged.iter().filter(|of| of.is_identifiable()).min_by(|a, b| a.error(by).total_cmp(&b.error(by)))
}

/// The law that is taken: of those that err little more than the least, the one with the fewest parameters.
fn best(judged: &[Judged], by: Option<Grouping>) -> Option<&Judged> {
    let most = AS_GOOD * least(judged, by)?.error(by);
    judged.iter().filter(|of| of.is_identifiable() && of.error(by) <= most).min_by_key(|of| of.numbers())
}

/// The law with the least error in its own sample.
fn nearest(judged: &[Judged]) -> Option<&Judged> {
    judged.iter().min_by(|a, b| a.fit.errors.root_mean_square.total_cmp(&b.fit.errors.root_mean_square))
}

fn introduction(
    map: &ForceMap,
    judged: &[Judged],
    best: &Judged,
    by: Option<Grouping>,
    deviation: Option<f64>,
) -> Vec<String> {
    let (held, slack) = (map.held().count(), map.points().len() - map.held().count());
    let percent = |errors: Errors| format!("{:.2} %", 100.0 * errors.root_mean_square);
    let mut words = vec![format!(
        "{} up to {:.1} N; {}, at which a law may not pull. Errors are in percent of the largest tension. {}",
        counted(held as u64, "tension"),
        map.largest(),
        counted(slack as u64, "slack point"),
        match deviation {
            Some(deviation) => format!("A tension is known to {deviation:.3} N (one standard deviation)."),
            None => "The scatter about each law says how sure its numbers are.".to_owned(),
        }
    )];
    let Some(least) = least(judged, by) else { return words };
    let rule = "Laws are compared by their root mean square errors";
    let taken = |error: f64| match least.candidate.name == best.candidate.name {
        true => String::new(),
        false => format!(
            " `{}` is taken: of the laws within a tenth of that it has the fewest parameters, {}, and errs by {:.2} %.",
            best.candidate.name,
            best.numbers(),
            100.0 * error
        ),
    };
    let (name, error, numbers) = (&least.candidate.name, 100.0 * least.error(by), least.numbers());
    let Some(by) = by else {
        words.push(format!(
            "{rule} in their own sample: there are too few lengths, pressures and runs to leave one out. `{name}` errs least: {error:.2} % \
             with {numbers} parameters.{}",
            taken(best.error(None))
        ));
        return words;
    };
    if let Some(nearest) = nearest(judged) {
        words.push(format!(
            "{rule} where they have not looked, {} left out one by one. `{name}` errs least: {error:.2} % with {numbers} parameters, and {} in \
             its own sample.{}",
            by.name(),
            percent(least.fit.errors),
            taken(best.error(Some(by)))
        ));
        if nearest.candidate.name != best.candidate.name {
            let beyond = match nearest.held(by) {
                Some(errors) => format!("At {} that it has not seen it errs by {}", by.name(), percent(errors)),
                None => format!("Without one of the {} it is not determined at all", by.name()),
            };
            words.push(format!(
                "Nearest in its own sample is `{}`: {} with {} numbers. {beyond}: what is nearest in sample is no guide to what lies \
                 between and beyond.",
                nearest.candidate.name,
                percent(nearest.fit.errors),
                nearest.numbers()
            ));
        }
    }
    words
}

/// Largest and root-mean-square error in percent.
fn percents(errors: Option<Errors>) -> [String; 2] {
    match errors {
        Some(errors) => [errors.worst, errors.root_mean_square].map(|error| format!("{:.2}", 100.0 * error)),
        None => ["–".to_owned(), "–".to_owned()],
    }
}

fn comparison(judged: &[Judged], by: Option<Grouping>) -> Table {
    let groupings: Vec<Grouping> = Grouping::ALL
        .into_iter()
        .filter(|by| judged.iter().any(|of| of.held_out.iter().any(|held| held.by == *by)))
        .collect();
    let mut head: Vec<String> = ["law", "numbers", "in sample: worst %", "rms %"].map(String::from).to_vec();
    for by in &groupings {
        head.extend([format!("held-out {}: worst %", by.name()), "rms %".to_owned()]);
        if *by != Grouping::Runs {
            head.push("between: rms %".to_owned());
        }
    }
    head.push("condition".to_owned());
    let row = |of: &Judged| {
        let mut row = vec![of.candidate.name.clone(), of.numbers().to_string()];
        row.extend(percents(Some(of.fit.errors)));
        for by in &groupings {
            row.extend(percents(of.held(*by)));
            if *by != Grouping::Runs {
                let [_, between] = percents(of.held_out(*by).and_then(HeldOut::between));
                row.push(between);
            }
        }
        row.push(if of.fit.fit.unidentifiable.is_empty() {
            format!("{:.1e}", of.fit.fit.condition)
        } else {
            "– not identifiable".to_owned()
        });
        row
    };
    let order = match by {
        Some(by) => format!("the root mean square of held-out {}", by.name()),
        None => "the root mean square in sample".to_owned(),
    };
    let caption = "Errors in percent of the largest tension. Held out: each length, pressure or run in turn is left out of the fit, and the \
                   error is taken there; – where the others do not determine the law. Between: likewise without the first and the last of \
                   them, which lie beyond the others. Condition: of the numbers, each over its size."
        .to_owned();
    let caption = format!(
        "{caption} In the order of {order}; laws whose parameters are not identifiable from the data come last."
    );
    Table { caption, head, rows: judged.iter().map(row).collect() }
}

fn sections(
    material: &Material,
    map: &ForceMap,
    base: &Scenario,
    judged: &[Judged],
    best: &Judged,
    table: &Table,
    text: &str,
) -> Vec<Section> {
    let mut plates = vec![compared(judged)];
    let pair: Vec<&Judged> = [Some(best), nearest(judged).filter(|of| of.candidate.name != best.candidate.name)]
        .into_iter()
        .flatten()
        .collect();
    let polynomial = judged.iter().find(|of| of.candidate.name == "polynomial");
    let three = pair
        .iter()
        .copied()
        .chain(polynomial.filter(|of| !pair.iter().any(|in_pair| in_pair.candidate.name == of.candidate.name)));
    plates.extend(astray(&three.collect::<Vec<_>>()));
    let mut sections = vec![
        Section {
            id: "laws",
            label: "Laws",
            title: "Every law, in its sample and out of it",
            plates,
            tables: vec![table.clone()],
            ..Section::default()
        },
        Section {
            id: "fit",
            label: "Fit",
            title: "The law that is taken",
            paragraphs: vec![format!("`{}`, as the scenario file below has it.", best.candidate.name)],
            plates: fitted(map, best).into_iter().chain([residuals(map, &pair)]).collect(),
            tables: vec![
                values::table("Numbers with their 95 % intervals.".to_owned(), &best.fit.fit),
                values::correlations(&best.fit.fit),
            ],
            files: vec![("scenario.toml".into(), text.to_owned().into())],
            ..Section::default()
        },
    ];
    if let Ok(of) = ratios(map, base) {
        sections.push(effectiveness(&of));
    }
    let others = judged.iter().filter(|of| of.candidate.name != best.candidate.name);
    let tables = others.map(|of| values::table(format!("{}.", of.candidate.name), &of.fit.fit)).collect();
    let paragraphs = vec![format!("From {}.", material.study.path.display())];
    sections.push(Section {
        id: "numbers",
        label: "Numbers",
        title: "The other laws’ numbers",
        paragraphs,
        tables,
        ..Section::default()
    });
    sections
}

/// The largest error in percent in a figure, so that one law gone astray does not press all others into a corner.
const EDGE: f64 = 30.0;
const BEYOND: &str = "What lies beyond 30 % is drawn there; the tables have the numbers.";

fn at_the_edge(error: f64) -> f64 {
    // What is no number stays none.
    if error > EDGE { EDGE } else { error }
}

/// Errors of every law side by side.
fn compared(judged: &[Judged]) -> Plate {
    let places: Vec<f64> = (0..judged.len()).map(|place| (judged.len() - 1 - place) as f64).collect();
    let words =
        judged.iter().zip(&places).map(|(of, place)| (*place, format!("{} ({})", of.candidate.name, of.numbers())));
    let axis = Axis::new("", "").words(words).starting_at(-0.5).ending_at(judged.len() as f64 - 0.5);
    let of = |errors: &dyn Fn(&Judged) -> Option<Errors>| -> Vec<f64> {
        judged.iter().map(|of| errors(of).map_or(f64::NAN, |errors| 100.0 * errors.root_mean_square)).collect()
    };
    let columns = [
        ("in sample", of(&|of| Some(of.fit.errors))),
        ("held-out lengths", of(&|of| of.held(Grouping::Lengths))),
        ("held-out pressures", of(&|of| of.held(Grouping::Pressures))),
    ];
    let mut panel = Panel::new(axis).legend(Legend::Above).height_mm(6.0 * judged.len() as f64 + 4.0);
    let mut data = Data::new(&[
        "place",
        "in_sample_rms_percent",
        "held_out_lengths_rms_percent",
        "held_out_pressures_rms_percent",
    ])
    .lacking(&["held_out_lengths_rms_percent", "held_out_pressures_rms_percent"]);
    data.rows = (0..judged.len())
        .map(|place| vec![place as f64, columns[0].1[place], columns[1].1[place], columns[2].1[place]])
        .collect();
    for (colour, (label, errors)) in columns.into_iter().enumerate() {
        let shown = errors.into_iter().map(at_the_edge).collect();
        panel = panel.series(Series::points(label, shown, places.clone()).colour(Colour::Category(colour)));
    }
    let x = Axis::new("root mean square error", "%").starting_at(0.0);
    let figure = Figure { width_mm: 170.0, x, panels: vec![panel], ..Figure::default() };
    let caption = format!(
        "Root mean square errors in percent of the largest tension; in brackets how many numbers were fitted. {BEYOND}"
    );
    Plate { stem: LAWS, caption, figure, data }
}

/// Errors at each length that was left out.
fn astray(pair: &[&Judged]) -> Option<Plate> {
    let mut panel = Panel::new(Axis::new("error there", "%").starting_at(0.0)).legend(Legend::Above);
    let mut data = Data::new(&["law", "left_out_m", "rms_percent"]).lacking(&["rms_percent"]);
    for (law, of) in pair.iter().enumerate() {
        let held = of.held_out(Grouping::Lengths)?;
        let middle = |fold: &[f64; 2]| 0.5 * (fold[0] + fold[1]);
        let x: Vec<f64> = held.folds.iter().map(|fold| middle(&fold.of)).collect();
        let y: Vec<f64> = held
            .folds
            .iter()
            .map(|fold| fold.errors.map_or(f64::NAN, |errors| 100.0 * errors.root_mean_square))
            .collect();
        data.rows.extend(x.iter().zip(&y).map(|(x, y)| vec![law as f64, *x, *y]));
        let shown = y.into_iter().map(at_the_edge).collect();
        let series = Series::line(of.candidate.name.clone(), x, shown).colour(Colour::Category(law));
        panel = panel.series(Series { style: Style::LineAndPoints, ..series });
    }
    let figure =
        Figure { width_mm: 120.0, x: Axis::new("length left out", "m"), panels: vec![panel], ..Figure::default() };
    let caption = format!(
        "Each length in turn was left out of the fit: the root mean square error at that length. The ends are beyond what was fitted, \
         the middle is between. {BEYOND}"
    );
    Some(Plate { stem: HELD_OUT, caption, figure, data })
}

/// Tensions over pressure, length by length where there are few, with the law's curves.
fn fitted(map: &ForceMap, best: &Judged) -> Option<Plate> {
    let actuator = best.fit.scenario.driven().ok()?.actuator;
    let groups = Grouping::Lengths.groups(map);
    let highest = map.held().fold(0.0_f64, |highest, point| highest.max(point.gauge_pressure));
    let mut panel = Panel::new(Axis::new("tension", "N").starting_at(0.0)).legend(Legend::Direct);
    let mut data = Data::new(&["length_m", "gauge_pressure_pa", "measured_n", "fitted_n"]);
    for (place, [low, high]) in groups.iter().enumerate() {
        let here: Vec<&Point> = map.held().filter(|point| (low..=high).contains(&&point.length)).collect();
        let length = 0.5 * (low + high);
        let colour = Colour::Ramp(place as f64 / (groups.len() - 1).max(1) as f64);
        let pressures: Vec<f64> = (0..=100).map(|part| highest * f64::from(part) / 100.0).collect();
        let curve = pressures.iter().map(|pressure| pull(&actuator, *pressure, length)).collect();
        panel = panel
            .series(Series::line(format!("{:.1} mm", 1e3 * length), pressures, curve).colour(colour).dash(Dash::Solid));
        let (x, y) = here.iter().map(|point| (point.gauge_pressure, point.tension)).unzip();
        panel = panel.series(Series::points("", x, y).colour(colour));
        data.rows.extend(
            here.iter().map(|point| vec![point.length, point.gauge_pressure, point.tension, force(&actuator, point)]),
        );
    }
    let x = Axis::new("gauge pressure", "Pa").starting_at(0.0);
    let figure = Figure { width_mm: 150.0, panel_height_mm: 80.0, x, panels: vec![panel], ..Figure::default() };
    Some(Plate { stem: FIT, caption: "Measured tensions, and the law at each length.".to_owned(), figure, data })
}

/// The tensions that were held.
fn prediction(map: &ForceMap, best: &Judged) -> Option<Prediction> {
    let actuator = best.fit.scenario.driven().ok()?.actuator;
    let column = |value: &dyn Fn(&Point) -> f64| map.held().map(value).collect::<Vec<f64>>();
    Some(Prediction {
        run: String::new(),
        quantity: "tension".to_owned(),
        unit: "N",
        coordinates: vec![
            ("length_m", column(&|point| point.length)),
            ("gauge_pressure_pa", column(&|point| point.gauge_pressure)),
        ],
        measured: column(&|point| point.tension),
        predicted: column(&|point| force(&actuator, point)),
    })
}

/// Tension in N of a law that cannot push.
fn pull(actuator: &Actuator, gauge_pressure: f64, length: f64) -> f64 {
    let force = force(actuator, &Point { gauge_pressure, length, tension: 0.0, slack: false, run: 0 });
    if force > 0.0 { force } else { f64::NAN }
}

fn residuals(map: &ForceMap, pair: &[&Judged]) -> Plate {
    let mut data = Data::new(&["law", "length_m", "gauge_pressure_pa", "residual_n"]);
    let mut panels = Vec::new();
    for (law, of) in pair.iter().enumerate() {
        let Ok(driven) = of.fit.scenario.driven() else { continue };
        let off = |point: &Point| force(&driven.actuator, point) - point.tension;
        let groups = Grouping::Lengths.groups(map);
        let mut panel = Panel::new(Axis::new(format!("off, {}", short(&of.candidate.name)), "N"))
            .horizontal(0.0, "")
            .legend(Legend::Direct);
        for (place, [low, high]) in groups.iter().enumerate() {
            let here: Vec<&Point> = map.held().filter(|point| (low..=high).contains(&&point.length)).collect();
            let (x, y) = here.iter().map(|point| (point.gauge_pressure, off(point))).unzip();
            let colour = Colour::Ramp(place as f64 / (groups.len() - 1).max(1) as f64);
            let label = if law == 0 { format!("{:.1} mm", 1e3 * 0.5 * (low + high)) } else { String::new() };
            let series = Series { style: Style::LineAndPoints, ..Series::line(label, x, y) };
            panel = panel.series(series.colour(colour).dash(Dash::Solid));
        }
        data.rows.extend(map.held().map(|point| vec![law as f64, point.length, point.gauge_pressure, off(point)]));
        panels.push(panel);
    }
    let figure = Figure {
        width_mm: 150.0,
        panel_height_mm: 45.0,
        x: Axis::new("gauge pressure", "Pa").starting_at(0.0),
        panels,
        ..Figure::default()
    };
    Plate {
        stem: RESIDUALS,
        caption: "What the law says less what was measured. A pattern is what the law cannot do.".to_owned(),
        figure,
        data,
    }
}

/// The first words of a law's name.
fn short(name: &str) -> &str {
    name.split(' ').next().unwrap_or(name)
}

/// Measured over ideal force at each pressure.
fn effectiveness(of: &[Ratio]) -> Section {
    let row = |ratio: &Ratio| {
        let interval =
            ratio.interval.map_or("– one point".to_owned(), |[low, high]| format!("{low:.3} to {high:.3}"));
        vec![
            format!("{:.1}", 1e-3 * ratio.gauge_pressure),
            format!("{:.4}", ratio.value),
            interval,
            ratio.points.to_string(),
        ]
    };
    let table = Table {
        caption: "Measured over ideal force (9) at each pressure, with the geometry as the scenario gives it."
            .to_owned(),
        head: ["gauge pressure kPa", "effectiveness", "95 % interval", "points"].map(String::from).to_vec(),
        rows: of.iter().map(row).collect(),
    };
    let mut data = Data::new(&["gauge_pressure_pa", "effectiveness"]);
    data.rows = of.iter().map(|ratio| vec![ratio.gauge_pressure, ratio.value]).collect();
    let (x, y) = of.iter().map(|ratio| (ratio.gauge_pressure, ratio.value)).unzip();
    let panel = Panel::new(Axis::new("effectiveness", "").starting_at(0.0))
        .series(Series::points("", x, y))
        .horizontal(1.0, "ideal");
    let figure = Figure {
        width_mm: 120.0,
        x: Axis::new("gauge pressure", "Pa").starting_at(0.0),
        panels: vec![panel],
        ..Figure::default()
    };
    let plate =
        Plate { stem: EFFECTIVENESS, caption: "Effectiveness at each nominal pressure.".to_owned(), figure, data };
    let paragraphs = vec![
        "Its size goes with 1/n² of the turns that the scenario gives; how it goes with pressure does not.".to_owned(),
    ];
    Section {
        id: "effectiveness",
        label: "Effectiveness",
        title: "Effectiveness over pressure (9)",
        paragraphs,
        plates: vec![plate],
        tables: vec![table],
        ..Section::default()
    }
}
