//! The `hammerfall` program: parse, run, exit status.

fn main() -> std::process::ExitCode {
    hammerfall::cli::main()
}
