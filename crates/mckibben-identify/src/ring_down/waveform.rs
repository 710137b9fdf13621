//! Friction from every sample of a ring-down: the simulated trajectory that fits best.
//!
//! The rig is simulated with every stick and slip located, over dual numbers, so that its derivatives are exact.
//! Unknown are Q and c of (12), the length at the first sample, and, on request, the velocity there and the sealed
//! pressure. The mass of the air is no unknown: in a sealed chamber without heat transfer only P Vᵏ counts.
//!
//! Intervals are those of [`least_squares`](crate::least_squares), from the scatter of the samples about the trajectory: they hold
//! the noise, and are as true as the model. A scatter well above [`Record::noise`] says that the model is not.

use super::record::Record;
use super::{Decrement, RingDownError};
use crate::adjustable::Seeded;
use crate::least_squares::{Estimate, Evaluation, Fit, Model, Search, Unknown, fit};
use crate::propagation::{Measured, Slope};
use crate::series::Polynomial;
use mckibben::parameter::{self, Parameter};
use mckibben::simulation::{Initial, InitialLength, Rig, simulate};
use mckibben::{AbsolutePressure, GaugePressure, Over, Scalar};

/// Relative tolerance of the trajectories: far below any sensor's noise.
const TOLERANCE: f64 = 1e-8;
/// Error of a trajectory over its amplitude.
const ERROR: f64 = 1e2 * TOLERANCE;
/// Part of the record that is fitted first, so that the phase is nearly right when the rest is.
const FIRST_PART: f64 = 0.3;
/// Samples that a start is taken from.
const START: usize = 5;

/// What is unknown at the first sample in addition to the length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// The velocity; otherwise it is the start's.
    pub velocity: bool,
    /// The pressure of the sealed air; otherwise it is the start's.
    pub pressure: bool,
}

impl Free {
    /// Both are unknown.
    pub const ALL: Self = Self { velocity: true, pressure: true };
}

/// Friction of the trajectory that fits best.
#[derive(Clone, Debug, PartialEq)]
pub struct Waveform {
    /// Q of (12) in m.
    pub coulomb_width: Estimate,
    /// c in N·s/m.
    pub viscous: Estimate,
    /// ζ of the viscous part, on the sealed stiffness at rest.
    pub damping_ratio: Estimate,
    /// Q in m of an equal linear spring, to compare with what turns show.
    pub shown_width: Estimate,
    /// Standard deviation of a sample about the trajectory in m. Well above [`Record::noise`], it says that the model is not the
    /// actuator's, and then the intervals are too narrow.
    pub scatter: f64,
    /// The least squares behind it: all unknowns, correlations, and what is not identifiable from the record.
    pub fit: Fit,
}

/// The springs of an actuator at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restoring {
    /// Secant stiffness k_sec of (13) in N/m, that Coulomb friction goes with.
    pub secant: f64,
    /// Tangent stiffness k_t in N/m with the valve shut, that the mass swings on.
    pub tangent: f64,
}

impl Restoring {
    /// Of a rig at a length in m and an absolute pressure.
    pub fn of(rig: &Rig, length: f64, pressure: AbsolutePressure) -> Self {
        let actuator = rig.actuator();
        let secant = actuator.secant_stiffness(length, pressure.0);
        Self { secant, tangent: actuator.sealed_stiffness(length, pressure) }
    }

    /// Of a sealed rig in equilibrium after it was at a start.
    ///
    /// # Errors
    /// [`RingDownError::Physics`] for a start outside the physics or a load without equilibrium.
    pub fn at_rest(rig: &Rig, start: &Initial) -> Result<Self, RingDownError> {
        let actuator = rig.actuator();
        let state = rig.start(start)?;
        let (mut length, mut pressure) = (state.length, state.pressure);
        // The pressure follows the volume and the length follows the pressure: together a contraction.
        for _ in 0..200 {
            let volumes = actuator.volume(state.length) / actuator.volume(length);
            pressure = AbsolutePressure(state.pressure.0 * volumes.powf(actuator.air().index()));
            let next = rig.equilibrium(pressure)?;
            let moved = (next - length).abs();
            length = 0.5 * (length + next);
            if moved < 1e-12 * length {
                break;
            }
        }
        Ok(Self::of(rig, length, pressure))
    }

