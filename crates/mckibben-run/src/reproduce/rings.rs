//! Figs. 8 and 9: ring-downs of a sealed muscle, and the damping that the paper's method finds in them.
//!
//! The peaks are events of the simulation, not samples: the instants at which the velocity comes to zero on the long
//! side. Amplitudes are counted from the length at which the sealed muscle balances the mass without friction.
//!
//! What a ring-down can show of the values that were put in:
//!
//! * the mass feels the tangent stiffness k_t with the valve shut, the friction of (12) is `Q k_sec`, so the Q of an
//!   equal linear spring is `Q k_sec/k_t`;
//! * the paper's `4Q` a cycle is the limit of small damping: its Q is low by `(1 + √β)²/4`;
//! * the spring is stiffer when it is long, so a swing reaches less far there: amplitudes on the long side shrink less
//!   than the swing does. Half of the way from a peak to the next trough obeys the same recursion, free of that.

use super::files;
use super::quasi_static::SealedMuscle;
use super::units::{INCH, INSIDE, LB, LBF_PER_INCH, PSI, assumed};
use crate::failure::Failure;
use crate::figure::symbols;
use crate::report::{Data, Finding, Plate, Section, Table, Verdict, number};
use mckibben::plant::RigTrajectory;
use mckibben::ring_down::{Cycle, Damping, Form};
use mckibben::simulation::{EventKind, Sliding};
use mckibben_plot::{Axis, Colour, Dash, Figure, Panel, Series};
use mckibben_scenario::Experiment;
use std::f64::consts::TAU;

/// The paper's averages.
const STATED_Q: f64 = 0.0044 * INCH;
const STATED_C: f64 = 0.02 * LBF_PER_INCH;
const STATED_RATIO: f64 = 0.035;

/// A simulated ring-down and what was found in it.
struct RingDown {
    label: &'static str,
    words: String,
    experiment: Experiment,
    run: RigTrajectory,
    mass: f64,
    /// Rest length in m and absolute pressure there in Pa.
    rest: (f64, f64),
    /// Times in s and lengths in m of the peaks, the release first.
    peaks: Vec<(f64, f64)>,
    period: f64,
    /// Secant and sealed tangent stiffness at rest in N/m.
    secant: f64,
    tangent: f64,
    /// By the paper's form from the first and the last cycle, by it from all, by the exact form from all.
    two_cycles: Damping,
    paper: Damping,
    exact: Damping,
    /// By the exact form from half of the way from each peak to the next trough.
    both_sides: Damping,
    cycles: Vec<Cycle>,
}

/// The section on Figs. 8 and 9.
pub(super) fn section() -> Result<Section, Failure> {
    let rings = [RingDown::simulate("fig-08.toml", "Fig. 8")?, RingDown::simulate("fig-09.toml", "Fig. 9")?];
    let [eight, nine] = &rings;
    let mut findings = Vec::new();
    for ring in &rings {
        findings.extend(ring.findings()?);
    }
    Ok(Section {
        id: "figs-8-9",
        label: "Figs. 8–9",
        title: "Ring-down of a sealed actuator, and its damping",
        paragraphs: vec![
            "The mass is released at rest 0.15 in below its rest length (assumed; the paper does not state the initial \
             displacement). The friction put in is the paper’s average, Q = 0.0044 in and c = 0.02 lbf·s/in. From the \
             simulated peaks the damping is then identified as the paper did, by (25)–(31), and by the exact \
             recursion of a linear spring, Δx = X(1 − β) + Q(1 + √β)²."
                .into(),
            "The identified Q is smaller than the one put in, for two reasons that can be computed. The Coulomb \
             force of (12) is Q k_sec with the secant stiffness of (13), but the mass swings on the sealed tangent \
             stiffness k_t of (5): the equal linear spring has the width Q k_sec/k_t. And 4Q is the limit of small \
             damping: with it the same peaks give a Q that is low by the factor (1 + √β)²/4. The viscous c comes out \
             low because the muscle is stiffer when it is long: peaks on that side, which the paper’s formula takes, \
             shrink less than the swing. Half of the way from peak to trough obeys the same recursion, is free of \
             that, and gives c and Q k_sec/k_t back within 1 %. A model fed with the Q of (28) is thus less damped \
             than the ring-down that gave it; the ratio k_sec/k_t rests on the assumed b, n and V_ext."
                .into(),
        ],
        plates: vec![eight.plate("fig-08"), nine.plate("fig-09"), drops(&rings)],
        tables: rings.iter().map(RingDown::table).collect::<Result<_, _>>()?,
        findings,
        files: vec![files::shown("fig-08.toml")?, files::shown("fig-09.toml")?],
    })
}

