//! The `carve` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    carvegraph_cli::main()
}
