//! A sweep by its parts: the class `Sweep`.

use crate::exceptions::{OrException, exception};
use crate::scenario::{Scenario, ScenarioArgument};
use crate::signals::interruptible;
use crate::typed::{Items, Names, Progress, is_truth, shortened};
use mckibben_run::failure::Failure;
use mckibben_run::sweep::counts::SweepCounts;
use mckibben_run::sweep::destination::Place;
use mckibben_run::sweep::folder::{FinishedPart, Folder};
use mckibben_run::sweep::prepared::Prepared;
use mckibben_run::sweep::step::Choice;
use mckibben_run::sweep::warned::Warned;
use mckibben_run::table::Kind;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyInt};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// The step that was chosen for all rows: its length in s, the accuracy that it is for, the rows that it is enough for, of
/// those that were tried, and the rows that no step is enough for.
type Chosen = (f64, f64, Items<u64>, Items<u64>);
/// These as they are returned to Python.
type Given = (f64, f64, Vec<u64>, Vec<u64>);

/// Runs of a scenario's section `[sweep]`, in parts that can be computed anywhere.
///
/// `mckibben.sweep` computes all of them; this class is for your own scheduler. Parts are bit-identical to those of
/// `mckibben sweep`.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     Scenario with a section `[sweep]`.
/// chosen : tuple, optional
///     Step of the fixed-step engine for all runs: its length in s, the accuracy, the runs that reach it and those that do not.
///     By default it is chosen here, where the scenario leaves it open.
///
/// Raises
/// ------
/// InputError
///     The scenario has no section `[sweep]`, or the section is not valid.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> sweep = mckibben.Sweep(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "20 ms"},
///     ...     "sweep": {"reductions": ["length.final"], "vary": {"load.mass": ["4 lb", "5 lb", "6 lb"]}},
///     ... }))
///     >>> sweep.rows, sweep.parts, sweep.units["length_final_m"]
///     (3, 1, 'm')
///     >>> sweep.part(0)[:4]
///     b'PAR1'
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Sweep {
    scenario: Py<Scenario>,
    prepared: Prepared,
    choice: Option<Choice>,
}

/// Runs for each thread, a part at least, between which `progress` is called; or a hundredth of the sweep.
const OBSERVED: u64 = 16;

/// Threads at most.
const MOST_JOBS: usize = 4096;

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

impl Sweep {
    /// The parts that are not finished in the sweep's folder, and what is known of the runs of the others.
    fn missing_in(&self, folder: &Folder) -> Result<(Vec<u64>, FinishedPart), Failure> {
        let plan = self.prepared.plan();
        let (mut missing, mut known) = (Vec::new(), FinishedPart::default());
        for part in 0..plan.parts() {
            match folder.finished(&plan, part)? {
                Some(FinishedPart { failed, warned }) => {
                    known.failed += failed;
                    known.warned.add_all(&warned);
                }
                None => missing.push(part),
            }
        }
        Ok((missing, known))
    }
}

/// The index of a part. That a sweep has so many is checked by what uses it.
struct Part(u64);

impl<'a, 'py> FromPyObject<'a, 'py> for Part {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = <u64 as FromPyObject<'a, 'py>>::INPUT_TYPE;

    fn extract(index: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match index.extract() {
            Ok(part) if !is_truth(&index) => Ok(Self(part)),
            Err(error) if !index.is_instance_of::<PyInt>() && !index.hasattr("__index__")? => Err(error),
            _ => {
                let title = format!("the sweep has no part {}", shortened(&index.to_string()));
                Err(exception(&Failure::input(title, "parts are counted from 0: give a whole number below `parts`")))
            }
        }
    }
}

