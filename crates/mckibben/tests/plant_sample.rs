//! Samples of plants: those of the engine of rigs, equations of a joint, shares of what sticks, derivatives, and what an event leaves.

use crate::common::joint::Pair;
use crate::common::{ATMOSPHERE, GRAVITY, INCH, PSI, Paper, ROOM, assert_close, assert_within, bisect, scaled};
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::{Load, MomentArm, Motion};
use mckibben::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{
    InitialAir, Mounted, Plant, PlantReader, PlantSample, PlantStart, PlantTrajectory, simulate_plant,
};
use mckibben::simulation::{Rig, SeriesTendon, simulate};
use mckibben::valve::{Command, Port, Request};
use mckibben::{Dual, GaugePressure, Real, Scalar, parameter};

/// The largest difference of two series over the range of the first, or over `least`.
fn apart(pairs: &[[f64; 2]], least: f64) -> f64 {
    let (low, high) = pairs.iter().fold((f64::MAX, f64::MIN), |(low, high), [v, _]| (low.min(*v), high.max(*v)));
    let scale = (high - low).max(least);
    pairs.iter().fold(0.0, |most: f64, [one, other]| most.max((one - other).abs() / scale))
}

/// The run of a rig's plant from the rig's own start.
fn run_of(rig: &Rig, paper: &Paper, duration: f64, tolerance: f64) -> PlantTrajectory {
    let start = rig.start(&paper.initial()).expect("a start");
    let plant = Plant::of_rig(rig);
    simulate_plant(&plant, &Plant::start_of_rig(rig, &start), duration, tolerance).expect("the run reaches its end")
}

fn compare_with_rig(name: &str, rig: &Rig, paper: &Paper, duration: f64) {
    let (tolerance, interval) = (1e-10, duration / 150.0);
    let start = rig.start(&paper.initial()).expect(name);
    let old = simulate(rig, start, duration, tolerance).expect(name);
    let samples: Vec<PlantSample> = run_of(rig, paper, duration, tolerance).samples(interval).collect();
    let pairs = |read: &dyn Fn(&mckibben::simulation::Sample, &PlantSample) -> [f64; 2], least: f64, what: &str| {
        let pairs: Vec<_> = old.samples(interval).zip(&samples).map(|(old, new)| read(&old, new)).collect();
        assert_eq!(pairs.len(), samples.len());
        let most = apart(&pairs, least);
        assert!(most < 1e-7, "{name}: {what} differs by {most:e}");
    };
    let shortest = rig.actuator().limits().min_length();
    let with_tendon = rig.tendon().is_some();
    pairs(&|old, new| [old.time, new.time], 1.0, "time");
    pairs(&|old, new| [old.load_distance, new.actuators[0].distance], 1e-3, "distance");
    if !with_tendon {
        pairs(&|old, new| [old.length.max(shortest), new.actuators[0].length], 1e-3, "length");
    }
    pairs(&|old, new| [old.load_velocity, new.actuators[0].rate], 0.1, "rate");
    pairs(&|old, new| [old.pressure.0, new.actuators[0].pressure.0], 1e4, "pressure");
    pairs(&|old, new| [old.air_mass, new.actuators[0].air_mass], 1e-6, "air mass");
    pairs(&|old, new| [old.temperature, new.actuators[0].temperature], 10.0, "temperature");
    pairs(&|old, new| [old.volume, new.actuators[0].volume], 1e-8, "volume");
    pairs(&|old, new| [old.tension, new.actuators[0].tension], 10.0, "tension");
    pairs(&|old, new| [old.mass_flow, new.actuators[0].mass_flow], 1e-4, "flow");
    if let Some(valve) = samples[0].valves.first().map(|_| 0) {
        let number = |open: bool| f64::from(u8::from(open));
        pairs(&|old, new| [number(old.ports.supply), number(new.valves[valve].ports.supply)], 1.0, "supply port");
        pairs(&|old, new| [number(old.ports.exhaust), number(new.valves[valve].ports.exhaust)], 1.0, "exhaust port");
    }
    let plant = Plant::of_rig(rig);
    let node = |wanted: &dyn Fn(&NodeKind) -> bool| plant.network().nodes.iter().position(|node| wanted(&node.kind));
    if let Some(hose) = node(&|kind| matches!(kind, NodeKind::Hose(_))) {
        pairs(&|old, new| [old.hose_pressure.0, new.nodes[hose].pressure.0], 1e4, "hose pressure");
        let content = |new: &PlantSample| {
            let hoses = plant.network().nodes.iter().zip(&new.nodes);
            hoses.filter(|(node, _)| matches!(node.kind, NodeKind::Hose(_))).map(|(_, at)| at.air_mass).sum::<f64>()
        };
        pairs(&|old, new| [old.hose_air_mass, content(new)], 1e-6, "air in the hose");
    }
    let outlet = node(&|kind| matches!(kind, NodeKind::Outlet { .. }));
    if let Some(supply) = outlet.or_else(|| node(&|kind| matches!(kind, NodeKind::Reservoir(_)))) {
        pairs(&|old, new| [old.supply_pressure.expect(name).0, new.nodes[supply].pressure.0], 1e4, "supply");
    }
}

