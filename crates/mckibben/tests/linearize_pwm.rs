//! The averaged valve against closed forms, against itself, and against the mean of simulated cycles.

use crate::common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::linearize::{Aim, Balance, Content, Linearization, linearize_driven};
use mckibben::simulation::{Actuation, Rig};
use mckibben::valve::{Command, Ramp, Request, Solenoid, ValveKind};

const PROCESSES: [Process; 4] = [
    Process::Isentropic,
    Process::Isothermal,
    Process::Polytropic { index: 1.2 },
    Process::EnergyBalance { heat_transfer: 0.5, wall_temperature: 300.0 },
];

fn mean(paper: &Paper, duty: f64) -> Linearization {
    linearize_driven(&paper.rig(), Aim::Duty(duty), Content::Of(paper.start())).expect("a balance of flows")
}

#[test]
fn the_share_is_the_duty_less_the_delays() {
    for (frequency, share) in [(25.0, 0.425), (50.0, 0.35)] {
        let linear = mean(&Paper::pwm(frequency, 0.5), 0.5);
        let averaged = linear.averaged().unwrap();
        assert_close(averaged.supply_share(), share, 1e-12);
        assert_close(averaged.duty_range.0, 4e-3 * frequency, 1e-14);
        assert_close(averaged.duty_range.1, 1.0 - 1e-3 * frequency, 1e-14);
        assert!(averaged.follows());
        let total: f64 = averaged.intervals.iter().map(|interval| interval.share).sum();
        assert_close(total, 1.0, 1e-12);
        assert_close(averaged.flow.inward, averaged.flow.outward, 1e-9);
    }
    // Below the range no pulse opens the valve, above it no gap shuts it: nothing answers to the duty.
    for (duty, share, gauge) in [(0.09, 0.0, 0.0), (0.98, 1.0, 100.0 * PSI)] {
        let linear = mean(&Paper::pwm(25.0, 0.5), duty);
        let averaged = linear.averaged().unwrap();
        assert!(!averaged.follows());
        assert_within(averaged.supply_share(), share, 1e-15);
        assert_within(linear.point.gauge_pressure().0, gauge, 1e-6);
        let column = linear.system.input("duty").unwrap();
        assert!(linear.system.b.iter().all(|row| row[column] == 0.0));
    }
}

/// The opening over a pulse is a trapezoid. The air beyond the mean flow, which swings the pressure by γ P/m, is its area above the
/// actual duty cycle.
#[test]
fn the_ripple_under_strokes_is_the_area_of_their_trapezoid() {
    let (frequency, duty, [rise, fall]) = (100.0, 0.5, [4e-3, 3e-3]);
    let paper = Paper::pwm(frequency, duty).isometric(3.5 * INCH);
    let solenoid = Solenoid::new(ValveKind::ThreeWay, 1e-3, 1e-3).expect("a solenoid");
    let solenoid = solenoid.with_ramp(Ramp::new(rise, fall).expect("a ramp"));
    let command = paper.command.clone().expect("pulses");
    let rig = Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig");
    let aim = Aim::DutyAtLength(duty, 3.5 * INCH);
    let linear = linearize_driven(&rig, aim, Content::Of(paper.start())).expect("a balance of flows");
    let averaged = linear.averaged().expect("pulses");
    let share = duty - 0.5 * (rise - fall) * frequency;
    assert_close(averaged.supply_share(), share, 1e-11);
    let open = duty / frequency - rise;
    let area = (1.0 - share) * (open + 0.5 * (1.0 - share) * (rise + fall));
    let flows = averaged.flow.inward / share + averaged.flow.outward / (1.0 - share);
    let state = linear.point.state;
    assert_close(averaged.pressure_ripple, 1.4 * state.pressure.0 / state.air_mass * flows * area, 1e-7);
    // By harmonics through the model, whose pressure follows the flow but for what the valve loses within a period.
    #[cfg(feature = "analysis")]
    assert_close(linear.ripple("pressure").expect("an output"), averaged.pressure_ripple, 0.02);
}

#[test]
fn choked_both_ways_the_pressure_is_the_share_of_the_supplys() {
    // Isothermal and choked on both sides: s G P_s/√T = (1 − s) G P/√T.
    let paper = Paper::pwm(25.0, 0.5).process(Process::Isothermal).with(|rig| rig.supply_gauge = 200.0 * PSI);
    let supply = 200.0 * PSI + ATMOSPHERE;
    for duty in [0.25, 0.3, 0.35] {
        let share = duty - 0.075;
        let linear = mean(&paper, duty);
        assert_close(linear.point.state.pressure.0, supply * share / (1.0 - share), 1e-12);
        assert_close(linear.point.temperature(), ROOM, 1e-12);
        // dP/dd of the balance, 1/(1 − s)², is what the matrices say of a slow change: −A⁻¹ B at an equilibrium of forces.
        let system = linear.minimal();
        let pressure = 2;
        let by_pressure = system.a[pressure][pressure];
        let by_duty = system.b[pressure][system.input("duty").unwrap()];
        assert_close(-by_duty / by_pressure, supply / ((1.0 - share) * (1.0 - share)), 1e-10);
    }
}

