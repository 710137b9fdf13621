//! The program `mckibben`: everything it does is in the library of this package.

use std::process::ExitCode;

fn main() -> ExitCode {
    mckibben_cli::run()
}
