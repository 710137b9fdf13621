//! `mckibben reproduce`: the report is complete, needs nothing else, is the same every time, and says what was
//! computed.

use crate::common::{Folder, of_repository};
use std::collections::BTreeMap;

/// Writes the report to a new folder; returns what was printed.
fn reproduced(folder: &Folder, name: &str) -> String {
    let output = folder.mckibben().args(["reproduce", "--output", name]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn files(folder: &Folder, name: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder.path(name)).unwrap().map(|entry| entry.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap())).collect()
}

/// Findings by name.
fn numbers(csv: &[u8]) -> BTreeMap<String, (f64, String)> {
    let mut reader = csv::Reader::from_reader(csv);
    let rows = reader.records().map(|row| row.unwrap());
    rows.map(|row| (row[1].to_owned(), (row[2].parse().unwrap(), row[5].to_owned()))).collect()
}

#[test]
fn the_report_is_complete_and_reproducible() {
    let folder = Folder::new("reproduce");
    let printed = reproduced(&folder, "a");
    assert!(printed.contains("a/index.html") && printed.contains("42.5 %"), "{printed}");
    let a = files(&folder, "a");
    let page = String::from_utf8(a["index.html"].clone()).unwrap();

    // Complete: every figure in three formats, inline in the page, and every file of the folder given in full.
    let stems: Vec<&str> = a.keys().filter_map(|name| name.strip_suffix(".svg")).collect();
    assert!(stems.len() >= 12, "{stems:?}");
    assert_eq!(page.matches("<svg ").count(), stems.len());
    for stem in &stems {
        assert!(a[&format!("{stem}.png")].starts_with(b"\x89PNG") && a[&format!("{stem}.csv")].len() > 100, "{stem}");
        assert!(page.contains(&format!("href=\"{stem}.csv\"")));
    }
    for entry in std::fs::read_dir(of_repository("examples/paper")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(page.contains(&format!("<code>{name}</code>")), "{name}");
    }

    // Self-contained: nothing is loaded; the only addresses are names of the SVG's language.
    for mark in ["src=", "<link", "<script", "url(", "@import", "https:"] {
        assert!(!page.contains(mark), "{mark}");
    }
    let others = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!others.contains("http:"));
    let targets = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next());
    for target in targets {
        match target.strip_prefix('#') {
            Some(id) => assert!(page.contains(&format!("id=\"{id}\"")), "{id}"),
            None => assert!(a.contains_key(target), "{target}"),
        }
    }

    // What is assumed is labelled wherever a figure rests on it.
    for (name, svg) in a.iter().filter(|(name, _)| name.ends_with(".svg") && name.as_str() != "fig-10.svg") {
        assert!(String::from_utf8_lossy(svg).contains("Assumed"), "{name}");
    }

    // The same every time, also over an older report.
    std::fs::write(folder.path("a").join("index.html"), "old").unwrap();
    reproduced(&folder, "a");
    assert!(files(&folder, "a") == a, "the second report differs");
}

#[test]
fn the_numbers_are_those_of_the_text_and_of_closed_forms() {
    let folder = Folder::new("reproduce-numbers");
    reproduced(&folder, "r");
    let found = numbers(&files(&folder, "r")["numbers.csv"]);
    let check = |name: &str, exact: f64, tolerance: f64, verdict: &str| {
        let (value, printed) = found.get(name).unwrap_or_else(|| panic!("{name} is not in {:?}", found.keys()));
        assert!((value - exact).abs() <= tolerance, "{name}: {value} is not {exact}");
        assert_eq!(printed, verdict, "{name}");
    };
    // d − (t_open − t_close) f, and the dead ends.
    check("Actual duty at 50 %, 25 Hz", 42.5, 1e-9, "agrees");
    check("Actual duty at 50 %, 50 Hz", 35.0, 1e-9, "agrees");
    check("Least duty that opens the valve, 25 Hz", 10.0, 0.1, "agrees");
    check("Least duty that opens the valve, 50 Hz", 20.0, 0.1, "agrees");
    check("Least duty that never closes it, 25 Hz", 97.5, 0.11, "agrees");
    check("Least duty that never closes it, 50 Hz", 95.0, 0.11, "agrees");

    // The nominal pressures at rest.
    check("Fig. 8: pressure at rest", 60.0, 1e-3, "put in");
    check("Fig. 9: pressure at rest", 80.0, 1e-3, "put in");

    // Q k_sec/k_t and the small-amplitude frequency by hand, from b, n and V_ext.
    let (b, n, inch): (f64, f64, f64) = (4.3218 * 0.0254, 2.5, 0.0254);
    let factor = 1.0 / (4.0 * std::f64::consts::PI * n * n);
    let pound = 0.453_592_37;
    for (label, psi, pounds) in [("Fig. 8", 60.0, 6.0), ("Fig. 9", 80.0, 11.0)] {
        let (mass, gauge) = (pounds * pound, psi * pound * 9.80665 / (inch * inch));
        let length = ((mass * 9.80665 / (gauge * factor) + b * b) / 3.0).sqrt();
        let slope = (b * b - 3.0 * length * length) * factor;
        let volume = length * (b * b - length * length) * factor + 3e-6;
        let tangent = 6.0 * gauge * length * factor + 1.4 * (gauge + 101_325.0) * slope * slope / volume;
        let secant = 3.0 * gauge * (length + 2.4952 * inch) * factor;
        let width = 0.0044 * secant / tangent;
        check(&format!("{label}: Q found by the exact form"), width, 0.012 * width, "round trip");
        let frequency = (tangent / mass).sqrt() / std::f64::consts::TAU;
        check(&format!("{label}: frequency"), frequency, 2e-3 * frequency, "not comparable");
    }

    // "of a lower magnitude"
    for figure in ["Fig. 11", "Fig. 12", "Fig. 13"] {
        let (ratio, verdict) = &found[&format!("{figure}: ripple at 50 Hz over that at 25 Hz")];
        assert!(*ratio > 0.0 && *ratio < 0.5 && verdict == "agrees", "{figure}: {ratio}, {verdict}");
    }
}

#[test]
fn the_loop_of_fig_4_is_left_open_by_q() {
    // At zero load friction holds F_s = Q k_sec, and k_sec (L − L_min) = F_s: the length left is Q, at any pressure.
    let folder = Folder::new("reproduce-loop");
    reproduced(&folder, "r");
    let all = files(&folder, "r");
    let mut reader = csv::Reader::from_reader(all["fig-04.csv"].as_slice());
    let rows = reader.records().map(|row| row.unwrap().iter().map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>());
    let unloaded: Vec<Vec<f64>> = rows.filter(|row| row[1] == 0.0).collect();
    assert_eq!(unloaded.len(), 8);
    for pair in unloaded.chunks(2) {
        assert_eq!(pair[0][2], 2.4952 * 0.0254);
        // The preset's L_min is b/√3 rounded to five digits, which leaves a force of 0.2 mN there.
        assert!((pair[1][2] - pair[0][2] - 0.0044 * 0.0254).abs() < 3e-7, "{pair:?}");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_refused() {
    let folder = Folder::new("reproduce-bad");
    let file = folder.file("taken", "");
    let output = folder.mckibben().args(["reproduce", "--output"]).arg(file.join("r")).output().unwrap();
    assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(folder.names(), ["taken"]);
}
