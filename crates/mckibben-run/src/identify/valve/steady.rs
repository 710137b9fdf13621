//! Steady flow through a valve: C and b of a flow curve, or the factor on the calculated flow.

use super::super::outcome::{self, Outcome, WARNED, file};
use super::super::{Material, Prediction, column, remedied, values};
use super::{MEND, absolute_pressures, actuator_of, flow_path_of, law_of, named, put, rows, valve_of, with_interval};
use super::{says_its_end, with_conductance, with_efficiency, with_flow_path};
use crate::failure::Failure;
use crate::quantities::{counted, quantity};
use crate::report::{Data, Plate, Section, Table};
use mckibben::AbsolutePressure;
use mckibben::air::Air;
use mckibben::parameter;
use mckibben::valve::{FlowLaw, FlowStandard, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::{Direction, Quantity, Recording};
use mckibben_identify::valve::{Efficiency, FlowCurve, Scatter, SteadyPoint, ValveError, efficiency, flow_coefficient};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series, Span};
use mckibben_scenario::FlowPath;

/// The figures.
pub(super) const CURVE: &str = "flow-curve";
const RATIOS: &str = "ratios";
pub(super) const STEMS: [&str; 2] = [CURVE, RATIOS];

/// Where the upstream pressure differs by more than this part, two flows do not come out equal to the last digit.
const APART: f64 = 0.05;

/// The points of all runs, and where each comes from.
struct Points {
    points: Vec<SteadyPoint>,
    /// The name of its run, and the number of its reading there, from 1.
    origins: Vec<(String, usize)>,
}

impl Points {
    /// Why nothing can be estimated from them; a point is named by its run.
    fn failed(&self, error: &ValveError) -> Failure {
        match error {
            ValveError::Implausible { what, point, value, unit, problem, remedy } => {
                match self.origins.get(point - 1) {
                    Some((run, reading)) => Failure::input(
                        format!("the run `{run}`: {what} of reading {reading} is {value} {unit}, {problem}"),
                        *remedy,
                    ),
                    None => remedied(&error.to_string(), MEND),
                }
            }
            ValveError::Fit(_) => Failure::stopped(error.to_string()),
            _ => remedied(&error.to_string(), MEND),
        }
    }
}

/// C and b of ISO 6358 from a flow curve.
pub(in super::super) fn flow_curve(material: &Material) -> Result<Outcome, Failure> {
    let scenario = material.document.scenario()?;
    valve_of(&scenario)?;
    let entry = material.study.flow;
    let air = *actuator_of(&scenario)?.air();
    let mut warnings = material.notes();
    let points = points(material, &mut warnings)?;
    let found = FlowCurve::fit(&points.points, &air, entry.scatter).map_err(|error| points.failed(&error))?;
    let both = [&found.sonic_conductance, &found.critical_ratio];
    let split = entry.flow_path == Direction::Exhaust;
    let (scenario, numbers) = with_conductance(&scenario, entry.flow_path, both, split, &mut warnings)?;
    let estimates = numbers;
    let numbers = values::of("Numbers with their 95 % intervals".to_owned(), &estimates);
    let scenarios = vec![("scenario.toml".to_owned(), file(&scenario))];
    let introduction = format!(
        "{} of steady flow, {} of them choked: C = {} and b = {}, by least squares over all of them at once. {}",
        counted(points.points.len() as u64, "point"),
        found.choked,
        with_interval(&found.sonic_conductance),
        with_interval(&found.critical_ratio),
        scatter_words(entry.scatter)
    );
    let sections = vec![
        outcome::numbers(vec![numbers.clone(), the_standards_way(&found)], &scenarios),
        Section {
            id: "curve",
            label: "Curve",
            title: "Conductance over the pressure ratio",
            paragraphs: vec![
                "Conductance: mass flow over reference density and upstream pressure, as if upstream were at 20 °C. Choked it \
                 is C, at any upstream pressure; from b on the law is a quarter of an ellipse."
                    .to_owned(),
            ],
            plates: vec![curve_plate(&points.points, &found, &air, CURVE)?],
            ..Section::default()
        },
    ];
    let law = fitted_law(&found, &air)?;
    let calculated =
        |point: &SteadyPoint| law.mass_flow(point.upstream.0.powi(2) / point.temperature, 1.0 - point.ratio());
    let predicted: Vec<f64> = points.points.iter().map(calculated).collect();
    let predictions = predictions(&points, &predicted);
    let found = outcome(material, "Flow curve", introduction, sections, (numbers, estimates), warnings, scenarios);
    Ok(Outcome { predictions, ..found })
}

