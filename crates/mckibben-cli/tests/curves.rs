//! `mckibben curves`: what it prints, writes and refuses.

use crate::common::{Folder, of_repository};

fn text(output: std::process::Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_table_is_the_law() {
    let folder = Folder::new("curves");
    let file = of_repository("examples/paper/fig-08.toml");
    let mut command = folder.mckibben();
    let printed = text(
        command.arg("curves").arg(file).args(["--gauge-pressures", "60psi", "--output", "c.csv"]).output().unwrap(),
    );
    assert!(printed.contains("60 psi") && printed.contains("valve shut, (6) leaves out"), "{printed}");
    // (3), (7) and the sealed stiffness of (5), written out.
    let (b, n, atmosphere): (f64, f64, f64) = (4.3218 * 0.0254, 2.5, 101_325.0);
    let gauge = 60.0 * 4.448_221_615_260_5 / 0.0254_f64.powi(2);
    let factor = 1.0 / (4.0 * std::f64::consts::PI * n * n);
    let csv = std::fs::read_to_string(folder.path("c.csv")).unwrap();
    let mut rows = 0;
    for line in csv.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let length = row[1];
        let slope = (b * b - 3.0 * length * length) * factor;
        let volume = length * (b * b - length * length) * factor;
        let constant = 6.0 * gauge * length * factor;
        let sealed = constant + 1.4 * (gauge + atmosphere) * slope * slope / (volume + 3e-6);
        for (value, exact) in [
            (row[0], gauge),
            (row[2], 1.0 - length / (3.85 * 0.0254)),
            (row[4], volume),
            (row[5], volume + 3e-6),
            (row[6], -gauge * slope),
            (row[7], constant),
            (row[8], sealed),
        ] {
            assert!((value - exact).abs() <= 1e-9 * exact.abs() + 1e-12, "{line}: {value} is not {exact}");
        }
        rows += 1;
    }
    assert_eq!(rows, 121);
}

#[test]
fn figures_are_drawn_over_length_and_contraction() {
    let folder = Folder::new("curves-plot");
    let file = of_repository("examples/fill-hold-exhaust.toml");
    for (name, over) in [("a.svg", "length"), ("b.png", "contraction")] {
        let mut command = folder.mckibben();
        text(command.arg("curves").arg(&file).args(["--plot", name, "--over", over]).output().unwrap());
    }
    assert!(std::fs::read_to_string(folder.path("a.svg")).unwrap().contains("length (mm)"));
    assert!(std::fs::read(folder.path("b.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(folder.names(), ["a.svg", "b.png"]);
}

#[test]
fn every_kind_of_load_has_an_operating_point() {
    let folder = Folder::new("curves-loads");
    for (file, word) in [
        ("isometric-charge.toml", "at the length that is held"),
        ("paper/fig-03.toml", "in the middle of the range"),
        ("paper/fig-13.toml", "where the load balances"),
    ] {
        let file = of_repository("examples").join(file);
        let printed = text(folder.mckibben().arg("curves").arg(file).output().unwrap());
        assert!(printed.contains(word), "{printed}");
    }
}

#[test]
fn what_is_wrong_is_refused_before_anything_is_written() {
    let folder = Folder::new("curves-bad");
    let file = of_repository("examples/paper/fig-08.toml");
    for (arguments, words) in [
        (["--gauge-pressures", "35"], "pressure"),
        (["--gauge-pressures", "-20psi"], "vacuum"),
        (["--output", "c.txt"], ".csv"),
        (["--plot", "c.jpg"], ".svg"),
        (["--set", "actuator.turns=-1"], "actuator.turns"),
    ] {
        let output = folder.mckibben().arg("curves").arg(&file).args([&arguments.join("=")]).output().unwrap();
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
        assert!(printed.contains(words), "{arguments:?}: {printed}");
    }
    assert!(folder.names().is_empty());
}
