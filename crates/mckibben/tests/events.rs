//! The contract of events, clause by clause: the generic integrator on systems whose events are known in closed form.
//!
//! The clauses are those of `mckibben::engine::event`. Rigs meet the same rules in `tests/stops.rs`.

use crate::common::{GRAVITY, Paper, assert_within};
use mckibben::engine::{GuardForm, Halt, Hybrid, Integrator, Statistics};
use mckibben::simulation::EventKind;
use mckibben::{Error, Over, Scalar};

/// `y′ᵢ = constantᵢ + timeᵢ t + Σ matrixᵢⱼ yⱼ`.
#[derive(Clone, Copy, Default)]
struct Field {
    constant: [f64; 2],
    time: [f64; 2],
    matrix: [[f64; 2]; 2],
}

/// A guard with its form; as a function it is `f₀ + f₁ y₀ + f₂ y₀²`.
#[derive(Clone, Copy)]
struct Watch {
    name: char,
    form: GuardForm,
    function: [f64; 3],
}

fn above(name: char, index: usize, bound: f64) -> Watch {
    Watch { name, form: GuardForm::Above { index, bound }, function: [0.0; 3] }
}
fn below(name: char, index: usize, bound: f64) -> Watch {
    Watch { name, form: GuardForm::Below { index, bound }, function: [0.0; 3] }
}
fn function(name: char, function: [f64; 3]) -> Watch {
    Watch { name, form: GuardForm::Function, function }
}

/// A system of two states: enough for every clause.
struct Small {
    /// By the number of guards that were crossed.
    field: fn(u64) -> Field,
    /// Those that are armed after so many crossings.
    watches: fn(u64) -> Vec<Watch>,
    reset: fn(char, &mut [f64; 2]),
    instants: Vec<f64>,
    magnitude: f64,
}

/// How many guards were crossed, and how many instants passed.
type Mode = (u64, usize);

impl Small {
    fn new(field: fn(u64) -> Field, watches: fn(u64) -> Vec<Watch>) -> Self {
        // States count as small against this magnitude: the first step spans the whole time, and error control, which the
        // polynomials here satisfy exactly, does not shorten it.
        Self { field, watches, reset: |_, _| {}, instants: Vec::new(), magnitude: 1e9 }
    }
}

impl Hybrid<f64> for Small {
    type Mode = Mode;
    type Guard = char;
    type Kind = char;
    type Work<T: Scalar> = ();

    fn states(&self) -> usize {
        2
    }
    fn work<T: Over<f64>>(&self) {}
    fn rates<T: Over<f64>>(&self, time: T, state: &[T], mode: &Mode, (): &mut (), rates: &mut [T]) {
        let field = (self.field)(mode.0);
        for (i, rate) in rates.iter_mut().enumerate() {
            *rate = T::constant(field.constant[i])
                + T::constant(field.time[i]) * time
                + T::constant(field.matrix[i][0]) * state[0]
                + T::constant(field.matrix[i][1]) * state[1];
        }
    }
    fn settling_rate(&self, _state: &[f64], mode: &Mode, (): &mut ()) -> f64 {
        let field = (self.field)(mode.0);
        (0..2).fold(0.0, |fastest: f64, i| fastest.max(-field.matrix[i][i]))
    }
    fn scales(&self, state: &[f64], _mode: &Mode, scales: &mut [f64]) {
        for (scale, value) in scales.iter_mut().zip(state) {
            *scale = value.abs() + 0.1 * self.magnitude;
        }
    }
    fn next_instant(&self, mode: &Mode, until: f64) -> Option<f64> {
        self.instants.get(mode.1).copied().filter(|instant| *instant <= until)
    }
    fn pass_instant(&self, _time: f64, _state: &mut [f64], mode: &mut Mode, (): &mut ()) -> Result<char, Error> {
        mode.1 += 1;
        Ok('i')
    }
    fn guards(&self, mode: &Mode, guards: &mut Vec<(char, GuardForm)>) {
        *guards = (self.watches)(mode.0).iter().map(|watch| (watch.name, watch.form)).collect();
    }
    fn guard<T: Over<f64>>(&self, guard: char, _time: T, state: &[T], mode: &Mode, (): &mut ()) -> T {
        let watch = (self.watches)(mode.0).into_iter().find(|watch| watch.name == guard).expect("an armed guard");
        let value = |index: usize, bound: f64| state[index] - T::constant(bound);
        match watch.form {
            GuardForm::Above { index, bound } => value(index, bound),
            GuardForm::Below { index, bound } => -value(index, bound),
            GuardForm::Function => {
                let [f0, f1, f2] = watch.function.map(T::constant);
                f0 + state[0] * (f1 + f2 * state[0])
            }
        }
    }
    fn cross(&self, guard: char, _time: f64, state: &mut [f64], mode: &mut Mode, (): &mut ()) -> Result<char, Error> {
        mode.0 += 1;
        let mut both = [state[0], state[1]];
        (self.reset)(guard, &mut both);
        state.copy_from_slice(&both);
        Ok(guard)
    }
    fn project(&self, _time: f64, _state: &mut [f64], _mode: &Mode, (): &mut ()) {}
    fn halts(&self, time: f64, _state: &[f64], why: Halt, _event: Option<char>) -> Error {
        let reason = match why {
            Halt::Events => "events",
            Halt::Step(_) => "step",
            Halt::Crawls(_) => "crawls",
        };
        Error::Stopped { time, reason, quantity: "height", value: 0.0, unit: "m", remedy: "none" }
    }
}

