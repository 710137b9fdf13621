//! What a hose explains of the paper's flow efficiency of 0.85 and of the damping that it missed: every figure of the tables
//! in `docs/air-line.md` is computed again. With `MCKIBBEN_WRITE` set the rows are printed instead.

use crate::common::{ATMOSPHERE, INCH, LB, LBF, PSI, Paper, ROOM, bisect};
use mckibben::AbsolutePressure;
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{Rig, State, simulate};
use mckibben::valve::{Command, Request, ValveKind};
use std::f64::consts::PI;

/// Length and bore of the hoses in m.
const HOSES: [[f64; 2]; 4] = [[0.5, 2e-3], [1.0, 2e-3], [1.0, 2.5e-3], [1.0, 4e-3]];
/// Bores in m and lengths in m of the first table.
const BORES: [f64; 5] = [1.5e-3, 2e-3, 2.5e-3, 3e-3, 4e-3];
const LENGTHS: [f64; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];

fn hosed(paper: &Paper, kind: HoseKind, size: [f64; 2]) -> Rig {
    let hose = Hose::new(kind, size, [1.82e-5, ROOM, 1.0], &paper.air()).expect("a hose");
    paper.rig().with_line(Line { hose: Some(hose), ..Line::NONE }).expect("a line")
}

fn filling() -> Paper {
    Paper::driven(Command::Constant(Request::Fill)).with(|rig| (rig.delays, rig.efficiency) = ((0.0, 0.0), 1.0))
}

/// Checks a row of a table of the page, each number within its last digit.
fn check(label: &str, numbers: &[f64], digits: usize) {
    let cells: Vec<String> = numbers.iter().map(|number| format!("{number:.digits$}")).collect();
    let row = format!("| {label} | {} |", cells.join(" | "));
    if std::env::var_os("MCKIBBEN_WRITE").is_some() {
        println!("{row}");
        return;
    }
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/air-line.md");
    let text = std::fs::read_to_string(page).expect("the page");
    let start = format!("| {label} |");
    let line = text.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("no row {label:?}"));
    let said: Vec<f64> = line[start.len()..].split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
    assert_eq!(said.len(), numbers.len(), "{line}");
    for (said, number) in said.iter().zip(numbers) {
        assert!((said - number).abs() < 1.01 * 0.1_f64.powi(digits as i32), "the page says {line}, measured is {row}");
    }
}

/// The part of the flow that the friction leaves: how much longer a held actuator takes from 20 to 80 psi than one with the
/// hose's volume in addition and no friction, at constant temperature.
fn efficiency(kind: HoseKind, [length, bore]: [f64; 2]) -> f64 {
    let paper = filling().process(Process::Isothermal).isometric(3.5 * INCH);
    let beside = paper.clone().with(|rig| rig.external_volume += PI / 4.0 * bore * bore * length);
    let taken = |run: &RigTrajectory| {
        let at = |psi: f64| bisect(1e-6, 1.0, |time| run.at(time).pressure.0 - ATMOSPHERE - psi * PSI);
        at(80.0) - at(20.0)
    };
    let through = simulate(&hosed(&paper, kind, [length, bore]), paper.start(), 1.0, 1e-7).expect("a run");
    taken(&beside.run(1.0, 1e-8)) / taken(&through)
}

#[test]
fn what_the_friction_takes_from_the_flow() {
    for bore in BORES {
        let numbers = LENGTHS.map(|length| efficiency(HoseKind::Lumped, [length, bore]));
        check(&format!("{} mm, lumped", bore * 1e3), &numbers, 2);
        let numbers = LENGTHS.map(|length| efficiency(HoseKind::Distributed { cells: 8 }, [length, bore]));
        check(&format!("{} mm, 8 cells", bore * 1e3), &numbers, 2);
    }
}