    /// The Q of (12) in m from that of a ring-down: `Q k_t/k_sec`.
    pub fn law_width(&self, shown: &Estimate) -> Estimate {
        scaled(shown, self.tangent / self.secant)
    }

    /// The Q in m of an equal linear spring: `Q k_sec/k_t` of the Q of (12).
    pub fn shown_width(&self, law: &Estimate) -> Estimate {
        scaled(law, self.secant / self.tangent)
    }
}

fn scaled(estimate: &Estimate, factor: f64) -> Estimate {
    let mut scaled = estimate.clone();
    scaled.value *= factor;
    scaled.bound = estimate.bound.map(|bound| bound * factor);
    scaled.standard_error = estimate.standard_error.map(|deviation| deviation * factor);
    scaled.confidence_interval = estimate.confidence_interval.map(|interval| interval.map(|end| end * factor));
    scaled
}

impl Waveform {
    /// The state at the first sample; what was not free in it is that of a `start`.
    pub fn start(&self, start: &Initial) -> Initial {
        let of = |name: &str| self.fit.estimates.iter().find(|estimate| estimate.name == name).map(|of| of.value);
        Initial {
            length: of("length").map_or(start.length, InitialLength::At),
            velocity: of("velocity").unwrap_or(start.velocity),
            gauge_pressure: of("gauge_pressure").map_or(start.gauge_pressure, GaugePressure),
            ..*start
        }
    }

    /// Fits a sealed rig to a record that begins with its first sample after the release; `start` is the state there, or a guess
    /// of what is `free` in it (its length is always taken from the record), and `turns`, if given, is where Q and c begin.
    ///
    /// # Errors
    /// [`RingDownError::Rig`] for a rig with a valve, without a mass or without Coulomb friction, [`RingDownError::Physics`] for a
    /// start outside the physics, [`RingDownError::Fit`] when nothing fits.
    pub fn fit(
        record: &Record,
        rig: &Rig,
        start: &Initial,
        free: Free,
        turns: Option<&Decrement>,
    ) -> Result<Self, RingDownError> {
        let mass = check(rig)?;
        let (time, length) = (record.time(), record.length());
        let few = START.min(time.len());
        let slope = Polynomial::fit(&time[..few], &length[..few], time[0], 1).map(|line| line.coefficients[1]);
        let noise = record.noise().max(f64::EPSILON * length[0].abs());
        let begin = Initial { length: InitialLength::At(length[0]), ..*start };
        let restoring = Restoring::at_rest(rig, &begin)?;
        let amplitude = length.iter().map(|x| (x - length[length.len() - 1]).abs()).fold(0.0, f64::max);
        let [width, viscous] = match turns {
            Some(turns) => [restoring.law_width(&turns.coulomb_width).value, turns.viscous.value],
            None => [1e-2 * amplitude, 0.02 * (restoring.tangent * mass).sqrt()],
        };
        let mut unknowns = vec![
            Unknown::new("coulomb_width", "m", width.max(1e-4 * amplitude)).between(0.0, f64::INFINITY),
            Unknown::new("viscous", "N*s/m", viscous.max(1e-4 * (restoring.tangent * mass).sqrt()))
                .between(0.0, f64::INFINITY),
            Unknown::new("length", "m", length[0]),
        ];
        let mut rows = vec![&parameter::COULOMB_WIDTH, &parameter::VISCOUS, &parameter::INITIAL_LENGTH];
        if free.velocity {
            // As fast as the swing at most, which is what its size is.
            let fastest = amplitude * (restoring.tangent / mass).sqrt();
            let velocity = slope.unwrap_or(0.0).clamp(-fastest, fastest);
            unknowns.push(Unknown::new("velocity", "m/s", velocity).between(-2.0 * fastest, 2.0 * fastest));
            rows.push(&parameter::INITIAL_VELOCITY);
        }
        if free.pressure {
            unknowns.push(Unknown::new("gauge_pressure", "Pa", start.gauge_pressure.0));
            rows.push(&parameter::INITIAL_GAUGE_PRESSURE);
        }
        let error = ERROR * amplitude;
        let of = |samples: usize| Trajectory {
            rig,
            start: &begin,
            rows: &rows,
            time: &time[..samples],
            length,
            noise,
            error,
        };
        let part = ((FIRST_PART * time.len() as f64) as usize).max(4 * unknowns.len()).min(time.len());
        if let Ok(fit) = fit(&of(part), &unknowns, &Search::default()) {
            for (unknown, value) in unknowns.iter_mut().zip(fit.values()) {
                // A start on a bound stays there.
                let held = unknown.bounds[0] == 0.0 && value <= 1e-3 * unknown.start;
                unknown.start = if held { 1e-3 * unknown.start } else { value };
            }
        }
        // What a search leaves of the way to a bound is its rounding.
        let whole = of(time.len());
        let fit = fit(&whole, &unknowns, &Search::default())?.on_bounds(&whole);
        Self::new(fit, rig, &begin, noise, mass, free)
    }

