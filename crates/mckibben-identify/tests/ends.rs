//! Where a search ends: at kinks, limits, interruptions and several minima, whose places are known in closed form.

use mckibben_identify::least_squares::{
    Ending, Evaluation, FitError, Loss, Model, Monitor, Search, Unknown, fit, fit_from,
};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Residuals and their derivatives by two unknowns.
type Residuals = fn([f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>);

/// A model of two unknowns that counts its evaluations, and may do something at each of them.
struct Plane<'a> {
    residuals: Residuals,
    evaluations: AtomicU32,
    at_each: &'a (dyn Fn(u32) + Sync),
}

impl<'a> Plane<'a> {
    fn new(residuals: Residuals, at_each: &'a (dyn Fn(u32) + Sync)) -> Self {
        Self { residuals, evaluations: AtomicU32::new(0), at_each }
    }
}

impl Model for Plane<'_> {
    fn residuals(&self) -> usize {
        (self.residuals)([1.0, 1.0]).0.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        (self.at_each)(self.evaluations.fetch_add(1, Ordering::Relaxed) + 1);
        let (residuals, slopes) = (self.residuals)([values[0], values[1]]);
        Evaluation { residuals, slopes: slopes.concat() }
    }
}

fn from(start: [f64; 2]) -> [Unknown; 2] {
    [Unknown::new("x", "1", start[0]), Unknown::new("y", "1", start[1])]
}

fn any_end() -> Search {
    Search { any_end: true, ..Search::default() }
}

