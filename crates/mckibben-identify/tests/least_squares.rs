//! Least squares against certified values, and against what an interval promises.

#[path = "../src/median.rs"]
mod median;

use mckibben_identify::least_squares::{
    Ending, Evaluation, FitError, Loss, Model, Search, Unknown, exceeds_scales, fit,
};

/// A curve through points: `y − f(x)` and the slopes of f.
struct Curve<F> {
    points: Vec<[f64; 2]>,
    curve: F,
}

impl<F: Fn(f64, &[f64]) -> (f64, Vec<f64>)> Model for Curve<F> {
    fn residuals(&self) -> usize {
        self.points.len()
    }
    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
        for [x, y] in &self.points {
            let (at, of) = (self.curve)(*x, values);
            residuals.push(at - y);
            slopes.extend(of);
        }
        Evaluation { residuals, slopes }
    }
}

/// A certified value and standard deviation for each unknown, and the residual standard deviation.
fn certified(curve: &Curve<Plain>, starts: &[&[f64]], expected: &[[f64; 2]], scatter: f64) {
    for start in starts {
        let unknown = |(place, value): (usize, &f64)| Unknown::new(format!("b{}", place + 1), "1", *value);
        let unknowns: Vec<Unknown> = start.iter().enumerate().map(unknown).collect();
        let fit = fit(curve, &unknowns, &Search::default()).expect("a fit");
        for (estimate, [value, deviation]) in fit.estimates.iter().zip(expected) {
            // In a flat valley the distance counts in standard errors.
            let off = (estimate.value - value).abs() / deviation;
            assert!(off < 1e-6, "{}: {} is {off:e} deviations off from {start:?}", estimate.name, estimate.value);
            let found = estimate.standard_error.expect("it is identifiable");
            assert!((found / deviation - 1.0).abs() < 1e-6, "{}: {found} for {deviation}", estimate.name);
        }
        assert!((fit.scatter / scatter - 1.0).abs() < 1e-9, "{}", fit.scatter);
        assert!(fit.unidentifiable.is_empty());
    }
}

/// The NIST's Misra1a: lower difficulty, two unknowns, monomolecular adsorption.
#[test]
fn the_certified_values_of_misra1a_come_out() {
    let points = vec![
        [77.6, 10.07],
        [114.9, 14.73],
        [141.1, 17.94],
        [190.8, 23.93],
        [239.9, 29.61],
        [289.0, 35.18],
        [332.8, 40.02],
        [378.4, 44.82],
        [434.8, 50.76],
        [477.3, 55.05],
        [536.8, 61.01],
        [593.1, 66.40],
        [689.1, 75.47],
        [760.0, 81.78],
    ];
    let curve = |x: f64, b: &[f64]| {
        let decay = (-b[1] * x).exp();
        (b[0] * (1.0 - decay), vec![1.0 - decay, b[0] * x * decay])
    };
    let expected = [[2.389_421_291_8e2, 2.707_007_524_1], [5.501_564_318_1e-4, 7.266_868_843_6e-6]];
    certified(&Curve { points, curve }, &[&[500.0, 0.0001], &[250.0, 0.0005]], &expected, 1.018_787_633_0e-1);
}

/// The NIST's MGH09: higher difficulty, four unknowns, enzyme reaction.
#[test]
fn the_certified_values_of_mgh09_come_out() {
    let points = vec![
        [4.0, 0.1957],
        [2.0, 0.1947],
        [1.0, 0.1735],
        [0.5, 0.16],
        [0.25, 0.0844],
        [0.167, 0.0627],
        [0.125, 0.0456],
        [0.1, 0.0342],
        [0.0833, 0.0323],
        [0.0714, 0.0235],
        [0.0625, 0.0246],
    ];
    let curve = |x: f64, b: &[f64]| {
        let (above, below) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
        let value = b[0] * above / below;
        (value, vec![above / below, b[0] * x / below, -value * x / below, -value / below])
    };
    let expected = [
        [1.928_069_345_8e-1, 1.143_531_222_7e-2],
        [1.912_823_287_3e-1, 1.963_322_091_1e-1],
        [1.230_565_069_3e-1, 8.084_203_123_2e-2],
        [1.360_623_306_8e-1, 9.002_554_230_8e-2],
    ];
    certified(&Curve { points, curve }, &[&[0.25, 0.39, 0.415, 0.39]], &expected, 6.627_923_653_4e-3);
}

