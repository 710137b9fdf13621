//! `mckibben gallery`: what it shows of the repository's examples, and what it says of a file that fails.

use crate::common::{Folder, of_repository};
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

/// Copies the files of a folder.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn every_example_of_the_repository_has_a_figure() {
    let folder = Folder::new("gallery");
    let examples = folder.path("examples");
    copy(&of_repository("examples"), &examples);
    // Thirty runs of waves in hoses take longer than all other examples together: two bores are enough here.
    let hoses = examples.join("line/sweep-hose.toml");
    let (text, bores) =
        (std::fs::read_to_string(&hoses).unwrap(), "[\"1.5 mm\", \"2 mm\", \"2.5 mm\", \"3 mm\", \"4 mm\"]");
    let lengths = "[\"0.1 m\", \"0.25 m\", \"0.5 m\", \"1 m\", \"1.5 m\", \"2 m\"]";
    assert!(text.contains(bores) && text.contains(lengths), "{text}");
    let text = text.replace(bores, "[\"3 mm\", \"4 mm\"]").replace(lengths, "[\"0.1 m\", \"0.25 m\"]");
    std::fs::write(&hoses, text).unwrap();
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
fn a_file_that_fails_is_shown_and_reported() {
    let folder = Folder::new("gallery-failure");
    std::fs::create_dir_all(folder.path("in/odd ones")).unwrap();
    std::fs::copy(of_repository("examples/isometric-charge.toml"), folder.path("in/good.toml")).unwrap();
    folder.file("in/odd ones/bad.toml", "# Not a <muscle>.\n[load]\nkind = \"none of these\"\n");
    let output = folder.mckibben().args(["gallery", "in", "--output", "out"]).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(printed.contains("index.html, 1 figure\n"), "the file that failed has none: {printed}");
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(page.contains("<img src=\"good.svg\"") && page.contains("1 failed"));
    assert!(page.contains("Not a &lt;muscle&gt;") && page.contains("none of these"), "{page}");
    assert!(page.contains("href=\"odd%20ones/bad.toml.txt\""));
    assert!(String::from_utf8_lossy(&output.stderr).contains("bad.toml"));
    assert_eq!(folder.mckibben().args(["gallery", "absent"]).output().unwrap().status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn symbolic_links_are_not_followed_out_of_the_folders() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("gallery-links");
    let scenario = std::fs::read_to_string(of_repository("examples/isometric-charge.toml")).unwrap();
    for inner in ["in/sub", "elsewhere", "out"] {
        std::fs::create_dir_all(folder.path(inner)).unwrap();
    }
    folder.file("in/good.toml", &scenario);
    folder.file("elsewhere/secret.toml", &format!("# A secret.\n{scenario}"));
    symlink(folder.path("elsewhere/secret.toml"), folder.path("in/file.toml")).unwrap();
    symlink(folder.path("elsewhere"), folder.path("in/folder")).unwrap();
    symlink(folder.path("elsewhere"), folder.path("in/folder.toml")).unwrap();
    symlink("../good.toml", folder.path("in/sub/within.toml")).unwrap();
    let gallery = || folder.mckibben().args(["gallery", "in", "--output", "out"]).output().unwrap();
    let output = gallery();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    assert!(error.contains("left out: 2 symbolic links that lead out of `in`"), "{error}");
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert_eq!(page.matches("<img ").count(), 2, "{page}");
    assert!(page.contains("sub/within.svg") && !page.contains("secret") && !folder.path("out/file.toml.txt").exists());
    // Nor is anything written through one.
    std::fs::write(folder.path("elsewhere/victim.svg"), "mine").unwrap();
    std::fs::remove_file(folder.path("out/good.svg")).unwrap();
    symlink(folder.path("elsewhere/victim.svg"), folder.path("out/good.svg")).unwrap();
    let output = gallery();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{error}");
    assert!(error.contains("good.svg") && error.contains("leads out of `out`"), "{error}");
    assert_eq!(std::fs::read_to_string(folder.path("elsewhere/victim.svg")).unwrap(), "mine");
    std::fs::remove_file(folder.path("out/good.svg")).unwrap();
    std::fs::remove_dir_all(folder.path("out/sub")).unwrap();
    symlink(folder.path("elsewhere"), folder.path("out/sub")).unwrap();
    assert_eq!(gallery().status.code(), Some(4));
    let mut there: Vec<_> =
        std::fs::read_dir(folder.path("elsewhere")).unwrap().map(|of| of.unwrap().file_name()).collect();
    there.sort();
    assert_eq!(there, ["secret.toml", "victim.svg"]);
}