#[test]
fn samples_of_rigs() {
    let pwm = Paper::pwm(25.0, 0.5);
    let air = pwm.air();
    let balance = Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: 290.0 };
    let motion = Motion::sinusoid(3.6 * INCH, 0.15 * INCH, 3.0, 0.0, pwm.thread_length).expect("a motion");
    let cases = vec![
        ("pwm", pwm.clone(), 0.3),
        ("sticks", Paper::sealed().gauge(60.0 * PSI).from(3.3 * INCH, 0.0), 2.0),
        ("slack", Paper::sealed().gauge(20.0 * PSI).from(2.6 * INCH, -0.8).mass(0.3), 0.2),
        ("isometric", Paper::pwm(25.0, 0.4).isometric(3.4 * INCH), 0.2),
        ("prescribed", pwm.clone().with(|rig| rig.load = Load::Prescribed(motion)), 0.4),
        ("isothermal", Paper::pwm(25.0, 0.5).process(Process::Isothermal), 0.2),
        ("energy", Paper::pwm(25.0, 0.5).process(balance), 0.2),
    ];
    for (name, paper, duration) in cases {
        compare_with_rig(name, &paper.rig(), &paper, duration);
    }
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    let filled = pwm.clone().gauge(40.0 * PSI);
    compare_with_rig("tendon", &filled.rig().with_tendon(tendon), &filled, 0.2);
    let hose = |kind| Hose::new(kind, [1.0, 3e-3], [1.8e-5, 293.15, 1.0], &air).expect("a hose");
    let bottle = Reservoir::new([1e-3, 1.4, 293.15], GaugePressure(7e5), None, &air).expect("a bottle");
    let regulator = Regulator::new(2e7, 0.0, 0.01).expect("a regulator");
    let leak = Leakage::new(2e-11).expect("a leak");
    let supply = |reservoir, regulator| Some(SupplyLine::new(reservoir, regulator, 1.0).expect("a supply"));
    let lines = [
        ("lumped", Line { hose: Some(hose(HoseKind::Lumped)), ..Line::NONE }),
        ("distributed", Line { hose: Some(hose(HoseKind::Distributed { cells: 3 })), ..Line::NONE }),
        ("leak and bottle", Line { leakage: Some(leak), supply: supply(Some(bottle), None), ..Line::NONE }),
        ("regulator", Line { supply: supply(Some(bottle), Some(regulator)), ..Line::NONE }),
    ];
    for (name, line) in lines {
        compare_with_rig(name, &pwm.rig().with_line(line).expect(name), &pwm, 0.2);
    }
}