/// The efficiency of the scenario's valve, or the flow coefficient of an area.
pub(in super::super) fn steady_flow(material: &Material) -> Result<Outcome, Failure> {
    let scenario = material.document.scenario()?;
    let valve = *valve_of(&scenario)?;
    let entry = material.study.flow;
    let actuator = actuator_of(&scenario)?;
    let mut warnings = material.notes();
    let points = points(material, &mut warnings)?;
    let failed = |error: ValveError| points.failed(&error);
    let (found, scenario, numbers, name) = match entry.area {
        None => {
            let law = law_of(flow_path_of(&valve, entry.flow_path), 1.0, &valve, &actuator)?;
            let found = efficiency(&points.points, &law, entry.scatter).map_err(failed)?;
            let scenario = with_efficiency(&scenario, entry.flow_path, found.factor.value, &mut warnings)?;
            let numbers = vec![named(&found.factor, &parameter::EFFICIENCY)];
            (found, scenario, numbers, "efficiency η")
        }
        Some(area) => {
            let found = flow_coefficient(&points.points, area, actuator.air(), entry.scatter).map_err(failed)?;
            let effective = area * found.factor.value;
            let split = entry.flow_path == Direction::Exhaust;
            let flow_path = FlowPath::FlowArea(effective);
            let mut scenario = with_flow_path(&scenario, entry.flow_path, flow_path, split, &mut warnings)?;
            let row = rows(entry.flow_path, valve_of(&scenario)?)[2];
            put(&mut scenario, &[(row, effective)])?;
            let of_area = Estimate {
                value: effective,
                bound: None,
                standard_error: found.factor.standard_error.map(|deviation| area * deviation),
                confidence_interval: found.factor.confidence_interval.map(|ends| ends.map(|end| area * end)),
                ..named(&found.factor, row)
            };
            let numbers = vec![found.factor.clone(), of_area];
            (found, scenario, numbers, "flow coefficient C_q")
        }
    };
    let estimates = numbers;
    let numbers = values::of("Numbers with their 95 % intervals".to_owned(), &estimates);
    let scenarios = vec![("scenario.toml".to_owned(), file(&scenario))];
    let introduction = format!(
        "{} points of steady flow: the {name} of (22), measured over calculated flow, is {}. {}",
        points.points.len(),
        with_interval(&found.factor),
        scatter_words(entry.scatter)
    );
    let sections = vec![
        outcome::numbers(vec![numbers.clone()], &scenarios),
        Section {
            id: "ratios",
            label: "Ratios",
            title: "Measured over calculated flow",
            paragraphs: vec![
                "A trend over the pressure ratio says that the flow path has another law than the calculated one: look at a \
                 `flow-curve` then."
                    .to_owned(),
            ],
            plates: vec![ratio_plate(&points.points, &found)],
            ..Section::default()
        },
    ];
    let calculated = points.points.iter().zip(&found.ratios).map(|(point, ratio)| point.mass_flow / ratio);
    let predicted: Vec<f64> = calculated.map(|flow| found.factor.value * flow).collect();
    let predictions = predictions(&points, &predicted);
    let found = outcome(material, "Steady flow", introduction, sections, (numbers, estimates), warnings, scenarios);
    Ok(Outcome { predictions, ..found })
}