    fn new(fit: Fit, rig: &Rig, start: &Initial, noise: f64, mass: f64, free: Free) -> Result<Self, RingDownError> {
        let values = fit.values();
        let mut found = Initial { length: InitialLength::At(values[2]), ..*start };
        if free.pressure {
            found.gauge_pressure.0 = values[values.len() - 1];
        }
        let restoring = Restoring::at_rest(rig, &found)?;
        let viscous = fit.estimates[1].clone();
        let measured = Measured {
            values: &[viscous.value],
            standard_errors: &[viscous.standard_error.unwrap_or(f64::INFINITY)],
            degrees_of_freedom: fit.degrees_of_freedom,
        };
        let critical = 2.0 * (restoring.tangent * mass).sqrt();
        let [damping_ratio] = measured.propagate([("damping_ratio", "")], |numbers| {
            Ok::<_, RingDownError>([numbers[0] / Slope::constant(critical)])
        })?;
        Ok(Self {
            shown_width: restoring.shown_width(&fit.estimates[0]),
            coulomb_width: fit.estimates[0].clone(),
            viscous,
            damping_ratio,
            scatter: fit.scatter * noise,
            fit,
        })
    }
}

/// Mass in kg of a rig that can ring down.
fn check(rig: &Rig) -> Result<f64, RingDownError> {
    let lack = |what| Err(RingDownError::Rig { what });
    match rig.load().inertia() {
        _ if rig.actuator().valve().is_some() => {
            lack("its valve would change the air; leave the valve and its command out")
        }
        _ if !rig.actuator().friction().has_coulomb() => lack(
            "it has no Coulomb friction to begin with; set actuator.friction.coulomb_width above zero, such as 0.1 mm",
        ),
        None => lack("nothing moves freely; hang a mass on it"),
        Some(inertia) => Ok(inertia.mass),
    }
}

/// The rig's length over time, as a function of the unknowns.
struct Trajectory<'a> {
    rig: &'a Rig,
    start: &'a Initial,
    /// The row of each unknown.
    rows: &'a [&'static Parameter],
    time: &'a [f64],
    length: &'a [f64],
    noise: f64,
    /// That of the simulation, in m.
    error: f64,
}

/// More directions than there are unknowns; the engine is compiled for these anyway.
type D = Seeded;

impl Trajectory<'_> {
    /// Lengths at the times; `None` where the physics ends.
    fn lengths(&self, values: &[f64]) -> Option<Vec<D>> {
        let number = |row: &'static Parameter, value: f64| {
            let place = self.rows.iter().position(|free| std::ptr::eq(*free, row));
            place.map_or(D::of(value), |place| D::variable(values[place], place))
        };
        let rig = self.rig.map(number);
        let start = rig.begin(&self.start.map(number)).ok()?;
        let last = self.time[self.time.len() - 1] - self.time[0];
        let run = simulate(&rig, start, D::constant(last), TOLERANCE).ok()?;
        let times = self.time.iter().map(|time| D::constant(time - self.time[0]));
        Some(run.at_each(times).map(|sample| sample.length).collect())
    }
}

impl Model for Trajectory<'_> {
    fn residuals(&self) -> usize {
        self.time.len()
    }

    fn error(&self) -> f64 {
        self.error / self.noise
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let unknowns = values.len();
        let Some(lengths) = self.lengths(values) else {
            let none = |count: usize| vec![f64::NAN; count];
            return Evaluation { residuals: none(self.time.len()), slopes: none(self.time.len() * unknowns) };
        };
        let residual = |(at, measured): (&D, &f64)| (at.value - measured) / self.noise;
        Evaluation {
            residuals: lengths.iter().zip(self.length).map(residual).collect(),
            slopes: lengths.iter().flat_map(|at| at.slope[..unknowns].iter().map(|s| s / self.noise)).collect(),
        }
    }
}
