//! Commands of a plant: controllers against the engine of one actuator and fixed steps of a joint, loops side by side, valves that are
//! set at run time, runs that are saved and restored.

use crate::common::joint::Pair;
use crate::common::{GRAVITY, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::command::{Driver, PlantMeasurement, PlantSensors};
use mckibben::control::{
    AirMass, Between, Controller, FeedForward, JointAim, JointController, JointSensors, JointTracker, Output, Pid,
    Place, Quantity, Regulator, Relay, Sampling, Sensor, Sensors, SetPoint, StaticAim, Tracker,
};
use mckibben::line::Reservoir;
use mckibben::load::{Limb, Motion};
use mckibben::mechanism::{Coupling, Mass, Mechanism, Pull};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{
    InitialAir, JointPlant, Mounted, Part, Plant, PlantRun, PlantStart, PlantTrajectory, TimeStepping, simulate_plant,
};
use mckibben::simulation::{Actuation, EventKind, InitialAngle, JointSample, Method, PressureSeries, Rig};
use mckibben::valve::{
    Command, FlowStandard, Port, Regulator as Proportional, Request, RuntimeCommand, Solenoid, Spool, ValveKind,
};
use mckibben::{Error, GaugePressure, Scalar};
use std::fmt::Debug;

const TOLERANCE: f64 = 1e-10;

fn fill_hold_exhaust() -> Paper {
    Paper::pwm(50.0, 0.5).gauge(20.0 * PSI).with(|rig| rig.kind = ValveKind::FillHoldExhaust)
}

fn sampling(rate: f64, delay: usize) -> Sampling {
    Sampling::new(rate, delay).expect("a rate")
}

fn pid(quantity: Quantity, band: f64, output: Output) -> Regulator {
    let pid = Pid::new(quantity, band, output).and_then(|pid| pid.with_integral(0.2));
    Regulator::Pid(pid.and_then(|pid| pid.with_derivative(0.01, 5e-3)).expect("a controller"))
}

fn relay(quantity: Quantity, band: f64, hysteresis: f64) -> Regulator {
    Regulator::Relay(Relay::new(quantity, band, hysteresis, Between::Hold).expect("a relay"))
}

fn tracker(quantity: Quantity, mean: f64, amplitude: f64, regulator: Regulator) -> Tracker {
    let set_point = SetPoint::sinusoid(quantity, mean, amplitude, 1.3, 0.2).expect("a set point");
    Tracker::new(quantity, set_point, regulator).expect("a tracker")
}

/// The largest difference of two series over the range of the first.
fn difference(ours: &[f64], theirs: &[f64]) -> f64 {
    let (low, high) = theirs.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
    let scale = (high - low).max(1e-3 * high.abs().max(low.abs()));
    ours.iter().zip(theirs).fold(0.0, |most, (one, other)| most.max((one - other).abs() / scale))
}

/// Runs a controller on the plant of a rig and at fixed steps, and its requests without it.
fn compare<C>(name: &str, paper: &Paper, controller: C, sampling: Sampling, sensors: Sensors)
where
    C: Controller<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let (rig, duration): (Rig, f64) = (paper.rig(), 0.8);
    let start = paper.start();
    let plant = Plant::of_rig(&rig);
    let driver = Driver::of_actuator(controller.clone(), 0, 0, (sampling, sensors));
    let at_start = Plant::start_of_rig(&rig, &start);
    let mut run = PlantRun::with_drivers(&plant, &at_start, TOLERANCE, vec![driver]).expect(name);
    let new = run.record_to(duration, &mut |_| Ok(())).expect(name);
    let decisions = new.decisions();
    assert_eq!(decisions.len(), 1 + (duration * sampling.rate() * (1.0 + 1e-12)) as usize, "{name}");
    for (index, (driver, decision)) in decisions.iter().enumerate() {
        assert_eq!(*driver, 0, "{name}");
        assert_close(decision.seen.time, index as f64 / sampling.rate(), 1e-14);
    }
    // At fixed steps of order 4 it comes to nearly that.
    let driver = Driver::of_actuator(controller, 0, 0, (sampling, sensors));
    let fixed = TimeStepping::Fixed { method: Method::Rk4, step: duration / 8000.0 };
    let mut steps = PlantRun::with_drivers(&plant, &at_start, fixed, vec![driver]).expect(name);
    steps.advance_to(duration).expect(name);
    let here = plant.indices().actuators[0];
    let (end, stepped) = (new.at(duration).0, steps.state());
    assert_close(stepped[here.pressure], end[here.pressure], 2e-3);
    let place = plant.indices().mechanisms[0].position(0);
    assert_close(stepped[place], end[place], 2e-3);
    let times = (0..=200).map(|index| duration * f64::from(index) / 200.0);
    let states: Vec<f64> = times.clone().map(|time| new.at(time).0[here.pressure]).collect();
    // The requests are the whole command: without the controller the run is the same.
    let start = Plant::start_of_rig(&rig, &start);
    let repeated = simulate_plant(new.plant(), &start, duration, TOLERANCE).expect(name);
    let again: Vec<f64> = times.map(|time| repeated.at(time).0[here.pressure]).collect();
    let most = difference(&again, &states);
    assert!(most < 1e-7, "{name}, without its controller: {most:e}");
}

