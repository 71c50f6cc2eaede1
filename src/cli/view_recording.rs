//! [`RecordingToView`]: a recording that is played in this process and shown on the page, with the models stored in it.

use super::error::CliError;
use super::follow::stop_wanted;
use super::replay::open;
use super::shown::Shown;
use crate::description::load::{load_model_text, load_world_text};
use crate::description::package::PackagePath;
use crate::description::{Diagnostics, Rules};
use crate::recording::{Attachment, Item, Player, PlayerOptions, RecordingError, Timeline};
use crate::simulation::SpawnOptions;
use belvedere_bridge::Node;
use belvedere_sensors::Pose;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A recording that is to be shown.
pub(super) struct RecordingToView {
    path: PathBuf,
    timeline: Arc<Timeline>,
    attachments: Vec<Attachment>,
}

impl RecordingToView {
    /// # Errors
    /// [`CliError::Input`]; [`CliError::Recording`] if the file is not a recording.
    pub(super) fn open(path: &Path) -> Result<Self, CliError> {
        let failed = |source| recording_error("read", path, source);
        // Read first, because this reports files that are not recordings.
        let mut recording = open(path, Duration::ZERO)?;
        let mut attachments = Vec::new();
        loop {
            match recording.next_item() {
                Ok(Some(Item::Attachment(attachment))) => attachments.push(attachment),
                // Attachments come before all messages.
                Ok(None | Some(Item::Message(_) | Item::Frame(_))) | Err(RecordingError::Cut) => break,
                Ok(Some(_)) => {}
                Err(error) => return Err(failed(error)),
            }
        }
        let file = reader(path).map_err(|source| CliError::Input { path: path.to_owned(), source })?;
        let timeline = Arc::new(Timeline::of(file).map_err(failed)?);
        Ok(Self { path: path.to_owned(), timeline, attachments })
    }

    pub(super) fn timeline(&self) -> &Arc<Timeline> {
        &self.timeline
    }

    /// Returns the stored world and robots. Files that they refer to are skipped if they are not found here.
    pub(super) fn models(&self, packages: &PackagePath) -> Shown {
        let rules = Rules { skip_missing: true, ..Rules::default() };
        let (mut world, mut robots) = (None, Vec::new());
        for Attachment { name, data, .. } in &self.attachments {
            let text = String::from_utf8_lossy(data);
            let mut diagnostics = Diagnostics::default();
            if text.contains("<world") {
                world = world.or_else(|| load_world_text(&text, name, packages, rules, &mut diagnostics));
            } else if let Some(mut model) = load_model_text(&text, name, packages, rules, &mut diagnostics) {
                // The file has the name of its robot.
                if let Some(name) = name.strip_suffix(".urdf") {
                    name.clone_into(&mut model.name);
                }
                robots.push((model, text.into_owned()));
            }
            for problem in diagnostics.errors() {
                tracing::warn!("{}: {problem}", self.path.display());
            }
        }
        let is_one = robots.len() == 1;
        let mut descriptions = Vec::new();
        let robots: Vec<_> = robots
            .into_iter()
            .map(|(model, text)| {
                let name = model.name.clone();
                let namespace = if is_one { String::new() } else { name.clone() };
                if text.contains("<robot") {
                    descriptions.push((namespace.clone(), text));
                }
                let world_from_model = Pose::IDENTITY;
                (model, SpawnOptions { name, namespace, world_from_model, is_robot: Some(true) })
            })
            .collect();
        Shown::new(&world.map(|world| world.models).unwrap_or_default(), &robots, descriptions)
    }

    /// Creates a player in place of a simulator.
    ///
    /// # Errors
    /// If the domain has a simulator.
    pub(super) fn player(&self, node: Node) -> Result<Player, CliError> {
        Player::open(
            node,
            PlayerOptions { name: self.path.display().to_string(), ..PlayerOptions::default() },
        )
        .map_err(|source| recording_error("play", &self.path, source))
    }

    /// Plays the recording until the user stops it.
    ///
    /// # Errors
    /// Errors of the player.
    pub(super) fn play(&self, mut player: Player) -> Result<(), CliError> {
        player
            .play_along(&self.timeline, || reader(&self.path), || !stop_wanted())
            .map_err(|source| recording_error("play", &self.path, source))
    }
}

fn reader(path: &Path) -> io::Result<BufReader<File>> {
    Ok(BufReader::with_capacity(1 << 20, File::open(path)?))
}

fn recording_error(action: &'static str, path: &Path, source: RecordingError) -> CliError {
    CliError::Recording { action, path: path.to_owned(), source: Box::new(source) }
}
