//! A host that integrates and locates events comes to the trajectory of the event-located engine.

use crate::common::Paper;
use crate::common::random_plants::{numbered, plant};
use mckibben::friction::Coulomb;
use mckibben::plant::{Plant, PlantExchange, PlantRun, PlantSample, PlantSampler, PlantSteps};
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

/// The numbers of a sample whose derivatives are known.
fn numbers(sample: &PlantSample) -> Vec<f64> {
    let mut all = Vec::new();
    for one in &sample.actuators {
        let air = [one.pressure.0, one.air_mass, one.temperature, one.volume, one.mass_flow];
        all.extend([one.distance, one.rate, one.length, one.velocity, one.tension].into_iter().chain(air));
    }
    for one in &sample.mechanisms {
        all.extend(one.position.iter().chain(&one.rate).chain(&one.actuator_force));
    }
    all.extend(sample.nodes.iter().map(|one| one.pressure.0));
    all
}

/// In states of random plants the derivatives of rates and of all that is read lie between the differences to both sides.
#[test]
fn random_plants_have_exact_derivatives() {
    const REACHES: [f64; 3] = [1e-5, 1e-6, 1e-7];
    let (mut tried, mut compared) = (0, 0_u64);
    for number in 0..60 {
        let (plant, start, duration) = plant(&numbered(number));
        let Ok(run) = plant.and_then(|plant| PlantRun::new(&plant, &start, 1e-8)) else { continue };
        let mut steps = run.steps(Method::Stable);
        let until = duration.min(0.04) * (0.2 + 0.01 * number as f64);
        if (1..=40).any(|part| steps.advance_to(until * f64::from(part) / 40.0).is_err()) {
            continue;
        }
        tried += 1;
        let mut exchange = PlantExchange::new(&steps, 1e-8).expect("a tolerance");
        let mut sampler = PlantSampler::new(&steps);
        let (time, state) = (steps.time(), steps.state().to_vec());
        let mut scales = vec![0.0; state.len()];
        exchange.scales(&steps, &mut scales).expect("as many");
        for place in 0..state.len() {
            let mut at = |exchange: &mut PlantExchange, reach: f64| {
                exchange.place(&mut steps, time, |own| {
                    own.copy_from_slice(&state);
                    own[place] += reach * scales[place];
                });
                let mut rates = vec![0.0; state.len()];
                exchange.rates(&steps, &mut rates).expect("as many");
                rates.extend(numbers(sampler.read_placed(&steps)));
                rates
            };
            let here = at(&mut exchange, 0.0);
            let around = REACHES.map(|reach| [-reach, reach].map(|reach| (reach, at(&mut exchange, reach))));
            let _ = at(&mut exchange, 0.0);
            let mut seed = vec![0.0; state.len()];
            seed[place] = scales[place];
            let mut exact = vec![0.0; state.len()];
            exchange.rates_along(&steps, &seed, &mut exact).expect("as many");
            let mut sample = steps.sample();
            exchange.sample_along(&steps, &seed, &mut sample).expect("as many");
            exact.extend(numbers(&sample));
            for (k, exact) in exact.iter().enumerate() {
                let lies_between = around.iter().any(|sides| {
                    let rises = sides.each_ref().map(|(reach, there)| (there[k] - here[k]) / reach);
                    let size = rises[0].abs().max(rises[1].abs()).max(exact.abs());
                    let rounding = 1e-14 * here[k].abs() / sides[1].0;
                    let usual = scales.get(k).map_or(0.0, |scale| 1e-6 * scale);
                    let near = 1e-3 * size + rounding + usual + 1e-13;
                    rises[0].min(rises[1]) - near <= *exact && *exact <= rises[0].max(rises[1]) + near
                });
                assert!(lies_between, "plant {number}: {k} by {place}: {exact} in {around:?}");
                compared += 1;
            }
        }
    }
    assert!(tried >= 30 && compared > 10_000, "{tried} plants, {compared} numbers");
}