/// Numbers between 0 and 1 that look random.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }
    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (2.0 * std::f64::consts::PI * self.uniform()).cos()
    }
}

fn line(x: f64, b: &[f64]) -> (f64, Vec<f64>) {
    (b[0] + b[1] * x, vec![1.0, x])
}

fn unknowns(names: &[&str]) -> Vec<Unknown> {
    names.iter().map(|name| Unknown::new(*name, "1", 1.0)).collect()
}

/// Over 500 trials the number of hits is binomial with 0.95: outside 0.917 to 0.983 once in a thousand.
#[test]
fn the_interval_holds_the_truth_in_95_of_100_trials() {
    let mut random = Random(7);
    let truth = [0.3, -2.0];
    let mut hits = [0; 2];
    for _ in 0..500 {
        let point = |place: i32| {
            let x = f64::from(place);
            [x, line(x, &truth).0 + 0.1 * random.normal()]
        };
        let curve = Curve { points: (0..8).map(point).collect(), curve: line };
        let fit = fit(&curve, &unknowns(&["offset", "slope"]), &Search::default()).expect("a fit");
        for (hits, (estimate, truth)) in hits.iter_mut().zip(fit.estimates.iter().zip(truth)) {
            let [low, high] = estimate.confidence_interval.expect("it is identifiable");
            *hits += u32::from(low <= truth && truth <= high);
        }
    }
    assert!(hits.iter().all(|hits| (458..=492).contains(hits)), "{hits:?}");
}

/// A curve whose derivatives are as exact as those of a simulated run.
struct Simulated<F>(Curve<F>);

impl<F: Fn(f64, &[f64]) -> (f64, Vec<f64>)> Model for Simulated<F> {
    fn residuals(&self) -> usize {
        self.0.residuals()
    }
    fn evaluate(&self, values: &[f64]) -> Evaluation {
        self.0.evaluate(values)
    }
    fn precision(&self) -> f64 {
        1e-6
    }
}

/// A value that is nearly zero is as identifiable as any other. Hits are binomial, as above.
#[test]
fn an_offset_of_zero_has_an_interval_and_does_not_shorten_those_of_others() {
    let mut random = Random(11);
    let truth = [0.0, 1.0];
    let mut hits = [0; 2];
    for _ in 0..500 {
        let point = |place: i32| {
            let x = 0.08 + 5e-4 * f64::from(place);
            [x, x + 1e-8 * random.normal()]
        };
        let curve = Simulated(Curve { points: (0..40).map(point).collect(), curve: line });
        let both = [Unknown::new("offset", "1", 0.0).between(-0.02, 0.02), Unknown::new("scale", "1", 0.9)];
        let rough = fit(&curve, &both, &Search::default()).expect("a fit");
        // As a second fit begins: at the values of the first.
        let from: Vec<Unknown> =
            both.iter().zip(rough.values()).map(|(of, start)| Unknown { start, ..of.clone() }).collect();
        let fit = fit(&curve, &from, &Search::default()).expect("a fit");
        assert!(fit.unidentifiable.is_empty() && fit.condition < 1e3, "{:?}", fit.unidentifiable);
        for (hits, (estimate, truth)) in hits.iter_mut().zip(fit.estimates.iter().zip(truth)) {
            let [low, high] = estimate.confidence_interval.expect("it is identifiable");
            *hits += u32::from(low <= truth && truth <= high);
        }
    }
    assert!(hits.iter().all(|hits| (458..=492).contains(hits)), "{hits:?}");
}

/// Of a slope through a known offset the variance is 1/Σx².
#[test]
fn a_narrow_prior_leaves_the_others_identifiable() {
    let points = (0..9).map(|place| [f64::from(place), 3.0 * f64::from(place)]).collect();
    let offset = Unknown { prior: Some([0.0, 1e-9]), ..Unknown::new("offset", "1", 0.0) };
    let both = [offset, Unknown::new("slope", "1", 1.0)];
    let search = Search { known_scales: true, ..Search::default() };
    let fit = fit(&Simulated(Curve { points, curve: line }), &both, &search).expect("a fit");
    let deviation = fit.estimates[1].standard_error.expect("it is identifiable");
    assert!((deviation * 204.0_f64.sqrt() - 1.0).abs() < 1e-6, "{deviation}");
    assert!(fit.unidentifiable.is_empty());
}

