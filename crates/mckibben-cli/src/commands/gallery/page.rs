//! The page of the gallery: one HTML file without scripts that shows the figures beside it.

use mckibben_run::quantities::counted;
use mckibben_run::report::{STYLE, escaped};
use std::fmt::Write as _;

/// What this page needs beyond the style of a report.
const CARDS: &str = "\
main, nav ol { max-width: 84rem; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 25rem), 1fr)); gap: 2.5rem 2rem; }
.cards article { min-width: 0; }
.cards h3 { margin: 0 0 .75rem; text-wrap: pretty; }
.cards figure { margin: 0; }
.cards img { display: block; width: 100%; height: auto; }
.cards code span + span { white-space: nowrap; }
.cards pre { white-space: pre-wrap; overflow-wrap: anywhere; }
.failed { border-left: .25rem solid var(--differs); color: var(--differs); background: var(--differs-ground); }
";

/// Files of one folder.
pub(super) struct Group {
    /// The folder below the one that is shown; empty for that one itself.
    pub(super) name: String,
    pub(super) entries: Vec<Entry>,
}

/// What the page shows of a file.
pub(super) struct Entry {
    /// The path below the folder that is shown.
    pub(super) file: String,
    /// What the file is about.
    pub(super) title: String,
    /// The command and a note, or why there is no figure.
    pub(super) drawn: Result<(String, String), String>,
}

/// Writing into a `String` cannot fail.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => {{ let _ = write!($out, $($arg)*); }};
}

/// The page over the files of `folder`.
pub(super) fn html(folder: &str, groups: &[Group]) -> String {
    let mut out = String::new();
    let entries = || groups.iter().flat_map(|group| &group.entries);
    let (count, failed) = (entries().count() as u64, entries().filter(|entry| entry.drawn.is_err()).count());
    let count = counted(count, "file");
    let folder = escaped(folder);
    put!(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    put!(out, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    put!(out, "<meta name=\"color-scheme\" content=\"light dark\">\n");
    put!(out, "<title>Gallery of {folder}</title>\n<style>\n{STYLE}{CARDS}</style>\n</head>\n<body>\n");
    put!(out, "<nav aria-label=\"Contents\">\n<ol>\n");
    for (place, group) in groups.iter().enumerate() {
        put!(out, "<li><a href=\"#group-{place}\">{}</a></li>\n", name(group, &folder));
    }
    put!(out, "</ol>\n</nav>\n<main>\n<header>\n<h1>Gallery of <code>{folder}</code></h1>\n<p>{count}");
    if failed > 0 {
        put!(out, ", <span class=\"verdict differs\">{failed} failed</span>");
    }
    put!(out, ".</p>\n</header>\n");
    for (place, group) in groups.iter().enumerate() {
        put!(out, "<section id=\"group-{place}\">\n<h2>{}</h2>\n<div class=\"cards\">\n", name(group, &folder));
        group.entries.iter().for_each(|entry| card(&mut out, entry));
        put!(out, "</div>\n</section>\n");
    }
    let version = env!("CARGO_PKG_VERSION");
    put!(out, "<footer><p>Made by mckibben {version} with <code>mckibben gallery</code>.</p></footer>\n");
    put!(out, "</main>\n</body>\n</html>\n");
    out
}

fn name(group: &Group, folder: &str) -> String {
    if group.name.is_empty() { folder.to_owned() } else { escaped(&group.name) }
}

fn card(out: &mut String, entry: &Entry) {
    let stem = entry.file.strip_suffix(".toml").unwrap_or(&entry.file);
    let (address, title) = (address(stem), escaped(&entry.title));
    put!(out, "<article>\n<h3>{title}</h3>\n");
    let text = format!("<a href=\"{address}.toml.txt\">{}</a>", escaped(&entry.file));
    match &entry.drawn {
        Ok((command, note)) => {
            put!(out, "<figure>\n<a href=\"{address}.svg\">");
            put!(out, "<img src=\"{address}.svg\" alt=\"{title}\" loading=\"lazy\"></a>\n");
            // A line may end between two options, not within one.
            let command = escaped(command).replace(" --", "</span> <span>--");
            put!(out, "<figcaption>{text}<br><code><span>{command}</span></code>");
            if !note.is_empty() {
                put!(out, "<br>{}", escaped(note));
            }
            put!(out, "</figcaption>\n</figure>\n");
        }
        Err(message) => put!(out, "<pre class=\"failed\">{}</pre>\n<p>{text}</p>\n", escaped(message)),
    }
    put!(out, "</article>\n");
}

/// A path as it stands in an address.
fn address(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-_.~".contains(&byte);
    let path = path.replace(std::path::MAIN_SEPARATOR, "/");
    path.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}

/// The first sentence of the comment that a file begins with; the comment's first paragraph where it has no end.
pub(super) fn first_sentence(text: &str) -> Option<String> {
    let comments = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    let paragraph: Vec<&str> = comments.take_while(|line| !line.is_empty()).collect();
    let paragraph = paragraph.join(" ");
    // A capital follows the end of a sentence; "Fig. 4" and "25 Hz. m" do not end one.
    let ends = paragraph.match_indices(". ").map(|(at, _)| at + 1);
    let end = ends.into_iter().find(|end| paragraph[end + 1..].starts_with(char::is_uppercase));
    let sentence = &paragraph[..end.unwrap_or(paragraph.len())];
    (!sentence.is_empty()).then(|| sentence.trim_end_matches('.').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_is_a_sentence() {
        let text = "# As in Fig. 4 of\n# the paper. The rest\n#\n# And more.\n[run]\n";
        assert_eq!(first_sentence(text).as_deref(), Some("As in Fig. 4 of the paper"));
        assert_eq!(first_sentence("[run]\n# late"), None);
    }

    #[test]
    fn nothing_escapes() {
        assert_eq!(address("a b/ü#1"), "a%20b/%C3%BC%231");
        let entry = Entry { file: "<a>.toml".into(), title: "\"x\" & y".into(), drawn: Err("<no>".into()) };
        let page = html("f", &[Group { name: String::new(), entries: vec![entry] }]);
        assert!(page.contains("&lt;no&gt;") && page.contains("&quot;x&quot; &amp; y") && !page.contains("<a>"));
        assert!(page.contains("1 failed") && !page.contains("<script") && !page.contains("http"));
    }
}