/// A log of events, the final state and mode, and the cost.
struct Log {
    events: Vec<(f64, char)>,
    state: [f64; 2],
    mode: Mode,
    counts: Statistics,
}

fn try_run(system: &Small, state: [f64; 2], until: f64) -> Result<Log, Error> {
    let mut integrator = Integrator::new(system, 0.0, &state, (0, 0), until, 1e-9);
    let mut events = Vec::new();
    let mut reached = 0.0;
    let mut before = (0, 0);
    while integrator.advance()? {
        let piece = integrator.piece();
        assert!(piece.end >= reached, "time goes back from {reached} to {}", piece.end);
        reached = piece.end;
        if let Some((kind, after)) = piece.event {
            assert_ne!(before, *after, "an event changes the mode");
            before = *after;
            events.push((piece.end, kind));
        }
    }
    assert_eq!(integrator.time(), until);
    let state = [integrator.state()[0], integrator.state()[1]];
    Ok(Log { events, state, mode: *integrator.mode(), counts: integrator.statistics() })
}

fn run(system: &Small, state: [f64; 2], until: f64) -> Log {
    try_run(system, state, until).expect("the run reaches its end")
}

fn names(log: &Log) -> String {
    log.events.iter().map(|(_, name)| *name).collect()
}

/// Constant acceleration of `y[0]`, with its rate in `y[1]`.
fn falling(_: u64) -> Field {
    Field { constant: [0.0, -GRAVITY], matrix: [[0.0, 1.0], [0.0, 0.0]], ..Field::default() }
}

fn bouncing_ball() -> Small {
    Small { reset: |_, y| *y = [0.0, -0.8 * y[1]], ..Small::new(falling, |_| vec![above('b', 0, 0.0)]) }
}

#[test]
fn a_bouncing_ball_bounces_when_it_should() {
    // Thrown up at v it is back after 2v/g, and each hop lasts 0.8 of the one before: twelve within 0.95 of their sum.
    for step in 0..100 {
        let speed = 1.0 + 0.02 * f64::from(step);
        let first = 2.0 * speed / GRAVITY;
        let log = run(&bouncing_ball(), [0.0, speed], 0.935 * first / 0.2);
        assert_eq!(log.events.len(), 12, "{:?}", log.events);
        for (bounce, (time, _)) in log.events.iter().enumerate() {
            let expected = first * (1.0 - 0.8_f64.powi(bounce as i32 + 1)) / 0.2;
            // Every hop starts at zero height and is located to 1e-15 of a step of up to 3 s.
            assert_within(*time, expected, 1e-13);
        }
    }
}

#[test]
fn clause_1_an_event_at_the_final_time_is_logged_and_crossed() {
    let system = Small { instants: vec![0.25, 1.0, 1.5], ..Small::new(falling, |_| Vec::new()) };
    let log = run(&system, [5.0, 0.0], 1.0);
    assert_eq!(log.events, [(0.25, 'i'), (1.0, 'i')]);
    assert_eq!(log.mode, (0, 2));
    assert_within(log.state[0], 5.0 - GRAVITY / 2.0, 1e-14);
    // A guard that goes below zero a thousandth of a nanosecond before the end.
    let straight = |_| Field { constant: [-1.0, 0.0], ..Field::default() };
    let log = run(
        &Small::new(straight, |crossed| vec![above('g', 0, 0.0); usize::from(crossed == 0)]),
        [1.0 - 1e-12, 0.0],
        1.0,
    );
    assert_eq!((names(&log).as_str(), log.mode), ("g", (1, 0)));
    // A poppet that moves in the last instant of a run: opened at 12 · 40 ms + 4 ms.
    let run = Paper::pwm(25.0, 0.5).run(0.484, 1e-8);
    let last = run.events().last().expect("an event");
    assert_eq!((last.time, last.kind), (0.484, EventKind::Valve));
    assert_eq!(run.at(0.484).ports.name(), "supply");
    assert_eq!(run.at(0.484 - 1e-9).ports.name(), "exhaust");
}

