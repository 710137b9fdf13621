//! Speed of our event-located integrator against its peers, at equal error.
//!
//! See README.md; in short: `cargo run --release` in this folder.

mod muscle;
mod ode_crate;
mod ours;
mod peer;
mod problem;
mod process;
mod report;
mod sundials;

use ivp::prelude::Method;
use ode_crate::OdeCrate;
use peer::Peer;
use problem::Problem;
use process::Process;
use std::path::Path;
use std::process::{Command, ExitCode};

/// The tolerance requested of all solvers.
const TOLERANCE: f64 = 1e-8;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Whether the comparison is complete.
fn run() -> Result<bool, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scenarios = here.join("../validation/reference");
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let built = program.parent().ok_or("the program lies in no folder")?;

    let mut peers: Vec<Box<dyn Peer>> = Vec::new();
    let mut missing = Vec::new();
    for method in [Method::DOP853, Method::DOPRI5] {
        peers.push(Box::new(OdeCrate(method)));
    }
    match sundials::build(&here.join("peers"), built) {
        Ok((program, version)) => {
            println!("SUNDIALS {version}, built with {}", sundials::FLAGS.join(" "));
            peers.extend(sundials::peers(&program).map(|peer| Box::new(peer) as Box<dyn Peer>));
        }
        Err(message) => missing.push(message),
    }
    match scipy(&here.join("peers/scipy_peer.py")) {
        Ok((peer, version)) => {
            println!("SciPy {version}");
            peers.push(Box::new(peer));
        }
        Err(message) => missing.push(message),
    }

    let name = std::env::args().nth(1).unwrap_or_else(|| "pwm-25hz-5lb".into());
    let problem = Problem::load(&scenarios.join(format!("{name}.toml")))?;
    println!("\n{name}.toml, {} s, rows each ms", problem.duration());
    report::comparison(&problem, &peers, TOLERANCE)?;
    println!();
    report::profile(&problem, TOLERANCE)?;
    println!();
    report::scenarios(&scenarios, &["pwm-25hz-5lb", "pwm-50hz-15lb", "sealed-ring-down", "stick-slip", "isometric"])?;
    for message in &missing {
        println!("\nNOT COMPARED: {message}");
    }
    Ok(missing.is_empty())
}

/// SciPy's DOP853, if Python has it.
fn scipy(script: &Path) -> Result<(Process, String), String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let version = Command::new(&python).args(["-c", "import scipy; print(scipy.__version__)"]).output();
    match version {
        Ok(output) if output.status.success() => Ok((
            Process {
                name: "SciPy DOP853".into(),
                program: python.into(),
                arguments: vec![script.display().to_string()],
                method: "DOP853".into(),
                repeats: 12,
            },
            String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        )),
        _ => Err(format!("{python} has no SciPy: python3 -m pip install scipy")),
    }
}