/// Damping ratio of the first cycles of a ring-down by 0.1 in, by the logarithmic decrement of its swings.
fn damping(rig: &Rig, start: State) -> f64 {
    let run = simulate(rig, start, 1.0, 1e-9).expect("a run");
    let lengths: Vec<f64> = run.samples(1e-4).map(|sample| sample.length).collect();
    let turns: Vec<f64> =
        lengths.windows(3).filter(|at| (at[1] - at[0]) * (at[2] - at[1]) < 0.0).map(|at| at[1]).collect();
    let swings: Vec<f64> = turns.windows(2).map(|pair| (pair[0] - pair[1]).abs()).collect();
    (swings[0] / swings[3]).ln() / (3.0 * PI)
}

fn ringing(mass: f64, friction: [f64; 2]) -> Paper {
    let paper = filling().mass(mass * LB).gauge(60.0 * PSI).friction(friction[0], friction[1]);
    let paper = paper.with(|rig| rig.supply_gauge = 60.0 * PSI);
    let rest = paper.rig().equilibrium(AbsolutePressure(60.0 * PSI + ATMOSPHERE)).expect("a balance");
    paper.from(rest + 0.1 * INCH, 0.0)
}

#[test]
fn what_the_hose_adds_to_the_damping() {
    const MASSES: [f64; 3] = [1.0, 5.0, 15.0];
    let open = |mass| ringing(mass, [0.0, 0.0]);
    let sealed = |mass| {
        open(mass).with(|rig| {
            (rig.kind, rig.command) = (ValveKind::FillHoldExhaust, Some(Command::Constant(Request::Hold)));
        })
    };
    let of = |paper: Paper| damping(&paper.rig(), paper.start());
    check("the paper's c and Q, sealed", &MASSES.map(|mass| of(ringing(mass, [0.02 * LBF / INCH, 0.0044 * INCH]))), 4);
    check("valve on the supply, no hose", &MASSES.map(|mass| of(open(mass))), 4);
    for [length, bore] in HOSES {
        let name = format!("{length} m of {} mm", bore * 1e3);
        let of = |paper: Paper| damping(&hosed(&paper, HoseKind::Lumped, [length, bore]), paper.start());
        check(&format!("valve on the supply, {name}"), &MASSES.map(|mass| of(open(mass))), 4);
        check(&format!("valve shut, {name}"), &MASSES.map(|mass| of(sealed(mass))), 4);
    }
}

/// Mean length in inches and mean gauge pressure in psi over the last of six seconds under the paper's PWM.
fn pulsed(rig: &Rig, paper: &Paper) -> [f64; 2] {
    let run = simulate(rig, paper.start(), 6.0, 1e-6).expect("a run");
    let (mut count, mut sums) = (0.0, [0.0; 2]);
    for sample in run.samples(1e-3).skip(5001) {
        count += 1.0;
        sums = [sums[0] + sample.length / INCH, sums[1] + (sample.pressure.0 - ATMOSPHERE) / PSI];
    }
    sums.map(|sum| sum / count)
}

#[test]
fn what_the_hose_does_to_the_pulsed_mass() {
    let paper =
        |mass: f64, efficiency: f64| Paper::pwm(25.0, 0.5).mass(mass * LB).with(|rig| rig.efficiency = efficiency);
    let both = |run: &dyn Fn(f64) -> [f64; 2]| {
        let [light, heavy] = [5.0, 15.0].map(run);
        [light[0], light[1], heavy[0], heavy[1]]
    };
    for efficiency in [1.0, 0.85] {
        let numbers = both(&|mass| pulsed(&paper(mass, efficiency).rig(), &paper(mass, efficiency)));
        check(&format!("no hose, efficiency {efficiency}"), &numbers, 2);
    }
    for [length, bore] in HOSES {
        let name = format!("{length} m of {} mm", bore * 1e3);
        let beside = |mass| paper(mass, 1.0).with(|rig| rig.external_volume += PI / 4.0 * bore * bore * length);
        check(&format!("the volume of {name} alone"), &both(&|mass| pulsed(&beside(mass).rig(), &beside(mass))), 2);
        let through = |mass| hosed(&paper(mass, 1.0), HoseKind::Lumped, [length, bore]);
        check(&format!("{name}, efficiency 1"), &both(&|mass| pulsed(&through(mass), &paper(mass, 1.0))), 2);
    }
}