/// A valley with a kink along x = y, at whose bottom derivatives point across and not along: (|x − y| + 1)² + 0.09 (x + y − 4)²,
/// with the least value at (2, 2), where the first residual is 1.
fn ridge([x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    let side = if x >= y { 1.0 } else { -1.0 };
    (vec![(x - y).abs() + 1.0, 0.3 * (x + y - 4.0), 0.2], vec![[side, -side], [0.3, 0.3], [0.0, 0.0]])
}

#[test]
fn a_search_that_ends_at_a_kink_returns_the_best_values_without_intervals() {
    let model = Plane::new(ridge, &|_| ());
    for start in [[0.5, 3.0], [9.0, 1.0], [-4.0, -4.5], [30.0, 31.0]] {
        let found = fit(&model, &from(start), &any_end()).expect("the best values");
        assert_eq!(found.ending, Ending::Kink, "from {start:?}: {found:?}");
        // A standard error along the kink is 1.2: the search ends within a fortieth of it.
        for value in found.values() {
            assert!((value - 2.0).abs() < 3e-2, "from {start:?}: {:?}", found.values());
        }
        assert!((found.cost - 0.5 * (1.0 + 0.04)).abs() < 1e-2, "{}", found.cost);
        assert!(found.estimates.iter().all(|of| of.standard_error.is_none() && of.confidence_interval.is_none()));
        // A search that must end at a minimum returns nothing.
        let strict = fit(&model, &from(start), &Search::default());
        assert!(matches!(strict, Err(FitError::NoMinimum { .. })), "{strict:?}");
    }
}

/// A kink that a bound cuts: the least value within the bounds is on the kink and on the bound.
#[test]
fn a_kink_on_a_bound_is_found_within_the_bounds() {
    let model = Plane::new(ridge, &|_| ());
    let [x, y] = from([1.0, 0.2]);
    let found = fit(&model, &[x.between(0.0, 1.5), y.between(0.0, 1.5)], &any_end()).expect("the best values");
    for estimate in &found.estimates {
        assert!((estimate.value - 1.5).abs() < 1e-2 && estimate.value <= 1.5, "{found:?}");
    }
}

/// A minimum at which a kink passes by, which is no hindrance: it has its intervals.
#[test]
fn a_minimum_near_a_kink_has_intervals() {
    let model = Plane::new(
        |[x, y]| {
            let over = (x - 3.0).max(0.0);
            let slope = if x > 3.0 { 1.0 } else { 0.0 };
            (vec![x - 2.0, y - 1.0, x + y - 3.1, over], vec![[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [slope, 0.0]])
        },
        &|_| (),
    );
    let found = fit(&model, &from([5.0, 5.0]), &any_end()).expect("a fit");
    assert_eq!(found.ending, Ending::Minimum);
    // Normal equations: x = 2 + 0.1/3, y = 1 + 0.1/3.
    assert!((found.estimates[0].value - (2.0 + 0.1 / 3.0)).abs() < 1e-7, "{found:?}");
    assert!(found.estimates.iter().all(|of| of.confidence_interval.is_some()));
}

/// Rosenbrock's valley, whose floor takes many steps.
fn valley([x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    (vec![10.0 * (y - x * x), 1.0 - x, 0.1 * (x - y)], vec![[-20.0 * x, 10.0], [-1.0, 0.0], [0.1, -0.1]])
}

fn half_squares(residuals: &[f64]) -> f64 {
    0.5 * residuals.iter().map(|residual| residual * residual).sum::<f64>()
}

#[test]
fn a_limit_of_steps_returns_the_best_values_so_far() {
    let model = Plane::new(valley, &|_| ());
    let begun = half_squares(&valley([-1.2, 1.0]).0);
    let mut before = begun;
    for most in [1, 3, 6] {
        let search = Search { most_steps: most, ..any_end() };
        let found = fit(&model, &from([-1.2, 1.0]), &search).expect("the best values");
        assert_eq!(found.ending, Ending::Steps { most });
        assert!(found.cost <= before && found.cost < begun, "{}", found.cost);
        let there = half_squares(&valley([found.values()[0], found.values()[1]]).0);
        assert!((found.cost / there - 1.0).abs() < 1e-12, "the cost is that of other values");
        assert!(found.estimates.iter().all(|of| of.confidence_interval.is_none()));
        before = found.cost;
    }
    let found = fit(&model, &from([-1.2, 1.0]), &any_end()).expect("a fit");
    assert_eq!(found.ending, Ending::Minimum);
    assert!((found.values()[0] - 1.0).abs() < 1e-9 && (found.values()[1] - 1.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn an_interrupted_search_returns_the_best_values_so_far() {
    for last in [2, 5, 9] {
        let monitor = Monitor::default();
        let stop = |evaluation: u32| {
            if evaluation == last {
                monitor.stop()
            }
        };
        let model = Plane::new(valley, &stop);
        let search = Search { monitor: monitor.clone(), ..any_end() };
        let found = fit(&model, &from([-1.2, 1.0]), &search).expect("the best values");
        assert_eq!(found.ending, Ending::Interrupted);
        // The evaluation under way is the last.
        assert_eq!(model.evaluations.load(Ordering::Relaxed), last);
        assert!(found.cost <= half_squares(&valley([-1.2, 1.0]).0) && found.cost.is_finite());
        assert!(found.estimates.iter().all(|of| of.confidence_interval.is_none()));
    }
    // Before there is a value there is nothing to return.
    let monitor = Monitor::default();
    monitor.stop();
    let search = Search { monitor, ..any_end() };
    assert_eq!(fit(&Plane::new(valley, &|_| ()), &from([-1.2, 1.0]), &search), Err(FitError::Interrupted));
}

#[test]
fn a_limit_of_time_returns_the_best_values_so_far() {
    let monitor = Monitor::default();
    monitor.stop_after(Duration::from_millis(300));
    // The valley takes more than ten evaluations.
    let wait = |_: u32| std::thread::sleep(Duration::from_millis(50));
    let model = Plane::new(valley, &wait);
    let found = fit(&model, &from([-1.2, 1.0]), &Search { monitor, ..any_end() }).expect("the best values");
    assert_eq!(found.ending, Ending::Time);
    assert!(model.evaluations.load(Ordering::Relaxed) <= 7, "{}", model.evaluations.load(Ordering::Relaxed));
}

/// (x² − 1)² + 0.01 (x − 1)² + (y − 1)² has its least value at x = 1 and another minimum where 2x(x + 1) + 0.01 = 0.
fn wells([x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    (vec![x * x - 1.0, 0.1 * (x - 1.0), y - 1.0], vec![[2.0 * x, 0.0], [0.1, 0.0], [0.0, 1.0]])
}

#[test]
fn several_starts_find_the_least_minimum_and_name_the_others() {
    let model = Plane::new(wells, &|_| ());
    let other = -0.5 - (0.25_f64 - 0.005).sqrt();
    let alone = fit_from(&model, &from([-2.0, 3.0]), &[], &any_end()).expect("a fit");
    assert!((alone.fit.values()[0] - other).abs() < 1e-7, "{alone:?}");
    assert!(alone.others.is_empty() && alone.tried == 1 && alone.agreeing == 1);
    let starts = [vec![2.0, 0.0], vec![-1.5, 0.5], vec![3.0, 2.0]];
    let found = fit_from(&model, &from([-2.0, 3.0]), &starts, &any_end()).expect("a fit");
    assert!((found.fit.values()[0] - 1.0).abs() < 1e-7, "{found:?}");
    assert_eq!((found.tried, found.agreeing, found.others.len()), (4, 2, 1));
    let minimum = &found.others[0];
    assert!((minimum.values[0] - other).abs() < 1e-7 && minimum.searches == 2, "{minimum:?}");
    assert_eq!(minimum.ending, Ending::Minimum);
    let cost = half_squares(&wells([other, 1.0]).0);
    assert!((minimum.cost / cost - 1.0).abs() < 1e-9, "{} is not {cost}", minimum.cost);
}

#[test]
fn screened_starts_cost_one_evaluation_each() {
    let model = Plane::new(wells, &|_| ());
    let starts: Vec<Vec<f64>> = (0..40).map(|place| vec![-4.0 + 0.2 * f64::from(place), 1.0]).collect();
    let search = Search { refined: Some(2), ..any_end() };
    let found = fit_from(&model, &from([-2.0, 3.0]), &starts, &search).expect("a fit");
    assert_eq!((found.tried, found.screened), (3, 40));
    assert!((found.fit.values()[0] - 1.0).abs() < 1e-7, "{found:?}");
    let screened = model.evaluations.load(Ordering::Relaxed);
    model.evaluations.store(0, Ordering::Relaxed);
    let all = fit_from(&model, &from([-2.0, 3.0]), &starts, &any_end()).expect("a fit");
    assert_eq!(all.tried, 41);
    assert!(
        4 * screened < model.evaluations.load(Ordering::Relaxed),
        "{screened} of {}",
        model.evaluations.load(Ordering::Relaxed)
    );
}

/// An interruption among several starts keeps what the first has found.
#[test]
fn an_interruption_among_several_starts_keeps_the_best() {
    let monitor = Monitor::default();
    let alone = Plane::new(wells, &|_| ());
    fit(&alone, &from([2.0, 0.0]), &any_end()).expect("a fit");
    let last = alone.evaluations.load(Ordering::Relaxed) + 2;
    let stop = |evaluation: u32| {
        if evaluation == last {
            monitor.stop()
        }
    };
    let model = Plane::new(wells, &stop);
    let search = Search { monitor: monitor.clone(), ..any_end() };
    let starts = vec![vec![-2.0, 3.0]; 5];
    // One thread takes one search after the other.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let found = one.install(|| fit_from(&model, &from([2.0, 0.0]), &starts, &search)).expect("the best values");
    assert!((found.fit.values()[0] - 1.0).abs() < 1e-7, "{found:?}");
    assert_eq!((found.fit.ending, found.tried), (Ending::Minimum, 2));
    assert_eq!(monitor.ending(), Some(Ending::Interrupted));
}

/// A model that is slow at its first start: there the search has no value before another start ends all searches.
struct SlowAtFirst<'a>(&'a Monitor);

impl Model for SlowAtFirst<'_> {
    fn residuals(&self) -> usize {
        wells([1.0, 1.0]).0.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let (mut residuals, slopes) = wells([values[0], values[1]]);
        if values == FIRST {
            let begun = Instant::now();
            while !self.0.is_stopped() && begun.elapsed() < Duration::from_millis(300) {
                std::thread::yield_now();
            }
            residuals[0] = if self.0.is_stopped() { f64::NAN } else { residuals[0] };
        } else {
            self.0.stop();
        }
        Evaluation { residuals, slopes: slopes.concat() }
    }
}

const FIRST: [f64; 2] = [1.1, 1.0];

#[test]
fn an_interruption_leaves_nothing_worse_than_the_first_start() {
    let monitor = Monitor::default();
    let search = Search { monitor: monitor.clone(), ..any_end() };
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let model = SlowAtFirst(&monitor);
    let found = two.install(|| fit_from(&model, &from(FIRST), &[vec![5.0, 9.0]], &search)).expect("the best values");
    assert_eq!((found.fit.values().as_slice(), &found.fit.ending), (FIRST.as_slice(), &Ending::Interrupted));
    assert_eq!(found.cost, half_squares(&wells(FIRST).0));
}

/// A loss that spares outliers, and takes its measure from the residuals, ends at a kink as well.
#[test]
fn a_robust_search_ends_at_a_kink_too() {
    let search = Search { loss: Loss::Huber(2.5), ..any_end() };
    let found = fit(&Plane::new(ridge, &|_| ()), &from([0.5, 3.0]), &search).expect("the best values");
    assert!(
        found.ending != Ending::Minimum && found.values().iter().all(|value| (value - 2.0).abs() < 0.1),
        "{found:?}"
    );
}

/// Derivatives that point the wrong way lead nowhere; steps without derivatives do.
#[test]
fn wrong_derivatives_do_not_keep_a_search_from_its_minimum() {
    let wrong: Residuals = |[x, y]| {
        let of = (vec![x - 3.0, y + 1.0, 0.5 * (x + y)], vec![[-1.0, 0.0], [0.0, -1.0], [-0.5, -0.5]]);
        (of.0, of.1)
    };
    let found = fit(&Plane::new(wrong, &|_| ()), &from([1.0, 1.0]), &any_end()).expect("the best values");
    // x = 3 − u, y = −1 − u with 1.5 u = 0.5.
    for (value, expected) in found.values().into_iter().zip([3.0 - 1.0 / 3.0, -1.0 - 1.0 / 3.0]) {
        assert!((value - expected).abs() < 5e-3, "{found:?}");
    }
}

/// A kink across one direction, and a sum of squares that is level along the other: the kink says nothing of the latter.
#[test]
fn what_is_not_identifiable_is_named_at_a_kink_too() {
    let model = Plane::new(
        |[x, y]| {
            let side = if x + y >= 4.0 { 1.0 } else { -1.0 };
            (vec![(x + y - 4.0).abs() + 1.0, 0.2, 0.1, 0.1], [vec![[side, side]], vec![[0.0, 0.0]; 3]].concat())
        },
        &|_| (),
    );
    let found = fit(&model, &from([0.5, 3.0]), &any_end()).expect("the best values");
    assert_eq!(found.ending, Ending::Kink, "{found:?}");
    assert!((found.values().iter().sum::<f64>() - 4.0).abs() < 1e-2, "{found:?}");
    let named: Vec<&str> = found.unidentifiable[0].shares.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(named, ["x", "y"], "{:?}", found.unidentifiable);
    // At a kink that both take part in nothing is named.
    let found = fit(&Plane::new(ridge, &|_| ()), &from([0.5, 3.0]), &any_end()).expect("the best values");
    assert!(found.unidentifiable.is_empty(), "{:?}", found.unidentifiable);
}
