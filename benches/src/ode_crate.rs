//! The ODE crate `ivp`: its explicit methods with its own events, restarted at every valve edge and event.

use crate::muscle::{GUARDS, Mode, Muscle, State};
use crate::ours::shortest;
use crate::peer::{Peer, Solution};
use crate::problem::{Problem, SAMPLE_INTERVAL};
use ivp::prelude::{Direction, EventConfig, FirstOrderSystem, Ivp, Method, Status};

/// One method of the crate.
pub struct OdeCrate(pub Method);

/// The muscle in one mode, as the crate wants it.
struct InMode<'a> {
    muscle: &'a Muscle,
    mode: Mode,
}

fn state(values: &[f64]) -> State {
    [values[0], values[1], values[2], values[3]]
}

impl FirstOrderSystem for InMode<'_> {
    fn derivative(&self, _time: f64, values: &[f64], slope: &mut [f64]) {
        slope.copy_from_slice(&self.muscle.rates(&self.mode, &state(values)));
    }

    fn n_events(&self) -> usize {
        GUARDS
    }

    fn events(&self, _time: f64, values: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.muscle.guards(&self.mode, &state(values)));
    }

    fn event_config(&self, _index: usize) -> EventConfig {
        EventConfig { direction: Direction::Negative, terminal_count: Some(1) }
    }
}

impl Peer for OdeCrate {
    fn name(&self) -> String {
        format!("ivp {:?}", self.0)
    }

    fn solve(&self, problem: &Problem, tolerance: f64, repeats: u32) -> Result<Solution, String> {
        let solution = simulate(problem, self.0, tolerance)?;
        let seconds = shortest(repeats, || simulate(problem, self.0, tolerance));
        Ok(Solution { seconds, ..solution })
    }
}

fn simulate(problem: &Problem, method: Method, tolerance: f64) -> Result<Solution, String> {
    let muscle = Muscle::new(problem, tolerance);
    let start = problem.experiment.start;
    let mut at = [start.length, start.velocity, start.pressure.0, start.air_mass];
    let mut mode = muscle.begin(problem.initial_port, &at);
    let absolute = problem.magnitudes().map(|magnitude| 0.1 * tolerance * magnitude);
    let last = (problem.duration() / SAMPLE_INTERVAL).round() as usize;
    let mut answer = Solution { samples: vec![[at[0], at[2]]], ..Solution::default() };
    let mut time = 0.0;
    let edges = problem.edges.iter().map(|&(time, port)| (time, Some(port)));
    for (stop, port) in edges.chain([(problem.duration(), None)]) {
        while time < stop {
            let system = InMode { muscle: &muscle, mode };
            let run = Ivp::first_order(&system, time, stop, &at)
                .method(method)
                .rtol(tolerance)
                .atol(absolute)
                .dense_output(true)
                .solve()
                .map_err(|error| format!("at {time} s: {error:?}"))?;
            if !matches!(run.status, Status::Success | Status::UserInterrupt) {
                return Err(format!("after {time} s: {:?}", run.status));
            }
            answer.evaluations += run.nfev as u64;
            answer.steps += run.nstep as u64;
            answer.events += 1;
            let fired = run.t_events.iter().position(|times| !times.is_empty());
            let reached = fired.map_or(stop, |guard| run.t_events[guard][0]);
            while answer.samples.len() <= last && answer.samples.len() as f64 * SAMPLE_INTERVAL <= reached + 1e-13 {
                let instant = (answer.samples.len() as f64 * SAMPLE_INTERVAL).min(reached);
                let row = run.sol(instant).map_err(|error| format!("at {instant} s: {error:?}"))?;
                answer.samples.push([row[0], row[2]]);
            }
            time = reached;
            match fired {
                Some(guard) => {
                    at = state(&run.y_events[guard][0]);
                    muscle.cross(guard, &mut mode, &mut at);
                }
                None => at = run.y.last().map_or(at, |values| state(values)),
            }
        }
        if let Some(port) = port {
            muscle.open(port, &mut mode, &at);
        }
    }
    Ok(answer)
}