#[test]
fn clause_2_the_armed_side_is_not_read_off_the_sign_at_the_start() {
    // Thrown up from the boundary, or from a rounding beyond it: no event there, one when it comes back.
    for start in [0.0, -1e-17, -1e-15, 1e-15] {
        let system = Small::new(falling, |crossed| vec![above('g', 0, 0.0); usize::from(crossed == 0)]);
        let log = run(&system, [start, 1.0], 1.0);
        assert_eq!(names(&log), "g", "from {start}");
        assert_within(log.events[0].0, 2.0 / GRAVITY, 1e-14);
    }
}

#[test]
fn clause_2_a_start_on_the_boundary_of_an_oscillator() {
    // y = ½ cos t + sin t is above one half from the start until tan(t/2) = 2.
    let swing = |_| Field { matrix: [[0.0, 1.0], [-1.0, 0.0]], ..Field::default() };
    let system =
        Small { magnitude: 1.0, ..Small::new(swing, |crossed| vec![above('g', 0, 0.5); usize::from(crossed == 0)]) };
    for start in [0.5, 0.5 - 1e-16] {
        let log = run(&system, [start, 1.0], 6.0);
        assert_eq!(names(&log), "g");
        assert_within(log.events[0].0, 2.0 * 2.0_f64.atan(), 1e-8);
    }
}

#[test]
fn clause_3_touching_zero_and_leaving_again_is_no_event() {
    // y = (t − 1)², above zero but for one instant.
    let touching = |_| Field { constant: [-2.0, 0.0], time: [2.0, 0.0], ..Field::default() };
    for watch in [|_: u64| vec![above('g', 0, 0.0)], |_: u64| vec![function('g', [0.0, 1.0, 0.0])]] {
        let log = run(&Small::new(touching, watch), [1.0 + 1e-14, 0.0], 3.0);
        assert_eq!(names(&log), "", "{:?}", log.events);
        // A dip a hundred-thousandth wide is found, though the step is 3 s.
        let dipping = Small::new(touching, watch);
        let mut integrator = Integrator::new(&dipping, 0.0, &[1.0 - 1e-10, 0.0], (0, 0), 3.0, 1e-9);
        assert!(integrator.advance().expect("a step"));
        let piece = integrator.piece();
        assert!(piece.event.is_some());
        // The depth of 1e-10 is the difference of numbers near one, so the place is good to 1e-16/1e-5.
        assert_within(piece.end, 1.0 - 1e-5, 1e-10);
    }
}

#[test]
fn clause_3_a_guard_does_not_fire_on_the_way_up() {
    // From below the bound upwards: a guard that means "stays above" is armed all along, and does not fire at the rise.
    let rising = |_| Field { constant: [1.0, 0.0], ..Field::default() };
    let log = run(&Small::new(rising, |_| vec![above('g', 0, 0.0)]), [0.0, 0.0], 3.0);
    assert_eq!(names(&log), "");
}

#[test]
fn clause_4_one_step_may_span_the_start_and_the_next_crossing() {
    // v = 2t² − 2t: zero at the start, negative, zero again at t = 1. Twelve evaluations take one step over all of it.
    let field = |_| Field { matrix: [[0.0, 1.0], [0.0, 0.0]], constant: [0.0, -2.0], time: [0.0, 4.0] };
    let system = Small::new(field, |crossed| if crossed == 0 { vec![below('r', 1, 0.0)] } else { Vec::new() });
    let mut integrator = Integrator::new(&system, 0.0, &[5.0, 0.0], (0, 0), 10.0, 1e-9);
    assert!(integrator.advance().expect("a step"));
    let piece = integrator.piece();
    assert_eq!(piece.arc.step, 10.0, "the step did span both zeros");
    assert_within(piece.end, 1.0, 1e-13);
    let mut state = [0.0; 2];
    piece.arc.at((1.0 - piece.arc.start) / piece.arc.step, &mut state);
    assert_within(state[1], 0.0, 1e-13);
}

#[test]
fn clause_5_the_earliest_is_crossed_and_the_rest_searched_again() {
    // Both bounds lie in one step. The reset at the first moves the second away for good.
    let falling_alone = |_| Field { constant: [-1.0, 0.0], ..Field::default() };
    let both = |crossed: u64| {
        if crossed == 0 { vec![above('l', 0, 1.0), above('f', 0, 2.0)] } else { vec![above('l', 0, 1.0)] }
    };
    let system = Small {
        reset: |name, y| {
            if name == 'f' {
                y[0] += 10.0
            }
        },
        ..Small::new(falling_alone, both)
    };
    let log = run(&system, [5.0, 0.0], 6.0);
    assert_eq!(names(&log), "f");
    assert_within(log.events[0].0, 3.0, 1e-13);
    // Without the reset both follow, each in its time.
    let log = run(
        &Small::new(falling_alone, |crossed| {
            if crossed == 0 {
                vec![above('l', 0, 1.0), above('f', 0, 2.0)]
            } else {
                vec![above('l', 0, 1.0); usize::from(crossed == 1)]
            }
        }),
        [5.0, 0.0],
        6.0,
    );
    assert_eq!(names(&log), "fl");
    assert_within(log.events[1].0, 4.0, 1e-13);
}

