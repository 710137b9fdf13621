//! The book: rendered from `docs/` with its equations, and its links and equations checked.
//!
//! Links from page to page are checked in what was rendered, with the places within a page; that each file exists to which a page
//! links is a test of `mckibben-cli`, `pages.rs`. A link out of the book leads to the repository.

use crate::counts::Counts;
use crate::dist::{copy, create, empty};
use crate::steps::{command, succeed};
use crate::tools::{Tool, install};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// What renders the book, with the features that it is built with: of one major version, or the one does not understand the other.
const TOOLS: [Tool; 2] =
    [("mdbook", "0.5.3", &["--no-default-features", "--features", "search"]), ("mdbook-katex", "0.10.0", &[])];

/// What stands before the number of an equation, and before what is rendered of one.
const TAG: &str = "\\tag{";
const MATH: &str = "<math ";

/// Builds the book into `target/book` and checks it.
pub(crate) fn book(root: &Path) -> Result<Counts, String> {
    let bin = install(root, "target/book-tools", &TOOLS, &[])?;
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(bin.clone()).chain(std::env::split_paths(&path)));
    let path = path.map_err(|error| format!("PATH: {error}"))?;
    let pages = root.join("target/book");
    empty(&pages)?;
    succeed(command(root, bin.join("mdbook")).arg("build").env("PATH", path))?;
    let (numbers, mut problems) = numbering(&root.join("docs"))?;
    let mut rendered = BTreeMap::new();
    for path in files(&pages, "html")? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // Pages that are made of the others, or of none.
        if !["print.html", "toc.html", "404.html"].contains(&name.as_str()) {
            let text = refer(&outwards(root, &pages, &path, &mut problems)?, &numbers);
            fs::write(&path, &text).map_err(|error| format!("{}: {error}", path.display()))?;
            rendered.insert(name, text);
        }
    }
    for (name, text) in &rendered {
        unrendered(name, text, &mut problems);
        links(name, text, &rendered, &mut problems);
    }
    let equations: usize = rendered.values().map(|text| text.matches("display=\"block\"").count()).sum();
    println!("{} pages, {equations} equations: target/book/index.html", rendered.len());
    if problems.is_empty() {
        Ok(Counts::NONE)
    } else {
        Err(format!("the book has mistakes:\n  {}", problems.join("\n  ")))
    }
}

fn files(folder: &Path, ending: &str) -> Result<Vec<std::path::PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found: Vec<_> = paths.filter(|path| path.extension().is_some_and(|its| its == ending)).collect();
    found.sort();
    Ok(found)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The page of each equation by its number. The equations of a page are numbered one after the other, by a letter that no other
/// page has, and each number that a page mentions is that of an equation.
fn numbering(docs: &Path) -> Result<(BTreeMap<String, String>, Vec<String>), String> {
    let (mut problems, mut letters, mut numbers, mut mentions) =
        (Vec::new(), BTreeMap::new(), BTreeMap::new(), Vec::new());
    for path in files(docs, "md")? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = read(&path)?;
        for (count, rest) in (1..).zip(text.split(TAG).skip(1)) {
            let (number, letter) = (tagged(rest), rest.split('.').next().unwrap_or_default().to_owned());
            if number != format!("{letter}.{count}") {
                problems.push(format!("docs/{name}: ({number}) is equation {count} of its page"));
            }
            if *letters.entry(letter).or_insert_with(|| name.clone()) != name {
                problems.push(format!("docs/{name}: the letter of ({number}) is another page's"));
            }
            numbers.insert(number, name.replace(".md", ".html"));
        }
        mentions.extend(text.split('(').skip(1).filter_map(|rest| Some((name.clone(), mentioned(rest)?.to_owned()))));
    }
    let lost = mentions.into_iter().filter(|(_, number)| !numbers.contains_key(number));
    problems.extend(lost.map(|(name, number)| format!("docs/{name}: there is no equation ({number})")));
    Ok((numbers, problems))
}

/// The number at the beginning of what stands in a tag.
fn tagged(rest: &str) -> String {
    rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '.').collect()
}

