//! Patterns in the names of files to include: `*`, `?` and `[…]`, as in Python's `glob`.

use crate::fault::Fault;
use std::path::{Component, Path, PathBuf};

/// The greatest number of files that one pattern may match or skip.
const MAX_FILES: usize = 10_000;

/// Returns whether a name is a pattern.
pub(super) fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// Returns the files that match a pattern, in the order of their names.
pub(super) fn matching(pattern: &Path) -> Result<Vec<PathBuf>, Fault> {
    let mut found = vec![PathBuf::new()];
    for component in pattern.components() {
        let name = match component {
            Component::Normal(name) => name.to_string_lossy().into_owned(),
            other => {
                for path in &mut found {
                    path.push(other);
                }
                continue;
            }
        };
        if !is_pattern(&name) {
            for path in &mut found {
                path.push(&name);
            }
            continue;
        }
        let pattern: Vec<char> = name.chars().collect();
        let mut next = Vec::new();
        let mut passed = 0;
        for folder in found {
            let read = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
            for entry in std::fs::read_dir(read).into_iter().flatten().filter_map(Result::ok) {
                let entry = entry.file_name().to_string_lossy().into_owned();
                let is_hidden = entry.starts_with('.') && !name.starts_with('.');
                if !is_hidden && matches(&pattern, &entry.chars().collect::<Vec<_>>()) {
                    next.push(folder.join(&entry));
                }
                passed += 1;
                if passed > MAX_FILES {
                    let what = format!("the pattern '{name}' is compared with more than {MAX_FILES} files");
                    return Err(Fault::new(what, "name a smaller folder"));
                }
            }
        }
        found = next;
    }
    found.retain(|path| path.exists());
    found.sort();
    Ok(found)
}

/// Returns true if a name matches a pattern, backtracking to the last `*` after a mismatch.
fn matches(pattern: &[char], name: &[char]) -> bool {
    let (mut at, mut place) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while place < name.len() {
        if pattern.get(at) == Some(&'*') {
            star = Some((at, place));
            at += 1;
        } else if let Some(length) = one(&pattern[at..], name[place]) {
            at += length;
            place += 1;
        } else if let Some((before, begin)) = star {
            star = Some((before, begin + 1));
            (at, place) = (before + 1, begin + 1);
        } else {
            return false;
        }
    }
    pattern[at..].iter().all(|c| *c == '*')
}

/// Returns the length of the part of a pattern that one character matches.
fn one(pattern: &[char], c: char) -> Option<usize> {
    match pattern.first()? {
        '?' => Some(1),
        '[' => {
            let is_not = pattern.get(1) == Some(&'!');
            let begin = if is_not { 2 } else { 1 };
            // A bracket that comes first belongs to the set.
            let end = pattern.iter().skip(begin + 1).position(|c| *c == ']').map(|at| begin + 1 + at);
            let Some(end) = end else { return (c == '[').then_some(1) };
            let set = &pattern[begin..end];
            let mut at = 0;
            let mut found = false;
            while at < set.len() {
                if at + 2 < set.len() && set[at + 1] == '-' {
                    found |= (set[at]..=set[at + 2]).contains(&c);
                    at += 3;
                } else {
                    found |= set[at] == c;
                    at += 1;
                }
            }
            (found != is_not).then_some(end + 1)
        }
        plain => (*plain == c).then_some(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_python() {
        for (pattern, name, fits) in [
            ("*.xacro", "a.xacro", true),
            ("*.xacro", "a.urdf", false),
            ("a*b*c", "aXbYbZc", true),
            ("a?c", "abc", true),
            ("a?c", "ac", false),
            ("[abc]x", "bx", true),
            ("[!abc]x", "bx", false),
            ("[a-c]x", "bx", true),
            ("[]]", "]", true),
            ("[x", "[x", true),
            ("***", "", true),
            ("*a", "b", false),
        ] {
            let characters = |text: &str| text.chars().collect::<Vec<_>>();
            assert_eq!(matches(&characters(pattern), &characters(name)), fits, "{pattern} {name}");
        }
        let long = "a".repeat(5000);
        let pattern: Vec<char> = "*a*a*a*a*b".chars().collect();
        assert!(!matches(&pattern, &long.chars().collect::<Vec<_>>()));
    }
}
