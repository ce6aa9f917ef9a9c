//! The `ferntast` command.

fn main() -> std::process::ExitCode {
    ferntast_nodes::command::main()
}
