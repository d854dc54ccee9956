//! The `carve` command again, built here so that the end-to-end tests can run it.

use std::process::ExitCode;

fn main() -> ExitCode {
    carvegraph_cli::main()
}