#[test]
fn each_controller_of_one_actuator_runs_as_at_fixed_steps() {
    let perfect = Sensors::perfect();
    let paper = fill_hold_exhaust();
    let by_pressure = |regulator| tracker(Quantity::Pressure, 45.0 * PSI, 5.0 * PSI, regulator);
    let with_output = |output| pid(Quantity::Pressure, 60.0 * PSI, output);
    let fast = sampling(100.0, 0).with_pulse_frequency(70.0).expect("a frequency");
    compare("pressure", &paper, by_pressure(with_output(Output::FillHoldExhaust)), fast, perfect);
    let three_way = Paper::pwm(50.0, 0.5).gauge(20.0 * PSI);
    compare("three-way", &three_way, by_pressure(with_output(Output::FillExhaust)), sampling(50.0, 2), perfect);
    compare("relay", &paper, by_pressure(relay(Quantity::Pressure, 3.0 * PSI, PSI)), sampling(200.0, 1), perfect);
    let length = tracker(Quantity::Length, 0.088, 2e-3, pid(Quantity::Length, 0.02, Output::FillHoldExhaust));
    compare("length", &paper, length, sampling(60.0, 0), perfect);
    let coarse = Sensors {
        pressure: Sensor::new(Quantity::Pressure, 2.0 * PSI, Some((0.0, 80.0 * PSI))).expect("one"),
        ..perfect
    };
    compare("sensors", &paper, by_pressure(with_output(Output::FillHoldExhaust)), sampling(80.0, 0), coarse);
    let held = paper.clone().isometric(3.4 * INCH);
    let force = tracker(Quantity::Force, 20.0, 3.0, pid(Quantity::Force, 30.0, Output::FillHoldExhaust));
    compare("force", &held, force, sampling(100.0, 0), perfect);
    let model = Paper::sealed().actuator();
    let aim = |place| {
        let force = SetPoint::constant(Quantity::Force, 22.0).expect("a force");
        StaticAim::new(model.clone(), force, place, GaugePressure(100.0 * PSI)).expect("an aim")
    };
    let wanted = SetPoint::steps(Quantity::Length, vec![0.0, 0.4], vec![0.088, 0.085]).expect("lengths");
    let feed_forward = FeedForward { aim: aim(Place::Measured), regulator: relay(Quantity::Pressure, 3.0 * PSI, 0.0) };
    compare("feed-forward", &paper, feed_forward, sampling(120.0, 0), perfect);
    let mass = AirMass::new(aim(Place::Wanted(wanted)), ROOM, relay(Quantity::AirMass, 2e-7, 0.0)).expect("a law");
    compare("air mass", &paper, mass, sampling(150.0, 0), perfect);
}