impl RingDown {
    fn simulate(file: &str, label: &'static str) -> Result<Self, Failure> {
        let experiment = files::experiment(file)?;
        let run = files::run(&experiment)?;
        let actuator = experiment.rig.actuator();
        let Some(load) = experiment.rig.load().inertia() else {
            return Err(Failure::stopped(format!("`{file}` has no mass to ring down")));
        };
        let muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        let length = muscle.balance(load.pull);
        let pressure = muscle.pressure(length);
        // The last reversal after which the motion goes on is a full peak; a final stop may lie anywhere within ±Q.
        let turns = run
            .events()
            .iter()
            .filter(|event| event.before.sliding == Sliding::Lengthening && event.after.sliding == Sliding::Shortening);
        let peaks: Vec<(f64, f64)> = std::iter::once((0.0, experiment.start.length))
            .chain(turns.map(|event| (event.time, run.at(event.time).length)))
            .collect();
        let amplitudes: Vec<f64> = peaks.iter().map(|peak| peak.1 - length).collect();
        let period = (peaks[peaks.len() - 1].0 - peaks[0].0) / (peaks.len() - 1) as f64;
        let cycles: Vec<Cycle> = amplitudes.windows(2).map(|w| Cycle { amplitude: w[0], next: w[1] }).collect();
        let fit = |form| Damping::from_peaks(&amplitudes, period, load.mass, form).map_err(files::stopped);
        let (paper, exact) = (fit(Form::Paper)?, fit(Form::Exact)?);
        let ends = [cycles[0], cycles[cycles.len() - 1]];
        let two_cycles = Damping::from_cycles(&ends, period, load.mass, Form::Paper).map_err(files::stopped)?;
        let half_swings: Vec<f64> = peaks
            .iter()
            .filter_map(|(time, peak)| {
                // The trough: the next time that the motion turns or stops.
                let trough = run.events().iter().find(|event| {
                    event.time > *time
                        && event.before.sliding == Sliding::Shortening
                        && event.after.sliding != Sliding::Shortening
                })?;
                (trough.after.sliding == Sliding::Lengthening).then(|| 0.5 * (peak - run.at(trough.time).length))
            })
            .collect();
        let both_sides = Damping::from_peaks(&half_swings, period, load.mass, Form::Exact).map_err(files::stopped)?;
        let absolute = mckibben::AbsolutePressure(pressure);
        let secant = actuator.coulomb_bound::<f64>(length, pressure) / STATED_Q;
        let tangent = actuator.sealed_stiffness(length, absolute);
        let words = format!("{} psi, {} lb", number(actuator.gauge(pressure).0 / PSI, 0), number(load.mass / LB, 0));
        let (mass, rest) = (load.mass, (length, pressure));
        Ok(Self {
            label,
            words,
            run,
            mass,
            rest,
            peaks,
            period,
            secant,
            tangent,
            two_cycles,
            paper,
            exact,
            both_sides,
            cycles,
            experiment,
        })
    }

    /// Q in m of the linear spring that rings down like this muscle in the limit of small amplitudes.
    fn equal_width(&self) -> f64 {
        STATED_Q * self.secant / self.tangent
    }

    /// ζ of the viscous friction put in.
    fn viscous_ratio(&self) -> f64 {
        STATED_C / (2.0 * (self.tangent * self.mass).sqrt())
    }

    /// β of the viscous friction put in.
    fn decay(&self) -> f64 {
        (-STATED_C * self.period / (2.0 * self.mass)).exp()
    }