#[test]
fn an_unknown_without_effect_is_named_alone() {
    let points = (0..9).map(|place| [f64::from(place), 2.0 + 0.01 * f64::from(place % 3)]).collect();
    let curve = |_: f64, b: &[f64]| (b[0], vec![1.0, 0.0]);
    let fit = fit(&Curve { points, curve }, &unknowns(&["level", "delay"]), &Search::default()).expect("a fit");
    let shares: Vec<_> = fit.unidentifiable.iter().flat_map(|direction| &direction.shares).collect();
    assert_eq!(shares, [&("delay".to_owned(), 1.0)]);
    assert!(fit.estimates[0].confidence_interval.is_some() && fit.estimates[1].confidence_interval.is_none());
    assert!(fit.condition.is_infinite());
}

/// A tenth of the readings is 30 standard deviations off; or a thirtieth of those of one quantity, whose weight they lower. Hits are
/// binomial, as above.
#[test]
fn intervals_of_a_robust_fit_hold_the_truth_among_outliers() {
    let truth = [0.3, -2.0];
    // Below zero a point is of the level alone, above of the slope alone.
    let split = |x: f64, b: &[f64]| match x < 0.0 {
        true => (0.2 * b[0], vec![0.2, 0.0]),
        false => (b[1] * x, vec![0.0, x]),
    };
    for (curve, from, every) in [(line as Plain, 0.0, 10), (split as Plain, -10.0, 30)] {
        let mut random = Random(7);
        let mut hits = [0; 2];
        for _ in 0..500 {
            let mut point = |place: i32| {
                let x = from + 0.1 * f64::from(place);
                let is_off = place % every == every / 2 && (x < 0.0 || from == 0.0);
                let off = if is_off { 30.0_f64.copysign(random.uniform() - 0.5) } else { 0.0 };
                let deviation = if x < 0.0 { 0.2 } else { 1.0 };
                [x, curve(x, &truth).0 + deviation * (random.normal() + off)]
            };
            let points = (0..if from == 0.0 { 60 } else { 200 }).map(&mut point).collect();
            let search = Search { loss: Loss::Huber(2.5), ..Search::default() };
            let fit = fit(&Curve { points, curve }, &unknowns(&["level", "slope"]), &search).expect("a fit");
            for (hits, (estimate, truth)) in hits.iter_mut().zip(fit.estimates.iter().zip(truth)) {
                let [low, high] = estimate.confidence_interval.expect("it is identifiable");
                *hits += u32::from(low <= truth && truth <= high);
            }
        }
        assert!(hits.iter().all(|hits| (458..=492).contains(hits)), "{hits:?}");
    }
}

#[test]
fn unknowns_that_are_not_identifiable_are_named_and_have_no_interval() {
    let points = (0..9).map(|place| [f64::from(place), 2.0 * f64::from(place) + 0.01 * f64::from(place % 3)]).collect();
    // Only the product of the first two is seen.
    let curve = |x: f64, b: &[f64]| (b[0] * b[1] * x + b[2], vec![b[1] * x, b[0] * x, 1.0]);
    let fit =
        fit(&Curve { points, curve }, &unknowns(&["width", "height", "offset"]), &Search::default()).expect("a fit");
    assert_eq!(fit.unidentifiable.len(), 1);
    let names: Vec<&str> = fit.unidentifiable[0].shares.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["width", "height"]);
    let intervals: Vec<bool> = fit.estimates.iter().map(|estimate| estimate.confidence_interval.is_some()).collect();
    assert_eq!(intervals, [false, false, true]);
    assert!(fit.condition > 1e9);
}

