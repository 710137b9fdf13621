//! The leg of `examples/plant/leg.toml` with pulsed valves, stepped by a custom loop: six of the paper's actuators,
//! each valve under PWM, and a belt under the foot.
//!
//! ```text
//! cargo run --release --example leg -- FOLDER [svg|png]
//! ```
//!
//! writes `leg.svg`, the time series, and `leg-sticks.svg`, the leg in one stride, into a folder. Nothing measures
//! anything: the duty cycles are a table over the stride. The leg's numbers are assumed, of the size of a small dog's.

use mckibben::mechanism::{Chain, Mechanism};
use mckibben::plant::{PlantRun, PlantSteps};
use mckibben::simulation::Method;
use mckibben::valve::{Request, RuntimeCommand};
use mckibben_plot::{Axis, Colour, Figure, Format, Legend, Panel, Series};
use mckibben_run::{output, units};
use mckibben_scenario::{Document, PlantExperiment};
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/leg.toml");
/// The actuators in the order of the duty cycles; a pair stands together.
const MUSCLES: [&str; 6] = ["hip-forward", "hip-back", "knee-forward", "knee-back", "both-forward", "both-back"];
/// Time of a stride in s.
const STRIDE: f64 = 1.2;
/// Strides that are walked, and those of them that are drawn.
const STRIDES: (u32, u32) = (6, 2);
/// Steps in a stride: a tenth of a millisecond each.
const STEPS: u32 = 12_000;
/// Steps between two points of a figure, and between two sticks.
const DRAWN: (u32, u32) = (24, 600);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or(PathBuf::from("."), PathBuf::from);
    let ending = std::env::args().nth(2).unwrap_or("svg".into());
    let PlantExperiment { plant, start, names, .. } = pulsed()?.plant_experiment()?.ok_or("the file has no plant")?;
    let [Mechanism::Chain(leg)] = plant.mechanisms() else { return Err("the leg is one chain".into()) };
    let actuator = |name: &str| names.actuators.iter().position(|its| its == name).ok_or("an actuator is missing");
    let places = MUSCLES.iter().map(|name| actuator(name)).collect::<Result<Vec<usize>, _>>()?;
    let valves = places.iter().map(|i| names.valves[*i].ok_or("a valve is missing")).collect::<Result<Vec<_>, _>>()?;
    let mut steps = PlantRun::new(&plant, &start, 1e-9)?.steps(Method::Stable);
    let mut walked = Walked::default();
    for stride in 0..STRIDES.0 {
        for count in 0..STEPS {
            for (valve, duty) in valves.iter().zip(duties(f64::from(count) / f64::from(STEPS))) {
                let pulses =
                    RuntimeCommand::Pulses { frequency: 25.0, duty, pulse: Request::Fill, rest: Request::Exhaust };
                steps.set(*valve, pulses)?;
            }
            if stride + STRIDES.1 >= STRIDES.0 && count % DRAWN.0 == 0 {
                walked.see(leg, &places, &steps);
            }
            if stride + 1 == STRIDES.0 && count % DRAWN.1 == 0 {
                walked.stand(leg, &steps);
            }
            steps.advance_to(STRIDE * (f64::from(stride) + f64::from(count + 1) / f64::from(STEPS)))?;
        }
    }
    walked.print_walk();
    for (stem, figure) in [("leg", walked.trajectories()), ("leg-sticks", walked.sticks(leg))] {
        let path = folder.join(format!("{stem}.{ending}"));
        output::write(&path, &units::drawn(figure).bytes(Format::of(&path)?)?)?;
    }
    println!("wrote leg.{ending} and leg-sticks.{ending} into {}", folder.display());
    Ok(())
}

/// The leg of the file with the paper's valves in place of pressure regulators, and no command.
fn pulsed() -> Result<Document, Box<dyn Error>> {
    let mut leg = Document::load(FILE)?;
    leg.remove("valve");
    leg.remove("command");
    for muscle in MUSCLES {
        leg.remove(&format!("actuators.{muscle}.command"));
    }
    leg.set_text("valve.preset", "\"matrix-eight-channel\"")?;
    leg.set_text("command.kind", "\"exhaust\"")?;
    Ok(leg)
}

/// Duty cycles over a stride. It begins as the foot lifts: the hip swings forward while the knee is bent, then the knee
/// stretches and the hip draws back.
fn duties(phase: f64) -> [f64; 6] {
    let hip = 0.19 * (TAU * (phase - 0.02)).sin();
    let bend = 0.40 * (0.5 + 0.5 * (TAU * (phase - 0.08)).cos()).powi(2);
    [0.44 + hip, 0.42 - hip, 0.46 - bend, 0.24 + bend, 0.25, 0.25]
}