#[pymethods]
impl Sweep {
    #[new]
    #[pyo3(signature = (scenario, chosen = None))]
    fn new(py: Python<'_>, scenario: ScenarioArgument<'_>, chosen: Option<Chosen>) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let of = scenario.get();
        let (prepared, choice) = py
            .detach(|| {
                let prepared = Prepared::of(&of.document, &of.settings())?.ok_or_else(|| {
                    let title = format!("`{}` has no section [sweep]", of.document.source().name());
                    Failure::input(title, "say what varies under [sweep.vary]")
                })?;
                let choice = match chosen {
                    None => Choice::of(prepared.sweep(), cores())?,
                    Some((step, accuracy, Items(reached), Items(unreached))) => {
                        Some(Choice { step, accuracy, reached, unreached })
                    }
                };
                Ok::<_, Failure>((prepared, choice))
            })
            .or_exception()?;
        Ok(Self { scenario, prepared, choice })
    }

    /// Scenario whose section `[sweep]` is run.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    /// Number of runs.
    #[getter]
    fn rows(&self) -> u64 {
        self.prepared.plan().rows
    }

    /// Number of parts, each of which is a Parquet file.
    #[getter]
    fn parts(&self) -> u64 {
        self.prepared.plan().parts()
    }

    /// Names of the columns of the table, in their order.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        self.prepared.columns().iter().map(|column| column.name.as_str()).collect()
    }

    /// Units of the columns of numbers by their names, in SI.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Names<'py>> {
        let units = PyDict::new(py);
        let numbers = self.prepared.columns().iter().filter(|column| column.kind == Kind::Number);
        numbers.into_iter().try_for_each(|column| units.set_item(&column.name, &column.unit))?;
        Ok(Names(units.into_any()))
    }

    /// Names of the columns of varied keys whose values are spaced or distributed evenly in their logarithm.
    #[getter]
    fn logarithmic(&self) -> Vec<String> {
        let axes = self.prepared.sweep().axes().iter();
        axes.filter(|axis| axis.is_logarithmic()).map(mckibben_scenario::Axis::column).collect()
    }

    /// Keys that runs leave out, since they have no meaning under a word of another key that varies: a sentence each.
    #[getter]
    fn left_out(&self) -> Vec<String> {
        self.prepared.sweep().left_out().iter().map(ToString::to_string).collect()
    }

    /// Longest step in s of the fixed-step engine, chosen for all runs; `None` where each run has its own.
    #[getter]
    fn step(&self) -> Option<f64> {
        self.choice.as_ref().map(|choice| choice.step)
    }

    /// Compute a part on one thread, with the interpreter released.
    ///
    /// Parameters
    /// ----------
    /// part : int
    ///     Index of the part, from 0.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     Content of its Parquet file.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is no such part.
    fn part<'py>(&self, py: Python<'py>, part: Part) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.prepared.part(self.choice.as_ref(), part.0)).or_exception()?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Create the folder of the sweep, or open one that holds the same sweep, and return what is missing in it.
    ///
    /// Parameters
    /// ----------
    /// folder : str or path
    ///     Folder of the sweep.
    ///
    /// Returns
    /// -------
    /// parts : list of int
    ///     Indices of the parts that are not finished.
    /// failed : int
    ///     Number of runs that failed in the finished parts.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The folder holds something else, or a damaged part.
    /// OutputError
    ///     The folder cannot be written to.
    fn missing(&self, folder: PathBuf) -> PyResult<(Vec<u64>, u64)> {
        let (missing, known) =
            self.prepared.folder(&folder).and_then(|folder| self.missing_in(&folder)).or_exception()?;
        Ok((missing, known.failed))
    }

    /// Warnings of the runs in the finished parts of the folder: codes, how many runs, the first of them, and what it says there.
    ///
    /// Parameters
    /// ----------
    /// folder : str or path
    ///     Folder of the sweep.
    ///
    /// Returns
    /// -------
    /// list of tuple
    ///     Code, number of runs, index of the first, and a sentence, for each code.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The folder holds something else, or a damaged part.
    fn warnings(&self, folder: PathBuf) -> PyResult<Vec<(String, u64, u64, String)>> {
        let (_, known) = self.prepared.folder(&folder).and_then(|folder| self.missing_in(&folder)).or_exception()?;
        let of = |(code, of): (&str, &Warned)| (code.to_owned(), of.runs, of.first, of.text.clone());
        Ok(known.warned.iter().map(of).collect())
    }

    /// Write a part into the folder, whole or not at all.
    ///
    /// Parameters
    /// ----------
    /// folder : str or path
    ///     Folder of the sweep.
    /// part : int
    ///     Index of the part, from 0.
    /// bytes : bytes
    ///     Content of its Parquet file, as `part` returns it.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The folder holds something else, or the bytes are not that part, whole; what stands in its place stays.
    /// OutputError
    ///     The file cannot be written.
    fn put(&self, py: Python<'_>, folder: PathBuf, part: Part, bytes: &[u8]) -> PyResult<()> {
        py.detach(|| {
            let (folder, plan) = (self.prepared.folder(&folder)?, self.prepared.plan());
            folder.put(&plan, part.0, bytes).map_err(|failure| failure.staying(|| folder.stays(&plan)))
        })
        .or_exception()
    }

    /// Compute the missing parts into the folder on several threads.
    ///
    /// Parameters
    /// ----------
    /// folder : str or path
    ///     Folder of the sweep; created where there is none.
    /// jobs : int, optional
    ///     Number of threads, from 1 to 4096; one for each core by default.
    /// progress : callable, optional
    ///     Called as `progress(done, parts)` after every few parts, with the number of finished parts and of all. An exception
    ///     that it raises ends the sweep.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The folder holds something else, or `jobs` is out of range.
    /// OutputError
    ///     A file cannot be written.
    ///
    /// Notes
    /// -----
    /// Ctrl-C ends the runs in progress; the parts that are finished by then stay in the folder. An exception of `progress` ends the
    /// sweep between parts. A run on its way to an orbit (`sweep.over`), and the trial of steps before the runs, are not ended.
    #[pyo3(signature = (folder, jobs = None, progress = None))]
    fn run(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        jobs: Option<usize>,
        progress: Option<Progress<'_>>,
    ) -> PyResult<()> {
        let jobs = jobs.unwrap_or_else(cores);
        if jobs == 0 {
            let remedy =
                format!("give a whole number from 1 to {MOST_JOBS}, or leave it out for a thread on each core");
            return Err(Failure::input("`jobs` = 0 is out of range", remedy)).or_exception();
        }
        if jobs > MOST_JOBS {
            let remedy = format!("give {MOST_JOBS} at most; more than there are cores are of no use");
            return Err(Failure::input(format!("{jobs} jobs are more threads than can be started"), remedy))
                .or_exception();
        }
        let mut totals = SweepCounts::new(self.prepared.sweep(), false);
        let (missing, _) = py.detach(|| self.missing_in(&self.prepared.folder(&folder)?)).or_exception()?;
        let mut done = self.parts() - missing.len() as u64;
        let of_rows = |rows: u64| (rows * jobs as u64).div_ceil(self.prepared.plan().part_rows.max(1));
        let together = match progress {
            None => missing.len() as u64,
            Some(_) => of_rows(OBSERVED).max(missing.len() as u64 / 100),
        };
        for parts in missing.chunks(usize::try_from(together).unwrap_or(usize::MAX).max(1)) {
            py.check_signals()?;
            interruptible(py, |check| {
                let place = Place::Folder(self.prepared.folder(&folder)?);
                self.prepared.simulate_checked(check, self.choice.as_ref(), parts.to_vec(), jobs, place, &mut totals)
            })?
            .or_exception()?;
            done += parts.len() as u64;
            progress.as_ref().map_or(Ok(()), |progress| progress.0.call1((done, self.parts())).map(|_| ()))?;
        }
        py.check_signals()
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Sweep of {:?}, {} runs>", self.scenario.get().title(), self.rows())
    }

    fn __getnewargs__(&self, py: Python<'_>) -> (Py<Scenario>, Option<Given>) {
        let chosen = self.choice.clone().map(|of| (of.step, of.accuracy, of.reached, of.unreached));
        (self.scenario.clone_ref(py), chosen)
    }
}
