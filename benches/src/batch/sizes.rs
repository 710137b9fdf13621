//! What a step costs in batches of different sizes, on one thread and on two.

use crate::ours::Engine;
use crate::work::{STEPS, Work};
use std::time::Instant;

const SIZES: [usize; 7] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000];
/// Actuator-steps in one call, as far as the limits on its steps allow.
const CALL: u64 = 10_000_000;
/// The fewest steps of a call, which get past the first opening of the valve.
const FEWEST_STEPS: u64 = 100;
/// Calls of which the shortest counts.
const REPEATS: u32 = 5;

/// Prints the table.
///
/// # Errors
/// When a run fails.
pub fn print(work: &Work) -> Result<(), String> {
    let engine = Engine::usual();
    println!("ns/actuator-step of {engine} by the size of the batch");
    println!(
        "{:>9} {:>7} {:>11} {:>12} {:>9} {:>18}",
        "rows", "steps", "one thread", "two threads", "speed-up", "to make a row, us"
    );
    for size in SIZES {
        let start = Instant::now();
        let rows = work.rows(size)?;
        let making = start.elapsed().as_secs_f64() * 1e6 / size as f64;
        let steps = (CALL / size as u64).clamp(FEWEST_STEPS, STEPS);
        let steps_in_all = size as f64 * steps as f64;
        let repeats = if steps_in_all > 2.0 * CALL as f64 { 1 } else { REPEATS };
        let mut cost = [f64::INFINITY; 2];
        for (shortest, threads) in cost.iter_mut().zip([1, 2]) {
            for _ in 0..repeats {
                *shortest = shortest.min(engine.run(rows.clone(), steps, threads)?.seconds * 1e9 / steps_in_all);
            }
        }
        let [one, two] = cost;
        println!("{size:>9} {steps:>7} {one:>11.1} {two:>12.1} {:>9.2} {making:>18.1}", one / two);
    }
    Ok(())
}
