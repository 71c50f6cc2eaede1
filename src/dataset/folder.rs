//! [`Folder`]: the folder of a data set, with its plan's identity, its shards, and the manifest of all of them.

use super::plan::{Identity, Plan, hex};
use super::shard::{sweep, write_whole};
use super::{DatasetError, making::Making};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// The file that identifies the plan of the shards.
const IDENTITY: &str = "plan.json";
const MANIFEST: &str = "manifest.json";
/// The file that shows some samples in one picture.
pub(super) const CONTACT_SHEET: &str = "contact_sheet.png";

/// The folder of a data set.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

/// The manifest of a complete data set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name and version of the program that made it.
    pub generator: String,
    /// SHA-256 of the plan.
    pub plan_sha256: String,
    /// Number of samples in all shards.
    pub samples: u64,
    /// The shards in order.
    pub shards: Vec<ShardEntry>,
}

/// A shard of a manifest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardEntry {
    /// Name of its file.
    pub name: String,
    /// Number of its samples.
    pub samples: u64,
    /// Length of the file.
    pub bytes: u64,
    /// SHA-256 of the file.
    pub sha256: String,
}

impl Folder {
    /// Opens the folder for the shards of a plan, and creates it if it does not exist.
    ///
    /// # Errors
    /// If it cannot be written, or contains shards of another plan.
    pub fn open(path: &Path, plan: &Plan) -> Result<Self, DatasetError> {
        let failed = |source| DatasetError::Output { path: path.to_owned(), source };
        fs::create_dir_all(path).map_err(failed)?;
        let folder = Self { path: path.to_owned() };
        let file = path.join(IDENTITY);
        // The plan may change as long as there are no shards.
        if !file.is_file() || folder.is_empty() {
            let text = serde_json::to_string_pretty(&plan.identity).unwrap_or_default() + "\n";
            write_whole(&file, text.as_bytes())?;
        }
        // Another process may have written it first.
        let bytes = fs::read(&file).map_err(|source| DatasetError::Input { path: file.clone(), source })?;
        let there: Identity = serde_json::from_slice(&bytes)
            .map_err(|error| DatasetError::Damaged { path: file, what: error.to_string() })?;
        if there == plan.identity {
            return Ok(folder);
        }
        let wanted = &plan.identity;
        let what = if there.generator != wanted.generator {
            format!("they were made by {}, this is {}", there.generator, wanted.generator)
        } else if there.plan != wanted.plan {
            format!("{} has changed", plan.source.display())
        } else {
            format!("these files have changed: {}", wanted.changed(&there).join(", "))
        };
        Err(DatasetError::OtherPlan { folder: path.to_owned(), what })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the path of a shard.
    pub fn shard(&self, shard: u64) -> PathBuf {
        self.path.join(shard_name(shard))
    }

    /// Returns true if a shard exists, which is then complete.
    pub fn has(&self, shard: u64) -> bool {
        self.shard(shard).is_file()
    }

    /// Returns true if there are no shards.
    fn is_empty(&self) -> bool {
        let mut entries = fs::read_dir(&self.path).into_iter().flatten().flatten();
        !entries.any(|entry| entry.file_name().to_string_lossy().starts_with("shard-"))
    }

    /// Removes temporary files of killed processes for a shard that exists now.
    pub(super) fn sweep(&self, shard: u64) {
        sweep(&self.path, &shard_name(shard));
    }

    /// Writes the manifest of a plan's shards, all of which must exist; returns it with its path.
    ///
    /// # Errors
    /// If a shard cannot be read, or does not match an earlier manifest, or the manifest cannot be written.
    pub fn finish(&self, plan: &Plan, making: &dyn Making) -> Result<(Manifest, PathBuf), DatasetError> {
        let mut shards = Vec::new();
        for shard in 0..plan.shards() {
            if making.is_stopped() {
                return Err(DatasetError::Stopped);
            }
            let path = self.shard(shard);
            let (bytes, sha256) =
                hash_file(&path).map_err(|source| DatasetError::Input { path: path.clone(), source })?;
            let range = plan.samples_of(shard);
            let entry =
                ShardEntry { name: shard_name(shard), samples: range.end - range.start, bytes, sha256 };
            shards.push(entry);
        }
        let manifest = Manifest {
            generator: plan.identity.generator.clone(),
            plan_sha256: plan.identity.plan.clone(),
            samples: plan.samples(),
            shards,
        };
        let path = self.path.join(MANIFEST);
        if let Some(before) =
            fs::read(&path).ok().and_then(|bytes| serde_json::from_slice::<Manifest>(&bytes).ok())
        {
            let changed = before.shards.iter().zip(&manifest.shards).find(|(before, now)| before != now);
            if let Some((before, now)) = changed {
                let what = format!("its SHA-256 is {}, {MANIFEST} has {}", now.sha256, before.sha256);
                return Err(DatasetError::Damaged { path: self.path.join(&now.name), what });
            }
        }
        let text = serde_json::to_string_pretty(&manifest).unwrap_or_default() + "\n";
        write_whole(&path, text.as_bytes())?;
        // All shards exist, so remaining temporary files belong to killed processes.
        for begin in ["shard-", IDENTITY, MANIFEST, CONTACT_SHEET] {
            sweep(&self.path, begin);
        }
        Ok((manifest, path))
    }
}

fn shard_name(shard: u64) -> String {
    format!("shard-{shard:06}.tar")
}

/// Returns length and SHA-256 of a file.
fn hash_file(path: &Path) -> io::Result<(u64, String)> {
    let mut file = File::open(path)?;
    let (mut hash, mut len) = (Sha256::new(), 0);
    let mut buffer = vec![0; 1 << 20];
    loop {
        let count = file.read(&mut buffer)?;
        if count == 0 {
            return Ok((len, hex(&hash.finalize())));
        }
        hash.update(&buffer[..count]);
        len += count as u64;
    }
}
