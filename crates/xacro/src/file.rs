//! Reading of files that other files name.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;
/// Most bytes that are read of what has no size, such as a pipe or a device: a file may name `/dev/zero`.
const LARGEST_STREAM: u64 = 1 << 24;
/// How long a pipe may give nothing while somebody has it open for writing.
const PATIENCE: Duration = Duration::from_secs(60);
/// The beginning of a pointer of Git LFS, a short text in place of a large file that was not downloaded.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";
/// The largest pointer, bytes.
const LARGEST_POINTER: usize = 1024;
/// The error for a pointer.
const IS_POINTER: &str = "it is a pointer of Git LFS, and not the file itself";
/// Time between two looks into a pipe.
const NAP: Duration = Duration::from_millis(5);

/// Reads a whole file.
///
/// # Errors
/// If it cannot be read, or is larger than a gigabyte; if it is a pipe that nobody writes into, or a pointer of Git LFS.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return read_stream(path);
    }
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size.min(LARGEST) as usize)?;
    file.take(LARGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() <= LARGEST_POINTER && bytes.starts_with(LFS_POINTER) {
        return Err(io::Error::other(IS_POINTER));
    }
    within(bytes, LARGEST)
}

/// Returns what the user can do about an error of [`read`].
pub fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::IsADirectory => "name a file in it",
        io::ErrorKind::PermissionDenied => "check the file's permissions",
        io::ErrorKind::Other if error.to_string() == IS_POINTER => "run git lfs pull in its repository",
        _ => "name another file",
    }
}

/// Returns why nothing can be read at a path, unless the reason is that nothing is there: the system's error, such as that
/// of a symbolic link that leads to itself, or where a broken link leads.
pub fn obstacle(path: &Path) -> Option<String> {
    let error = std::fs::metadata(path).err()?;
    if error.kind() != io::ErrorKind::NotFound {
        return Some(error.to_string());
    }
    let target = std::fs::read_link(path).ok()?;
    Some(format!("it is a symbolic link to {}, which does not exist", target.display()))
}

/// Returns true if something is at a path, also what cannot be read.
pub fn is_there(path: &Path) -> bool {
    path.exists() || obstacle(path).is_some()
}

/// Lists the places where a file was looked for, each once, as part of a sentence.
pub fn list(places: &[PathBuf]) -> String {
    let mut listed: Vec<String> = Vec::new();
    for place in places {
        let text = match obstacle(place) {
            Some(why) => format!("{} ({why})", place.display()),
            None => place.display().to_string(),
        };
        if !listed.contains(&text) {
            listed.push(text);
        }
    }
    listed.join(", ")
}

/// Returns a sentence about a file that is needed, and is not at its place.
pub fn lacking(path: &Path) -> String {
    match obstacle(path) {
        Some(why) => format!("the file {} cannot be read: {why}", path.display()),
        None => format!("there is no file {}", path.display()),
    }
}

/// Reads a pipe or a device to its end.
fn read_stream(path: &Path) -> io::Result<Vec<u8>> {
    let mut stream = open_without_waiting(path)?;
    let (mut bytes, mut part) = (Vec::new(), vec![0; 1 << 16]);
    let mut waited = Duration::ZERO;
    while bytes.len() as u64 <= LARGEST_STREAM {
        match stream.read(&mut part) {
            Ok(0) if bytes.is_empty() => {
                return Err(io::Error::other("it is empty, or a pipe that nobody writes into"));
            }
            Ok(0) => break,
            Ok(count) => {
                bytes.extend_from_slice(&part[..count]);
                waited = Duration::ZERO;
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock && waited < PATIENCE => {
                std::thread::sleep(NAP);
                waited += NAP;
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                return Err(io::Error::other(format!("nothing came out of it for {} s", PATIENCE.as_secs())));
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    within(bytes, LARGEST_STREAM)
}

fn within(bytes: Vec<u8>, most: u64) -> io::Result<Vec<u8>> {
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("it has more than {} MB", most >> 20)));
    }
    Ok(bytes)
}

/// Opens a pipe even if nobody has it open for writing, which otherwise would wait for a writer, without end.
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64")))]
fn open_without_waiting(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt as _;
    /// The flag `O_NONBLOCK` of these systems.
    const NONBLOCK: i32 = 0o4000;
    File::options().read(true).custom_flags(NONBLOCK).open(path)
}

#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"))))]
fn open_without_waiting(path: &Path) -> io::Result<File> {
    File::open(path)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_pointer_of_git_lfs_is_not_taken_for_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.stl");
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
        std::fs::write(&path, pointer).unwrap();
        let error = read(&path).unwrap_err();
        assert_eq!(error.to_string(), "it is a pointer of Git LFS, and not the file itself");
        assert_eq!(remedy(&error), "run git lfs pull in its repository");
        std::fs::write(&path, format!("{pointer}{}", " ".repeat(1024))).unwrap();
        assert!(read(&path).is_ok());
    }

    /// A pipe without a writer is an error at once; of one with a slow writer, everything is read.
    #[test]
    fn a_pipe_is_read_only_while_somebody_writes_into_it() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = read(&pipe).unwrap_err().to_string();
        assert!(error.contains("a pipe that nobody writes into"), "{error}");
        let mut writer = Command::new("sh")
            .args([
                "-c",
                "exec 3<>\"$1\"; sleep 0.3; printf one >&3; sleep 0.3; printf two >&3; sleep 0.1",
                "sh",
            ])
            .arg(&pipe)
            .spawn()
            .unwrap();
        // Until the writer has opened it, the pipe has none.
        let bytes = std::iter::repeat_with(|| read(&pipe)).find_map(Result::ok).unwrap();
        assert_eq!(bytes, b"onetwo");
        assert!(writer.wait().unwrap().success());
    }
}
