//! The integrator: error against tolerance on problems in closed form, order of the dense output, and a stiff decay.

use crate::common::{assert_close, assert_within};
use mckibben::engine::{GuardForm, Halt, Hybrid, Integrator, Statistics};
use mckibben::{Error, Over, Scalar};

/// Which problem.
#[derive(Clone, Copy, Debug)]
enum Problem {
    /// `y″ = −y`.
    Oscillator,
    /// `y₀′ = y₀ (1 − y₀)` and `y₁′ = −y₁²`.
    Growth,
    /// `y₀′ = −λ (y₀ − cos t)` with λ = 1e5, `y₁′ = −y₁`.
    Stiff,
}

const LAMBDA: f64 = 1e5;

impl Problem {
    fn start(self) -> [f64; 2] {
        match self {
            Self::Oscillator => [1.0, 0.0],
            Self::Growth => [0.01, 2.0],
            Self::Stiff => [0.0, 1.0],
        }
    }

    fn exact(self, t: f64) -> [f64; 2] {
        match self {
            Self::Oscillator => [t.cos(), -t.sin()],
            Self::Growth => [1.0 / (1.0 + 99.0 * (-t).exp()), 1.0 / (0.5 + t)],
            Self::Stiff => {
                let l = LAMBDA;
                let forced = |t: f64| (l * l * t.cos() + l * t.sin()) / (1.0 + l * l);
                [forced(t) - forced(0.0) * (-l * t).exp(), (-t).exp()]
            }
        }
    }
}

impl Hybrid<f64> for Problem {
    type Mode = ();
    type Guard = ();
    type Kind = ();
    type Work<T: Scalar> = ();

    fn states(&self) -> usize {
        2
    }
    fn work<T: Over<f64>>(&self) {}
    fn rates<T: Over<f64>>(&self, time: T, state: &[T], (): &(), (): &mut (), rates: &mut [T]) {
        let (a, b) = (state[0], state[1]);
        (rates[0], rates[1]) = match self {
            Self::Oscillator => (b, -a),
            Self::Growth => (a * (T::one() - a), -(b * b)),
            Self::Stiff => (-T::constant(LAMBDA) * (a - time.cos()), -b),
        };
    }
    fn settling_rate(&self, state: &[f64], (): &(), (): &mut ()) -> f64 {
        match self {
            Self::Oscillator => 0.0,
            Self::Growth => f64::max(2.0 * state[0] - 1.0, 2.0 * state[1]),
            Self::Stiff => LAMBDA,
        }
    }
    fn scales(&self, state: &[f64], (): &(), scales: &mut [f64]) {
        for (scale, value) in scales.iter_mut().zip(state) {
            *scale = value.abs() + 0.1;
        }
    }
    fn next_instant(&self, (): &(), _until: f64) -> Option<f64> {
        None
    }
    fn pass_instant(&self, _time: f64, _state: &mut [f64], (): &mut (), (): &mut ()) -> Result<(), Error> {
        Ok(())
    }
    fn guards(&self, (): &(), guards: &mut Vec<((), GuardForm)>) {
        guards.clear();
    }
    fn guard<T: Over<f64>>(&self, (): (), _time: T, _state: &[T], (): &(), (): &mut ()) -> T {
        T::one()
    }
    fn cross(&self, (): (), _time: f64, _state: &mut [f64], (): &mut (), (): &mut ()) -> Result<(), Error> {
        Ok(())
    }
    fn project(&self, _time: f64, _state: &mut [f64], (): &(), (): &mut ()) {}
    fn halts(&self, time: f64, _state: &[f64], _why: Halt, _event: Option<()>) -> Error {
        Error::Stopped { time, reason: "stuck", quantity: "y", value: 0.0, unit: "", remedy: "none" }
    }
}

