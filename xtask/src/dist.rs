//! What a release carries: the program in an archive with its manual pages, its completions and the C library, a wheel, its
//! source, and checksums.
//!
//! | made | by | tried |
//! |---|---|---|
//! | `mckibben-VERSION-TARGET.tar.gz` | the profile `dist` | unpacked, and a scenario run by it; an example in C |
//! What a release carries: the program in an archive with its library, manual pages and completions, a wheel, its source, and checksums.
//!
//! | made | by | tried |
//! |---|---|---|
//! | `mckibben-VERSION-TARGET.tar.gz` | the profile `dist`, with the library of functional mock-up units | unpacked, a scenario run and a unit written by it |
//! | `mckibben-VERSION-cp310-abi3-….whl` | Maturin, by that profile | installed where there is no Cargo, and a scenario run by it |
//! | `mckibben-VERSION.tar.gz` | Maturin | its metadata are read, so nothing reaches outside it |
//! | `SHA256SUMS` | | |
//!
//! What would go to the registry of crates is packed and compiled from its packages.

use crate::c;
use crate::python;
use crate::steps::{cargo, command, packages, root, succeed, words};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// The shells that have completions.
const SHELLS: [(&str, &str); 5] = [
    ("bash", "mckibben"),
    ("zsh", "_mckibben"),
    ("fish", "mckibben.fish"),
    ("powershell", "_mckibben.ps1"),
    ("elvish", "mckibben.elv"),
];
/// What lies beside the program.
const BESIDE: [&str; 5] = ["README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE-MIT", "LICENSE-APACHE"];

