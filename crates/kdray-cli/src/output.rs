//! Results, for people and for programs.

use std::io::{self, Write};

use anyhow::Context;
use serde::Serialize;

/// Prints `result` as one JSON object, or its `text`.
pub(crate) fn print(json: bool, result: &impl Serialize, text: &str) -> anyhow::Result<()> {
    let mut line = if json { serde_json::to_string(result)? } else { text.to_owned() };
    if !line.ends_with('\n') {
        line.push('\n');
    }
    io::stdout().write_all(line.as_bytes()).context("cannot write the result")
}

/// Lines of a name and a value each, the values under each other.
pub(crate) fn table(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0) + 2;
    rows.iter().map(|(name, value)| format!("{name:width$}{value}\n")).collect()
}
