//! A tank that is charged or discharged through a valve: C and b from its pressure alone, or its volume where the valve is
//! known.
//!
//! ```text
//! isothermal       ṁ = (V/RT) dP/dt          as ISO 6358-2 does, in a tank stuffed with metal wool
//! any process      P(t) of the simulated tank
//! ```
//!
//! Several records are fitted together by [`Tank::fit_together`]: they need not begin at the same pressure, and a charge goes
//! with a discharge where the flow path is the same.
//!
//! [`Tank::isothermal_flow`] makes points of steady flow for [`FlowCurve`](super::FlowCurve): the slope of a cubic through
//! the samples of each of a number of windows that share none, so that their errors are independent. [`Tank::fit`] fits the
//! trajectory, with exact derivatives. A tank is simulated as an actuator that is held at one length: the external volume
//! makes up the rest.
//!
//! The unknown pressure and the stated temperature at the start are those of the valve's opening, which may be before the first
//! sample.
//!
//! C and V cannot both be found from a pressure: a tank twice as large behind twice the valve has the same. The temperature
//! at the start is that of the tank's wall.
//!
//! With an unknown heat transfer the sum of squares has several minima, since b and h A can stand in for each other. The
//! search begins at the guesses and on a grid of b and of the heat transfer over the heat that flows with the air,
//!
//! ```text
//! h = h A τ/(m c_v)    τ = P/|dP/dt|,    n = 1 + (γ − 1)/(1 + h),    C ρ₀ √(T₀/T) P₁ ψ(r, b) = ṁ = V |dP/dt|/(n R T)
//! ```
//!
//! where C and h A follow from the first fall or rise of the pressure, so that they do not depend on the guesses: of still
//! air (h = 0) the rate is that of an adiabatic tank, at its wall's temperature (h → ∞) that of an isothermal one.
//!
//! Where every sample may be choked, b has no effect: [`TankFit::all_choked`].
//!
//! Source: ISO 6358-2:2019 names the two tests; the isothermal tank is that of EP 1847812. Checked by `tests/valve.rs`.

use super::ValveError;
use super::steady::{LAMINAR_RATIO, SteadyPoint, check_pressure};
use crate::adjustable::Seeded;
use crate::least_squares::{self, Estimate, Evaluation, Fit, Model, Search, Unknown, fit_from};
use crate::series::{self, Polynomial};
use mckibben::air::{Air, Process};
use mckibben::force::{Characteristic, Effective, Effectiveness, IdealBraid, LengthLimits};
use mckibben::friction::Friction;
use mckibben::load::Load;
use mckibben::parameter::{self, Parameter};
use mckibben::simulation::{Actuation, Initial, InitialLength, Rig, simulate};
use mckibben::valve::{
    Command, ExhaustTemperature, FlowLaw, FlowStandard, Request, Solenoid, Supply, Valve, ValveKind,
};
use mckibben::{AbsolutePressure, Actuator, Braid, GaugePressure, Over, Scalar};

/// Samples that it takes.
const LEAST_SAMPLES: usize = 8;
/// Samples of a window, for a cubic and some to spare.
const LEAST_IN_WINDOW: usize = 6;
/// Where the search begins in addition to the guesses when b and the heat transfer are unknown: b, and h of the heat transfer.
const STARTS: ([f64; 2], [f64; 5]) = ([0.2, 0.45], [0.1, 0.3, 1.0, 3.0, 10.0]);
/// Part of the change of the pressure from which C of a start follows, and the largest pressure ratio of its flow.
const FIRST_PART: f64 = 0.2;
const NEARLY_EQUAL: f64 = 0.99;
/// The least and the largest b that are searched.
const RATIOS: [f64; 2] = [-0.5, 0.95];
/// Part of the largest pressure ratio by which b is above it where every sample is choked: above the error of a trajectory.
const CHOKED: f64 = 1e-6;
/// Halves of the interval of b within which the largest pressure ratio is worth a search in which every sample is choked.
const WORTH: f64 = 4.0;
/// The quantile of χ² of one degree of freedom at 95 %: so much more a single unknown that is held may leave by chance.
const BY_CHANCE: f64 = 3.841;
/// Relative tolerance of the trajectories.
const TOLERANCE: f64 = 1e-9;
/// A braid so thin that it is negligible relative to the tank: thread length and length in m, turns.
const BRAID: (f64, f64, f64) = (0.1, 0.08, 1e4);

