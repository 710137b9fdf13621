//! Runs of plants go on: they neither crawl nor stop where nothing is wrong, and what cannot be run is refused with its reason.

use crate::common::Paper;
use mckibben::plant::{Plant, PlantRun};

/// What a run may take without progress counts from where it was, not from where it was taken up again.
#[test]
fn a_run_in_many_short_steps_does_not_crawl() {
    let paper = Paper::sealed();
    let rig = paper.rig();
    let plant = Plant::of_rig(&rig).expect("a plant");
    let start = Plant::start_of_rig(&rig, &paper.start());
    let mut run = PlantRun::new(&plant, &start, 1e-6).expect("a run");
    for count in 1..=100_500_u32 {
        run.advance_to(f64::from(count) * 1e-6).expect("it goes on");
    }
    let counts = run.statistics();
    assert!(counts.explicit_steps + counts.implicit_steps > 100_000, "{counts:?}");
    run.advance_to(0.1105).expect("it goes on");
}