#[test]
fn samples_of_joints() {
    let swings = Pair::of(Paper::sealed().gauge(40.0 * PSI)).with(|pair| {
        pair.limb.distance = 0.1;
        pair.limb.hanging_angle = 0.2;
        pair.angular_velocity = 3.0;
        pair.damping = 0.05;
    });
    let driven = Pair::of(Paper::pwm(25.0, 0.5)).with(|pair| pair.papers[1] = Paper::pwm(25.0, 0.3));
    for (name, pair, duration) in [("swings and sticks", swings, 2.0), ("driven", driven, 0.3)] {
        let rig = pair.rig().expect(name);
        let start = rig.start(&pair.initial()).expect(name);
        let plant = Plant::of_joint(&rig).expect(name);
        let run = simulate_plant(&plant, &Plant::start_of_joint(&rig, &start), duration, 1e-10).expect(name);
        let news: Vec<_> = run.samples(duration / 150.0).collect();
        let joint = rig.joint();
        for sample in &news {
            let of = &sample.mechanisms[0];
            let (angle, rate) = (of.position[0], of.rate[0]);
            let leverage = joint.leverage(angle);
            let tensions = [0, 1].map(|i| sample.actuators[i].tension);
            let torque = leverage.torque_of(tensions);
            assert_within(of.actuator_force[0], torque, 1e-12 * (1.0 + torque.abs()));
            let whole = torque + joint.other_torque(angle, rate);
            assert_within(of.acceleration[0] * joint.inertia(), whole, 1e-9 * (1.0 + torque.abs()));
            for (i, actuator) in sample.actuators.iter().enumerate() {
                assert_close(actuator.length, leverage.lengths[i], 1e-14);
                assert_within(actuator.velocity, leverage.slopes()[i] * rate, 1e-14);
                let its = &rig.driven()[i].actuator;
                assert_close(actuator.volume, its.volume(actuator.length), 1e-12);
                let content = actuator.air_mass * its.air().gas_constant() * actuator.temperature;
                assert_close(actuator.pressure.0 * actuator.volume, content, 1e-12);
            }
        }
        if name.ends_with("sticks") {
            let last = news.last().expect("a sample");
            assert_eq!((last.mechanisms[0].rate[0], last.mechanisms[0].acceleration[0]), (0.0, 0.0), "it sticks");
            assert!(last.mechanisms[0].actuator_force[0].abs() > 1e-3, "under a load");
        }
    }
}

/// A joint of a chain under a torque, without gravity.
fn loaded(torque: f64) -> (ChainSegment, Revolute) {
    let stops = JointStops { ends: [None; 2], stiffness: 500.0, damping: 0.0 };
    let segment = ChainSegment { length: 0.3, mass: 0.5, distance: 0.1, inertia: 1e-3 };
    (segment, Revolute { torque, damping: 0.0, stops })
}

/// Sealed muscles at rest on a chain under torques (N·m): of each muscle the gauge pressure (psi) and its pulleys, joint and
/// signed radius (m). The sample after a second, with the least and the largest tension that each can hold.
fn at_rest(torques: &[f64], muscles: &[(f64, &[(usize, f64)])]) -> (PlantSample, Vec<[f64; 2]>) {
    let (segments, joints) = torques.iter().map(|torque| loaded(*torque)).unzip();
    let chain = Chain::new(segments, joints, [0.0, 0.0], None).expect("a chain");
    let length = 0.088;
    let mounted: Vec<Mounted> = muscles
        .iter()
        .map(|(_, pulleys)| {
            let arm = |&(joint, radius): &(usize, f64)| Arm {
                joint,
                sign: radius.signum(),
                arm: MomentArm::Pulley(radius.abs()),
            };
            Mounted {
                actuator: Paper::sealed().actuator(),
                mechanism: 0,
                coupling: Coupling::arms(length, pulleys.iter().map(arm).collect()).expect("a coupling"),
                tendon: None,
                pressure: None,
            }
        })
        .collect();
    let network = Network::new(&Paper::sealed().air());
    let actuator = Paper::sealed().actuator();
    let air = muscles.iter().map(|(psi, _)| InitialAir { gauge_pressure: GaugePressure(psi * PSI), temperature: ROOM });
    let start = PlantStart {
        positions: vec![vec![0.0; torques.len()]],
        rates: vec![vec![0.0; torques.len()]],
        air: air.collect(),
        lengths: vec![None; muscles.len()],
        friction: vec![],
    };
    let plant = Plant::new(mounted, network, vec![Mechanism::Chain(chain)]).expect("a plant");
    let run = simulate_plant(&plant, &start, 1.0, 1e-10).expect("the run reaches its end");
    let bounds = muscles.iter().map(|(psi, _)| {
        let (least, most) = actuator.holdable(length, psi * PSI + ATMOSPHERE, false, 0.0);
        [least, most]
    });
    (run.sample(1.0), bounds.collect())
}

