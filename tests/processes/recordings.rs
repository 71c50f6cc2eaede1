//! Code that the tests of recordings and replays share: a recorded run, and reading of files.

use crate::live::{PATIENCE, output, own_domain};
use belvedere::recording::{Item, RecordedFrame, RecordingError, RecordingReader};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A child process, which is stopped when dropped.
pub(crate) struct Process(pub(crate) Child);

impl Process {
    pub(crate) fn start(command: &mut Command) -> Self {
        Self(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    /// Waits for its end, and returns its exit code and standard error.
    pub(crate) fn end(mut self) -> (Option<i32>, String) {
        let started = Instant::now();
        while self.0.try_wait().unwrap().is_none() {
            assert!(started.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(5));
        }
        let mut errors = String::new();
        self.0.stderr.as_mut().unwrap().read_to_string(&mut errors).unwrap();
        (self.0.wait().unwrap().code(), errors)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Reads a recording from its beginning, without its index; see [`read_all`].
pub(crate) fn read(bytes: &[u8]) -> (Vec<Item>, Option<RecordingError>) {
    read_all(RecordingReader::new(bytes))
}

/// Returns everything that can be read from a recording, and the error at its end, if any.
pub(crate) fn read_all<R: Read>(mut reader: RecordingReader<R>) -> (Vec<Item>, Option<RecordingError>) {
    let mut items = Vec::new();
    loop {
        match reader.next_item() {
            Ok(Some(item)) => items.push(item),
            Ok(None) => return (items, None),
            Err(error) => return (items, Some(error)),
        }
    }
}

pub(crate) fn frames(items: &[Item]) -> BTreeMap<&str, Vec<&RecordedFrame>> {
    let mut frames: BTreeMap<&str, Vec<&RecordedFrame>> = BTreeMap::new();
    for item in items {
        if let Item::Frame(frame) = item {
            frames.entry(&frame.topic).or_default().push(frame);
        }
    }
    frames
}

pub(crate) fn messages(items: &[Item]) -> BTreeMap<(&str, &str), Vec<&[u8]>> {
    let mut messages: BTreeMap<(&str, &str), Vec<&[u8]>> = BTreeMap::new();
    for item in items {
        if let Item::Message(message) = item {
            messages.entry((&message.topic, &message.type_name)).or_default().push(&message.data);
        }
    }
    messages
}

pub(crate) fn info(path: &Path) -> Value {
    let shown = output(&["info", path.to_str().unwrap(), "--json"]);
    serde_json::from_slice(&shown.stdout).unwrap()
}

/// Runs the simulator for this many simulated seconds and records it; returns the output of `--hash`.
pub(crate) fn record_a_run(path: &Path, seconds: &str) -> BTreeMap<String, (String, u64)> {
    record_a_run_as(path, seconds, "ros1")
}

/// The same with messages of this profile.
pub(crate) fn record_a_run_as(path: &Path, seconds: &str, profile: &str) -> BTreeMap<String, (String, u64)> {
    let path = path.to_str().unwrap();
    let domain = own_domain();
    let run =
        ["run", "--domain", &domain, "--rate", "max", "--duration", seconds, "--hash", "--record", path];
    let run = output(&[&run[..], &["--profile", profile]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    let lines = text.lines().filter_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [hash, topic, count, "frames"] => {
                Some((topic.to_owned(), (hash.to_owned(), count.parse().unwrap())))
            }
            _ => None,
        }
    });
    lines.collect()
}