/// Makes everything that a release carries, in `target/release-files`.
pub(crate) fn run() -> ExitCode {
    match all(&root()) {
        Ok(folder) => {
            println!("\nwrote {}", folder.display());
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn all(root: &Path) -> Result<PathBuf, String> {
    let folder = root.join("target/release-files");
    empty(&folder)?;
    let name = archive(root, &folder)?;
    let python = python::environment(root, "python/tests/requirements.txt")?;
    let mut wheel = command(root, &python);
    wheel.args(["-m", "maturin", "build", "--locked", "--profile", "dist", "--out"]);
    succeed(wheel.arg(&folder))?;
    let mut source = command(root, &python);
    succeed(source.args(["-m", "maturin", "sdist", "--out"]).arg(&folder))?;
    stands_alone(root, &folder)?;
    python::installs(root, &folder)?;
    println!("{name} runs, and so does the wheel without Cargo");
    checksums(&python, &folder)?;
    // Each crate, compiled from what its package holds and from nothing else.
    succeed(&mut packages(root))?;
    Ok(folder)
}

/// The program with what belongs to it; the archive's name.
fn archive(root: &Path, folder: &Path) -> Result<String, String> {
    succeed(cargo(root).args([
        "build",
        "--locked",
        "--profile",
        "dist",
        "--package",
        "mckibben-cli",
        "--bin",
        "mckibben",
        "--package",
        "mckibben-fmu",
        "--lib",
    ]))?;
    let name = format!("mckibben-{}-{}", env!("CARGO_PKG_VERSION"), target(root)?);
    let (staged, file) = (root.join("target/release-staged"), format!("mckibben{}", std::env::consts::EXE_SUFFIX));
    empty(&staged)?;
    let into = staged.join(&name);
    let built = python::target_folder(root).join("dist").join(&file);
    for part in ["man", "completions"] {
        create(&into.join(part))?;
    }
    copy(&built, &into.join(&file))?;
    let library = library();
    copy(&built.with_file_name(&library), &into.join(&library))?;
    BESIDE.iter().try_for_each(|file| copy(&root.join(file), &into.join(file)))?;
    let program = into.join(&file);
    for (shell, file) in SHELLS {
        write(&into.join("completions").join(file), &output(Command::new(&program).args(["completions", shell]))?)?;
    }
    for command in commands(&program)? {
        let (page, arguments) = match command.as_str() {
            "" => ("mckibben.1".to_owned(), vec!["man"]),
            name => (format!("mckibben-{name}.1"), vec!["man", name]),
        };
        write(&into.join("man").join(page), &output(Command::new(&program).args(arguments))?)?;
    }
    c::release(root, &into)?;
    let archive = folder.join(format!("{name}.tar.gz"));
    succeed(command(&staged, "tar").arg("-czf").arg(&archive).arg(&name))?;
    // Unpacked it runs.
    empty(&staged)?;
    succeed(command(&staged, "tar").arg("-xzf").arg(&archive))?;
    let scenario = root.join("examples/paper/fig-12.toml");
    let program = staged.join(&name).join(&file);
    succeed(command(root, &program).arg("simulate").arg(&scenario))?;
    succeed(command(root, &program).arg("fmu").arg(&scenario).arg("--output").arg(staged.join("muscle.fmu")))?;
    Ok(format!("{name}.tar.gz"))
}

/// The file of the library that a functional mock-up unit carries, which lies beside the program.
fn library() -> String {
    let (begins, ends) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    format!("{begins}mckibben_fmu{ends}")
}

/// The commands of the program, with an empty name for the program itself.
fn commands(program: &Path) -> Result<Vec<String>, String> {
    let help = output(Command::new(program).arg("--help"))?;
    let listed =
        help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1).take_while(|line| !line.is_empty());
    // A line that goes on with an explanation is indented further.
    let named = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = named.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    Ok(std::iter::once("").chain(names).map(str::to_owned).collect())
}

/// The machine that the compiler compiles for.
fn target(root: &Path) -> Result<String, String> {
    let told = output(command(root, "rustc").arg("-vV"))?;
    let host = told.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "rustc does not say which machine it compiles for".to_owned())
}

/// That the source of the wheel needs nothing outside it.
fn stands_alone(root: &Path, folder: &Path) -> Result<(), String> {
    let staged = root.join("target/release-staged");
    empty(&staged)?;
    let version = env!("CARGO_PKG_VERSION");
    // With the time of now: by that of the archive, what was compiled of an older one would pass for this.
    succeed(command(&staged, "tar").arg("-xzmf").arg(folder.join(format!("mckibben-{version}.tar.gz"))))?;
    let inside = staged.join(format!("mckibben-{version}"));
    let mut check = cargo(&inside);
    // Its lock file names the packages of the whole workspace, of which it has a part.
    check.args(["check", "--offline", "--package", "mckibben-python"]);
    // What other checks have compiled of the packages from the registry serves here too.
    succeed(check.env("CARGO_TARGET_DIR", python::target_folder(root)))
}

fn checksums(python: &Path, folder: &Path) -> Result<(), String> {
    let sums = "import hashlib, pathlib, sys\n\
                for path in sorted(pathlib.Path(sys.argv[1]).iterdir()):\n    \
                print(hashlib.sha256(path.read_bytes()).hexdigest(), '', path.name)";
    let sums = output(Command::new(python).args(["-c", sums]).arg(folder))?;
    print!("{sums}");
    write(&folder.join("SHA256SUMS"), &sums)
}

/// What a program prints.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let line = words(command);
    match command.output() {
        Ok(done) if done.status.success() => Ok(String::from_utf8_lossy(&done.stdout).into_owned()),
        Ok(done) => Err(format!("`{line}` ended with {}: {}", done.status, String::from_utf8_lossy(&done.stderr))),
        Err(error) => Err(format!("`{line}` could not be started: {error}")),
    }
}

/// An empty folder.
pub(crate) fn empty(folder: &Path) -> Result<(), String> {
    if folder.exists() {
        std::fs::remove_dir_all(folder)
            .map_err(|error| format!("{} could not be removed: {error}", folder.display()))?;
    }
    create(folder)
}

pub(crate) fn create(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{} could not be made: {error}", folder.display()))
}

pub(crate) fn copy(from: &Path, to: &Path) -> Result<(), String> {
    std::fs::copy(from, to).map(drop).map_err(|error| format!("{} could not be copied: {error}", from.display()))
}

pub(crate) fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{} could not be written: {error}", path.display()))
}
