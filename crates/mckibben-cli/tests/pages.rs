//! The pages: each link leads somewhere, and the book has every chapter.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn pages() -> Vec<PathBuf> {
    let inside = |folder: &str| std::fs::read_dir(root().join(folder)).expect("a folder");
    let entries = [".", "docs", "examples"].into_iter().flat_map(inside);
    let is_page = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "md");
    entries.map(|entry| entry.expect("an entry").path()).filter(is_page).collect()
}

/// What a page links to within the repository, without the place in it.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    links.filter(|link| !link.contains("://")).map(|link| link.split('#').next().unwrap_or_default())
}

#[test]
fn every_link_leads_to_a_file() {
    let (mut links, mut broken) = (0, Vec::new());
    for page in pages() {
        let text = std::fs::read_to_string(&page).expect("a page");
        for target in targets(&text).filter(|target| !target.is_empty()) {
            links += 1;
            if !page.parent().expect("a folder").join(target).exists() {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
    assert!(links > 50, "only {links} links were found");
}

#[test]
fn the_book_has_every_chapter() {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).expect("the summary");
    let chapters: Vec<&str> = targets(&summary).collect();
    for entry in std::fs::read_dir(root().join("docs")).expect("the chapters") {
        let name = entry.expect("an entry").file_name().into_string().expect("a name");
        let is_chapter = name.ends_with(".md") && name != "SUMMARY.md";
        assert!(!is_chapter || chapters.contains(&name.as_str()), "docs/{name} is not in docs/SUMMARY.md");
    }
}
