//! Cost.
#[path = "../tests/common/mod.rs"]
mod common;
use common::*;
use mckibben::line::*;
use mckibben::simulation::*;
use std::time::Instant;
fn main() {
    let paper = Paper::pwm(25.0, 0.5);
    for (l, d) in [(1.0, 2.5e-3), (1.0, 4e-3), (0.3, 2.5e-3), (3.0, 2.5e-3)] {
        let h = Hose::new(HoseKind::Lumped, [l, d], [1.82e-5, ROOM, 1.0], &paper.air()).unwrap();
        let line = Line { hose: Some(h), ..Line::NONE };
        let hosed = paper.rig().with_line(line).unwrap();
        let plain = paper.rig();
        let time = |rig: &Rig, tol: f64| {
            let mut best = f64::INFINITY;
            let mut counts = Counts::default();
            for _ in 0..30 {
                let t = Instant::now();
                counts = simulate(rig, paper.start(), 2.0, tol).unwrap().counts();
                best = best.min(t.elapsed().as_secs_f64());
            }
            (best * 1e3, counts)
        };
        for tol in [1e-6, 1e-8, 1e-10] {
            let (a, ca) = time(&plain, tol);
            let (b, cb) = time(&hosed, tol);
            println!(
                "{l} {d} tol {tol:e} plain {a:.3} ms {} hosed {b:.3} ms {} {:?} ratio {:.2}",
                ca.evaluations,
                cb.evaluations,
                cb,
                b / a
            );
        }
        for method in [Method::Stable, Method::Rk4] {
            let step = |rig: &Rig| {
                let mut best = f64::INFINITY;
                for _ in 0..10 {
                    let t = Instant::now();
                    let mut s = FixedStepper::new(rig, paper.start(), method);
                    for i in 1..=20000 {
                        s.advance_to(i as f64 * 1e-4).unwrap();
                    }
                    best = best.min(t.elapsed().as_secs_f64());
                }
                best / 20000.0 * 1e9
            };
            let (a, b) = (step(&plain), step(&hosed));
            println!("  {method:?} plain {a:.0} ns hosed {b:.0} ns ratio {:.2}", b / a);
        }
    }
}