/// Pressure over time in a tank, from the valve's opening on.
#[derive(Clone, Debug, PartialEq)]
pub struct TankRecord {
    /// When the valve opens.
    opened: f64,
    time: Vec<f64>,
    pressure: Vec<f64>,
}

impl TankRecord {
    /// Samples of the absolute `pressure` in Pa at each `time` in s; the valve is open from the first on.
    ///
    /// # Errors
    /// [`ValveError::Series`] for fewer than eight samples, a number that is not finite, or times out of order;
    /// [`ValveError::Implausible`] for a pressure that is no absolute one.
    pub fn new(time: Vec<f64>, pressure: Vec<f64>) -> Result<Self, ValveError> {
        series::check(&time, &pressure, "the pressure", LEAST_SAMPLES)?;
        for (place, value) in pressure.iter().enumerate() {
            check_pressure("pressure", place, *value, "Pa")?;
        }
        Ok(Self { opened: time[0], time, pressure })
    }

    /// With a valve that opens at a time in s, before the first sample: readings may be lacking there.
    ///
    /// # Errors
    /// [`ValveError::Misuse`] for a time after the first sample, or none.
    pub fn opened_at(self, time: f64) -> Result<Self, ValveError> {
        match time.is_finite() && time <= self.time[0] {
            true => Ok(Self { opened: time, ..self }),
            false => Err(ValveError::Misuse {
                what: "the valve opens after the first sample",
                remedy: "leave out the samples before it opens",
            }),
        }
    }

    /// The pressure in Pa at the opening, on the line through the first samples.
    fn first_guess(&self) -> f64 {
        let few = LEAST_SAMPLES.min(self.time.len());
        let line = Polynomial::fit(&self.time[..few], &self.pressure[..few], self.opened, 1);
        let guess = line.filter(|_| self.opened < self.time[0]).map_or(self.pressure[0], |line| line.coefficients[0]);
        // Far before the samples the line leads nowhere.
        let [least, most] = [0.5, 2.0].map(|part| part * self.pressure[0]);
        guess.clamp(least, most)
    }
}

/// Where the air comes from or goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// From a supply at an absolute pressure and a temperature in K.
    Charge {
        /// Absolute pressure of the supply.
        supply: AbsolutePressure,
        /// Its temperature in K.
        temperature: f64,
    },
    /// To the atmosphere.
    Discharge,
}

/// A rigid volume behind a valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tank {
    /// Volume in m³, the line to the valve included; where it is unknown, a guess.
    pub volume: f64,
    /// Temperature of the air in K when the valve opens.
    pub temperature: f64,
    /// The gas, the atmosphere, and how heat goes between it and the wall.
    pub air: Air,
    /// What happens.
    pub transfer: Transfer,
}

/// What is unknown in addition to the pressure when the valve opens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TankUnknown {
    /// C and b of the valve, from guesses in m³/(s·Pa) and 1.
    Valve {
        /// A guess of C in m³/(s·Pa).
        sonic_conductance: f64,
        /// A guess of b.
        critical_ratio: f64,
    },
    /// The volume, with a valve that is known.
    Volume {
        /// How the size of the valve is stated.
        standard: FlowStandard,
        /// The factor on its flow.
        efficiency: f64,
    },
}

/// The trajectories that fit best.
#[derive(Clone, Debug, PartialEq)]
pub struct TankFit {
    /// C in m³/(s·Pa), where it was unknown.
    pub sonic_conductance: Option<Estimate>,
    /// b, where it was unknown.
    pub critical_ratio: Option<Estimate>,
    /// Volume in m³, where it was unknown.
    pub volume: Option<Estimate>,
    /// Heat transfer h A in W/K, where it was unknown.
    pub heat_transfer: Option<Estimate>,
    /// Standard deviation of a sample about the trajectory in Pa, over all records.
    pub scatter: f64,
    /// Of each record: that standard deviation in Pa, and the noise of its samples, estimated from their neighbours.
    pub of_records: Vec<[f64; 2]>,
    /// Whether the data do not contradict that every sample was choked. Then b is not identifiable, and [`TankFit::critical_ratio`]
    /// is the least that it can be: the largest pressure ratio of the records.
    pub all_choked: bool,
    /// The least squares behind it.
    pub fit: Fit,
}