/// Gives each equation a place by its number, and makes links of the numbers that the text mentions.
fn refer(text: &str, numbers: &BTreeMap<String, String>) -> String {
    let mut parts = text.split(MATH);
    let mut placed = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let equation = part.split_once("</math>").map_or(part, |(equation, _)| equation);
        placed += MATH;
        if let Some((_, rest)) = equation.split_once(TAG) {
            placed += &format!("id=\"eq-{}\" ", tagged(rest));
        }
        placed += part;
    }
    let Some((head, mut rest)) = placed.split_once("<main>") else { return placed };
    let mut linked = format!("{head}<main>");
    while let Some(at) = rest.find(['<', '(']) {
        let (before, from) = rest.split_at(at);
        linked += before;
        let closing = [("<math", "</math>"), ("<code", "</code>"), ("<pre", "</pre>"), ("<a ", "</a>"), ("<", ">")];
        let skipped = closing.iter().find(|(opening, _)| from.starts_with(opening));
        let end = skipped.and_then(|(_, end)| Some(from.find(end)? + end.len())).unwrap_or(1);
        match mentioned(&from[1..]).and_then(|number| Some((number, numbers.get(number)?))) {
            Some((number, page)) if skipped.is_none() => {
                linked += &format!("(<a href=\"{page}#eq-{number}\">{number}</a>)");
                rest = &from[number.len() + 2..];
            }
            _ => {
                linked += &from[..end];
                rest = &from[end..];
            }
        }
    }
    linked + rest
}

/// The number of an equation, such as `V.3`, that ends at the next bracket.
fn mentioned(rest: &str) -> Option<&str> {
    let (number, _) = rest.split_once(')')?;
    let (letter, count) = number.split_once('.')?;
    let is_one = letter.len() == 1 && letter.starts_with(|c: char| c.is_ascii_uppercase());
    (is_one && !count.is_empty() && count.bytes().all(|byte| byte.is_ascii_digit())).then_some(number)
}

/// The text between two marks, repeatedly taken out.
fn without(text: &str, [from, to]: [&str; 2]) -> String {
    let mut parts = text.split(from);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once(to).map_or("", |(_, rest)| rest))
}

/// An equation that does not render stays as it was written.
fn unrendered(name: &str, text: &str, problems: &mut Vec<String>) {
    let main = text.split_once("<main>").map_or("", |(_, rest)| rest);
    let main = main.split_once("</main>").map_or(main, |(main, _)| main);
    let prose = [["<pre", "</pre>"], ["<code", "</code>"], ["<annotation", "</annotation>"]]
        .into_iter()
        .fold(main.to_owned(), |text, marks| without(&text, marks));
    for (at, _) in prose.match_indices('$').step_by(2) {
        let rest: String = prose[at..].chars().take(60).collect();
        problems.push(format!("{name}: an equation was not rendered: {}", rest.replace('\n', " ")));
    }
}

/// The values of an attribute.
fn attributes<'t>(text: &'t str, attribute: &str) -> impl Iterator<Item = &'t str> {
    let before = format!(" {attribute}=\"");
    let starts: Vec<usize> = text.match_indices(&before).map(|(at, _)| at + before.len()).collect();
    starts.into_iter().filter_map(|at| text[at..].split('"').next())
}

/// Leads what a page has from outside the book to the repository, and pictures to copies.
fn outwards(root: &Path, pages: &Path, path: &Path, problems: &mut Vec<String>) -> Result<String, String> {
    let text = read(path)?;
    let mut changed = text.clone();
    let outside =
        |attribute| attributes(&text, attribute).filter(|link| link.starts_with("../")).collect::<BTreeSet<_>>();
    for link in outside("href") {
        let (file, place) = link.split_once('#').unwrap_or((link, ""));
        let file = file.trim_start_matches("../");
        // The renderer takes any page for one of the book's.
        let file = match file.strip_suffix(".html") {
            Some(page) if !root.join(file).exists() => format!("{page}.md"),
            _ => file.to_owned(),
        };
        if !root.join(&file).exists() {
            problems.push(format!("{}: {link} leads nowhere", path.display()));
        }
        let place = if place.is_empty() { String::new() } else { format!("#{place}") };
        let whole = format!("{}/blob/main/{file}{place}", env!("CARGO_PKG_REPOSITORY"));
        changed = changed.replace(&format!("href=\"{link}\""), &format!("href=\"{whole}\""));
    }
    for link in outside("src") {
        let file = link.trim_start_matches("../");
        let to = pages.join(file);
        create(to.parent().unwrap_or(pages))?;
        copy(&root.join(file), &to)?;
        changed = changed.replace(&format!("src=\"{link}\""), &format!("src=\"{file}\""));
    }
    Ok(changed)
}

/// That each link within the book leads to a page, and to a place that the page has.
fn links(name: &str, text: &str, rendered: &BTreeMap<String, String>, problems: &mut Vec<String>) {
    let main = text.split_once("<main>").map_or("", |(_, rest)| rest);
    for link in attributes(main, "href").filter(|link| !link.contains(':')) {
        let (page, place) = link.split_once('#').unwrap_or((link, ""));
        let page = if page.is_empty() { name } else { page };
        let Some(target) = rendered.get(page) else {
            if page.ends_with(".html") {
                problems.push(format!("{name}: {link} leads nowhere"));
            }
            continue;
        };
        if !place.is_empty() && !attributes(target, "id").any(|id| id == place) {
            problems.push(format!("{name}: {page} has no place #{place}"));
        }
    }
}