#[test]
fn a_prior_determines_what_the_data_do_not() {
    let points = (0..9).map(|place| [f64::from(place), 6.0 * f64::from(place)]).collect();
    let curve = |x: f64, b: &[f64]| (b[0] * b[1] * x, vec![b[1] * x, b[0] * x]);
    let mut unknowns = unknowns(&["width", "height"]);
    unknowns[0].prior = Some([2.0, 0.1]);
    let search = Search { known_scales: true, ..Search::default() };
    let fit = fit(&Curve { points, curve }, &unknowns, &search).expect("a fit");
    let values = fit.values();
    assert!((values[0] - 2.0).abs() < 1e-9 && (values[1] - 3.0).abs() < 1e-9, "{values:?}");
    // The data are exact but for their scale of 1: Σx² = 204, and the prior is narrower than they.
    let deviation = fit.estimates[0].standard_error.expect("the prior determines it");
    assert!((deviation - 0.1).abs() < 1e-9, "{deviation}");
}

#[test]
fn an_unknown_on_its_bound_has_no_interval_and_the_others_are_as_if_it_were_fixed() {
    let points: Vec<[f64; 2]> = (0..6).map(|place| [f64::from(place), 1.5 * f64::from(place) - 1.0]).collect();
    let mut bounded = unknowns(&["offset", "slope"]);
    bounded[0] = bounded[0].clone().between(0.0, 5.0);
    let fit_of = fit(&Curve { points: points.clone(), curve: line }, &bounded, &Search::default()).expect("a fit");
    assert!(fit_of.estimates[0].on_bound && fit_of.estimates[0].confidence_interval.is_none());
    // Through the origin: Σxy/Σx².
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), [x, y]| (xy + x * y, xx + x * x));
    assert!((fit_of.estimates[1].value - xy / xx).abs() < 1e-5, "{}", fit_of.estimates[1].value);
}

#[test]
fn an_outlier_moves_squares_and_hardly_moves_cauchy() {
    // A tenth off to either side, four in turn: straight and of slope 1/2 in the mean.
    let off = |place: i32| 0.1 * f64::from([1, -1, -1, 1][place as usize % 4]);
    let point = |place: i32| [f64::from(place), 1.0 + 0.5 * f64::from(place) + off(place)];
    let mut points: Vec<[f64; 2]> = (0..20).map(point).collect();
    points[17][1] += 50.0;
    let slope = |loss| {
        let search = Search { loss, ..Search::default() };
        let curve = Curve { points: points.clone(), curve: line };
        fit(&curve, &unknowns(&["offset", "slope"]), &search).expect("a fit").values()[1]
    };
    assert!((slope(Loss::Squares) - 0.5).abs() > 0.3);
    // Nothing was said of the scale: the losses find it, so that they do the same in other units.
    assert!((slope(Loss::Huber(1.5)) - 0.5).abs() < 0.01, "{}", slope(Loss::Huber(1.5)));
    assert!((slope(Loss::Cauchy(1.5)) - 0.5).abs() < 2e-3, "{}", slope(Loss::Cauchy(1.5)));
    let other_units: Vec<[f64; 2]> = points.iter().map(|[x, y]| [*x, 1e-4 * y]).collect();
    let huber = Search { loss: Loss::Huber(1.5), ..Search::default() };
    let small = fit(&Curve { points: other_units, curve: line }, &unknowns(&["offset", "slope"]), &huber);
    assert!((small.expect("a fit").values()[1] / (1e-4 * slope(Loss::Huber(1.5))) - 1.0).abs() < 1e-5);
}

#[test]
fn too_few_points_and_a_start_outside_the_bounds_have_their_messages() {
    let curve = Curve { points: vec![[0.0, 1.0], [1.0, 2.0]], curve: line };
    let names = unknowns(&["offset", "slope"]);
    let few = fit(&curve, &names, &Search::default()).expect_err("too few");
    assert!(few.to_string().contains("2 measurements cannot determine 2 unknowns"), "{few}");
    let outside = [names[0].clone().between(2.0, 3.0), names[1].clone()];
    let more = Curve { points: vec![[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]], curve: line };
    let outside = fit(&more, &outside, &Search::default()).expect_err("outside");
    assert!(outside.to_string().contains("offset starts at 1, which is not between 2 and 3"), "{outside}");
    let nowhere = Curve { points: more.points, curve: |_: f64, _: &[f64]| (f64::NAN, vec![0.0; 2]) };
    let nowhere = fit(&nowhere, &names, &Search::default()).expect_err("nowhere");
    assert!(nowhere.to_string().contains("no finite value at the start"), "{nowhere}");
}