impl Tank {
    /// Points of steady flow from an isothermal tank, one for each of a number of `windows`. Near equal pressures the flow
    /// falls too fast for a cubic: leave points with a ratio above 0.9 out.
    ///
    /// # Errors
    /// [`ValveError::Misuse`] for windows of fewer than six samples.
    pub fn isothermal_flow(&self, record: &TankRecord, windows: usize) -> Result<Vec<SteadyPoint>, ValveError> {
        let size = record.time.len() / windows.max(1);
        if size < LEAST_IN_WINDOW {
            return Err(ValveError::Misuse {
                what: "a window has fewer than six samples, too few for a slope",
                remedy: "ask for fewer windows, or sample faster",
            });
        }
        let point = |(time, pressure): (&[f64], &[f64])| {
            let middle = 0.5 * (time[0] + time[size - 1]);
            let cubic = Polynomial::fit(time, pressure, middle, 3)?;
            let (inside, rate) = (AbsolutePressure(cubic.coefficients[0]), cubic.coefficients[1]);
            let flow = self.air.mass(AbsolutePressure(rate), self.volume, self.temperature);
            Some(match self.transfer {
                Transfer::Charge { supply, temperature } => {
                    SteadyPoint { upstream: supply, downstream: inside, temperature, mass_flow: flow }
                }
                Transfer::Discharge => SteadyPoint {
                    upstream: inside,
                    downstream: self.air.atmosphere(),
                    temperature: self.temperature,
                    mass_flow: -flow,
                },
            })
        };
        Ok(record.time.chunks_exact(size).zip(record.pressure.chunks_exact(size)).filter_map(point).collect())
    }

    /// Fits the simulated pressure to a record; with `heat`, the heat transfer too, of air with an energy balance: then from
    /// several starts that follow from the data, since b and the heat transfer can stand in for each other.
    ///
    /// # Errors
    /// As [`Tank::fit_together`].
    pub fn fit(&self, record: &TankRecord, wanted: TankUnknown, heat: bool) -> Result<TankFit, ValveError> {
        Self::fit_together(&[(*self, record)], wanted, heat)
    }

    /// Fits several records, of discharges and charges from any pressures: the unknowns are common to all of them,
    /// the pressure when its valve opens is separate for each, and each is weighed by the noise of its samples. Guesses
    /// of volume and heat transfer are those of the first tank.
    ///
    /// # Errors
    /// [`ValveError::Misuse`] for heat without an energy balance or no record at all, [`ValveError::CriticalRatio`] for a
    /// b outside 0 to 1, [`ValveError::Physics`] for a number outside its range, [`ValveError::Fit`] when nothing fits.
    pub fn fit_together(runs: &[(Self, &TankRecord)], wanted: TankUnknown, heat: bool) -> Result<TankFit, ValveError> {
        let Some((first, _)) = runs.first() else {
            return Err(ValveError::Misuse { what: "there is no record of a tank", remedy: "give one or more" });
        };
        let mut unknowns: Vec<Unknown> = runs
            .iter()
            .map(|(_, record)| Unknown::new("pressure", "Pa", record.first_guess()).between(1.0, f64::INFINITY))
            .collect();
        let mut rows = Vec::new();
        match wanted {
            TankUnknown::Valve { sonic_conductance, critical_ratio } => {
                rows.extend([&parameter::SONIC_CONDUCTANCE, &parameter::CRITICAL_RATIO]);
                unknowns.push(
                    Unknown::new("sonic_conductance", "m^3/(s*Pa)", sonic_conductance)
                        .between(1e-3 * sonic_conductance, 1e3 * sonic_conductance),
                );
                unknowns.push(Unknown::new("critical_ratio", "", critical_ratio).between(RATIOS[0], RATIOS[1]));
            }
            TankUnknown::Volume { .. } => {
                rows.push(&parameter::EXTERNAL_VOLUME);
                unknowns
                    .push(Unknown::new("volume", "m^3", first.volume).between(1e-3 * first.volume, 1e3 * first.volume));
            }
        }
        if heat {
            let Process::EnergyBalance { heat_transfer, .. } = first.air.process() else {
                return Err(ValveError::Misuse {
                    what: "heat transfer is to be estimated for air whose process has none",
                    remedy: "give the air an energy balance with a guess of h A",
                });
            };
            rows.push(&parameter::HEAT_TRANSFER);
            unknowns.push(Unknown::new("heat_transfer", "W/K", heat_transfer).between(0.0, f64::INFINITY));
        }
        let trajectory = |(tank, record): &(Self, &TankRecord)| {
            let noise = series::noise(&record.time, &record.pressure).max(f64::EPSILON * record.pressure[0]);
            Ok(Trajectory { tank: *tank, rig: tank.rig(wanted)?, record: (*record).clone(), noise })
        };
        let trajectories = runs.iter().map(trajectory).collect::<Result<Vec<_>, ValveError>>()?;
        let together = Together { trajectories, rows };
        let starts = starts(runs[0], &unknowns);
        let fit = fit_from(&together, &unknowns, &starts, &Search::default())?.fit.on_bounds(&together);
        let choked = together.choked(&unknowns, &fit);
        let all_choked = choked.is_some();
        let fit = choked.unwrap_or(fit);
        let of = |name: &str| fit.estimates.iter().find(|estimate| estimate.name == name).cloned();
        if let Some(ratio) = of("critical_ratio") {
            let reaches = ratio.confidence_interval.unwrap_or([ratio.value; 2]);
            if ratio.on_bound || reaches[1] < 0.0 {
                return Err(ValveError::CriticalRatio { value: ratio.value });
            }
        }
        Ok(TankFit {
            sonic_conductance: of("sonic_conductance"),
            critical_ratio: of("critical_ratio"),
            volume: of("volume"),
            heat_transfer: of("heat_transfer"),
            scatter: together.scatter(&fit),
            of_records: together.of_records(&fit),
            all_choked,
            fit,
        })
    }