/// Runs a controller on a joint's plant, and at fixed steps of order 4, which come to it.
fn compare_joint<C>(name: &str, pair: &Pair, controller: C, sampling: Sampling)
where
    C: JointController<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let (rig, duration) = (pair.rig().expect(name), 0.6);
    let start = rig.start(&pair.initial()).expect(name);
    let set_up = (sampling, JointSensors::perfect());
    let joint = JointPlant::new(&rig).expect(name);
    let driver = joint.driver(controller.clone(), set_up).expect(name);
    let run = joint.record(&start, (duration, TOLERANCE), Some(driver), &mut |_| Ok(())).expect(name);
    let samples: Vec<_> = run.samples(duration / 200.0).collect();
    let fixed = TimeStepping::Fixed { method: Method::Rk4, step: duration / (200.0 * f64::from(STEPS)) };
    let driver = joint.driver(controller, set_up).expect(name);
    let by_steps = joint.record(&start, (duration, fixed), Some(driver), &mut |_| Ok(())).expect(name);
    let stepped: Vec<_> = by_steps.samples(duration / 200.0).collect();
    let series = |of: &[JointSample], read: &dyn Fn(&JointSample) -> f64| of.iter().map(read).collect::<Vec<f64>>();
    let apart = |read: &dyn Fn(&JointSample) -> f64| difference(&series(&stepped, read), &series(&samples, read));
    let most =
        [apart(&|it| it.angle), apart(&|it| it.actuators[0].pressure.0), apart(&|it| it.actuators[1].pressure.0)];
    println!("{name}: {most:?}");
    assert!(most.iter().all(|most| *most < 1e-6), "{name}: {most:?}");
    let decisions = run.decisions();
    assert_eq!(decisions.len(), by_steps.decisions().len(), "{name}");
    for (ours, theirs) in decisions.iter().zip(by_steps.decisions()) {
        assert_eq!((ours.aim, ours.seen.time), (theirs.aim, theirs.seen.time), "{name}");
        assert_within(ours.seen.angle, theirs.seen.angle, 1e-6);
        for i in 0..2 {
            assert_within(ours.seen.actuators[i].tension, theirs.seen.actuators[i].tension, 1e-3);
        }
    }
}

/// Fixed steps between two samples.
const STEPS: u32 = 60;

#[test]
fn each_controller_of_a_joint_runs_as_at_fixed_steps() {
    let paper = |coulomb: f64| {
        Paper::driven(Command::Constant(Request::Hold))
            .gauge(30.0 * PSI)
            .friction(3.5, coulomb)
            .process(Process::Isothermal)
            .with(|rig| {
                rig.kind = ValveKind::FillHoldExhaust;
                rig.delays = (1e-3, 2e-3);
                rig.standard = FlowStandard::Orifice { flow_area: 4e-7 };
            })
    };
    let joint = |coulomb| {
        Pair::of(paper(coulomb)).with(|pair| {
            pair.limb = Limb { mass: 0.3, distance: 0.05, inertia: 1e-3, gravity: GRAVITY, hanging_angle: 0.0 };
            pair.damping = 0.03;
            pair.angle = InitialAngle::At(0.05);
        })
    };
    let angle = SetPoint::sinusoid(Quantity::Angle, 0.05, 0.15, 1.5, 0.0).expect("a set point");
    let swings = JointTracker { angle, regulator: pid(Quantity::Angle, 0.5, Output::FillHoldExhaust) };
    compare_joint("tracker", &joint(0.0), swings.clone(), sampling(100.0, 1));
    compare_joint("tracker on dry friction", &joint(1e-4), swings, sampling(80.0, 0));
    let of_one =
        |target: f64| tracker(Quantity::Pressure, target, 5.0 * PSI, relay(Quantity::Pressure, 2.0 * PSI, 0.0));
    compare_joint("two of one", &joint(0.0), [of_one(45.0 * PSI), of_one(30.0 * PSI)], sampling(150.0, 0));
    let aim = || {
        let pair = joint(0.0);
        let of = |quantity, value| SetPoint::constant(quantity, value).expect("a set point");
        let points = [of(Quantity::Angle, 0.15), of(Quantity::Stiffness, 2.0)];
        let rig = pair.rig().expect("a rig");
        let actuators = [0, 1].map(|i| rig.driven()[i].actuator.clone());
        JointAim::new(actuators, *rig.joint(), points, GaugePressure(90.0 * PSI)).expect("within reach")
    };
    let forward = FeedForward { aim: aim(), regulator: relay(Quantity::Pressure, PSI, 0.0) };
    compare_joint("feed-forward", &joint(0.0), forward, sampling(200.0, 0));
    let mass = AirMass::new(aim(), 293.15, relay(Quantity::AirMass, 1e-7, 0.0)).expect("a controller");
    compare_joint("air mass", &joint(0.0), mass, sampling(100.0, 0));
}