    /// (32), in order of the cycles.
    fn equivalent_ratios(&self) -> Result<Vec<f64>, Failure> {
        self.cycles.iter().map(|cycle| cycle.equivalent_ratio().map_err(files::stopped)).collect()
    }

    fn plate(&self, stem: &'static str) -> Plate {
        let samples: Vec<_> = self.run.samples(self.experiment.run.sample_interval).collect();
        let atmosphere = self.experiment.rig.actuator().air().atmosphere();
        let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
        let length = samples.iter().map(|s| s.length / INCH).collect();
        let gauge = samples.iter().map(|s| s.pressure.gauge(atmosphere).0 / PSI).collect();
        let peaks = self.peaks.iter().copied();
        let lengths = Panel::new(Axis::new("length", "in"))
            .series(Series::line("length", time.clone(), length))
            .horizontal(self.rest.0 / INCH, "rest without friction")
            .marks(symbols::marks(
                EventKind::Reversal,
                "peaks",
                peaks.clone().map(|p| p.0).collect(),
                peaks.map(|p| p.1 / INCH).collect(),
            ));
        let pressures = Panel::new(Axis::new("gauge pressure", "psi"))
            .series(Series::line("gauge pressure", time, gauge).colour(Colour::Category(1)).dash(Dash::Solid))
            .height_mm(28.0);
        let figure = Figure::new(Axis::new("time", "s"))
            .caption(assumed(INSIDE) + " The initial displacement, 0.15 in, is assumed too.")
            .size_mm(120.0, 48.0)
            .panel(lengths)
            .panel(pressures);
        let mut data = Data::new(&["time_s", "length_m", "velocity_m_s", "absolute_pressure_pa", "tension_n"]);
        data.rows.extend(samples.iter().map(|s| vec![s.time, s.length, s.velocity, s.pressure.0, s.tension]));
        let caption = format!(
            "{} of the paper: length over time, {}. The paper’s curves are not at hand.",
            self.label, self.words
        );
        Plate { stem, caption, figure, data }
    }

    fn table(&self) -> Result<Table, Failure> {
        let ratios = self.equivalent_ratios()?;
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let row = |name: &str, width: f64, viscous: f64, ratio: f64| {
            vec![
                name.to_owned(),
                format!("{} in", number(width / INCH, 5)),
                format!("{} lbf·s/in", number(viscous / LBF_PER_INCH, 5)),
                number(ratio, 4),
            ]
        };
        let damping = |name: &str, d: &Damping| row(name, d.coulomb_width, d.viscous, d.damping_ratio);
        let rows = vec![
            row("Put in (the paper’s averages)", STATED_Q, STATED_C, self.viscous_ratio()),
            row("Equal linear spring: Q k_sec/k_t", self.equal_width(), STATED_C, self.viscous_ratio()),
            damping("Found: paper’s form, first and last cycle", &self.two_cycles),
            damping("Found: paper’s form, all cycles", &self.paper),
            damping("Found: exact form, all cycles", &self.exact),
            damping("Found: exact form, half of peak to trough", &self.both_sides),
        ];
        let frequency = (self.tangent / self.mass).sqrt() / TAU;
        let caption = format!(
            "{}, {}: damping put in and found. k_sec = {} lbf/in, k_t = {} lbf/in, {} full cycles of {} ms ({} Hz; \
             √(k_t/M)/2π = {} Hz). ζ_eq (32) from {} in the first cycle to {} in the last, mean {}.",
            self.label,
            self.words,
            number(self.secant / LBF_PER_INCH, 2),
            number(self.tangent / LBF_PER_INCH, 2),
            self.cycles.len(),
            number(1e3 * self.period, 2),
            number(1.0 / self.period, 3),
            number(frequency, 3),
            number(ratios[0], 4),
            number(ratios[ratios.len() - 1], 4),
            number(mean, 4),
        );
        let head = ["Damping", "Q", "c", "ζ (viscous)"].map(String::from).to_vec();
        Ok(Table { caption, head, rows })
    }

