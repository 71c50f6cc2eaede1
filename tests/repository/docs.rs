//! The pages of the documentation: every link has a target, every page is in the book.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders with files of others, or with build output.
const NOT_OURS: [&str; 5] = ["target", "build", "node_modules", ".git", ".venv"];

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && !NOT_OURS.contains(&name) {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

/// The text without code blocks and inline code, in which a bracket is not a link.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            prose.extend(line.split('`').step_by(2));
            prose.push('\n');
        }
    }
    prose
}

/// The targets of links: the content of `](…)`.
fn targets(prose: &str) -> impl Iterator<Item = &str> {
    prose.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target)
}

/// The anchors that GitHub generates for headings.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        is_code ^= line.trim_start().starts_with("```");
        if is_code || !line.starts_with('#') {
            continue;
        }
        let heading = line.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        found.insert(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
    }
    found
}

#[test]
fn every_link_has_a_target() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    pages(root, &mut all);
    let (mut count, mut broken) = (0, Vec::new());
    for page in &all {
        let text = fs::read_to_string(page).unwrap();
        for target in targets(&prose(&text)) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() { page.clone() } else { page.parent().unwrap().join(path) };
            let is_there = file.exists()
                && (anchor.is_empty()
                    || fs::read_to_string(&file).is_ok_and(|text| anchors(&text).contains(anchor)));
            if !is_there {
                broken.push(format!("{}: {target}", page.strip_prefix(root).unwrap().display()));
            }
        }
    }
    assert!(broken.is_empty(), "links without a target:\n{}", broken.join("\n"));
    assert!(count > 100, "only {count} links were found, so they are not parsed correctly");
}

#[test]
fn every_page_is_in_the_book() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let listed: BTreeSet<_> = targets(&summary).map(str::to_owned).collect();
    let mut there = Vec::new();
    pages(&docs, &mut there);
    let there: BTreeSet<_> = there
        .iter()
        .map(|page| page.strip_prefix(&docs).unwrap().to_str().unwrap().to_owned())
        .filter(|page| page != "SUMMARY.md")
        .collect();
    assert_eq!(listed, there);
}

/// The pages list every robot and world that comes with the program, and the gallery shows each.
#[test]
fn every_shipped_robot_and_world_is_shown() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let gallery = fs::read_to_string(root.join("docs/gallery.md")).unwrap();
    for (folder, ending, page) in [
        ("models/turtlebot_description/robots", ".urdf.xacro", "docs/robots.md"),
        ("models/worlds", ".world", "docs/worlds.md"),
    ] {
        let page_text = fs::read_to_string(root.join(page)).unwrap();
        let files = fs::read_dir(root.join(folder)).unwrap().map(|file| file.unwrap().file_name());
        let files: Vec<String> = files.map(|file| file.into_string().unwrap()).collect();
        let names: Vec<&str> = files.iter().filter_map(|file| file.strip_suffix(ending)).collect();
        assert!(!names.is_empty());
        for name in names {
            assert!(page_text.contains(&format!("| `{name}`")), "{page} has no row for {name}");
            assert!(gallery.contains(&format!("gallery/{name}.jpg")), "docs/gallery.md does not show {name}");
        }
    }
}