/// What is drawn of a walk.
#[derive(Default)]
struct Walked {
    time: Vec<f64>,
    angles: [Vec<f64>; 2],
    pressures: [Vec<f64>; 6],
    press: Vec<f64>,
    foot: [Vec<f64>; 2],
    sticks: Vec<[[f64; 2]; 2]>,
}

impl Walked {
    fn see(&mut self, leg: &Chain, places: &[usize], steps: &PlantSteps) {
        self.time.push(steps.time() - f64::from(STRIDES.0 - STRIDES.1) * STRIDE);
        let sample = steps.sample();
        let (angle, rate) = (&sample.mechanisms[0].position, &sample.mechanisms[0].rate);
        for (angles, angle) in self.angles.iter_mut().zip(angle) {
            angles.push(angle.to_degrees());
        }
        for (pressures, place) in self.pressures.iter_mut().zip(places) {
            pressures.push(sample.actuators[*place].pressure.0 - 101_325.0);
        }
        let is_down = leg.foot(angle, rate).is_some_and(|(depth, _)| depth > 0.0);
        self.press.push(if is_down { leg.foot_press(angle, rate).max(0.0) } else { 0.0 });
        for (axis, place) in leg.joint_place(2, angle).into_iter().enumerate() {
            self.foot[axis].push(place);
        }
    }

    fn stand(&mut self, leg: &Chain, steps: &PlantSteps) {
        let angle = &steps.sample().mechanisms[0].position;
        self.sticks.push([1, 2].map(|joint| leg.joint_place(joint, angle)));
    }

    fn print_walk(&self) {
        let range = |values: &[f64]| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        for (name, values, unit, factor) in [
            ("hip", &self.angles[0], "deg", 1.0),
            ("knee", &self.angles[1], "deg", 1.0),
            ("foot forward", &self.foot[0], "mm", 1e3),
            ("foot up", &self.foot[1], "mm", 1e3),
            ("belt up", &self.press, "N", 1.0),
        ] {
            let (low, high) = range(values);
            println!("{name:13} {:7.1} to {:7.1} {unit}", low * factor, high * factor);
        }
        let carried = self.press.iter().filter(|force| **force > 0.0).count();
        println!("on the belt   {:7.1} % of the stride", 100.0 * carried as f64 / self.time.len() as f64);
    }

    fn trajectories(&self) -> Figure {
        let line = |label: &str, values: &[f64], colour: usize| {
            Series::line(label, self.time.clone(), values.to_vec()).colour(Colour::Category(colour))
        };
        let pair = |name: &str, first: usize| {
            Panel::new(Axis::new(format!("{name}, gauge pressure"), "Pa").starting_at(0.0))
                .series(line("forward", &self.pressures[first], 0))
                .series(line("back", &self.pressures[first + 1], 1))
                .legend(Legend::Above)
        };
        let angles = Panel::new(Axis::new("angle", "°"));
        let [hip, knee] = &self.angles;
        Figure::new(Axis::new("time", "s"))
            .title("A leg steps under PWM")
            .panel(angles.series(line("hip", hip, 0)).series(line("knee", knee, 1)))
            .panel(pair("hip", 0))
            .panel(pair("knee", 2))
            .panel(pair("both", 4))
            .panel(Panel::new(Axis::new("belt on foot", "N")).series(line("up", &self.press, 0)))
            .size_mm(120.0, 26.0)
    }

    fn sticks(&self, leg: &Chain) -> Figure {
        let mut panel = Panel::new(Axis::new("height", "m"));
        let axis = Axis::new("forward", "m").starting_at(-0.28).ending_at(0.28);
        for (count, [knee, foot]) in self.sticks.iter().enumerate() {
            let stick = Series::line("", vec![0.0, knee[0], foot[0]], vec![0.0, knee[1], foot[1]]);
            panel = panel.series(stick.colour(Colour::Ramp(count as f64 / self.sticks.len() as f64)));
        }
        let [x, y] = &self.foot;
        panel = panel.series(Series::line("foot", x.clone(), y.clone()).colour(Colour::Category(1)));
        if let Some(belt) = leg.belt() {
            panel = panel.horizontal(-belt.depth, "belt");
        }
        Figure::new(axis)
            .title("One stride")
            .note("a stick every twentieth of the stride, from dark at its start to light at its end")
            .panel(panel)
            .size_mm(110.0, 95.0)
    }
}