/// Actuators of the paper on one bottle, each with a mass and a valve.
fn on_one_bottle(papers: &[Paper], volume: f64) -> (Plant, PlantStart, usize) {
    let air = papers[0].air();
    let mut network = Network::new(&air);
    let bottle = Reservoir::new([volume, 1.4, ROOM], GaugePressure(7e5), None, &air).expect("a bottle");
    let bottle = network.node(NodeKind::Reservoir(bottle), 0.0, ROOM);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let (mut mounted, mut mechanisms, mut positions, mut airs) = (vec![], vec![], vec![], vec![]);
    for (index, paper) in papers.iter().enumerate() {
        let solenoid = Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a solenoid");
        let command = paper.command.clone().expect("a command");
        let valve = network.valve(Actuation { solenoid, command });
        let chamber = network.chamber(index, ROOM);
        for (from, port) in [(bottle, Port::Supply), (outside, Port::Exhaust)] {
            let law = *paper.valve().law_of(port);
            network.branch(from, chamber, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
        mounted.push(Mounted {
            actuator: paper.actuator().without_valve(),
            mechanism: index,
            coupling: Coupling::Direct { coordinate: 0 },
            tendon: None,
            pressure: None,
        });
        mechanisms.push(Mechanism::Mass(Mass::new(2.0 + index as f64, Pull::Gravity(GRAVITY), None).expect("a mass")));
        positions.push(vec![0.093 - 0.002 * index as f64]);
        airs.push(InitialAir { gauge_pressure: GaugePressure(paper.gauge), temperature: ROOM });
    }
    let count = papers.len();
    let rates = vec![vec![0.0]; count];
    let start = PlantStart { positions, rates, air: airs, lengths: vec![None; count], friction: vec![] };
    (Plant::new(mounted, network, mechanisms).expect("a plant"), start, bottle)
}

fn two_loops() -> [Driver; 2] {
    let first = tracker(
        Quantity::Pressure,
        45.0 * PSI,
        4.0 * PSI,
        pid(Quantity::Pressure, 60.0 * PSI, Output::FillHoldExhaust),
    );
    let second = tracker(Quantity::Length, 0.088, 2e-3, relay(Quantity::Length, 5e-4, 0.0));
    [
        Driver::of_actuator(first, 0, 0, (sampling(70.0, 1), Sensors::perfect())),
        Driver::of_actuator(second, 1, 1, (sampling(110.0, 0), Sensors::perfect())),
    ]
}

fn record(plant: &Plant, start: &PlantStart, drivers: Vec<Driver>, duration: f64) -> PlantTrajectory {
    let mut run = PlantRun::with_drivers(plant, start, TOLERANCE, drivers).expect("a run");
    run.record_to(duration, &mut |_| Ok(())).expect("the run reaches its end")
}

#[test]
fn two_unlike_loops_share_a_bottle() {
    let papers = [fill_hold_exhaust(), fill_hold_exhaust().with(|rig| rig.delays = (3e-3, 2e-3))];
    let duration = 0.6;
    let (plant, start, bottle) = on_one_bottle(&papers, 2e-4);
    let run = record(&plant, &start, two_loops().to_vec(), duration);
    // Each samples at its own instants, exactly.
    for (driver, rate) in [(0, 70.0), (1, 110.0)] {
        let times = run.decisions().iter().filter(|(its, _)| *its == driver).map(|(_, decision)| decision.seen.time);
        let expected: Vec<f64> = (0..=(duration * rate) as u32).map(|k| f64::from(k) / rate).collect();
        assert_eq!(times.collect::<Vec<f64>>(), expected, "driver {driver}");
        let events = run.events().iter();
        let sampled =
            events.filter(|event| event.kind.part == Part::Driver(driver) && event.kind.kind == EventKind::Sample);
        assert_eq!(sampled.count(), expected.len());
    }
    // The requests of the drivers, as schedules, give the same run.
    let repeated = simulate_plant(run.plant(), &start, duration, TOLERANCE).expect("a run");
    let places = plant.indices();
    let tank = places.nodes[bottle].expect("a state");
    let times: Vec<f64> = (0..=200).map(|k| duration * f64::from(k) / 200.0).collect();
    let series = |run: &PlantTrajectory, place: usize| times.iter().map(|t| run.at(*t).0[place]).collect::<Vec<f64>>();
    for place in [tank, places.actuators[0].pressure, places.actuators[1].pressure, 0, 2] {
        let most = difference(&series(&repeated, place), &series(&run, place));
        assert!(most < 1e-7, "state {place}: {most:e}");
    }
    // The bottle sags: a large one does not, and then each loop runs as it does alone.
    let sagged = run.at(0.0).0[tank] - run.at(duration).0[tank];
    assert!(sagged > 2e4, "{sagged}");
    let (plant, start, _) = on_one_bottle(&papers, 1e9);
    let both = record(&plant, &start, two_loops().to_vec(), duration);
    for (kept, driver) in two_loops().into_iter().enumerate() {
        let alone = record(&plant, &start, vec![driver], duration);
        let place = plant.indices().actuators[kept].pressure;
        let most = difference(&series(&alone, place), &series(&both, place));
        assert!(most < 1e-7, "loop {kept} alone: {most:e}");
    }
}

#[test]
fn a_run_that_is_restored_goes_on_with_what_its_drivers_remember() {
    let papers = [fill_hold_exhaust(), fill_hold_exhaust()];
    let (plant, start, _) = on_one_bottle(&papers, 5e-4);
    let mut run = PlantRun::with_drivers(&plant, &start, 1e-9, two_loops().to_vec()).expect("a run");
    run.advance_to(0.253).expect("on");
    let saved = run.save();
    run.advance_to(0.5).expect("on");
    let ahead = run.state().to_vec();
    // Another run of the plant, elsewhere, is brought to the same place: the same bits follow.
    let mut other = PlantRun::with_drivers(&plant, &start, 1e-9, two_loops().to_vec()).expect("a run");
    other.advance_to(0.1).expect("on");
    for _ in 0..2 {
        other.restore(&saved).expect("the same plant");
        assert_eq!(other.time(), 0.253);
        other.advance_to(0.5).expect("on");
        assert_eq!(other.state(), ahead);
        assert_eq!(other.statistics(), run.statistics());
    }
    // Pauses change nothing but rounding and the tolerance's share.
    let mut whole = PlantRun::with_drivers(&plant, &start, 1e-9, two_loops().to_vec()).expect("a run");
    whole.advance_to(0.5).expect("on");
    for (one, other) in whole.state().iter().zip(&ahead) {
        assert_close(*one, *other, 1e-6);
    }
    let (bigger, start, _) = on_one_bottle(&papers[..1], 5e-4);
    let mut run = PlantRun::new(&bigger, &start, 1e-9).expect("a run");
    assert!(matches!(run.restore(&saved), Err(Error::Misuse { .. })));
}

/// A plant of one valve under a command.
fn under(solenoid: Solenoid, command: Command) -> (Plant, PlantStart) {
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).gauge(20.0 * PSI);
    let rig = Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig");
    let start = rig.start(&paper.initial()).expect("a start");
    (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start))
}

