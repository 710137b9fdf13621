//! The architecture page names paths that exist, and every source file of the core is on it.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Everything between backticks on the page that looks like a path.
fn named_paths(page: &str) -> Vec<&str> {
    page.split('`').skip(1).step_by(2).filter(|word| word.contains('/') && !word.contains(' ')).collect()
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_path_on_the_page_exists() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page");
    let paths = named_paths(&page);
    assert!(paths.len() > 20, "only {} paths were found", paths.len());
    for path in paths {
        let in_scenario = root().join("crates/mckibben-scenario").join(path);
        assert!(root().join(path).exists() || in_scenario.exists(), "ARCHITECTURE.md names {path}, which is not there");
    }
}

#[test]
fn every_source_file_of_the_core_is_on_the_page() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page");
    let core = root().join("crates/mckibben/src");
    let mut files = Vec::new();
    sources(&core, &mut files);
    for file in files {
        let relative = file.strip_prefix(root()).expect("inside the project").to_string_lossy().replace('\\', "/");
        assert!(page.contains(&format!("`{relative}`")), "{relative} is not on the page");
    }
}
