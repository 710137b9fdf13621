//! A host that integrates and locates events comes to the trajectory of the event-located engine.

use crate::common::Paper;
use mckibben::plant::{Plant, PlantExchange, PlantRun, PlantSteps};
use mckibben::simulation::Method;

/// A host with the classic Runge-Kutta formula and bisection.
struct Host {
    steps: PlantSteps,
    exchange: PlantExchange,
    next: f64,
    events: u32,
}

impl Host {
    fn new(plant: &Plant, start: &mckibben::plant::PlantStart) -> Self {
        let mut steps = PlantRun::new(plant, start, 1e-8).expect("a start").steps(Method::Stable);
        let mut exchange = PlantExchange::new(&steps, 1e-8).expect("a tolerance");
        let next = exchange.update(&mut steps).expect("a start").next;
        Self { steps, exchange, next, events: 0 }
    }

    fn rates(&mut self, time: f64, state: &[f64]) -> Vec<f64> {
        self.exchange.place(&mut self.steps, time, |own| own.copy_from_slice(state));
        let mut rates = vec![0.0; state.len()];
        self.exchange.rates(&self.steps, &mut rates).expect("as many");
        rates
    }

    /// A state after a step of `h` s from a state.
    fn step(&mut self, time: f64, state: &[f64], h: f64) -> Vec<f64> {
        let add = |rates: &[f64], h: f64| -> Vec<f64> {
            state.iter().zip(rates).map(|(state, rate)| state + h * rate).collect()
        };
        let a = self.rates(time, state);
        let b = self.rates(time + h / 2.0, &add(&a, h / 2.0));
        let c = self.rates(time + h / 2.0, &add(&b, h / 2.0));
        let d = self.rates(time + h, &add(&c, h));
        let mean: Vec<f64> = (0..state.len()).map(|k| (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0).collect();
        add(&mean, h)
    }

    /// The least guard in a state.
    fn least(&mut self, time: f64, state: &[f64]) -> f64 {
        self.exchange.place(&mut self.steps, time, |own| own.copy_from_slice(state));
        let mut values = vec![0.0; self.exchange.guard_count()];
        self.exchange.guards(&self.steps, &mut values);
        values.into_iter().fold(f64::INFINITY, f64::min)
    }

    fn advance(&mut self, until: f64, longest: f64) {
        while self.steps.time() < until {
            let (time, state) = (self.steps.time(), self.steps.state().to_vec());
            let mut h = longest.min(until - time).min(self.next - time);
            let mut is_event = time + h >= self.next - 1e-12;
            let mut end = self.step(time, &state, h);
            if self.least(time + h, &end) < 0.0 {
                let (mut low, mut high) = (0.0, h);
                while high - low > 1e-13 {
                    let middle = 0.5 * (low + high);
                    let there = self.step(time, &state, middle);
                    if self.least(time + middle, &there) < 0.0 { high = middle } else { low = middle }
                }
                (h, is_event) = (high, true);
                end = self.step(time, &state, h);
            }
            self.exchange.place(&mut self.steps, time + h, |own| own.copy_from_slice(&end));
            if is_event {
                let update = self.exchange.update(&mut self.steps).expect("goes on");
                (self.next, self.events) = (update.next, self.events + update.events);
            }
        }
    }
}

/// Pulses of a valve, flows that change their regime, and friction that holds and lets go.
#[test]
fn a_host_that_integrates_comes_to_the_trajectory_of_the_engine() {
    for paper in [Paper::pwm(25.0, 0.6).gauge(2e5).from(0.09, 0.0), Paper::sealed().gauge(3e5).from(0.085, 0.0)] {
        let rig = paper.rig();
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &paper.start()));
        let mut run = PlantRun::new(&plant, &start, 1e-11).expect("a start");
        let mut host = Host::new(&plant, &start);
        let scales: Vec<f64> = {
            let mut scales = vec![0.0; host.steps.state().len()];
            host.exchange.scales(&host.steps, &mut scales).expect("as many");
            scales
        };
        for count in 1..=8 {
            let time = 0.02 * f64::from(count);
            run.advance_to(time).expect("a run");
            host.advance(time, 2e-5);
            for (k, (ours, theirs)) in host.steps.state().iter().zip(run.state()).enumerate() {
                let error = (ours - theirs).abs() / scales[k];
                assert!(error < 1e-6, "state {k} at {time} s: {ours} for {theirs}, off by {error:e} of its size");
            }
        }
        assert!(host.events >= 1, "{} events", host.events);
    }
}

/// The derivatives of rates in a direction are those of differences; numbers that are too few are refused.
#[test]
fn rates_have_exact_derivatives() {
    let paper = Paper::pwm(25.0, 0.6).gauge(2e5).from(0.09, 0.0);
    let rig = paper.rig();
    let mut host = Host::new(&Plant::of_rig(&rig), &Plant::start_of_rig(&rig, &paper.start()));
    host.advance(0.013, 2e-5);
    let (time, state) = (host.steps.time(), host.steps.state().to_vec());
    let mut scales = vec![0.0; state.len()];
    host.exchange.scales(&host.steps, &mut scales).expect("as many");
    let seed: Vec<f64> = scales.iter().enumerate().map(|(k, scale)| scale * (1.0 - 0.3 * k as f64)).collect();
    let mut exact = vec![0.0; state.len()];
    host.exchange.rates_along(&host.steps, &seed, &mut exact).expect("as many");
    let at = |host: &mut Host, h: f64| {
        let there: Vec<f64> = state.iter().zip(&seed).map(|(state, seed)| state + h * seed).collect();
        host.rates(time, &there)
    };
    let (up, down) = (at(&mut host, 1e-5), at(&mut host, -1e-5));
    for k in 0..state.len() {
        let rise = (up[k] - down[k]) / 2e-5;
        assert!((rise - exact[k]).abs() <= 1e-6 * exact[k].abs().max(up[k].abs()), "{k}: {rise} for {}", exact[k]);
    }
    assert!(host.exchange.rates_along(&host.steps, &seed[1..], &mut exact).is_err());
    assert!(PlantExchange::new(&host.steps, 0.0).is_err());
    for time in [1e9, -2.0, f64::NAN] {
        host.exchange.place(&mut host.steps, time, |_| {});
        assert!(host.exchange.update(&mut host.steps).is_err(), "{time}");
    }
}