    /// Absolute pressure in Pa at times in s after the valve has opened on a tank at an absolute pressure.
    ///
    /// # Errors
    /// [`ValveError::Physics`] for a number outside its range.
    pub fn pressures(
        &self,
        from: AbsolutePressure,
        standard: FlowStandard,
        efficiency: f64,
        times: &[f64],
    ) -> Result<Vec<f64>, ValveError> {
        let rig = self.rig(TankUnknown::Volume { standard, efficiency })?;
        let start = rig.start(&self.initial(from))?;
        let last = times.iter().copied().fold(0.0, f64::max);
        let run = simulate(&rig, start, last, TOLERANCE)?;
        Ok(run.at_each(times.iter().copied()).map(|sample| sample.pressure.0).collect())
    }

    fn initial(&self, pressure: AbsolutePressure) -> Initial {
        Initial {
            gauge_pressure: pressure.gauge(self.air.atmosphere()),
            temperature: self.temperature,
            length: InitialLength::At(BRAID.1),
            velocity: 0.0,
        }
    }

    /// The tank with its valve as a rig.
    fn rig(&self, wanted: TankUnknown) -> Result<Rig, ValveError> {
        let (standard, efficiency) = match wanted {
            TankUnknown::Valve { sonic_conductance, critical_ratio } => {
                (FlowStandard::Iso6358 { sonic_conductance, critical_ratio }, 1.0)
            }
            TankUnknown::Volume { standard, efficiency } => (standard, efficiency),
        };
        let air = self.air;
        let (supply, request) = match self.transfer {
            Transfer::Charge { supply, temperature } => {
                (Supply::new(supply.gauge(air.atmosphere()), temperature, &air)?, Request::Fill)
            }
            Transfer::Discharge => (Supply::new(GaugePressure(0.0), self.temperature, &air)?, Request::Exhaust),
        };
        let law = FlowLaw::new(standard, efficiency, LAMINAR_RATIO, &air)?;
        let valve = Valve::new(law, supply, ExhaustTemperature::Actuator, &air);
        let braid = Braid::new(BRAID.0, BRAID.2)?;
        let limits = LengthLimits::new(&braid, None, 0.5 * (BRAID.0 + BRAID.1), 1e5, 0.0)?;
        let law =
            Effective { law: Characteristic::from(IdealBraid { braid }), effectiveness: Effectiveness::Constant(1.0) };
        let actuator = Actuator::new(law, limits, Friction::NONE, self.volume, air)?.with_valve(valve);
        let solenoid = Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0)?;
        let actuation = Actuation { solenoid, command: Command::Constant(request) };
        Ok(Rig::new(actuator, Some(actuation), Load::Isometric)?)
    }
}

/// More starts than the guesses, of a valve whose heat transfer is unknown too: C and h A by the first change of the pressure in a run.
fn starts((tank, record): (Tank, &TankRecord), unknowns: &[Unknown]) -> Vec<Vec<f64>> {
    let place = |name: &str| unknowns.iter().position(|unknown| unknown.name == name);
    let places = place("sonic_conductance").zip(place("critical_ratio")).zip(place("heat_transfer"));
    let (Some(((conductance, ratio), heat)), Some(first)) = (places, FirstChange::of(&tank, record)) else {
        return Vec::new();
    };
    let start = |b: f64, h: f64| {
        let mut start: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
        (start[conductance], start[ratio], start[heat]) = (first.conductance(&tank, b, h), b, first.heat(&tank, h));
        start
    };
    STARTS.0.iter().flat_map(|b| STARTS.1.map(|h| start(*b, h))).collect()
}

