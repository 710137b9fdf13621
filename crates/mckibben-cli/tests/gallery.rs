//! `mckibben gallery`: what it shows of the repository's examples, and what it says of a file that fails.

mod common;

use common::{Folder, of_repository};
use std::path::Path;

/// The scenario files under a folder, as paths below it without their ending; a study is none.
fn stems(folder: &Path, below: &str, stems: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = format!("{below}{}", entry.file_name().into_string().unwrap());
        if entry.path().is_dir() {
            self::stems(&entry.path(), &format!("{name}/"), stems);
        } else if let Some(stem) = name.strip_suffix(".toml").filter(|_| !is_study(&entry.path())) {
            stems.push(stem.to_owned());
        }
    }
}

fn is_study(path: &Path) -> bool {
    std::fs::read_to_string(path).unwrap().contains("\n[study]\n")
}

#[test]
fn every_example_of_the_repository_has_a_figure() {
    let folder = Folder::new("gallery");
    let examples = of_repository("examples");
    let output = folder.mckibben().arg("gallery").arg(&examples).args(["--output", "out"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    let mut names = Vec::new();
    stems(&examples, "", &mut names);
    assert!(names.len() > 30, "{names:?}");
    for name in &names {
        assert!(page.contains(&format!("<img src=\"{name}.svg\"")), "{name} is not on the page");
        assert!(page.contains(&format!("href=\"{name}.toml.txt\"")), "{name} has no text");
        let figure = std::fs::read_to_string(folder.path(&format!("out/{name}.svg"))).unwrap();
        assert!(figure.starts_with("<svg") && figure.contains("<path") && !figure.contains("NaN"), "{name}");
        let text = std::fs::read(folder.path(&format!("out/{name}.toml.txt"))).unwrap();
        assert_eq!(text, std::fs::read(examples.join(format!("{name}.toml"))).unwrap());
    }
    assert_eq!(page.matches("<img ").count(), names.len());
    assert!(names.contains(&"identify/rig".to_owned()) && !names.contains(&"identify/tank".to_owned()), "{names:?}");
    assert!(!page.contains("class=\"failed\"") && !page.contains("<script"));
    for (name, command) in [
        ("linearize-pwm", "linearize"),
        ("laws/wall", "curves"),
        ("sweep-mass-pressure", "sweep"),
        ("antagonistic-joint", "simulate"),
    ] {
        let stem = name.rsplit('/').next().unwrap();
        let path = examples.join(format!("{name}.toml"));
        let whole = format!("mckibben {command} {}</span> <span>--plot {stem}.svg", path.display());
        assert!(page.contains(&whole), "{whole}");
    }
    assert!(page.contains("--over length"), "a prescribed motion is drawn over length");
}

#[test]
fn a_file_that_fails_is_shown_and_told() {
    let folder = Folder::new("gallery-failure");
    std::fs::create_dir_all(folder.path("in/odd ones")).unwrap();
    std::fs::copy(of_repository("examples/isometric-charge.toml"), folder.path("in/good.toml")).unwrap();
    folder.file("in/odd ones/bad.toml", "# Not a <muscle>.\n[load]\nkind = \"none of these\"\n");
    let output = folder.mckibben().args(["gallery", "in", "--output", "out"]).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(page.contains("<img src=\"good.svg\"") && page.contains("1 failed"));
    assert!(page.contains("Not a &lt;muscle&gt;") && page.contains("none of these"), "{page}");
    assert!(page.contains("href=\"odd%20ones/bad.toml.txt\""));
    assert!(String::from_utf8_lossy(&output.stderr).contains("bad.toml"));
    assert_eq!(folder.mckibben().args(["gallery", "absent"]).output().unwrap().status.code(), Some(2));
}
