//! The architecture page names paths that exist. The page of equations leads from
//! each equation of the paper to a function and a test that exist, and the page of limits quotes messages that exist.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Everything between backticks on the page that looks like a path.
fn named_paths(page: &str) -> Vec<&str> {
    page.split('`').skip(1).step_by(2).filter(|word| word.contains('/') && !word.contains(' ')).collect()
}

/// Whether a file has a function of a name; for a test, one that is marked as such.
fn defines(path: &str, name: &str, of_test: bool) -> bool {
    let text = std::fs::read_to_string(root().join(path)).unwrap_or_default();
    let mut before = "";
    text.lines().map(str::trim).any(|line| {
        let marked = std::mem::replace(&mut before, line) == "#[test]";
        let code = line.split("//").next().unwrap_or_default();
        let follows = code.split_once("fn ").and_then(|(_, rest)| rest.strip_prefix(name));
        follows.is_some_and(|rest| rest.starts_with(['(', '<'])) && (marked || !of_test)
    })
}

/// What a cell links to: the names in backticks, each with its file within the project.
fn links(cell: &str) -> Vec<(&str, &str)> {
    let named = cell.split("[`").skip(1).filter_map(|rest| rest.split_once("`](../"));
    named.filter_map(|(name, rest)| Some((name, rest.split_once(')')?.0))).collect()
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
fn every_equation_leads_to_a_function_and_a_test() {
    let page = std::fs::read_to_string(root().join("docs/equations.md")).expect("the page");
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| | "));
    let mut labels = String::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
        let [label, _, functions, tests] = cells[..] else { panic!("four cells, not {}: {row}", cells.len()) };
        labels += label;
        for (cell, of_test) in [(functions, false), (tests, true)] {
            let links = links(cell);
            assert!(!links.is_empty(), "{label} leads to nothing: {cell}");
            for (name, path) in links {
                let kind = if of_test { "test" } else { "function" };
                assert!(defines(path, name, of_test), "{label}: there is no {kind} {name} in {path}");
            }
        }
    }
    for number in 1..=32 {
        assert!(labels.contains(&format!("({number})")), "({number}) of the paper is not on the page");
    }
    // The search itself distinguishes a test, a function and nothing.
    let file = "crates/mckibben/src/braid.rs";
    assert!(defines(file, "volume", false) && !defines(file, "volume", true) && !defines(file, "volum", false));
}

#[test]
fn the_page_of_limits_is_the_table_of_the_core() {
    let page = std::fs::read_to_string(root().join("docs/limits.md")).expect("the page");
    let row = |limit: &&mckibben::limit::Limit| format!("| {} | {} | {} |\n", limit.feature, limit.with, limit.remedy);
    let due: String = mckibben::limit::LIMITS.iter().map(row).collect();
    let head = "| not implemented | with | instead |\n|---|---|---|\n";
    assert!(page.contains(&format!("{head}{due}\n")), "docs/limits.md is due to have:\n\n{head}{due}");
}