/// What is set at run time, at instants a millisecond apart, is the schedule that would have been known beforehand.
#[test]
fn valves_that_are_set_at_run_time_run_as_under_the_schedule() {
    let times: Vec<f64> = (0..150).map(|k| f64::from(k) * 2e-3).collect();
    let part = |k: usize| ((k * 37) % 101) as f64 / 101.0;
    let requests: Vec<Request> =
        (0..150).map(|k| [Request::Fill, Request::Hold, Request::Exhaust][(part(k) * 3.0) as usize]).collect();
    let positions: Vec<f64> = (0..150).map(|k| 2.0 * part(k) - 1.0).collect();
    let set_points: Vec<f64> = (0..150).map(|k| 1e5 + 4e5 * part(k)).collect();
    let seats = Solenoid::new(ValveKind::FillHoldExhaust, 2.7e-3, 1.3e-3).expect("a solenoid");
    let spool = Solenoid::proportional(Spool::new(60.0, 0.7, 0.05, 0.05).expect("a spool"));
    let regulator = Solenoid::regulating(Proportional::new(0.02, 5.5e-3, 5e6).expect("a regulator"));
    type Case = (&'static str, Solenoid, Command, Command, Vec<RuntimeCommand>);
    let nothing = vec![10.0];
    let cases: Vec<Case> = vec![
        (
            "seats",
            seats,
            Command::table(times.clone(), requests.clone()).expect("a table"),
            Command::Constant(Request::Hold),
            requests.iter().map(|request| (*request).into()).collect(),
        ),
        (
            "spool",
            spool,
            Command::positions(times.clone(), positions.clone()).expect("positions"),
            Command::positions(nothing.clone(), vec![0.0]).expect("positions"),
            positions.iter().map(|at| RuntimeCommand::Position(*at)).collect(),
        ),
        (
            "regulator",
            regulator,
            Command::set_points(times.clone(), set_points.clone()).expect("set points"),
            Command::set_points(nothing, vec![0.0]).expect("set points"),
            set_points.iter().map(|gauge| RuntimeCommand::SetPoint(GaugePressure(*gauge))).collect(),
        ),
    ];
    for (name, solenoid, schedule, before, commands) in cases {
        let (plant, start) = under(solenoid, schedule);
        let known = simulate_plant(&plant, &start, 0.3, TOLERANCE).expect(name);
        let (plant, start) = under(solenoid, before);
        let mut run = PlantRun::new(&plant, &start, TOLERANCE).expect(name);
        let mut most: f64 = 0.0;
        for (time, commanded) in times.iter().zip(&commands) {
            run.advance_to(*time).expect(name);
            run.set(0, *commanded).expect(name);
            let (state, _) = known.at(*time);
            for (one, other) in run.state().iter().zip(&state) {
                most = most.max((one - other).abs() / other.abs().max(0.1));
            }
        }
        assert!(most < 1e-7, "{name}: {most:e}");
        assert!(run.measurement().time > 0.29);
    }
}

#[test]
fn pulses_that_are_set_at_run_time_are_those_of_the_schedule() {
    let solenoid = Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).expect("a solenoid");
    let pwm = Command::pwm(25.0, 0.4, Request::Fill, Request::Exhaust).expect("a command");
    let (plant, start) = under(solenoid, pwm);
    let known = simulate_plant(&plant, &start, 0.5, TOLERANCE).expect("a run");
    let (plant, start) = under(solenoid, Command::Constant(Request::Exhaust));
    let mut run = PlantRun::new(&plant, &start, TOLERANCE).expect("a run");
    run.set(0, RuntimeCommand::Pulses { frequency: 25.0, duty: 0.4, pulse: Request::Fill, rest: Request::Exhaust })
        .expect("set");
    for count in 1..=97 {
        let time = 0.5 * f64::from(count) / 97.0;
        run.advance_to(time).expect("on");
        for (one, other) in run.state().iter().zip(&known.at(time).0) {
            assert_within(*one, *other, 1e-7 * other.abs().max(0.1));
        }
    }
}

