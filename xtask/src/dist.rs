//! What a release carries: the program in an archive with libraries, manual pages and completions, a wheel, its source, and
//! checksums.
//!
//! | made | by | tried |
//! |---|---|---|
//! | `mckibben-VERSION-TARGET.tar.gz` | the profile `dist` | unpacked; a scenario run and a unit of FMI written by it |
//! | its `lib/` and `include/` | that profile | an example in C, and MuJoCo that loads the plugin |
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
/// What lies in the program's folder.
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
    let python = python::environment(root, "python/tests/requirements.txt")?;
    let name = archive(root, &folder, &python)?;
    let mut wheel = command(root, &python);
    wheel.args(["-m", "maturin", "build", "--locked", "--profile", "dist", "--features", "f32", "--out"]);
    succeed(wheel.arg(&folder))?;
    let mut source = command(root, &python);
    succeed(source.args(["-m", "maturin", "sdist", "--out"]).arg(&folder))?;
    stands_alone(root, &folder)?;
    python::installs(root, &folder)?;
    println!("{name} runs, and so does the wheel without Cargo");
    checksums(&python, &folder)?;
    forget_packages()?;
    // Each crate, compiled from what its package holds and from nothing else.
    succeed(&mut packages(root))?;
    Ok(folder)
}

/// The program with what belongs to it; the archive's name.
fn archive(root: &Path, folder: &Path, python: &Path) -> Result<String, String> {
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
    let library = library("fmu");
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
    plugin(root, &into, python)?;
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

/// The file of the shared library of a crate.
fn library(of: &str) -> String {
    let (begins, ends) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    format!("{begins}mckibben_{of}{ends}")
}

/// Builds the plugin of MuJoCo for programs in C and C++, and lets MuJoCo load it.
fn plugin(root: &Path, into: &Path, python: &Path) -> Result<(), String> {
    let mut build = cargo(root);
    build.args(["rustc", "--locked", "--profile", "dist", "--package", "mckibben-mujoco", "--lib"]);
    succeed(build.args(["--features", "register-on-load", "--crate-type", "cdylib"]))?;
    let file = library("mujoco");
    let plugin = into.join("lib").join(&file);
    copy(&python::target_folder(root).join("dist").join(&file), &plugin)?;
    let load = "import mujoco, sys; mujoco.mj_loadPluginLibrary(sys.argv[1]); mujoco.MjModel.from_xml_string(\
                '<mujoco><extension><plugin plugin=\"mckibben.muscle\"/></extension></mujoco>')";
    succeed(command(root, python).args(["-c", load]).arg(&plugin))
}

/// Removes what Cargo unpacked of these packages before: it would pass for what is packed now, whose version is no other.
fn forget_packages() -> Result<(), String> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| Some(std::env::home_dir()?.join(".cargo")));
    let unpacked = home.ok_or("there is no home folder")?.join("registry/src");
    let entries = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| (entry.path(), entry.file_name().to_string_lossy().into_owned())).collect::<Vec<_>>()
    };
    // A registry without a host is a folder, as the one in which Cargo puts what it packs.
    for (registry, _) in entries(&unpacked).into_iter().filter(|(_, name)| name.starts_with('-')) {
        for (package, _) in entries(&registry).into_iter().filter(|(_, name)| name.starts_with("mckibben")) {
            std::fs::remove_dir_all(&package)
                .map_err(|error| format!("{} could not be removed: {error}", package.display()))?;
        }
    }
    Ok(())
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
    let printed = output(command(root, "rustc").arg("-vV"))?;
    let host = printed.lines().find_map(|line| line.strip_prefix("host: "));
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