/// The first change of the pressure in a tank, in Pa/s, and the pressure in Pa halfway.
struct FirstChange {
    rate: f64,
    pressure: f64,
}

impl FirstChange {
    /// By the chord over the first part of the change; none where the pressure does not change.
    fn of(tank: &Tank, record: &TankRecord) -> Option<Self> {
        let from = record.first_guess();
        let change = |pressure: &f64| match tank.transfer {
            Transfer::Charge { .. } => pressure - from,
            Transfer::Discharge => from - pressure,
        };
        let most = record.pressure.iter().map(change).fold(0.0, f64::max);
        let first = record.pressure.iter().position(|pressure| change(pressure) >= FIRST_PART * most)?;
        let (duration, pressure) = (record.time[first] - record.opened, record.pressure[first]);
        (most > 0.0 && duration > 0.0)
            .then(|| Self { rate: change(&pressure) / duration, pressure: 0.5 * (from + pressure) })
    }

    /// C in m³/(s·Pa) of a valve with this b, where h of the heat transfer is such.
    fn conductance(&self, tank: &Tank, b: f64, h: f64) -> f64 {
        let index = 1.0 + (tank.air.heat_capacity_ratio() - 1.0) / (1.0 + h);
        let inside = AbsolutePressure(self.pressure);
        let (upstream, downstream, temperature) = match tank.transfer {
            Transfer::Charge { supply, temperature } => (supply, inside, temperature),
            Transfer::Discharge => (inside, tank.air.atmosphere(), tank.temperature),
        };
        let mass_flow = tank.air.mass(AbsolutePressure(self.rate), tank.volume, temperature) / index;
        let point = SteadyPoint { upstream, downstream, temperature, mass_flow };
        let beyond = (point.ratio().min(NEARLY_EQUAL) - b).max(0.0) / (1.0 - b);
        point.conductance() / (1.0 - beyond * beyond).sqrt()
    }

    /// Heat transfer in W/K of which h is such: m/τ is the mass of air whose pressure is the rate, each second.
    fn heat(&self, tank: &Tank, h: f64) -> f64 {
        let specific_heat = tank.air.gas_constant() / (tank.air.heat_capacity_ratio() - 1.0);
        h * specific_heat * tank.air.mass(AbsolutePressure(self.rate), tank.volume, tank.temperature)
    }
}

/// More directions than there are unknowns; the engine is compiled for these anyway.
type D = Seeded;

/// The pressure over time in one tank.
struct Trajectory {
    tank: Tank,
    rig: Rig,
    record: TankRecord,
    noise: f64,
}

/// All of them, by the pressures at their starts and what is common.
struct Together {
    trajectories: Vec<Trajectory>,
    /// The row of each common number.
    rows: Vec<&'static Parameter>,
}

impl Trajectory {
    /// Pressures at the times by the pressure at the start, direction 0, and the common numbers, the directions after it;
    /// `None` where the physics ends.
    fn pressures(&self, rows: &[&'static Parameter], start: f64, common: &[f64]) -> Option<Vec<D>> {
        let atmosphere = self.tank.air.atmosphere().0;
        let number = |row: &'static Parameter, value: f64| {
            if std::ptr::eq(row, &parameter::INITIAL_GAUGE_PRESSURE) {
                return D::variable(start, 0) - D::of(atmosphere);
            }
            let place = rows.iter().position(|free| std::ptr::eq(*free, row));
            place.map_or(D::of(value), |place| D::variable(common[place], 1 + place))
        };
        let rig = self.rig.map(number);
        let initial = self.tank.initial(AbsolutePressure(start)).map(number);
        let start = rig.begin(&initial).ok()?;
        let time = &self.record.time;
        let opened = self.record.opened;
        let run = simulate(&rig, start, D::constant(time[time.len() - 1] - opened), TOLERANCE).ok()?;
        let times = time.iter().map(|at| D::constant(at - opened));
        Some(run.at_each(times).map(|sample| sample.pressure.0).collect())
    }
}

impl Together {
    /// Samples of each record with its noise, in the order of the residuals.
    fn counts(&self) -> impl Iterator<Item = (usize, f64)> {
        self.trajectories.iter().map(|of| (of.record.time.len(), of.noise))
    }