    fn findings(&self) -> Result<Vec<Finding>, Failure> {
        let ratios = self.equivalent_ratios()?;
        let label = self.label;
        let rest = self.experiment.rig.actuator().gauge(self.rest.1).0 / PSI;
        let round_trip = || {
            let expected = number(self.equal_width() / INCH, 5);
            Verdict::RoundTrip(format!(
                "0.0044 in was put in; Q k_sec/k_t = {expected} in is what a linear spring would show"
            ))
        };
        let of_average =
            || Verdict::NotComparable("the paper averages over tests and cycles that its text does not list".into());
        Ok(vec![
            Finding::new(format!("{label}: pressure at rest"), rest, 2, "psi").against(
                self.words.clone(),
                Verdict::Input("the file’s pressure at release was chosen for this".into()),
            ),
            Finding::new(format!("{label}: Q found by (25)–(28)"), self.two_cycles.coulomb_width / INCH, 5, "in")
                .against("0.0044 in", round_trip()),
            Finding::new(format!("{label}: Q found by the exact form"), self.exact.coulomb_width / INCH, 5, "in")
                .against("0.0044 in", round_trip()),
            Finding::new(format!("{label}: c found by (31)"), self.two_cycles.viscous / LBF_PER_INCH, 5, "lbf·s/in")
                .against(
                    "0.02 lb-s/in",
                    Verdict::RoundTrip("0.02 was put in; the muscle is stiffer on the side of the peaks".into()),
                ),
            Finding::new(format!("{label}: ζ_eq (32), first cycle"), ratios[0], 4, "")
                .against(format!("{STATED_RATIO}, an average"), of_average()),
            Finding::new(format!("{label}: frequency"), 1.0 / self.period, 3, "Hz").against(
                "“natural frequencies are in good agreement”",
                Verdict::NotComparable("no number is stated".into()),
            ),
        ])
    }
}

/// The drop of each cycle over its amplitude, against the lines that the recursions say.
fn drops(rings: &[RingDown; 2]) -> Plate {
    let mut panel = Panel::new(Axis::new("drop Δx in one cycle", "10⁻³ in").starting_at(0.0));
    let mut data = Data::new(&["figure", "amplitude_m", "drop_m", "expected_exact_m", "expected_4q_m"]);
    let mil = 1e-3 * INCH;
    for (place, ring) in rings.iter().enumerate() {
        let colour = Colour::Category(place);
        let (decay, equal) = (ring.decay(), ring.equal_width());
        let exact = |x: f64| Form::Exact.drop(x, decay, equal);
        let stated = |x: f64| Form::Paper.drop(x, decay, STATED_Q);
        for cycle in &ring.cycles {
            let x = cycle.amplitude;
            data.rows.push(vec![8.0 + place as f64, x, cycle.drop(), exact(x), stated(x)]);
        }
        let ends = [0.0, 160.0 * mil];
        let line = |label: String, f: &dyn Fn(f64) -> f64| {
            Series::line(label, ends.map(|x| x / mil).to_vec(), ends.map(|x| f(x) / mil).to_vec()).colour(colour)
        };
        let (x, y) = (
            ring.cycles.iter().map(|c| c.amplitude / mil).collect(),
            ring.cycles.iter().map(|c| c.drop() / mil).collect(),
        );
        panel = panel
            .series(Series::points(format!("{}: simulated", ring.label), x, y).colour(colour))
            .series(line("exact, Q k_sec/k_t".into(), &exact).dash(Dash::Solid))
            .series(line("4Q with the Q put in".into(), &stated).dash(Dash::Dashed));
    }
    let figure = Figure::new(Axis::new("amplitude X", "10⁻³ in").starting_at(0.0).ending_at(160.0))
        .caption(assumed(INSIDE))
        .size_mm(120.0, 58.0)
        .panel(panel);
    let caption = "How the peaks shrink: dots from the simulation, solid the exact recursion with c and the equal \
                   linear spring’s Q k_sec/k_t, dashed the paper’s (25) with the c and Q that were put in. The \
                   intercept is the Coulomb part, the slope the viscous one.";
    Plate { stem: "fig-08-09-drops", caption: caption.into(), figure, data }
}