/// The mass flows of each run with those that the fitted law predicts, one for each point.
fn predictions(points: &Points, predicted: &[f64]) -> Vec<Prediction> {
    let places: Vec<usize> = (0..points.points.len()).collect();
    let of_runs = places.chunk_by(|a, b| points.origins[*a].0 == points.origins[*b].0);
    let of_run = |places: &[usize]| {
        let column = |of: &dyn Fn(&SteadyPoint) -> f64| places.iter().map(|at| of(&points.points[*at])).collect();
        Prediction {
            run: points.origins[places[0]].0.clone(),
            quantity: "mass flow".to_owned(),
            unit: "kg/s",
            coordinates: vec![
                ("pressure_ratio", column(&SteadyPoint::ratio)),
                ("upstream_absolute_pressure_pa", column(&|point| point.upstream.0)),
                ("downstream_absolute_pressure_pa", column(&|point| point.downstream.0)),
                ("temperature_k", column(&|point| point.temperature)),
            ],
            measured: column(&|point| point.mass_flow),
            predicted: places.iter().map(|at| predicted[*at]).collect(),
        }
    };
    of_runs.map(of_run).collect()
}

/// The flow law with the C and b of a flow curve; a b below zero is 0.
fn fitted_law(found: &FlowCurve, air: &Air) -> Result<FlowLaw, Failure> {
    let [sonic_conductance, critical_ratio] = [found.sonic_conductance.value, found.critical_ratio.value.max(0.0)];
    let standard = FlowStandard::Iso6358 { sonic_conductance, critical_ratio };
    FlowLaw::new(standard, 1.0, parameter::LAMINAR_RATIO.default.unwrap_or(0.999), air)
        .map_err(|error| Failure::stopped(error.to_string()))
}

fn outcome(
    material: &Material,
    title: &str,
    introduction: String,
    sections: Vec<Section>,
    (values, estimates): (Table, Vec<Estimate>),
    warnings: Vec<String>,
    scenarios: Vec<(String, String)>,
) -> Outcome {
    Outcome {
        title: format!("{title} of {}", material.name()),
        introduction: vec![introduction],
        sections,
        table: Table::default(),
        values,
        estimates,
        warnings,
        scenarios,
        ..Outcome::default()
    }
}

fn scatter_words(scatter: Scatter) -> &'static str {
    match scatter {
        Scatter::Constant => "Flows are taken to scatter alike, whatever their size (`flow.scatter`).",
        Scatter::Proportional => "Flows are taken to scatter by the same part of each (`flow.scatter`).",
    }
}

/// The points of all runs.
fn points(material: &Material, warnings: &mut Vec<String>) -> Result<Points, Failure> {
    let mut all = Points { points: Vec::new(), origins: Vec::new() };
    for recording in &material.recordings {
        let atmosphere = material.document_of(recording)?.scenario()?.air.atmospheric_pressure;
        let of_run = of_run(recording, atmosphere, warnings)?;
        if ![Quantity::MassFlow, Quantity::VolumeFlow].iter().any(|flow| says_its_end(material, *flow)) {
            saturated(recording, &of_run)?;
        }
        for (reading, point) in of_run {
            all.points.push(point);
            all.origins.push((recording.name.clone(), reading));
        }
    }
    Ok(all)
}

