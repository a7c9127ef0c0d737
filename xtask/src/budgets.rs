//! Small functions in short files, measured.
//!
//! A function runs from its `fn` to the closing brace at the same indent, which is right for
//! formatted code; CI formats before it measures.

use std::collections::BTreeMap;
use std::io::Result;
use std::path::Path;

use crate::sources::{self, Source};

/// The most lines a file and a function may have.
struct Limits {
    file: usize,
    function: usize,
}

const RUST: Limits = Limits { file: 400, function: 70 };
const RUST_TEST: Limits = Limits { file: 500, function: 70 };
const WGSL: Limits = Limits { file: 150, function: 50 };

/// Nine of ten functions have at most this many lines.
const MOST_FUNCTIONS: usize = 30;

/// Lines of files and functions.
#[derive(Default)]
struct Lengths {
    files: Vec<usize>,
    functions: Vec<usize>,
}

/// A function as it stands in its file.
#[derive(Debug, PartialEq)]
struct Function<'a> {
    name: &'a str,
    /// Line of its `fn`, from 1.
    line: usize,
    lines: usize,
}

/// Prints the table and gives everything over its limit.
pub(crate) fn check(root: &Path) -> Result<Vec<String>> {
    let mut by_crate: BTreeMap<String, Lengths> = BTreeMap::new();
    let mut all = Lengths::default();
    let mut complaints = Vec::new();
    for source in sources::read(root, &["rs", "wgsl"])? {
        let functions = functions(&source.text);
        complaints.extend(over_limits(&source, &functions));
        for lengths in [by_crate.entry(crate_of(&source.path)).or_default(), &mut all] {
            lengths.files.push(source.text.lines().count());
            lengths.functions.extend(functions.iter().map(|function| function.lines));
        }
    }
    print_table(&by_crate, &all);
    let most = percentile(&all.functions, 90);
    if most > MOST_FUNCTIONS {
        complaints.push(format!("p90 of functions is {most} lines, at most {MOST_FUNCTIONS}"));
    }
    Ok(complaints)
}

fn over_limits(source: &Source, functions: &[Function]) -> Vec<String> {
    let Source { path, text } = source;
    let limits = limits_of(path);
    let lines = text.lines().count();
    let mut complaints = Vec::new();
    if lines > limits.file {
        complaints.push(format!("{path}: {lines} lines, at most {}", limits.file));
    }
    for Function { name, line, lines } in functions {
        if *lines > limits.function {
            let limit = limits.function;
            complaints.push(format!("{path}:{line}: `{name}` has {lines} lines, at most {limit}"));
        }
    }
    complaints
}

fn limits_of(path: &str) -> Limits {
    if path.ends_with(".wgsl") {
        WGSL
    } else if path.split('/').any(|part| part == "tests" || part == "tests.rs") {
        RUST_TEST
    } else {
        RUST
    }
}

/// `crates/kdray` of `crates/kdray/src/lib.rs`, `xtask` of `xtask/src/main.rs`.
fn crate_of(path: &str) -> String {
    let depth = if path.starts_with("crates/") { 2 } else { 1 };
    path.split('/').take(depth).collect::<Vec<_>>().join("/")
}

fn functions(text: &str) -> Vec<Function<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let function = |start: usize| {
        let name = function_name(lines[start])?;
        let length = function_lines(&lines[start..])?;
        Some(Function { name, line: start + 1, lines: length })
    };
    (0..lines.len()).filter_map(function).collect()
}

/// Name of the function that starts on a line, if one does.
fn function_name(line: &str) -> Option<&str> {
    let (before, after) = line.trim_start().split_once("fn ")?;
    let qualifies = |word: &str| {
        matches!(word, "pub" | "const" | "async" | "unsafe" | "extern" | "\"C\"")
            || word.starts_with("pub(")
    };
    // In WGSL attributes may stand on the line of their function.
    if !before.starts_with('@') && !before.split_whitespace().all(qualifies) {
        return None;
    }
    let name = after.split(|c: char| !c.is_alphanumeric() && c != '_').next();
    name.filter(|name| !name.is_empty())
}

/// Lines of the function on the first of `lines`, or `None` if it has no body.
fn function_lines(lines: &[&str]) -> Option<usize> {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let is_end = |line: &&str| indent(line) == indent(lines[0]) && line.ends_with(['}', ';']);
    let end = lines.iter().position(is_end)?;
    lines[end].ends_with('}').then_some(end + 1)
}

fn print_table(by_crate: &BTreeMap<String, Lengths>, all: &Lengths) {
    let head = format!("{:>6} {:>6} {:>4} {:>4}", "count", "median", "p90", "max");
    println!("{:20} {:>23}   {:>23}", "lines of", "files", "functions");
    println!("{:20} {head}   {head}", "");
    let named = by_crate.iter().map(|(name, lengths)| (name.as_str(), lengths));
    for (name, lengths) in named.chain([("all", all)]) {
        println!("{name:20} {}   {}", row(&lengths.files), row(&lengths.functions));
    }
}

fn row(lengths: &[usize]) -> String {
    let [median, p90, max] = [50, 90, 100].map(|percent| percentile(lengths, percent));
    format!("{:>6} {median:>6} {p90:>4} {max:>4}", lengths.len())
}

/// The smallest length that `percent` of all do not exceed; 0 of none.
fn percentile(lengths: &[usize], percent: usize) -> usize {
    let mut sorted = lengths.to_vec();
    sorted.sort_unstable();
    let rank = (lengths.len() * percent).div_ceil(100);
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_end_at_the_brace_below_them() {
        let text = "\
trait A {
    fn bodiless(
        &self,
    );
    fn short(&self) {}
}
// fn in_a_comment() {
pub(crate) const fn long(
    a: u32,
) -> u32 {
    if a > 0 {
        1
    }
}
@compute @workgroup_size(8, 8) fn kernel() {
    let a = 1;
}
";
        let found: Vec<_> = functions(text).iter().map(|f| (f.name, f.line, f.lines)).collect();
        assert_eq!(found, [("short", 5, 1), ("long", 8, 7), ("kernel", 15, 3)]);
    }

    #[test]
    fn what_is_over_its_limit_is_named() {
        let text = format!("fn long() {{\n{}}}\n", "    ();\n".repeat(69));
        let source = Source { path: "crates/a/src/lib.rs".to_owned(), text };
        let expected = "crates/a/src/lib.rs:1: `long` has 71 lines, at most 70";
        assert_eq!(over_limits(&source, &functions(&source.text)), [expected]);
    }

    #[test]
    fn percentiles_are_lengths_that_occur() {
        let lengths: Vec<usize> = (1..=10).rev().collect();
        assert_eq!([50, 90, 100].map(|percent| percentile(&lengths, percent)), [5, 9, 10]);
        assert_eq!(percentile(&[], 90), 0);
    }
}