/// Wherever the engine takes a random plant, a host that integrates comes as well, through events of which two come in one instant.
#[test]
fn a_host_goes_through_the_events_of_random_plants() {
    let mut events = 0;
    for number in [2, 8, 18, 29, 34, 66, 85, 125] {
        let (plant, start, _) = plant(&numbered(number));
        let plant = plant.expect("a plant");
        let mut run = PlantRun::new(&plant, &start, 1e-10).expect("a start");
        let mut host = Host::new(&plant, &start);
        run.advance_to(4e-3).expect("a run");
        host.advance(4e-3, 2e-6);
        let miss = crate::plant_steps::difference(&plant, host.steps.state(), run.state());
        assert!(miss < 1e-4, "plant {number}: {miss}");
        events += host.events;
    }
    assert!(events > 20, "{events} events");
}

/// A given rate that leaves zero smoothly ends the rest by a guard: the force then jumps by dry friction, in the direction of the
/// rate, at the start as after a rest within the run. At zero and at a rounding beside it no guard falls.
#[test]
fn a_rate_that_leaves_zero_smoothly_ends_the_rest() {
    const FORCE: f64 = 5.0;
    let dry = Coulomb::new(0.0).and_then(|law| law.with_force(FORCE, 0.0)).expect("dry friction");
    let paper = Paper::sealed().gauge(3e5).from(0.085, 0.0).with(|rig| (rig.viscous, rig.coulomb) = (0.0, Some(dry)));
    let rig = paper.rig();
    let start = Plant::start_of_rig(&rig, &paper.start());
    let (plant, start) = Plant::of_rig(&rig).to_external(&start).expect("a host's");
    let place = plant.indices().mechanisms[0].rate(0);
    // The least guard and the tension at a rate, in the mode that holds.
    let at = |host: &mut Host, rate: f64| {
        let (time, mut state) = (host.steps.time(), host.steps.state().to_vec());
        state[place] = rate;
        (host.least(time, &state), host.steps.sample().actuators[0].tension)
    };
    for sign in [1.0, -1.0] {
        let mut host = Host::new(&plant, &start);
        let (least, rest) = at(&mut host, 0.0);
        assert!(least > 0.0, "{least} at rest");
        for direction in [sign, -sign] {
            assert!(at(&mut host, 1e-14 * direction).0 > 0.0);
            let (least, before) = at(&mut host, 1e-3 * direction);
            assert!(least < 0.0 && (before - rest).abs() < 1e-9, "{least}, {before} N for {rest} N");
            host.exchange.update(&mut host.steps).expect("goes on");
            let (least, sliding) = at(&mut host, 1e-3 * direction);
            assert!(least > 0.0, "{least} while it slides");
            let jump = sliding - rest - direction * FORCE;
            assert!(jump.abs() < 1e-9, "{sliding} N for {rest} N at rest");
            // An event at which the rate is zero.
            at(&mut host, 0.0);
            host.exchange.enter_motion(&mut host.steps);
        }
    }
}

/// Pulses that are too short for a poppet are no events, and nothing is looked for without end among them.
#[test]
fn pulses_that_no_poppet_follows_are_no_events() {
    let paper = Paper::pwm(25.0, 0.05).gauge(2e5).from(0.09, 0.0);
    let rig = paper.rig();
    let host = Host::new(&Plant::of_rig(&rig), &Plant::start_of_rig(&rig, &paper.start()));
    assert_eq!(host.next, f64::INFINITY);
}

/// At its shortest length without a velocity the weight decides: each update leaves the muscle taken up, whatever it was before, and no
/// guard that a host sees is zero.
#[test]
fn a_muscle_at_its_shortest_length_takes_up_its_load() {
    let paper = Paper::sealed().gauge(4e5);
    let shortest = paper.rig().actuator().limits().min_length();
    let paper = paper.from(shortest, 0.0);
    let rig = paper.rig();
    let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &paper.start()));
    let mut run = PlantRun::new(&plant, &start, 1e-11).expect("a start");
    let mut host = Host::new(&plant, &start);
    for _ in 0..3 {
        host.exchange.update(&mut host.steps).expect("goes on");
        let mut guards = vec![0.0; host.exchange.guard_count()];
        host.exchange.guards(&host.steps, &mut guards);
        assert!(guards.iter().all(|guard| *guard > 0.0), "{guards:?}");
    }
    run.advance_to(0.2).expect("a run");
    host.advance(0.2, 2e-5);
    assert!(run.state()[0] > shortest);
    for (ours, theirs) in host.steps.state().iter().zip(run.state()) {
        assert!((ours - theirs).abs() < 1e-5 * theirs.abs().max(1e-2), "{ours} for {theirs}");
    }
}
