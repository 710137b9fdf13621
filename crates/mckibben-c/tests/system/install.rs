//! The library as it is installed, found by pkg-config and by CMake.

use super::common::{arm, compile, here, library, run, scratch};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Installs the library as `cargo xtask dist` does.
fn installed(name: &str) -> PathBuf {
    let prefix = scratch(name);
    let copy = |from: &Path, to: &str| {
        let to = prefix.join(to);
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        std::fs::copy(from, to).expect("a copy");
    };
    for file in ["libmckibben_c.so", "libmckibben_c.a"] {
        copy(&library().join(file), &format!("lib/{file}"));
    }
    copy(&here().join("include/mckibben.h"), "include/mckibben.h");
    copy(&here().join("package/mckibben-config.cmake"), "lib/cmake/mckibben/mckibben-config.cmake");
    for (file, to) in [("mckibben.pc", "lib/pkgconfig"), ("mckibben-config-version.cmake", "lib/cmake/mckibben")] {
        let template = here().join(format!("package/{file}.in"));
        let template = std::fs::read_to_string(template).expect("a template");
        std::fs::create_dir_all(prefix.join(to)).expect("a folder");
        let due = template.replace("@VERSION@", env!("CARGO_PKG_VERSION"));
        std::fs::write(prefix.join(to).join(file), due).expect("a file");
    }
    prefix
}

#[test]
fn pkg_config_finds_the_library() {
    let prefix = installed("pkg-config");
    let mut query = Command::new("pkg-config");
    query.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
    let version = run(query.args(["--modversion", "mckibben"]));
    assert_eq!(version.trim(), env!("CARGO_PKG_VERSION"));
    let mut query = Command::new("pkg-config");
    query.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
    let flags = run(query.args(["--cflags", "--libs", "mckibben"]));
    let path = format!("-Wl,-rpath,{}", prefix.join("lib").display());
    let flags: Vec<&str> = flags.split_whitespace().chain([path.as_str()]).collect();
    assert!(flags.contains(&"-lmckibben_c"), "{flags:?}");
    compile("hanging_mass.c", &prefix.join("program"), &flags);
    assert!(run(&mut Command::new(prefix.join("program"))).starts_with("length 0.0"));
}

/// A program that was linked to the library by its path finds it elsewhere, by its name.
#[test]
fn a_program_finds_the_library_by_its_name() {
    let prefix = installed("name");
    let (here, there) = (prefix.join("lib"), prefix.join("moved"));
    let path = here.join("libmckibben_c.so").display().to_string();
    compile("hanging_mass.c", &prefix.join("program"), &[&path]);
    std::fs::rename(&here, &there).expect("a folder");
    let mut program = Command::new(prefix.join("program"));
    assert!(run(program.env("LD_LIBRARY_PATH", &there)).starts_with("length 0.0"));
}

#[test]
fn cmake_finds_the_library() {
    let prefix = installed("cmake");
    let version = env!("CARGO_PKG_VERSION");
    let numbers = [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")];
    let [major, minor, patch] = numbers.map(|number| number.parse::<u32>().expect("a number"));
    let series = format!("{major}.{minor}");
    // Later ones, and of another major number.
    let other = format!("{series}.{} {major}.{} {}", patch + 1, minor + 1, major + 1);
    let project = format!(
        "cmake_minimum_required(VERSION 3.13)\n\
         project(arm C CXX)\n\
         foreach(other {other})\n\
             find_package(mckibben ${{other}} QUIET)\n\
             if(mckibben_FOUND)\n\
                 message(FATAL_ERROR \"{version} is taken for ${{other}}\")\n\
             endif()\n\
         endforeach()\n\
         find_package(mckibben {series} REQUIRED)\n\
         if(NOT mckibben_VERSION STREQUAL \"{version}\")\n\
             message(FATAL_ERROR \"${{mckibben_VERSION}} is found for {version}\")\n\
         endif()\n\
         add_executable(arm {0}/arm.cpp)\n\
         target_link_libraries(arm PRIVATE mckibben::mckibben)\n\
         add_executable(mass {0}/hanging_mass.c)\n\
         target_link_libraries(mass PRIVATE mckibben::mckibben_static)\n",
        here().join("examples").display()
    );
    let (source, build) = (prefix.join("source"), prefix.join("build"));
    std::fs::create_dir_all(&source).expect("a folder");
    std::fs::write(source.join("CMakeLists.txt"), project).expect("a file");
    let path = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    run(Command::new("cmake").arg("-S").arg(&source).arg("-B").arg(&build).arg(path));
    run(Command::new("cmake").arg("--build").arg(&build));
    assert!(run(Command::new(build.join("arm")).arg(arm())).contains("again equal"));
    assert!(run(&mut Command::new(build.join("mass"))).starts_with("length 0.0"));
}