#[test]
fn muscles_about_one_joint_share_what_they_hold() {
    let radii = [0.02, 0.01, -0.015, 0.004];
    let pulleys: Vec<[(usize, f64); 1]> = radii.iter().map(|radius| [(0, *radius)]).collect();
    let psi = [60.0, 80.0, 70.0, 50.0];
    let muscles: Vec<(f64, &[(usize, f64)])> = psi.iter().zip(&pulleys).map(|(psi, it)| (*psi, &it[..])).collect();
    let (_, bounds) = at_rest(&[0.0], &muscles);
    // Without a load on the friction, each pulls with the middle of what it can hold.
    let middle: f64 = radii.iter().zip(&bounds).map(|(r, [least, most])| r * 0.5 * (least + most)).sum();
    let reach: f64 = radii.iter().zip(&bounds).map(|(r, [least, most])| r.abs() * 0.5 * (most - least)).sum();
    let mut clipped = 0;
    for part in [0.0, 0.3, -0.6, 0.9, 0.97, -0.99] {
        let (sample, bounds) = at_rest(&[-middle - part * reach], &muscles);
        assert_eq!(sample.mechanisms[0].rate[0], 0.0, "{part}: it sticks");
        let share = |i: usize, z: f64| (radii[i] * z).clamp(-1.0, 1.0);
        let held = |z: f64| (0..4).map(|i| radii[i] * 0.5 * (bounds[i][1] - bounds[i][0]) * share(i, z)).sum::<f64>();
        let z = bisect(-1e3, 1e3, |z| held(z) - part * reach);
        for i in 0..4 {
            let [least, most] = bounds[i];
            let expected = 0.5 * (least + most) + 0.5 * (most - least) * share(i, z);
            assert_within(sample.actuators[i].tension, expected, 1e-7 * most);
            clipped += i32::from(share(i, z).abs() == 1.0);
        }
        assert_close(sample.mechanisms[0].actuator_force[0], middle + part * reach, 1e-10);
    }
    assert!(clipped > 5, "some are at their bounds: {clipped}");
}

#[test]
fn muscles_about_three_joints_share_what_they_hold() {
    let pulleys: [&[(usize, f64)]; 7] = [
        &[(0, 0.02)],
        &[(0, -0.02)],
        &[(1, 0.015)],
        &[(1, -0.01), (2, -0.02)],
        &[(0, 0.01), (1, 0.012)],
        &[(2, 0.018)],
        &[(2, -0.009), (0, 0.004)],
    ];
    let psi = [50.0, 60.0, 70.0, 55.0, 45.0, 65.0, 40.0];
    let muscles: Vec<(f64, &[(usize, f64)])> = psi.iter().copied().zip(pulleys).collect();
    let entry = |i: usize, joint: usize| pulleys[i].iter().filter(|it| it.0 == joint).map(|it| it.1).sum::<f64>();
    let torque = |tension: &[f64], joint: usize| (0..7).map(|i| entry(i, joint) * tension[i]).sum::<f64>();
    let (_, bounds) = at_rest(&[0.0; 3], &muscles);
    let mut clipped = 0;
    // What is to be held is what shares within the bounds hold.
    for seed in 0..12_u32 {
        let number = |k: u32| (f64::from(seed * 31 + k * 17 + 3) * 0.618_033_988_75).fract();
        let wide = if seed % 2 == 0 { 0.6 } else { 0.999 };
        let shares: Vec<f64> = (0..7).map(|i| (3.0 * (2.0 * number(i) - 1.0)).clamp(-wide, wide)).collect();
        let any: Vec<f64> =
            bounds.iter().zip(&shares).map(|([l, u], share)| 0.5 * (l + u) + 0.5 * (u - l) * share).collect();
        let torques: Vec<f64> = (0..3).map(|joint| -torque(&any, joint)).collect();
        let (sample, bounds) = at_rest(&torques, &muscles);
        assert_eq!(sample.mechanisms[0].rate, [0.0; 3], "{seed}: it sticks");
        let tension: Vec<f64> = sample.actuators.iter().map(|it| it.tension).collect();
        for (joint, given) in torques.iter().enumerate() {
            assert_within(torque(&tension, joint), -given, 1e-9);
        }
        // ξ_i = clip(J_i z) for one z: those between their bounds give z, which all others must agree with.
        let xi: Vec<f64> = (0..7)
            .map(|i| (tension[i] - 0.5 * (bounds[i][0] + bounds[i][1])) / (0.5 * (bounds[i][1] - bounds[i][0])))
            .collect();
        assert!(xi.iter().all(|xi| xi.abs() < 1.0 + 1e-7), "{seed}: {xi:?}");
        let free: Vec<usize> = (0..7).filter(|&i| xi[i].abs() < 1.0 - 1e-6).collect();
        clipped += 7 - free.len();
        // The least sum of squares: no change that holds the same and keeps to the bounds makes it less.
        let cost = |tension: &[f64]| {
            let term = |i: usize| {
                let [least, most] = bounds[i];
                (tension[i] - 0.5 * (least + most)).powi(2) / (0.5 * (most - least))
            };
            (0..7).map(term).sum::<f64>()
        };
        let least = cost(&tension);
        for other in 0..4_u32 {
            // Towards another set of tensions that holds the same: the ones that the torques were made of, and mixtures.
            let part = [1.0, 0.3, 0.05, 0.01][other as usize];
            let mixed: Vec<f64> = tension.iter().zip(&any).map(|(own, any)| own + part * (any - own)).collect();
            assert!(cost(&mixed) >= least - 1e-6 * least, "{seed}: {} is less than {least}", cost(&mixed));
        }
        // And exactly: with three of the free ones for z.
        if free.len() >= 3 {
            let rows: Vec<[f64; 3]> = free.iter().map(|&i| [entry(i, 0), entry(i, 1), entry(i, 2)]).collect();
            if let Some(z) = solve3(&rows, &free.iter().map(|&i| xi[i]).collect::<Vec<_>>()) {
                for i in 0..7 {
                    let at: f64 = (0..3).map(|joint| entry(i, joint) * z[joint]).sum();
                    assert_within(xi[i], at.clamp(-1.0, 1.0), 1e-5);
                }
            }
        }
    }
    assert!(clipped > 3, "some are at their bounds: {clipped}");
}

