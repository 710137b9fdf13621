//! What the page on C shows compiles.

use super::common::{here, run, scratch};
use std::process::Command;

/// What a block on the page takes from around it.
const AROUND: [&str; 2] = [
    "double length, double velocity, double mass",
    "double t, const double *duty, const double *length, mckibben_response *response, mckibben_plant *muscle, \
     mckibben_status *statuses",
];

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