#[test]
fn a_function_drives_several_valves_by_what_any_node_shows() {
    // One driver of both valves: it fills the one whose chamber is lower, as long as the bottle is above 6.5 bar.
    let papers = [fill_hold_exhaust(), fill_hold_exhaust().gauge(10.0 * PSI)];
    let (plant, start, bottle) = on_one_bottle(&papers, 1e-4);
    let decide = move |seen: &PlantMeasurement, filled: &mut u32, commands: &mut [Option<RuntimeCommand>]| {
        let lower = usize::from(seen.actuators[1].pressure.0 < seen.actuators[0].pressure.0);
        let fills = seen.nodes[bottle].0 > 6.5e5;
        *filled += u32::from(fills);
        commands[lower] = Some(if fills { Request::Fill } else { Request::Hold }.into());
        commands[1 - lower] = Some(Request::Hold.into());
    };
    let driver = Driver::of_function(decide, 0, &[0, 1], sampling(100.0, 0), PlantSensors::perfect());
    let run = record(&plant, &start, vec![driver], 1.0);
    let (end, _) = run.at(1.0);
    let atmosphere = papers[0].air().atmosphere();
    let gauge = |place: usize| end[place] - atmosphere.0;
    let tank = gauge(plant.indices().nodes[bottle].expect("a state"));
    // It stopped within what one sample lets in.
    assert!(tank < 6.5e5 && tank > 6.1e5, "{tank}");
    // What is held keeps its air, from the closing delay on to the next sample; what is filled gains some.
    let mut filled = [0, 0];
    for (_, decision) in run.decisions().iter().filter(|(_, decision)| decision.seen.time < 0.985) {
        for valve in 0..2 {
            let place = plant.indices().actuators[valve].mass();
            let mass = |after: f64| run.at(decision.seen.time + after).0[place];
            let fills = decision.commands[valve] == Some(Request::Fill.into());
            if fills {
                assert!(mass(0.01) > mass(0.005), "valve {valve} at {} s", decision.seen.time);
                assert!(decision.seen.actuators[valve].pressure.0 <= decision.seen.actuators[1 - valve].pressure.0);
                filled[valve] += 1;
            } else {
                assert_close(mass(0.01), mass(0.00101), 1e-12);
            }
        }
    }
    assert!(filled.iter().all(|count| *count > 0), "{filled:?}");
    let last = &run.decisions().last().expect("a decision").1;
    assert!(last.commands.iter().all(|commanded| *commanded == Some(Request::Hold.into())));
    assert_close(last.seen.nodes[bottle].0, tank, 1e-9);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let papers = [fill_hold_exhaust(), fill_hold_exhaust()];
    let (plant, start, _) = on_one_bottle(&papers, 1e-3);
    let steady = |commanded: RuntimeCommand, valves: &[usize]| {
        let decide = move |_: &PlantMeasurement, (): &mut (), commands: &mut [Option<RuntimeCommand>]| {
            commands.fill(Some(commanded))
        };
        Driver::of_function(decide, (), valves, sampling(50.0, 0), PlantSensors::perfect())
    };
    let fill = RuntimeCommand::Request(Request::Fill);
    let run = |drivers| PlantRun::with_drivers(&plant, &start, 1e-8, drivers);
    let refused = |drivers: Vec<Driver>| run(drivers).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refused(vec![steady(fill, &[0]), steady(fill, &[1, 0])]).contains("two drivers"));
    assert!(refused(vec![steady(fill, &[2])]).contains("not there"));
    let absent = tracker(Quantity::Pressure, 2e5, 0.0, relay(Quantity::Pressure, 1e4, 0.0));
    let absent = Driver::of_actuator(absent, 7, 0, (sampling(50.0, 0), Sensors::perfect()));
    assert!(refused(vec![absent]).contains("not there"));
    let mut driven = run(vec![steady(fill, &[0])]).expect("a run");
    assert!(driven.set(0, Request::Hold).expect_err("refused").to_string().contains("driver"));
    assert!(driven.set(5, Request::Hold).expect_err("refused").to_string().contains("not there"));
    driven.set(1, Request::Exhaust).expect("the valve is free");
    let at = driven.save();
    assert!(matches!(driven.set(1, RuntimeCommand::Position(0.5)), Err(Error::Misuse { .. })));
    let rapid = RuntimeCommand::Pulses { frequency: 1e15, duty: 0.5, pulse: Request::Fill, rest: Request::Hold };
    driven.set(1, rapid).expect("a frequency");
    assert!(driven.advance_to(1.0).expect_err("refused").to_string().contains("edges of pulses"));
    // A run that is refused stays where it was.
    assert_eq!(driven.state(), at.state());
    // A driver that requests what its valve cannot do ends the run.
    let mut wrong = run(vec![steady(RuntimeCommand::Position(0.1), &[0])]).expect("a run");
    assert!(wrong.advance_to(0.1).expect_err("refused").to_string().contains("spool"));
    assert!(matches!(driven.advance_to(f64::NAN), Err(Error::OutOfRange { .. })));
    assert!(matches!(driven.advance_to(f64::INFINITY), Err(Error::OutOfRange { .. })));
    let mut calls = run(vec![steady(fill, &[0])]).expect("a run");
    assert!(matches!(calls.set_rates(0, &[0.0]), Err(Error::Misuse { .. })));
}