/// Solves the normal equations of rows of three by Cramer's rule; none where they are singular.
fn solve3(rows: &[[f64; 3]], right: &[f64]) -> Option<[f64; 3]> {
    let mut matrix = [[0.0; 3]; 3];
    let mut sums = [0.0; 3];
    for (row, right) in rows.iter().zip(right) {
        for i in 0..3 {
            sums[i] += row[i] * right;
            for j in 0..3 {
                matrix[i][j] += row[i] * row[j];
            }
        }
    }
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(&matrix);
    let size = matrix[0][0] * matrix[1][1] * matrix[2][2];
    (whole > 1e-6 * size).then(|| {
        std::array::from_fn(|k| {
            let mut changed = matrix;
            for i in 0..3 {
                changed[i][k] = sums[i];
            }
            determinant(&changed) / whole
        })
    })
}

#[test]
fn a_muscle_held_at_a_length_pulls_without_friction() {
    let paper = Paper::sealed().gauge(60.0 * PSI).isometric(3.4 * INCH);
    let sample = run_of(&paper.rig(), &paper, 0.1, 1e-8).sample(0.05);
    let expected: f64 = paper.actuator().static_force(3.4 * INCH, 60.0 * PSI + ATMOSPHERE);
    assert_close(sample.actuators[0].tension, expected, 1e-12);
}

/// A muscle that rests on its shortest length bears any tension up to its largest: a light weight is all that it feels.
#[test]
fn on_its_shortest_length_a_muscle_bears_what_hangs_on_it() {
    let mass = 0.01;
    let shortest = Paper::sealed().thread_length / 3.0_f64.sqrt();
    // Its static force is zero at b/√3, so that friction alone holds it there.
    let paper = Paper::sealed().gauge(60.0 * PSI).mass(mass).from(shortest, 0.0);
    let sample = run_of(&paper.rig(), &paper, 0.1, 1e-8).sample(0.05);
    assert_eq!(sample.mechanisms[0].rate[0], 0.0);
    assert_close(sample.actuators[0].tension, mass * GRAVITY, 1e-12);
}

