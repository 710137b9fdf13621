//! Arguments that no calculation can begin with: numbers that are none, arrays that do not fit, counts that no memory holds.
//!
//! Each is refused before anything is allocated or has changed, by the argument's name and the element's index.

use mckibben_run::failure::Failure;
use mckibben_scenario::list_and_entry;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use std::collections::HashMap;

/// Refuses numbers that are not finite; `index` says how an element is named, as `[3]` or `[3, 0]`.
pub(crate) fn finite_by(name: &str, numbers: &[f64], index: impl Fn(usize) -> String) -> Result<(), Failure> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(at) => Err(Failure::input(
            format!("{name}{} = {:?} is no finite number", index(at), numbers[at]),
            format!("give finite numbers in `{name}`"),
        )),
    }
}

/// Refuses numbers of an array of one dimension that are not finite.
pub(crate) fn finite(name: &str, numbers: &[f64]) -> Result<(), Failure> {
    finite_by(name, numbers, |at| format!("[{at}]"))
}

/// Refuses numbers of a table of so many columns that are not finite.
pub(crate) fn finite_table(name: &str, numbers: &[f64], width: usize) -> Result<(), Failure> {
    finite_by(name, numbers, |at| format!("[{}, {}]", at / width.max(1), at % width.max(1)))
}

/// Refuses a number that is not finite, or not in a range that is said in words.
pub(crate) fn number(name: &str, value: f64, unit: &str, range: &str, is_in: bool) -> Result<(), Failure> {
    match value.is_finite() && is_in {
        true => Ok(()),
        false => Err(Failure::input(
            format!("{name} = {value:?} {unit} is out of range").replace("  ", " "),
            format!("give {range}"),
        )),
    }
}

/// Refuses paths of parameters that name one number twice, as `load.mass` twice, or `[1]` and `[01]` of a list.
pub(crate) fn each_once(name: &str, paths: &[String]) -> Result<(), Failure> {
    let mut seen: HashMap<(&str, Option<usize>), &str> = HashMap::new();
    for path in paths {
        let entry = list_and_entry(path).and_then(|(list, place)| Some((list, place.parse::<usize>().ok()?)));
        let key = entry.map_or((path.as_str(), None), |(list, place)| (list, Some(place)));
        if let Some(first) = seen.insert(key, path) {
            let twice = if first == path { String::new() } else { format!(", also as `{first}`") };
            let title = format!("`{name}` names `{path}` twice{twice}");
            return Err(Failure::input(title, "name each number once; the path of a list stands for all its entries"));
        }
    }
    Ok(())
}

/// Refuses paths of parameters in sections that take no part in what is made of the scenario.
pub(crate) fn taking_part(name: &str, paths: &[String], idle: &[(&str, &str)]) -> Result<(), Failure> {
    for path in paths {
        let sections: Vec<&str> = path.split('.').collect();
        // Behind the name of an actuator, or of the second one of a joint.
        let section = match sections.as_slice() {
            ["actuators", _, section, ..] | ["antagonist", section, ..] | [section, ..] => *section,
            [] => continue,
        };
        if let Some((_, why)) = idle.iter().find(|(idle, _)| *idle == section) {
            return Err(Failure::input(format!("`{name}`: `{path}` changes nothing of {why}"), "leave it out"));
        }
    }
    Ok(())
}

/// Refuses an array without the right number of entries.
pub(crate) fn fitting(name: &str, length: usize, count: usize) -> Result<(), Failure> {
    if length == count {
        return Ok(());
    }
    let remedy = format!("give a C-contiguous array of {count} numbers (float64), one for each actuator");
    Err(Failure::input(format!("{name} has {length} entries for {count} actuators"), remedy))
}

/// Refuses an array of entries of a NumPy type that does not have the shape that it must have.
pub(crate) fn shaped(name: &str, kind: &str, given: &[usize], due: &[usize]) -> Result<(), Failure> {
    if given == due {
        return Ok(());
    }
    let title = format!("{name} is of another shape, {}", tuple(given));
    Err(Failure::input(title, format!("give a C-contiguous array of shape {} of {kind}", tuple(due))))
}

/// A shape as NumPy writes it.
pub(crate) fn tuple(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Refuses more of something than this machine's memory holds.
pub(crate) fn room(py: Python<'_>, count: usize, what: &str, each: usize) -> PyResult<()> {
    let (needed, memory) = (count as f64 * each as f64, memory(py));
    if needed <= memory {
        return Ok(());
    }
    let most = memory / each as f64;
    Err(PyMemoryError::new_err(format!(
        "{count} {what} need {} ({each} bytes each), and there are {} of memory; give a count of {most:.0} at most",
        bytes(needed),
        bytes(memory)
    )))
}

/// Says that there was no room for something after all.
pub(crate) fn no_room(count: usize, what: &str, each: usize) -> PyErr {
    let needed = bytes(count as f64 * each as f64);
    PyMemoryError::new_err(format!("{count} {what} need {needed}, which cannot be had; give a smaller count"))
}

/// Bytes of memory that this process may use: the machine's, or what its container has; without end where neither is known.
fn memory(py: Python<'_>) -> f64 {
    let machine = || -> PyResult<f64> {
        let os = py.import("os")?;
        let known = |name: &str| os.call_method1("sysconf", (name,))?.extract::<f64>();
        Ok(known("SC_PHYS_PAGES")? * known("SC_PAGE_SIZE")?)
    };
    let container = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let of_container =
        container.iter().filter_map(|path| std::fs::read_to_string(path).ok()?.trim().parse::<f64>().ok());
    of_container.chain(machine().ok()).filter(|bytes| *bytes > 0.0).fold(f64::INFINITY, f64::min)
}

/// An amount of memory for people.
fn bytes(amount: f64) -> String {
    let (unit, size) = [("EB", 1e18), ("PB", 1e15), ("TB", 1e12), ("GB", 1e9)]
        .into_iter()
        .find(|(_, size)| amount >= *size)
        .unwrap_or(("MB", 1e6));
    format!("{:.1} {unit}", amount / size)
}