/// How the balance of flows moves with the duty, by differences; and by the matrices with the ends held.
fn gain(paper: &Paper, duty: f64) -> (f64, f64) {
    let at = |duty: f64| {
        linearize_driven(&paper.rig(), Aim::DutyAtLength(duty, 3.5 * INCH), Content::Of(paper.start()))
            .expect("a balance")
    };
    let system = at(duty).minimal();
    let (a, b) = (&system.a, &system.b);
    let by_matrices = match a.len() {
        1 => -b[0][0] / a[0][0],
        _ => -(a[1][1] * b[0][0] - a[0][1] * b[1][0]) / (a[0][0] * a[1][1] - a[0][1] * a[1][0]),
    };
    (slope(1e-4, |h| at(duty + h).point.state.pressure.0), by_matrices)
}

#[test]
fn a_slow_change_of_duty_moves_the_pressure_as_the_balance_does() {
    for process in PROCESSES {
        let paper = Paper::pwm(50.0, 0.5).process(process).isometric(3.5 * INCH);
        for duty in [0.25, 0.5, 0.8] {
            let (by_balance, by_matrices) = gain(&paper, duty);
            assert_close(by_matrices, by_balance, 1e-6);
        }
    }
}

#[test]
fn the_duty_for_a_pressure_gives_that_pressure() {
    for process in PROCESSES {
        let paper = Paper::pwm(25.0, 0.5).process(process);
        let (rig, content) = (paper.rig(), Content::Of(paper.start()));
        let gauge = GaugePressure(50.0 * PSI);
        let held = linearize_driven(&rig, Aim::Balance(Balance::AtPressure(gauge)), content).unwrap();
        let duty = held.averaged().unwrap().duty;
        let back = linearize_driven(&rig, Aim::Duty(duty), content).unwrap();
        assert_close(back.point.gauge_pressure().0, gauge.0, 1e-9);
        assert_close(back.point.temperature(), held.point.temperature(), 1e-9);
    }
}

/// What is looked for is a duty, so it does not depend on the command's own, even where no pulse of that moves a poppet.
#[test]
fn the_duty_for_a_pressure_does_not_depend_on_the_commands_own() {
    let gauge = GaugePressure(50.0 * PSI);
    for kind in [ValveKind::ThreeWay, ValveKind::ThreeWayNormallyOpen, ValveKind::FillHoldExhaust] {
        let mut duties = Vec::new();
        for own in [0.5, 0.0, 0.02, 0.95, 0.99, 1.0] {
            let paper = Paper::pwm(25.0, own).with(|rig| rig.kind = kind);
            let (rig, content) = (paper.rig(), Content::Of(paper.start()));
            let held = linearize_driven(&rig, Aim::Balance(Balance::AtPressure(gauge)), content).expect("a duty");
            let averaged = held.averaged().expect("pulses");
            assert!(averaged.follows(), "{kind:?} from {own}: {}", averaged.duty);
            let back = linearize_driven(&rig, Aim::Duty(averaged.duty), content).expect("a balance");
            assert_close(back.point.gauge_pressure().0, gauge.0, 1e-8);
            duties.push(averaged.duty);
        }
        duties.iter().for_each(|duty| assert_within(*duty, duties[0], 1e-9));
    }
}

#[test]
fn two_seats_that_overlap_or_leave_the_air_alone_are_averaged_too() {
    let with = |rest, opening: f64| {
        Paper::driven(Command::pwm(40.0, 0.5, Request::Fill, rest).unwrap())
            .with(|rig| (rig.kind, rig.delays) = (ValveKind::FillHoldExhaust, (opening, 3e-3)))
    };
    // Each poppet opens 2 ms late and shuts 3 ms late: for 1 ms both are open, twice in a period.
    let linear = mean(&with(Request::Exhaust, 2e-3), 0.5);
    let averaged = linear.averaged().unwrap();
    let both: f64 = averaged.intervals.iter().filter(|i| i.ports.supply && i.ports.exhaust).map(|i| i.share).sum();
    assert_close(both, 0.08, 1e-10);
    assert_close(averaged.duty_range.0, 0.12, 1e-12);
    assert_close(averaged.duty_range.1, 0.88, 1e-12);
    // Fill and hold: air comes until there is no difference of pressure left.
    let linear = mean(&with(Request::Hold, 2e-3), 0.5);
    assert_close(linear.point.gauge_pressure().0, 100.0 * PSI, 1e-9);
}

