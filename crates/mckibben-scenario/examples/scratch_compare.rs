//! scratch
use mckibben_scenario::Document;
fn main() {
    let mut worst: f64 = 0.0;
    let rtol: f64 = std::env::args().nth(1).map_or(1e-10, |s| s.parse().unwrap());
    let only = std::env::args().nth(2);
    let mut names: Vec<_> = std::fs::read_dir("/tmp/refcsv").unwrap().map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "csv")).collect();
    names.sort();
    for path in names {
        let name = path.file_stem().unwrap().to_str().unwrap().to_string();
        if only.as_ref().is_some_and(|o| *o != name) { continue; }
        let document = Document::load(format!("validation/reference/{name}.toml")).unwrap();
        let e = match document.experiment() { Ok(e) => e, Err(d) => { println!("{name}: {d}"); continue; } };
        let t0 = std::time::Instant::now();
        let t = match mckibben::simulation::simulate(&e.rig, e.start, e.run.duration, rtol) { Ok(t) => t, Err(d) => { println!("{name}: {d}"); continue; } };
        let dt = t0.elapsed().as_secs_f64();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|l| l.split(',').collect()).collect();
        let ours: Vec<_> = t.samples(e.run.sample_interval).collect();
        if rows.len() != ours.len() { println!("{name}: {} rows, ours {}", rows.len(), ours.len()); }
        let mut errs = vec![]; let mut valve = 0;
        for c in 1..9 {
            let (mut lo, mut hi, mut err, mut at) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64, 0.0);
            for (r, s) in rows.iter().zip(&ours) {
                let x: f64 = r[c].parse().unwrap();
                let y = [s.time, s.length, s.velocity, s.pressure.0, s.air_mass, s.temperature, s.volume, s.tension, s.mass_flow][c];
                lo = lo.min(x); hi = hi.max(x); if (x - y).abs() > err { err = (x - y).abs(); at = s.time; }
                if c == 1 && r[9] != s.ports.name() { valve += 1; }
            }
            errs.push((err / (hi - lo).max(1e-12 * hi.abs().max(1e-300)), at));
        }
        let w = errs.iter().fold(0.0f64, |a, b| a.max(b.0)); worst = worst.max(w);
        let a = t.audit();
        println!("{name:28} max {w:.1e} valve {valve} [{}] {:?} {:.0} us/s energy {:.1e} air {:.1e}", errs.iter().map(|e| format!("{:.0e}@{:.3}", e.0, e.1)).collect::<Vec<_>>().join(" "), t.counts(), dt * 1e6 / e.run.duration, a.residual() / a.turnover(), a.air_residual() / a.air_in.max(a.air_out).max(1e-9));
    }
    println!("worst {worst:.2e}");
}
