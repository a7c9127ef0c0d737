//! The README's Rust example is one that the tests run.

use std::io::Result;
use std::path::Path;

use crate::sources;

/// Where the example is a doc test.
const TESTED: &str = "crates/kdray/src/tree/mod.rs";

/// Complains if the first Rust block of the README is no documentation example of [`TESTED`].
pub(crate) fn check(root: &Path) -> Result<Vec<String>> {
    let readme = sources::read_text(root, "README.md")?;
    let documentation = documentation(&sources::read_text(root, TESTED)?);
    let example = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next());
    Ok(match example {
        Some(example) if documentation.contains(&format!("```\n{example}```")) => Vec::new(),
        Some(_) => vec![format!("README.md: its Rust example is not the one in {TESTED}")],
        None => vec!["README.md: it has no Rust example".to_owned()],
    })
}

/// The text of all documentation comments, without the lines that examples hide.
fn documentation(source: &str) -> String {
    let line = |line: &'_ str| {
        let text = line.trim_start().strip_prefix("///")?;
        Some(text.strip_prefix(' ').unwrap_or(text).to_owned() + "\n")
    };
    source.lines().filter_map(line).filter(|line| !line.starts_with("# ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documentation_is_what_readers_see() {
        let source = "/// One.\n///\n    /// let a = 1;\n    /// # Ok(())\nfn f() {}\n";
        assert_eq!(documentation(source), "One.\n\nlet a = 1;\n");
    }
}