/// Mean pressure, length and tension over whole cycles of a simulation after it has settled.
fn cycle_mean(paper: &Paper, frequency: f64, settle: f64, cycles: usize) -> [f64; 3] {
    let until = (settle * frequency).ceil() / frequency;
    let end = until + cycles as f64 / frequency;
    let run = paper.run(end, 1e-9);
    let count = 200 * cycles;
    let mut sum = [0.0; 3];
    for n in 0..count {
        let sample = run.at(until + (end - until) * (n as f64 + 0.5) / count as f64);
        for (sum, value) in sum.iter_mut().zip([sample.pressure.0, sample.length, sample.tension]) {
            *sum += value / count as f64;
        }
    }
    sum
}

/// The promise: as long as the poppets follow and the ripple is small, so much of the ripple lies between the means.
const PART_OF_RIPPLE: f64 = 0.1;

/// How far the balance lies from the mean of simulated cycles, as a part of the ripple; whether that was promised.
fn part_of_ripple(paper: &Paper, linear: &Linearization, frequency: f64) -> (f64, bool) {
    let averaged = linear.averaged().unwrap();
    let [pressure, _, tension] = cycle_mean(paper, frequency, 3.0, 8);
    let part = (pressure - linear.point.state.pressure.0).abs() / averaged.pressure_ripple;
    let promised = averaged.follows() && averaged.ripple_is_small();
    if promised && linear.point.rig.load().inertia().is_some() {
        // On average nothing accelerates.
        assert_close(tension, linear.point.tension(), 2e-3);
    }
    (part, promised)
}

#[test]
fn simulated_cycles_have_the_mean_of_the_averaged_model_over_its_range() {
    // A quick valve: at 400 Hz its delays leave duties from 0.16 to 0.92.
    let mut promised = 0;
    for (frequency, process) in [(400.0, PROCESSES[0]), (400.0, PROCESSES[3]), (1200.0, PROCESSES[1])] {
        for duty in [0.2, 0.35, 0.5, 0.7, 0.9] {
            let delays = (0.16 / frequency, 0.08 / frequency);
            let paper = Paper::pwm(frequency, duty).with(|rig| rig.delays = delays).process(process);
            let paper = paper.isometric(3.5 * INCH);
            let content = Content::Of(paper.start());
            let linear = linearize_driven(&paper.rig(), Aim::DutyAtLength(duty, 3.5 * INCH), content).unwrap();
            let (part, claimed) = part_of_ripple(&paper, &linear, frequency);
            println!("{frequency} Hz, d = {duty}: {part:.4} of the ripple, promised {claimed}");
            assert!(!claimed || part < PART_OF_RIPPLE, "{part}");
            promised += usize::from(claimed);
        }
    }
    assert!(promised >= 12, "{promised}");
}

#[test]
fn the_papers_valve_with_its_load_is_followed_where_that_is_promised() {
    let mut promised = Vec::new();
    for (frequency, duty) in [(25.0, 0.2), (25.0, 0.5), (50.0, 0.3), (50.0, 0.45), (50.0, 0.6), (100.0, 0.6)] {
        let paper = Paper::pwm(frequency, duty).friction(20.0, 0.0);
        let linear = mean(&paper, duty);
        let (part, claimed) = part_of_ripple(&paper, &linear, frequency);
        println!("{frequency} Hz, d = {duty}: {part:.4} of the ripple, promised {claimed}");
        assert!(!claimed || part < PART_OF_RIPPLE, "{part}");
        promised.push(claimed);
    }
    assert!(promised.contains(&true) && promised.contains(&false), "{promised:?}");
}

#[test]
fn what_cannot_be_averaged_is_refused_with_a_remedy() {
    let no = |rig: &Rig, aim, content| match linearize_driven(rig, aim, content) {
        Err(error) => error.to_string(),
        Ok(linear) => panic!("{:?}", linear.point),
    };
    let paper = Paper::pwm(25.0, 0.5);
    let content = Content::Temperature(ROOM);
    assert!(no(&Paper::sealed().rig(), Aim::Duty(0.5), content).contains("no PWM"));
    let filled = Paper::driven(Command::Constant(Request::Fill)).rig();
    assert!(no(&filled, Aim::Duty(0.5), content).contains("no PWM"));
    assert!(no(&paper.rig(), Aim::Duty(1.5), content).contains("command.duty"));
    let too_high = Balance::AtPressure(GaugePressure(150.0 * PSI));
    assert!(no(&paper.rig(), Aim::Balance(too_high), content).contains("no duty"));
    let isometric = paper.clone().isometric(3.5 * INCH);
    assert!(no(&isometric.rig(), Aim::Duty(0.5), content).contains("isometric"));
    let warm = paper.clone().process(PROCESSES[3]);
    assert!(no(&warm.rig(), Aim::Duty(0.5), content).contains("temperature follows"));
    let slow = Command::pwm(40.0, 0.05, Request::Fill, Request::Hold).unwrap();
    let slow = Paper::driven(slow).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    assert!(no(&slow.rig(), Aim::Duty(0.05), content).contains("never opens"));
}