/// Largest errors at the ends of steps and between them, and the cost.
fn errors(problem: Problem, until: f64, tolerance: f64) -> (f64, f64, Statistics) {
    let mut integrator = Integrator::new(&problem, 0.0, &problem.start(), (), until, tolerance);
    let apart = |state: &[f64], time: f64| {
        let exact = problem.exact(time);
        f64::max((state[0] - exact[0]).abs(), (state[1] - exact[1]).abs())
    };
    let (mut at_ends, mut between) = (0.0_f64, 0.0_f64);
    while integrator.advance().expect("a step") {
        let piece = integrator.piece();
        assert_eq!(integrator.time(), piece.end);
        at_ends = at_ends.max(apart(integrator.state(), piece.end));
        for theta in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let mut state = [0.0; 2];
            piece.arc.at(theta, &mut state);
            between = between.max(apart(&state, piece.arc.start + theta * piece.arc.step));
        }
    }
    assert_eq!(integrator.time(), until);
    (at_ends, between, integrator.statistics())
}

#[test]
fn the_error_follows_the_tolerance() {
    for (problem, until) in [(Problem::Oscillator, 20.0), (Problem::Growth, 12.0), (Problem::Stiff, 1.0)] {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let (at_ends, between, counts) = errors(problem, until, tolerance);
            // Some tens of steps, none of which is allowed more than the tolerance; growth multiplies early errors by up
            // to e^(1/2) · … < 30; rounding adds a few 1e-15 each.
            assert!(at_ends < 100.0 * tolerance + 1e-13, "{problem:?} at {tolerance:e}: {at_ends:e}, {counts:?}");
            assert!(between < 100.0 * tolerance + 1e-13, "{problem:?} at {tolerance:e}: {between:e} between steps");
        }
    }
}

#[test]
fn the_explicit_method_is_of_order_eight() {
    // On the oscillator the step is nearly constant, so the error falls with the eighth power of the number of steps.
    let points: Vec<(f64, f64)> = [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]
        .map(|tolerance| {
            let (at_ends, _, counts) = errors(Problem::Oscillator, 100.0, tolerance);
            assert_eq!(counts.implicit_steps, 0);
            ((counts.explicit_steps as f64).ln(), at_ends.ln())
        })
        .to_vec();
    let order = -fitted_slope(&points);
    assert!((order - 8.0).abs() < 0.5, "order {order}: {points:?}");
}

fn fitted_slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let (num, den) = points.iter().fold((0.0, 0.0), |(num, den), point| {
        (num + (point.0 - x) * (point.1 - y), den + (point.0 - x) * (point.0 - x))
    });
    num / den
}

#[test]
fn a_stiff_decay_at_a_hundred_thousand_takes_few_steps() {
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        let (at_ends, _, counts) = errors(Problem::Stiff, 10.0, tolerance);
        let steps = counts.explicit_steps + counts.implicit_steps;
        // An explicit method would need a million evaluations for its stability alone.
        // At 1e-10 the error of an explicit step is down to rounding, so that accuracy never allows a much longer one.
        assert!(counts.implicit_steps > 0 && steps < 2000, "{tolerance:e}: {counts:?}");
        assert!(counts.evaluations < 40_000, "{tolerance:e}: {counts:?}");
        assert!(at_ends < 100.0 * tolerance, "{tolerance:e}: {at_ends:e}");
    }
}

#[test]
fn the_end_is_reached_exactly_and_stays_reached() {
    for until in [1e-9, 0.1, 1.0 / 3.0, 1e3] {
        let problem = Problem::Oscillator;
        let mut integrator = Integrator::new(&problem, 0.0, &problem.start(), (), until, 1e-8);
        let mut reached = 0.0;
        while integrator.advance().expect("a step") {
            let piece = integrator.piece();
            assert_close(piece.arc.start, reached, 1e-15);
            reached = piece.end;
        }
        assert_eq!((reached, integrator.time()), (until, until));
        assert!(!integrator.advance().expect("no step"));
        let radius = integrator.state()[0].hypot(integrator.state()[1]);
        assert_within(radius, 1.0, 1e-8 * (1.0 + until));
    }
}
