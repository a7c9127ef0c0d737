//! Chores that keep the repository in order: `cargo xtask <chore>`.

mod budgets;
mod readme;
mod references;
mod sources;

use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <chore>

chores:
  budgets     measures files and functions against the limits of STYLE.md
  references  checks that every paper key resolves in REFERENCES.md, and that all are used
  readme      checks that the README's Rust example is the tested one of `Tree::build`";

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let chore = std::env::args().nth(1).unwrap_or_default();
    let complaints = match chore.as_str() {
        "budgets" => budgets::check(&root),
        "references" => references::check(&root),
        "readme" => readme::check(&root),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    report(&chore, complaints)
}

/// Prints what a chore found; success if that is nothing.
fn report(chore: &str, complaints: std::io::Result<Vec<String>>) -> ExitCode {
    let complaints = complaints.unwrap_or_else(|error| vec![error.to_string()]);
    for complaint in &complaints {
        eprintln!("{chore}: {complaint}");
    }
    if complaints.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