/// The readings of a run that have all that a point has, with their numbers.
fn of_run(
    recording: &Recording,
    atmosphere: f64,
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, SteadyPoint)>, Failure> {
    use Quantity::{
        DownstreamAbsolutePressure, DownstreamGaugePressure, UpstreamAbsolutePressure, UpstreamGaugePressure,
    };
    let (upstream, _) = absolute_pressures(recording, [UpstreamGaugePressure, UpstreamAbsolutePressure], atmosphere)?;
    let (downstream, measured) =
        absolute_pressures(recording, [DownstreamGaugePressure, DownstreamAbsolutePressure], atmosphere)?;
    let least = downstream.iter().copied().fold(f64::INFINITY, f64::min);
    if measured == DownstreamAbsolutePressure && least > 0.0 && least < 0.9 * atmosphere {
        warnings.push(format!(
            "{WARNED}`{}`: the {} falls to {}, below the atmosphere’s {}: a vacuum behind the valve, or a gauge pressure under the \
             wrong name.",
            recording.name,
            measured.words(),
            quantity(least, "Pa"),
            quantity(atmosphere, "Pa")
        ));
    }
    let temperature = column(recording, Quantity::Temperature)?;
    let by_volume = recording.column(Quantity::VolumeFlow);
    if by_volume.is_some() && recording.column(Quantity::MassFlow).is_some() {
        let title = format!("the run `{}` has a mass flow and a volume flow", recording.name);
        return Err(Failure::input(title, "leave one of the two columns out"));
    }
    let (flow, density) = match by_volume {
        Some(flow) => (flow, REFERENCE_DENSITY),
        None => (column(recording, Quantity::MassFlow)?, 1.0),
    };
    let lengths = [upstream.len(), downstream.len(), temperature.values.len(), flow.values.len()];
    if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
        let title = format!("the run `{}` has its columns in tables of different length", recording.name);
        return Err(Failure::input(title, "put pressures, temperature and flow of a point into one row of one table"));
    }
    if flow.deviation.is_some() {
        let text = "the `deviation` of the flow is not used: how the points scatter about the law says how sure it is.";
        warnings.push(format!("`{}`: {text}", recording.name));
    }
    let point = |row: usize| SteadyPoint {
        upstream: AbsolutePressure(upstream[row]),
        downstream: AbsolutePressure(downstream[row]),
        temperature: temperature.values[row],
        mass_flow: density * flow.values[row],
    };
    let whole = |point: &SteadyPoint| {
        [point.upstream.0, point.downstream.0, point.temperature, point.mass_flow].iter().all(|value| value.is_finite())
    };
    let points = (0..upstream.len()).map(|row| (row + 1, point(row))).filter(|(_, point)| whole(point));
    Ok(points.collect())
}

/// Refuses the same largest flow at upstream pressures that differ: a meter at its end.
fn saturated(recording: &Recording, points: &[(usize, SteadyPoint)]) -> Result<(), Failure> {
    let largest = points.iter().map(|(_, point)| point.mass_flow).fold(0.0, f64::max);
    let at_largest = || points.iter().filter(|(_, point)| point.mass_flow == largest);
    let upstream = || at_largest().map(|(_, point)| point.upstream.0);
    let (least, most) = (upstream().fold(f64::INFINITY, f64::min), upstream().fold(0.0, f64::max));
    let count = at_largest().count();
    if count < 3 || most <= (1.0 + APART) * least {
        return Ok(());
    }
    let title = format!(
        "the run `{}`: the flow is {largest:.6e} kg/s, its largest value, at {count} upstream pressures from {} to {}: the flow \
         meter is at its end",
        recording.name,
        quantity(least, "Pa"),
        quantity(most, "Pa")
    );
    Err(Failure::input(title, "say `saturates` in the column of the flow to leave these readings out"))
}

/// C from the choked points alone, b from the others with that C.
fn the_standards_way(found: &FlowCurve) -> Table {
    let rows =
        [(&found.choked_conductance, found.choked, "choked"), (&found.subsonic_ratio, found.subsonic, "subsonic")];
    let row = |(estimate, count, which): (&Estimate, usize, &str)| {
        let mut row = values::row(estimate);
        row[0] = format!(
            "{} ({})",
            row[0].replace('`', "").replace('_', " "),
            counted(count as u64, &format!("{which} point"))
        );
        row
    };
    Table {
        rows: rows.map(row).to_vec(),
        ..values::of("One after the other, as the standard goes about it".to_owned(), &[])
    }
}