/// Over dual numbers a run under a driver carries its derivatives, through every sampling instant and pulse.
#[test]
fn derivatives_pass_through_a_driver() {
    type D = mckibben::Seeded;
    let (plant, start, _) = on_one_bottle(&[fill_hold_exhaust()], 3e-4);
    let law = tracker(
        Quantity::Pressure,
        45.0 * PSI,
        4.0 * PSI,
        pid(Quantity::Pressure, 60.0 * PSI, Output::FillHoldExhaust),
    );
    let row = &mckibben::parameter::RESERVOIR_VOLUME;
    let end = |volume: f64| {
        let changed = plant.map(|_, parameter, value| if parameter.key == row.key { volume } else { value });
        let driver = Driver::of_actuator(law.clone(), 0, 0, (sampling(70.0, 1), Sensors::perfect()));
        let mut run = PlantRun::with_drivers(&changed, &start, 1e-12, vec![driver]).expect("a run");
        run.advance_to(0.2).expect("on");
        run.state()[plant.indices().actuators[0].pressure]
    };
    let constant = |number: &f64| D::constant(*number);
    let seeded = plant.map(
        |_, parameter, value| {
            if parameter.key == row.key { D::variable(value, 0) } else { D::constant(value) }
        },
    );
    let dual_start = PlantStart {
        positions: start.positions.iter().map(|list| list.iter().map(constant).collect()).collect(),
        rates: vec![vec![D::constant(0.0)]],
        air: vec![InitialAir {
            gauge_pressure: GaugePressure(constant(&start.air[0].gauge_pressure.0)),
            temperature: constant(&start.air[0].temperature),
        }],
        lengths: vec![None],
        friction: vec![],
    };
    let of_law = law.map(|_, value| D::constant(value));
    let instants = sampling(70.0, 1).map(|_, value| D::constant(value));
    let driver = Driver::of_actuator(of_law, 0, 0, (instants, Sensors::perfect()));
    let mut run = PlantRun::with_drivers(&seeded, &dual_start, 1e-12, vec![driver]).expect("a run");
    run.advance_to(D::constant(0.2)).expect("on");
    let reached = run.state()[plant.indices().actuators[0].pressure];
    let step = 3e-8;
    let difference = (end(3e-4 + step) - end(3e-4 - step)) / (2.0 * step);
    assert_close(reached.value, end(3e-4), 1e-9);
    assert_close(reached.slope[0], difference, 1e-4);
    assert!(difference.abs() > 1e6, "{difference}");
}

