//! A leg of two segments steps on a belt: three antagonistic pairs of the paper's actuator, each valve under PWM.
//!
//! ```text
//! cargo run --release --example leg -- FOLDER [svg|png]
//! ```
//!
//! writes `leg.svg`, the courses over time, and `leg-sticks.svg`, the leg in one stride, into a folder. Nobody measures
//! anything: the duty cycles are a table over the stride. The leg's numbers are assumed, of the size of a small dog's.

use mckibben::GaugePressure;
use mckibben::control::Drive;
use mckibben::load::leg::{Leg, LegState, STRANDS};
use mckibben::simulation::LegStepper;
use mckibben::valve::Request;
use mckibben_cli::plot::{Axis, Colour, Figure, Legend, Panel, Series, Theme};
use mckibben_scenario::Document;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

const MUSCLE: &str = r#"
actuator.preset = "colbrunn-2001"
supply.gauge_pressure = "100 psi"
valve.preset = "matrix-eight-channel"
command = { kind = "pwm", frequency = "25 Hz", duty = 0.5 }
load.kind = "isometric"
initial = { gauge_pressure = "15 psi", length = "80 mm" }
run.duration = "1 s"
"#;

/// Pulses in a second.
const FREQUENCY: f64 = 25.0;
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
    let rig = Document::parse(MUSCLE, "muscle")?.experiment()?.rig;
    let leg = Leg::small_dog();
    let start = LegState { angles: [0.1, -0.5], rates: [0.0; 2] };
    let gauge = GaugePressure(1e5);
    let mut stepper = LegStepper::new(leg, start, [(&rig, gauge); STRANDS], 293.15, FREQUENCY)?;
    let mut walked = Walked::default();
    for stride in 0..STRIDES.0 {
        for count in 0..STEPS {
            let phase = f64::from(count) / f64::from(STEPS);
            stepper.drive(duties(phase).map(pulses))?;
            let drawn = stride + STRIDES.1 >= STRIDES.0;
            if drawn && count % DRAWN.0 == 0 {
                walked.see(&stepper, f64::from(STRIDES.0 - STRIDES.1) * STRIDE);
            }
            if stride + 1 == STRIDES.0 && count % DRAWN.1 == 0 {
                walked.stand(&stepper);
            }
            stepper.advance_to(STRIDE * (f64::from(stride) + f64::from(count + 1) / f64::from(STEPS)))?;
        }
    }
    walked.tell();
    walked.courses().write(&folder.join(format!("leg.{ending}")), Theme::default())?;
    walked.sticks(&leg).write(&folder.join(format!("leg-sticks.{ending}")), Theme::default())?;
    println!("wrote leg.{ending} and leg-sticks.{ending} into {}", folder.display());
    Ok(())
}

/// Duty cycles over a stride. It begins as the foot lifts: the hip swings forward while the knee is bent, then the knee
/// stretches and the hip draws back.
fn duties(phase: f64) -> [f64; STRANDS] {
    let hip = 0.19 * (TAU * (phase - 0.02)).sin();
    let bend = 0.40 * (0.5 + 0.5 * (TAU * (phase - 0.08)).cos()).powi(2);
    [0.44 + hip, 0.42 - hip, 0.46 - bend, 0.24 + bend, 0.25, 0.25]
}

fn pulses(duty: f64) -> Drive {
    Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust }
}

/// What is drawn of a walk.
#[derive(Default)]
struct Walked {
    time: Vec<f64>,
    angles: [Vec<f64>; 2],
    pressures: [Vec<f64>; STRANDS],
    belt: [Vec<f64>; 2],
    foot: [Vec<f64>; 2],
    sticks: Vec<[[f64; 2]; 2]>,
}

impl Walked {
    fn see(&mut self, stepper: &LegStepper, from: f64) {
        let (leg, state) = (stepper.leg(), stepper.state());
        self.time.push(stepper.time() - from);
        for joint in 0..2 {
            self.angles[joint].push(state.angles[joint].to_degrees());
        }
        for (pressures, actuator) in self.pressures.iter_mut().zip(stepper.actuators()) {
            pressures.push(actuator.state().pressure.0 - 101_325.0);
        }
        let [_, foot] = leg.places(&state.angles);
        let force = leg.belt_force(state);
        for axis in 0..2 {
            self.belt[axis].push(force[axis]);
            self.foot[axis].push(foot[axis]);
        }
    }

    fn stand(&mut self, stepper: &LegStepper) {
        self.sticks.push(stepper.leg().places(&stepper.state().angles));
    }

    fn tell(&self) {
        let range = |values: &[f64]| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        for (name, values, unit, factor) in [
            ("hip", &self.angles[0], "deg", 1.0),
            ("knee", &self.angles[1], "deg", 1.0),
            ("foot forward", &self.foot[0], "mm", 1e3),
            ("foot up", &self.foot[1], "mm", 1e3),
            ("belt up", &self.belt[1], "N", 1.0),
        ] {
            let (low, high) = range(values);
            println!("{name:13} {:7.1} to {:7.1} {unit}", low * factor, high * factor);
        }
        let carried = self.belt[1].iter().filter(|force| **force > 0.0).count();
        println!("on the belt   {:7.1} % of the stride", 100.0 * carried as f64 / self.time.len() as f64);
    }

    fn courses(&self) -> Figure {
        let line = |label: &str, values: &[f64], colour: usize| {
            Series::line(label, self.time.clone(), values.to_vec()).colour(Colour::Category(colour))
        };
        let pair = |name: &str, first: usize| {
            Panel::new(Axis::new(format!("{name} pressure"), "Pa").starting_at(0.0))
                .series(line("forward", &self.pressures[first], 0))
                .series(line("back", &self.pressures[first + 1], 1))
                .legend(Legend::Above)
        };
        let angles = Panel::new(Axis::new("angle", "deg")).series(line("hip", &self.angles[0], 0)).series(line(
            "knee",
            &self.angles[1],
            1,
        ));
        let force = Panel::new(Axis::new("belt on foot", "N")).series(line("up", &self.belt[1], 0)).series(line(
            "forward",
            &self.belt[0],
            1,
        ));
        Figure::new(Axis::new("time", "s"))
            .title("A leg steps under PWM")
            .panel(angles)
            .panel(pair("hip", 0))
            .panel(pair("knee", 2))
            .panel(pair("both", 4))
            .panel(force)
            .size_mm(120.0, 26.0)
    }

    fn sticks(&self, leg: &Leg) -> Figure {
        let mut panel = Panel::new(Axis::new("height", "m"));
        let axis = Axis::new("forward", "m").starting_at(-0.28).ending_at(0.28);
        for (count, [knee, foot]) in self.sticks.iter().enumerate() {
            let stick = Series::line("", vec![0.0, knee[0], foot[0]], vec![0.0, knee[1], foot[1]]);
            panel = panel.series(stick.colour(Colour::Ramp(count as f64 / self.sticks.len() as f64)));
        }
        let [x, y] = &self.foot;
        panel = panel.series(Series::line("foot", x.clone(), y.clone()).colour(Colour::Category(1)));
        if let Some(belt) = leg.belt {
            panel = panel.horizontal(-belt.depth, "belt");
        }
        Figure::new(axis).title("One stride").panel(panel).size_mm(110.0, 95.0)
    }
}