/// Conductance over the pressure ratio, measured and fitted.
pub(super) fn curve_plate(
    points: &[SteadyPoint],
    found: &FlowCurve,
    air: &Air,
    stem: &'static str,
) -> Result<Plate, Failure> {
    let [sonic_conductance, critical_ratio] = [found.sonic_conductance.value, found.critical_ratio.value.max(0.0)];
    let law = fitted_law(found, air)?;
    // At the reference temperature; the same at any upstream pressure.
    let at = |ratio: f64, mass_flow: f64| SteadyPoint {
        upstream: AbsolutePressure(1e5),
        downstream: AbsolutePressure(1e5 * ratio),
        temperature: REFERENCE_TEMPERATURE,
        mass_flow,
    };
    let fitted = |ratio: f64| {
        let flow = law.mass_flow(1e5 * 1e5 / REFERENCE_TEMPERATURE, 1.0 - ratio);
        at(ratio, flow).conductance()
    };
    let scale = 1e8;
    let ratios: Vec<f64> = points.iter().map(SteadyPoint::ratio).collect();
    let measured: Vec<f64> = points.iter().map(|point| scale * point.conductance()).collect();
    let off: Vec<f64> = ratios
        .iter()
        .zip(&measured)
        .map(|(ratio, measured)| 100.0 * (scale * fitted(*ratio) - measured) / (scale * sonic_conductance))
        .collect();
    // Close to equal pressures the ellipse is steep.
    let fine: Vec<f64> = (0..=400).map(|part| 1.0 - (1.0 - f64::from(part) / 400.0).powi(2)).collect();
    let curve = fine.iter().map(|ratio| scale * fitted(*ratio)).collect();
    let mut data = Data::new(&["pressure_ratio", "measured_l_s_bar", "fitted_l_s_bar"]);
    data.rows =
        ratios.iter().zip(&measured).map(|(ratio, measured)| vec![*ratio, *measured, scale * fitted(*ratio)]).collect();
    let top = Panel::new(Axis::new("conductance", "L/(s·bar)").starting_at(0.0))
        .legend(Legend::Above)
        .height_mm(60.0)
        .vertical(critical_ratio, "b")
        .series(Series::line("fitted", fine, curve))
        .series(Series::points("measured", ratios.clone(), measured).colour(Colour::Category(1)));
    let rest = outcome::off("off", "% of C", Series::points("", ratios, off));
    let x = Axis::new("downstream over upstream pressure", "").starting_at(0.0).ending_at(1.0);
    Ok(Plate {
        stem,
        caption: "Measured and fitted conductance over the pressure ratio, and the one less the other.".to_owned(),
        figure: Figure { width_mm: 130.0, x, panels: vec![top, rest], ..Figure::default() },
        data,
    })
}

fn ratio_plate(points: &[SteadyPoint], found: &Efficiency) -> Plate {
    let ratios: Vec<f64> = points.iter().map(SteadyPoint::ratio).collect();
    let mut data = Data::new(&["pressure_ratio", "mass_flow_kg_s", "measured_over_calculated"]);
    data.rows = ratios
        .iter()
        .zip(points)
        .zip(&found.ratios)
        .map(|((ratio, point), factor)| vec![*ratio, point.mass_flow, *factor])
        .collect();
    let mut panel = Panel::new(Axis::new("measured over calculated flow", ""))
        .legend(Legend::Above)
        .height_mm(60.0)
        .horizontal(found.factor.value, "")
        .series(Series::points("each point", ratios, found.ratios.clone()).colour(Colour::Category(1)));
    if let Some([low, high]) = found.factor.confidence_interval {
        panel = panel.span(Span::strip("95 % interval of the factor", low, high));
    }
    let x = Axis::new("downstream over upstream pressure", "").starting_at(0.0).ending_at(1.0);
    Plate {
        stem: RATIOS,
        caption: "Measured over calculated flow, point by point, and the factor that fits best with its interval."
            .to_owned(),
        figure: Figure { width_mm: 130.0, x, panels: vec![panel], ..Figure::default() },
        data,
    }
}