/// Rates that a host gives, at the corners of a motion that is given by straight lines.
#[test]
fn an_external_mechanism_follows_its_host_under_a_driver() {
    let length = [0.0930, 0.0900, 0.0915, 0.0880, 0.0920];
    let times: Vec<f64> = (0..5).map(|k| 0.1 * f64::from(k)).collect();
    let paper = fill_hold_exhaust();
    let motion = Motion::table(times.clone(), length.to_vec(), paper.thread_length).expect("a motion");
    let of = |mechanism: Mechanism| {
        let (plant, mut start, _) = on_one_bottle(core::slice::from_ref(&paper), 1e-3);
        start.positions = vec![vec![length[0]]];
        (Plant::new(plant.actuators().to_vec(), plant.network().clone(), vec![mechanism]).expect("a plant"), start)
    };
    let driver = || two_loops()[0].clone();
    let (plant, start) = of(Mechanism::Prescribed(motion));
    let given = record(&plant, &start, vec![driver()], 0.4);
    let (plant, start) = of(Mechanism::External { distances: 1 });
    let mut run = PlantRun::with_drivers(&plant, &start, TOLERANCE, vec![driver()]).expect("a run");
    for k in 0..4 {
        run.set_rates(0, &[(length[k + 1] - length[k]) / 0.1]).expect("rates");
        run.advance_to(times[k + 1]).expect("on");
        let (state, _) = given.at(times[k + 1] - 1e-12);
        let here = plant.indices().actuators[0];
        assert_close(run.state()[here.pressure], state[here.pressure], 1e-7);
        assert_close(run.state()[0], length[k + 1], 1e-12);
        let tension = run.measurement().actuators[0].tension;
        assert!(tension > 0.0);
    }
    assert!(matches!(run.set_rates(0, &[0.1, 0.2]), Err(Error::Table { .. })));
    assert!(matches!(run.set_rates(0, &[f64::NAN]), Err(Error::OutOfRange { .. })));
}

/// A prescribed pressure in one actuator and a controlled one in the other, on one mass: the measurement is the prescribed pressure.
#[test]
fn a_prescribed_pressure_and_a_driver_act_in_one_plant() {
    let paper = fill_hold_exhaust();
    let (plant, _, _) = on_one_bottle(core::slice::from_ref(&paper), 1e-3);
    let pressure = PressureSeries::new(&[0.0, 0.2, 0.5], &[1e5, 3e5, 2e5]).expect("a time series");
    let mut mounted = plant.actuators().to_vec();
    mounted.push(Mounted { pressure: Some(pressure), ..mounted[0].clone() });
    let mass = Mechanism::Mass(Mass::new(4.0, Pull::Gravity(GRAVITY), None).expect("a mass"));
    let plant = Plant::new(mounted, plant.network().clone(), vec![mass]).expect("a plant");
    let air = InitialAir { gauge_pressure: GaugePressure(1e5), temperature: ROOM };
    let start = PlantStart {
        positions: vec![vec![0.092]],
        rates: vec![vec![0.0]],
        air: vec![air; 2],
        lengths: vec![None; 2],
        friction: vec![],
    };
    let run = record(&plant, &start, vec![two_loops()[0].clone()], 0.5);
    for (_, decision) in run.decisions() {
        let time = decision.seen.time;
        let given = if time < 0.2 { 1e5 + 1e6 * time } else { 3e5 - (time - 0.2) / 0.3 * 1e5 };
        assert_close(decision.seen.actuators[1].pressure.0, given, 1e-9);
        // Both span the same distance, and M g − F₁ − F₂ accelerates it.
        assert_eq!(decision.seen.actuators[0].length, decision.seen.actuators[1].length);
    }
}
