//! The command line with what this build offers.

fn main() -> std::process::ExitCode {
    sumo_mfc::cli::main(&sumo_mfc::scenario::Catalog::installed())
}
