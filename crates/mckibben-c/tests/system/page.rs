//! What the page on C shows compiles, and the header in the standards that it says it needs.

use super::common::{here, run, scratch};
use std::process::Command;

/// What a block on the page takes from around it.
const AROUND: [&str; 2] = [
    "double length, double velocity, double mass",
    "double t, const double *duty, const double *length, mckibben_response *response, mckibben_plant *muscle, \
     mckibben_status *statuses",
];

/// Says whether a compiler takes the header in a standard, without extensions.
fn compiles(compiler: &str, language: &str, standard: &str) -> bool {
    let source = scratch(&format!("standard-{standard}")).join("source");
    std::fs::write(&source, "#include <mckibben.h>\nint main(void) { return mckibben_version() == NULL; }\n")
        .expect("a file");
    let mut command = Command::new(compiler);
    command.args(["-x", language, &format!("-std={standard}"), "-Wall", "-Wextra", "-pedantic-errors", "-Werror"]);
    command.arg("-fsyntax-only").arg("-I").arg(here().join("include")).arg(source);
    command.output().expect("a compiler").status.success()
}

#[test]
fn the_header_needs_the_standards_that_it_says() {
    let header = std::fs::read_to_string(here().join("include/mckibben.h")).expect("the header");
    assert!(header.contains("C99 or C++11"));
    for (compiler, language, standard, is_enough) in [
        ("cc", "c", "c89", false),
        ("cc", "c", "c99", true),
        ("cc", "c", "c11", true),
        ("c++", "c++", "c++98", false),
        ("c++", "c++", "c++11", true),
        ("c++", "c++", "c++20", true),
    ] {
        assert_eq!(compiles(compiler, language, standard), is_enough, "{standard}");
    }
}

#[test]
fn the_code_on_the_page_compiles() {
    let page = std::fs::read_to_string(here().join("../../docs/c.md")).expect("the page");
    let blocks: Vec<&str> = page.split("```c\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(blocks.len(), AROUND.len());
    let folder = scratch("page");
    for (index, (block, around)) in blocks.into_iter().zip(AROUND).enumerate() {
        let body: String =
            block.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
        let text = format!(
            "#include <mckibben.h>\n#include <stdio.h>\nint block({around});\nint block({around})\n{{\n{body}return 0;\n}}\n"
        );
        let source = folder.join(format!("block-{index}.c"));
        std::fs::write(&source, text).expect("a file");
        let mut compiler = Command::new("cc");
        compiler.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I"]).arg(here().join("include"));
        run(compiler.arg(source));
    }
}