#[test]
fn clause_5_guards_of_one_instant_follow_in_the_order_of_the_list() {
    let falling_both = |_| Field { constant: [-1.0, -1.0], ..Field::default() };
    let one = |crossed: u64| [above('a', 0, 0.0), above('b', 1, 0.0)][(crossed as usize).min(2)..].to_vec();
    let other = |crossed: u64| [above('b', 1, 0.0), above('a', 0, 0.0)][(crossed as usize).min(2)..].to_vec();
    for (watches, order) in [(one as fn(u64) -> Vec<Watch>, "ab"), (other as fn(u64) -> Vec<Watch>, "ba")] {
        for step in 0..100 {
            let start = 0.5 + 0.02 * f64::from(step);
            let log = run(&Small::new(falling_both, watches), [start, start], 3.0);
            assert_eq!(names(&log), order);
            // The same time, up to the rounding of its own computation.
            assert_within(log.events[0].0, start, 1e-14);
            assert_within(log.events[1].0, log.events[0].0, 1e-14);
        }
    }
    // Three at once, one of them a function.
    let three = |crossed: u64| {
        let all = [function('c', [0.0, 1.0, 0.0]), above('a', 0, 0.0), above('b', 1, 0.0)];
        all[(crossed as usize).min(3)..].to_vec()
    };
    assert_eq!(names(&run(&Small::new(falling_both, three), [1.0, 1.0], 3.0)), "cab");
}

#[test]
fn clause_5_an_instant_comes_after_a_guard_that_fires_at_it() {
    let falling_alone = |_| Field { constant: [-1.0, 0.0], ..Field::default() };
    let once = |crossed: u64| vec![above('g', 0, 0.0); usize::from(crossed == 0)];
    for ahead in [1e-12, 1e-15] {
        let system = Small { instants: vec![1.0], ..Small::new(falling_alone, once) };
        let log = run(&system, [1.0 - ahead, 0.0], 3.0);
        assert_eq!(names(&log), "gi", "{ahead} s before the instant");
    }
    // In the same instant to the bit, none is lost.
    let system = Small { instants: vec![1.0], ..Small::new(falling_alone, once) };
    let log = run(&system, [1.0, 0.0], 3.0);
    let mut both: Vec<char> = names(&log).chars().collect();
    both.sort_unstable();
    assert_eq!(both, ['g', 'i']);
    for (time, _) in log.events {
        assert_within(time, 1.0, 1e-14);
    }
}

#[test]
fn clause_7_events_that_do_not_let_time_advance_are_an_error() {
    // Each mode's guard is violated at once: two vector fields that push at each other.
    let field = |crossed: u64| Field {
        constant: [if crossed.is_multiple_of(2) { -1.0 } else { 1.0 }, 0.0],
        ..Field::default()
    };
    let watches = |crossed: u64| vec![if crossed.is_multiple_of(2) { above('a', 0, 0.0) } else { below('b', 0, 0.0) }];
    match try_run(&Small::new(field, watches), [1.0, 0.0], 3.0) {
        Err(Error::Stopped { time, quantity, .. }) => {
            assert_within(time, 1.0, 1e-12);
            assert_eq!(quantity, "height");
        }
        other => panic!("{:?}", other.map(|log| log.events.len())),
    }
}

#[test]
fn clause_7_a_ball_that_bounces_ever_faster_is_an_error_and_not_an_endless_loop() {
    // The hops add up to 2v/g/(1 − 0.8): there is no way past that instant.
    match try_run(&bouncing_ball(), [0.0, 2.0], 5.0) {
        Err(Error::Stopped { time, .. }) => assert_within(time, 4.0 / GRAVITY / 0.2, 1e-6),
        other => panic!("{:?}", other.map(|log| log.events.len())),
    }
}

#[test]
fn a_guard_that_is_no_linear_form_is_located_as_well() {
    // ¼ − y² with y = t.
    let rising = |_| Field { constant: [1.0, 0.0], ..Field::default() };
    let watches = |crossed: u64| vec![function('q', [0.25, 0.0, -1.0]); usize::from(crossed == 0)];
    let log = run(&Small::new(rising, watches), [0.0, 0.0], 10.0);
    assert_within(log.events[0].0, 0.5, 1e-13);
    assert!(log.counts.evaluations < 60, "{:?}", log.counts);
}