#[test]
fn samples_at_an_event_have_what_follows() {
    let paper = Paper::driven(Command::pwm(10.0, 0.5, Request::Fill, Request::Exhaust).expect("a command"));
    let run = run_of(&paper.rig(), &paper, 0.3, 1e-8);
    // The poppet opens 4 ms after the coil is energised, and closes 1 ms after it is released.
    // While it fills, the source gives what the muscle gets; else the atmosphere takes it.
    for time in [0.02, 0.07] {
        let sample = run.sample(time);
        let flow = sample.actuators[0].mass_flow;
        let boundary: f64 = sample.nodes.iter().map(|node| node.mass_flow).filter(|own| *own != flow).sum();
        assert!((time < 0.05) == (flow > 0.0) && boundary == -flow, "{time}: {flow} {boundary}");
    }
    for (time, supply) in [(0.104, true), (0.151, false), (0.204, true)] {
        let ports = |time: f64| run.sample(time).valves[0].ports;
        assert_eq!((ports(time).supply, ports(time - 1e-9).supply), (supply, !supply), "{time}");
        let shares = run.sample(time).valves[0].openings;
        let [own, other] = [shares[Port::Supply as usize], shares[Port::Exhaust as usize]];
        assert_eq!([own, other], if supply { [1.0, 0.0] } else { [0.0, 1.0] });
    }
}

#[test]
fn samples_in_order_are_samples_one_by_one() {
    let paper = Paper::pwm(25.0, 0.5);
    let run = run_of(&paper.rig(), &paper, 0.1, 1e-6);
    let mut backwards = PlantReader::new(&run);
    let samples: Vec<PlantSample> = run.samples(0.003).collect();
    assert_eq!(samples.len(), 35);
    assert_eq!(samples.last().expect("a sample").time, 0.1);
    for sample in samples.iter().rev() {
        assert_eq!(*sample, run.sample(sample.time));
        assert_eq!(*sample, backwards.read(sample.time));
    }
    assert_eq!(run.sample(-1.0), samples[0]);
    assert_eq!(run.sample(9.0), samples[34]);
}

/// Derivatives of what a sample has, against finite differences: of a muscle that moves, and of one that sticks.
#[test]
fn samples_carry_derivatives() {
    let paper = Paper::driven(Command::Constant(Request::Fill)).mass(8.0);
    let row = &parameter::SUPPLY_GAUGE_PRESSURE;
    let read = |sample: &PlantSample| {
        let of = &sample.actuators[0];
        [of.length, of.rate, of.pressure.0, of.tension, of.mass_flow, of.volume, of.heat_flow]
    };
    let rig = paper.rig();
    let run = |rig: &Rig| {
        let start = rig.start(&paper.initial()).expect("a start");
        let plant = Plant::of_rig(rig);
        simulate_plant(&plant, &Plant::start_of_rig(rig, &start), 0.08, 1e-12).expect("a run")
    };
    let plant: Plant<mckibben::Seeded> = Plant::of_rig(&rig).map(|_, parameter, value| {
        let factor = if std::ptr::eq(parameter, row) { Dual::variable(1.0, 0) } else { Dual::constant(1.0) };
        Dual::constant(value) * factor
    });
    let own = Plant::start_of_rig(&rig, &rig.start(&paper.initial()).expect("a start"));
    let constant = mckibben::Seeded::constant;
    let start = PlantStart {
        positions: vec![own.positions[0].iter().map(|x| constant(*x)).collect()],
        rates: vec![own.rates[0].iter().map(|x| constant(*x)).collect()],
        air: vec![InitialAir {
            gauge_pressure: GaugePressure(constant(own.air[0].gauge_pressure.0)),
            temperature: constant(own.air[0].temperature),
        }],
        lengths: vec![None],
        friction: vec![],
    };
    let dual = simulate_plant(&plant, &start, constant(0.08), 1e-12).expect("a run");
    let at = dual.sample(constant(0.05));
    let of = &at.actuators[0];
    let slopes = [of.length, of.rate, of.pressure.0, of.tension, of.mass_flow, of.volume, of.heat_flow]
        .map(|number| number.slope[0]);
    let step = 1e-4;
    let [more, less] = [step, -step].map(|part| read(&run(&scaled(&rig, row, part)).sample(0.05)));
    for (k, slope) in slopes.into_iter().enumerate() {
        let difference = (more[k] - less[k]) / (2.0 * step);
        assert_within(slope, difference, 1e-4 * difference.abs().max(1e-12));
        assert!(slope != 0.0 && at.time.value() == 0.05, "{k}: {slopes:?} {more:?} {less:?}");
    }
}
