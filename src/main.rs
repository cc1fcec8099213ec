//! The command line, for the robots of this build.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    piaffe_cli::run(piaffe::BUILT)
}