    /// Scatter about the trajectory and noise of each record in Pa; each has its share of the degrees of freedom.
    fn of_records(&self, fit: &Fit) -> Vec<[f64; 2]> {
        let freedom = fit.degrees_of_freedom.max(1) as f64 / self.residuals() as f64;
        let mut rest = fit.residuals.as_slice();
        let of = |(count, noise): (usize, f64)| {
            let (own, behind) = rest.split_at(count);
            rest = behind;
            let squares: f64 = own.iter().map(|residual| residual * residual).sum();
            [noise * (squares / (count as f64 * freedom)).sqrt(), noise]
        };
        self.counts().map(of).collect()
    }

    /// The largest ratio of downstream to upstream pressure on the fitted trajectories.
    fn largest_ratio(&self, fit: &Fit) -> f64 {
        let mut residuals = fit.residuals.iter();
        let mut largest = 0.0_f64;
        for of in &self.trajectories {
            for (measured, residual) in of.record.pressure.iter().zip(residuals.by_ref()) {
                let inside = measured + of.noise * residual;
                largest = largest.max(match of.tank.transfer {
                    Transfer::Charge { supply, .. } => inside / supply.0,
                    Transfer::Discharge => of.tank.air.atmosphere().0 / inside,
                });
            }
        }
        largest
    }

    /// The fit in which every sample is choked, where the data do not contradict that: b has no effect there, and its value is the
    /// least of those that are as good.
    fn choked(&self, unknowns: &[Unknown], fit: &Fit) -> Option<Fit> {
        let place = unknowns.iter().position(|unknown| unknown.name == "critical_ratio")?;
        let (ratio, b) = (self.largest_ratio(fit), &fit.estimates[place]);
        // Near choked flow b has hardly an effect, and the linear interval is too short: several of it say where a search is worth it.
        let reach = b.confidence_interval.map_or(0.0, |[_, most]| most - b.value);
        if b.value + WORTH * reach < ratio || ratio >= RATIOS[1] {
            return None;
        }
        let (mut from, mut others) = (fit.values(), unknowns.to_vec());
        from.remove(place);
        others.remove(place);
        let holding = Holding { model: self, place, value: ratio };
        let held =
            least_squares::fit(&holding, &least_squares::starting_at(&others, &from), &Search::default()).ok()?;
        if b.value < ratio && (held.cost - fit.cost) * fit.degrees_of_freedom as f64 > BY_CHANCE * fit.cost {
            return None;
        }
        let mut values = held.values();
        values.insert(place, ratio.max(self.largest_ratio(&held)) * (1.0 + CHOKED));
        Some(least_squares::fitted(self, unknowns, &Search::default(), values))
    }

    fn scatter(&self, fit: &Fit) -> f64 {
        let squares =
            self.of_records(fit).into_iter().zip(self.counts()).map(|([own, _], (count, _))| count as f64 * own * own);
        (squares.sum::<f64>() / self.residuals() as f64).sqrt()
    }
}

/// A model with one of its unknowns held.
struct Holding<'a> {
    model: &'a Together,
    place: usize,
    value: f64,
}

impl Model for Holding<'_> {
    fn residuals(&self) -> usize {
        self.model.residuals()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let mut all = values.to_vec();
        all.insert(self.place, self.value);
        let Evaluation { residuals, mut slopes } = self.model.evaluate(&all);
        let mut at = 0..;
        slopes.retain(|_| at.next().is_none_or(|at| at % all.len() != self.place));
        Evaluation { residuals, slopes }
    }
}

impl Model for Together {
    fn residuals(&self) -> usize {
        self.counts().map(|(count, _)| count).sum()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let (own, common) = values.split_at(self.trajectories.len());
        let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
        for (run, of) in self.trajectories.iter().enumerate() {
            let Some(pressures) = of.pressures(&self.rows, own[run], common) else {
                residuals.extend(vec![f64::NAN; of.record.time.len()]);
                slopes.extend(vec![f64::NAN; of.record.time.len() * values.len()]);
                continue;
            };
            for (at, measured) in pressures.iter().zip(&of.record.pressure) {
                residuals.push((at.value - measured) / of.noise);
                let mut row = vec![0.0; values.len()];
                row[run] = at.slope[0] / of.noise;
                for (into, slope) in row[own.len()..].iter_mut().zip(&at.slope[1..]) {
                    *into = slope / of.noise;
                }
                slopes.extend(row);
            }
        }
        Evaluation { residuals, slopes }
    }
}
