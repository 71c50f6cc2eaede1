//! Reading of files that other files name.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

/// The largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;
/// Most bytes that are read of what has no size, such as a pipe or a device: a file may name `/dev/zero`.
const LARGEST_STREAM: u64 = 1 << 24;

/// Reads a whole file.
///
/// # Errors
/// If it cannot be read, or is larger than a gigabyte.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let about = file.metadata()?;
    let most = if about.is_file() { LARGEST } else { LARGEST_STREAM };
    let mut bytes = Vec::new();
    if about.is_file() {
        bytes.try_reserve_exact(about.len().min(most) as usize)?;
    }
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("it has more than {} MB", most >> 20)));
    }
    Ok(bytes)
}
