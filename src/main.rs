//! The command line of calipose; see `calipose --help`.

fn main() -> std::process::ExitCode {
    calipose::cli::main()
}
