//! scratch
use mckibben::air::{Air, Process};
use mckibben::force::*;
use mckibben::friction::Friction;
use mckibben::load::Load;
use mckibben::simulation::*;
use mckibben::valve::*;
use mckibben::*;
const IN: f64 = 0.0254;
const LBF: f64 = 4.4482216152605;
const PSI: f64 = LBF / (IN * IN);
fn rig(duty: f64, f: f64, lb: f64, sealed: bool, q: f64) -> Rig {
    let braid = Braid::new(4.3218 * IN, 2.5).unwrap();
    let limits = LengthLimits::new(&braid, Some(2.4952 * IN), 3.85 * IN, 1.75e5, 100.0).unwrap();
    let air = Air::standard(Process::Isentropic).unwrap();
    let law = Effective { law: IdealBraid { braid }, effectiveness: Effectiveness::constant(1.0).unwrap() };
    let friction = Friction::new(0.02 * LBF / IN, q * IN).unwrap();
    let a = Actuator::new(law, limits, friction, 3e-6, air).unwrap();
    let load = Load::hanging_mass(lb * 0.45359237, 9.80665).unwrap();
    if sealed {
        return Rig::new(a, None, load).unwrap();
    }
    let law = FlowLaw::new(FlowStandard::Orifice { flow_area: 1.8e-5 * 0.3048 * 0.3048 }, 0.85, 0.999, &air).unwrap();
    let supply = Supply::new(GaugePressure(100.0 * PSI), 293.15, &air).unwrap();
    let a = a.with_valve(Valve::new(law, supply, ExhaustTemperature::Actuator, &air));
    let act = Actuation {
        solenoid: Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).unwrap(),
        command: Command::pwm(f, duty, Request::Fill, Request::Exhaust).unwrap(),
    };
    Rig::new(a, Some(act), load).unwrap()
}
fn main() {
    let rtol: f64 = std::env::args().nth(1).map_or(1e-8, |s| s.parse().unwrap());
    let r = rig(0.5, 25.0, 5.0, false, 0.0044);
    let init = Initial {
        gauge_pressure: GaugePressure(0.0),
        temperature: 293.15,
        length: InitialLength::Equilibrium,
        velocity: 0.0,
    };
    let s = r.start(&init).unwrap();
    println!("{s:?}");
    let t = simulate(&r, s, 2.0, rtol).unwrap();
    println!("{:?}", t.counts());
    let reference = simulate(&r, s, 2.0, 1e-12).unwrap();
    let mut err = [0.0f64; 4];
    for (a, b) in t.samples(1e-3).zip(reference.samples(1e-3)) {
        err[0] = err[0].max((a.length - b.length).abs());
        err[1] = err[1].max((a.velocity - b.velocity).abs());
        err[2] = err[2].max((a.pressure.0 - b.pressure.0).abs());
        err[3] = err[3].max((a.air_mass - b.air_mass).abs());
    }
    println!("err {err:?} {:?}", reference.counts());
    let mut best = f64::INFINITY;
    for _ in 0..50 {
        let t0 = std::time::Instant::now();
        let t = simulate(&r, s, 2.0, rtol).unwrap();
        std::hint::black_box(&t);
        best = best.min(t0.elapsed().as_secs_f64());
    }
    println!("{:.1} us per simulated second", best * 1e6 / 2.0);
    let mut k = std::collections::BTreeMap::new();
    for e in t.events() {
        *k.entry(e.kind).or_insert(0) += 1;
    }
    println!("{k:?}");
    for e in t.events().iter().take(20) {
        println!(
            "{:.6} {:?} {:?} {:?} {:?} {:?}",
            e.time,
            e.kind,
            e.after.ports.name(),
            e.after.supply_zone.or(e.after.exhaust_zone),
            e.after.extent,
            e.after.sliding
        );
    }
    for x in t.samples(0.1) {
        println!(
            "{:.2} {:.5} {:.4} {:.0} {:.3e} {:.1} {:.2} {:.2e} {}",
            x.time,
            x.length,
            x.velocity,
            x.pressure.0,
            x.air_mass,
            x.temperature,
            x.tension,
            x.mass_flow,
            x.ports.name()
        );
    }
    // sealed ring-down
    let r = rig(0.5, 25.0, 6.0, true, 0.0044);
    let init = Initial {
        gauge_pressure: GaugePressure(60.0 * PSI),
        temperature: 293.15,
        length: InitialLength::Equilibrium,
        velocity: 0.3,
    };
    let s = r.start(&init).unwrap();
    let t = simulate(&r, s, 3.0, rtol).unwrap();
    println!("{:?}", t.counts());
    for e in t.events() {
        println!("{:.6} {:?} {:?} {:?}", e.time, e.kind, e.after.extent, e.after.sliding);
    }
}
