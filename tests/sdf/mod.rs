//! World files written by a test, and the messages of loading them.
#![allow(dead_code, reason = "each test binary uses its own part of this")]

use belvedere::description::load::load_world;
use belvedere::description::model::World;
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere::description::{Problem, Severity};
use glam::DVec3;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with a world file and the files that it refers to.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self, relative: &str) -> PathBuf {
        self.0.path().join(relative)
    }

    pub(crate) fn write(&self, relative: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(relative);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Loads the content of `<world>` in a version of SDF.
    pub(crate) fn load(
        &self,
        version: &str,
        content: &str,
        gazebo_compat: bool,
    ) -> (Option<World>, Vec<Problem>) {
        let text = format!("<sdf version='{version}'><world name='w'>\n{content}\n</world></sdf>");
        let path = self.write("test.world", text);
        load(path.to_str().unwrap(), gazebo_compat)
    }
}

pub(crate) fn load(file_or_name: &str, gazebo_compat: bool) -> (Option<World>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let world = load_world(
        file_or_name,
        &package_path([], None),
        Rules { gazebo_compat, ..Rules::default() },
        &mut diagnostics,
    );
    (world, diagnostics.problems().to_vec())
}

/// Loads content that must have no errors.
pub(crate) fn good(version: &str, content: &str) -> World {
    let (world, problems) = Folder::new().load(version, content, false);
    assert!(problems.is_empty(), "{problems:#?}");
    world.unwrap()
}

/// Asserts that there is a single problem: an error at `test.world:line` that contains all `words`, and has a remedy.
#[track_caller]
pub(crate) fn assert_one_error(problems: &[Problem], line: u32, words: &[&str]) {
    let [problem] = problems else { panic!("expected one error, got {problems:#?}") };
    let text = problem.to_string();
    assert_eq!(problem.severity, Severity::Error, "{text}");
    assert_eq!(problem.source.line, line, "{text}");
    assert!(problem.source.file.ends_with("test.world"), "{text}");
    assert!(!problem.remedy.is_empty(), "no remedy: {text}");
    for word in words {
        assert!(text.contains(word), "'{word}' is not in: {text}");
    }
}

/// Asserts that faulty content gives one error; its line is counted from 1 at the first line of the content.
#[track_caller]
pub(crate) fn assert_bad(version: &str, content: &str, line: u32, words: &[&str]) {
    let (_, problems) = Folder::new().load(version, content, false);
    assert_one_error(&problems, line + 1, words);
}

/// A static model with one link.
pub(crate) fn model(inner: &str) -> String {
    format!("<model name='m'><static>true</static><link name='l'>\n{inner}\n</link></model>")
}

pub(crate) fn visual(inner: &str) -> String {
    model(&format!("<visual name='v'>{inner}</visual>"))
}

pub(crate) fn box_visual(more: &str) -> String {
    visual(&format!("<geometry><box><size>1 1 1</size></box></geometry>\n{more}"))
}

pub(crate) const BOX: &str = "<geometry><box><size>1 1 1</size></box></geometry>";

pub(crate) fn close(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-9, "{a} is not {b}");
}
