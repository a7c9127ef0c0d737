//! Papers by key: every key in brackets has an entry, and every entry is used.

use std::collections::BTreeMap;
use std::io::Result;
use std::path::Path;

use crate::sources::{self, Source};

const REFERENCES: &str = "REFERENCES.md";

/// Where keys may stand.
const EXTENSIONS: [&str; 5] = ["rs", "wgsl", "md", "toml", "py"];

/// Gives the keys without an entry and the entries without a use.
pub(crate) fn check(root: &Path) -> Result<Vec<String>> {
    let references = sources::read_text(root, REFERENCES)?;
    let mut sources = sources::read(root, &EXTENSIONS)?;
    // The entries do not use themselves, and the tests below make keys up.
    sources.retain(|source| source.path != REFERENCES && !source.path.starts_with("xtask/"));
    Ok(compare(&references, &sources))
}

fn compare(references: &str, sources: &[Source]) -> Vec<String> {
    let mut complaints = Vec::new();
    let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
    for entry in references.lines().filter_map(entry) {
        if uses.insert(entry, 0).is_some() {
            complaints.push(format!("{REFERENCES}: [{entry}] has two entries"));
        }
    }
    for Source { path, text } in sources {
        for (number, line) in text.lines().enumerate() {
            for key in keys(line) {
                match uses.get_mut(key) {
                    Some(count) => *count += 1,
                    None => {
                        let line = number + 1;
                        complaints.push(format!("{path}:{line}: [{key}] is not in {REFERENCES}"));
                    }
                }
            }
        }
    }
    let unused = uses.iter().filter(|(_, count)| **count == 0);
    complaints.extend(unused.map(|(key, _)| format!("{REFERENCES}: nothing uses [{key}]")));
    complaints
}

/// The key of an entry, whose heading is `## [KEY]`.
fn entry(line: &str) -> Option<&str> {
    keys(line.strip_prefix("## ")?).next()
}

/// The keys that stand in brackets on a line.
fn keys(line: &str) -> impl Iterator<Item = &str> {
    let bracketed = line.split('[').skip(1).filter_map(|rest| rest.split_once(']'));
    bracketed.map(|(text, _)| text).filter(|text| is_key(text))
}

/// Initials of the authors, a plus if there are more, and two digits of the year.
fn is_key(text: &str) -> bool {
    let Some((authors, year)) = text.len().checked_sub(2).and_then(|at| text.split_at_checked(at))
    else {
        return false;
    };
    let authors = authors.strip_suffix('+').unwrap_or(authors);
    (2..=5).contains(&authors.len())
        && authors.starts_with(|c: char| c.is_ascii_uppercase())
        && authors.bytes().all(|byte| byte.is_ascii_alphabetic())
        && year.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_told_from_other_brackets() {
        let line =
            r"As in \[AB12], [CDE+09] and [Xyz11]; not a[i32], [x](y), [12], [A99 or [AB1é].";
        assert_eq!(keys(line).collect::<Vec<_>>(), ["AB12", "CDE+09", "Xyz11"]);
    }

    #[test]
    fn both_ways_are_checked() {
        let text = "//! A test [AB12].\n//! Another [EF34].\n".to_owned();
        let source = Source { path: "a.rs".to_owned(), text };
        let complaints = compare("## [AB12]\n## [CD56]\n", &[source]);
        let expected =
            ["a.rs:2: [EF34] is not in REFERENCES.md", "REFERENCES.md: nothing uses [CD56]"];
        assert_eq!(complaints, expected);
    }
}
