//! `belvedere info`: shows the contents of a recording.

use super::error::CliError;
use super::follow::print_line;
use super::replay::open;
use crate::recording::{Attachment, Item, RecordedStream, RecordingError};
use indicatif::HumanBytes;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Show the contents of a recording: how it was made, its streams, and the number of frames of each.
///
/// Reads every byte. If the file was cut off, its complete part is shown, and if it is damaged, all parts that are not;
/// the exit code is 1.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  belvedere info run.mcap\n  belvedere info run.mcap.active --json\n  belvedere info run.mcap --extract description     (the robots and the world of the run)"
)]
pub struct InfoArgs {
    /// The recording
    file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Extract the files stored in the recording into this folder, which is created
    #[arg(long, value_name = "FOLDER")]
    extract: Option<PathBuf>,
}

/// The contents of a recording.
#[derive(Default)]
struct Found {
    about: BTreeMap<String, String>,
    streams: BTreeMap<String, RecordedStream>,
    hashes: BTreeMap<String, String>,
    attachments: Vec<Attachment>,
    /// Type, number and total bytes of the messages, by topic.
    channels: BTreeMap<String, (String, u64, u64)>,
    frames: BTreeMap<String, u64>,
    times_ns: Option<[u64; 2]>,
    /// The damaged parts.
    left_out: Vec<String>,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Recording`] if the file is not a recording, or not complete.
pub fn run(args: &InfoArgs) -> Result<(), CliError> {
    let mut recording = open(&args.file, Duration::ZERO)?;
    let mut found = Found::default();
    let ended = loop {
        match recording.next_item() {
            Ok(Some(item)) => found.add(item),
            Ok(None) => break found.completeness(),
            Err(error) => break Err(error),
        }
    };
    // Before anything is printed, because the reader of standard output may have gone by then.
    if let Some(folder) = &args.extract {
        found.extract(folder)?;
    }
    if !matches!(ended, Err(RecordingError::NotMcap | RecordingError::Io(_))) {
        let bytes = std::fs::metadata(&args.file).map_or(0, |metadata| metadata.len());
        if args.json {
            print_line(&found.json(recording.library(), bytes, ended.is_ok()).to_string())?;
        } else {
            print_line(found.text(recording.library(), bytes).trim_end())?;
        }
    }
    for what in &found.left_out {
        tracing::warn!("{}: {what}", args.file.display());
    }
    ended.map_err(|source| CliError::Recording {
        action: "read all of",
        path: args.file.clone(),
        source: Box::new(source),
    })
}

impl Found {
    /// Returns an error if parts were left out.
    fn completeness(&self) -> Result<(), RecordingError> {
        let parts = match self.left_out.len() {
            0 => return Ok(()),
            1 => "1 part is".to_owned(),
            number => format!("{number} parts are"),
        };
        Err(RecordingError::Damaged { parts })
    }

    fn add(&mut self, item: Item) {
        match item {
            Item::About(about) => self.about = about,
            Item::Hashes(hashes) => self.hashes = hashes,
            Item::Attachment(attachment) => self.attachments.push(attachment),
            Item::Stream(stream) => {
                self.streams.insert(stream.topic.clone(), stream);
            }
            Item::Message(message) => {
                let channel = self.channels.entry(message.topic).or_default();
                channel.0 = message.type_name;
                channel.1 += 1;
                channel.2 += message.data.len() as u64;
                self.cover(message.log_time_ns);
            }
            Item::LeftOut(what) => self.left_out.push(what),
            Item::Frame(frame) => {
                *self.frames.entry(frame.topic).or_default() += 1;
                self.cover(frame.log_time_ns);
            }
        }
    }

    /// Writes the files stored in the recording. Existing files are not replaced.
    fn extract(&self, folder: &Path) -> Result<(), CliError> {
        let failed = |path: &Path, source| CliError::Output { path: path.to_owned(), source };
        std::fs::create_dir_all(folder).map_err(|source| failed(folder, source))?;
        for Attachment { name, data, .. } in &self.attachments {
            // The recording may come from others, and the name in it may be any path.
            let Some(name) = Path::new(name).file_name() else { continue };
            let path = folder.join(name);
            let mut file = std::fs::File::create_new(&path).map_err(|source| failed(&path, source))?;
            file.write_all(data).map_err(|source| failed(&path, source))?;
        }
        Ok(())
    }

    fn cover(&mut self, time_ns: u64) {
        let [first, last] = self.times_ns.unwrap_or([time_ns; 2]);
        self.times_ns = Some([first.min(time_ns), last.max(time_ns)]);
    }

    fn text(&self, library: &str, bytes: u64) -> String {
        let [first, last] = self.times_ns.unwrap_or_default().map(|time_ns| time_ns as f64 * 1e-9);
        let mut lines = vec![format!(
            "{}, {:.3} s of simulated time from {first:.3} s on, written by {library}",
            HumanBytes(bytes),
            last - first
        )];
        lines.extend(self.about.iter().map(|(name, word)| format!("  {name}: {word}")));
        for Attachment { name, media_type, data } in &self.attachments {
            lines.push(format!("  file: {name}, {media_type}, {}", HumanBytes(data.len() as u64)));
        }
        if !self.streams.is_empty() {
            lines.push("streams".to_owned());
        }
        let width = self.streams.keys().map(String::len).max().unwrap_or(0);
        for (topic, stream) in &self.streams {
            let frames = self.frames.get(topic).copied().unwrap_or(0);
            let hash = self.hashes.get(topic).map_or("", String::as_str);
            lines.push(format!("  /{topic:width$}  {:16}  {frames:>8} frames  {hash}", stream.kind));
        }
        lines.push("messages".to_owned());
        let width = self.channels.keys().map(String::len).max().unwrap_or(0);
        for (topic, (type_name, count, bytes)) in &self.channels {
            lines.push(format!("  {topic:width$}  {type_name:26}  {count:>8}  {}", HumanBytes(*bytes)));
        }
        lines.join("\n")
    }

    fn json(&self, library: &str, bytes: u64, is_complete: bool) -> Value {
        let stream = |(topic, stream): (&String, &RecordedStream)| {
            json!({
                "topic": format!("/{topic}"),
                "kind": stream.kind.as_str(),
                "encoding": stream.encoding.as_str(),
                "frames": self.frames.get(topic).copied().unwrap_or(0),
                "hash": self.hashes.get(topic),
            })
        };
        let file = |file: &Attachment| json!({ "name": file.name, "type": file.media_type, "bytes": file.data.len() });
        let channel = |(topic, (type_name, count, bytes)): (&String, &(String, u64, u64))| json!({ "topic": topic, "type": type_name, "messages": count, "bytes": bytes });
        json!({
            "library": library,
            "bytes": bytes,
            "complete": is_complete,
            "left_out": self.left_out,
            "times_ns": self.times_ns,
            "about": self.about,
            "files": self.attachments.iter().map(file).collect::<Vec<_>>(),
            "streams": self.streams.iter().map(stream).collect::<Vec<_>>(),
            "messages": self.channels.iter().map(channel).collect::<Vec<_>>(),
        })
    }
}