/// Value and slopes at a place, by the unknowns.
type Plain = fn(f64, &[f64]) -> (f64, Vec<f64>);

/// A straight line through points whose best fit lies beyond every bound.
fn beyond(scale: f64) -> Curve<Plain> {
    Curve {
        points: (0..8).map(|x| [f64::from(x), scale]).collect(),
        curve: |x, of: &[f64]| (of[0] + x * of[1], vec![1.0, x]),
    }
}

#[test]
fn a_fit_in_which_every_unknown_rests_on_a_bound_has_values_and_no_intervals() {
    let unknowns = [Unknown::new("a", "", 0.5).between(0.0, 1.0), Unknown::new("b", "", 0.0).between(-1.0, 1e-9)];
    for scale in [1e1, 1e4, 1e8] {
        let found =
            fit(&beyond(scale), &unknowns, &Search::default()).unwrap_or_else(|error| panic!("{scale}: {error}"));
        assert!(
            found.estimates.iter().all(|of| of.on_bound && of.confidence_interval.is_none()),
            "{:?}",
            found.estimates
        );
        assert!((found.estimates[0].value - 1.0).abs() < 1e-6, "{:?}", found.estimates);
        assert!(found.condition.is_finite() && found.unidentifiable.is_empty());
    }
}

#[test]
fn what_ends_a_search_is_said_in_words() {
    let unknowns = [Unknown::new("a", "", 0.5), Unknown::new("b", "", 0.25)];
    let line = |slope: f64| Curve {
        points: (0..8).map(|x| [f64::from(x), 1.0]).collect(),
        curve: move |x, of: &[f64]| (of[0] + x * of[1], vec![slope, slope * x]),
    };
    // Derivatives that are none, that are too large for their squares, and that point the wrong way.
    for slope in [f64::NAN, f64::INFINITY, 1e300, -1.0] {
        let error = fit(&line(slope), &unknowns, &Search::default()).expect_err("there is no minimum");
        assert!(matches!(error, FitError::NoMinimum { .. }), "{error}");
    }
    let few = Search { most_steps: 1, ..Search::default() };
    let error = fit(&rosenbrock(), &[Unknown::new("x", "", -1.2), Unknown::new("y", "", 1.0)], &few);
    assert_eq!(error, Err(FitError::NoMinimum { why: Ending::Steps { most: 1 } }));
    let endings = [Ending::Kink, Ending::Steps { most: 7 }, Ending::Numbers];
    for words in endings.map(|why| FitError::NoMinimum { why }.to_string()) {
        assert!(words.starts_with("the search found no minimum: ") && words.contains("; start nearer"), "{words}");
        assert!(!words.contains(['{', '"']) && !words.contains("TRF"), "{words}");
    }
}

/// Rosenbrock's valley as residuals, which takes many steps, and one more residual so that there is a degree of
/// freedom.
fn rosenbrock() -> Curve<Plain> {
    let curve = |which: f64, of: &[f64]| match which as u8 {
        0 => (10.0 * (of[1] - of[0] * of[0]), vec![-20.0 * of[0], 10.0]),
        1 => (1.0 - of[0], vec![-1.0, 0.0]),
        _ => (0.1 * (of[0] - of[1]), vec![0.1, -0.1]),
    };
    Curve { points: vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], curve }
}

/// Quantiles of χ² at a thousandth, from a table: 29.588 of 10 degrees of freedom, 10.828 of one. Scales that are a third too small are no
/// matter.
#[test]
fn residuals_exceed_their_scales_beyond_chance() {
    for (count, quantile) in [(1, 10.828_f64), (10, 29.588)] {
        let size = (quantile / f64::from(count)).sqrt();
        assert!(exceeds_scales(1.02 * size, count as usize) && !exceeds_scales(0.98 * size, count as usize), "{count}");
    }
    assert!(exceeds_scales(1.51, 1000) && !exceeds_scales(1.49, 1000));
}
