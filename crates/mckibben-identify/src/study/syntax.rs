//! What to do about a file that is TOML and no study.

/// The remedy for brackets and dots that mean something else in TOML than was meant: `[run]` for `[[run]]`, `[fit.load.mass]` for
/// `[fit."load.mass"]`.
pub(super) fn remedy(text: &str) -> Option<String> {
    let table: toml::Table = text.parse().ok()?;
    if table.get("run").is_some_and(toml::Value::is_table) {
        return Some("write `[[run]]`, in two brackets, once for each run".to_owned());
    }
    let unquoted = |section: &str| {
        let entries = table.get(section)?.as_table()?.iter();
        let inner = |(name, entry): (&String, &toml::Value)| {
            let (key, _) = entry.as_table()?.iter().find(|(key, value)| value.is_table() && *key != "prior")?;
            Some(format!("write a name with dots in quotes: `[{section}.\"{name}.{key}\"]`"))
        };
        entries.filter_map(inner).next()
    };
    ["fit", "columns"].into_iter().find_map(unquoted)
}
