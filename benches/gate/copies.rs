//! Fresh copies of a program, each run alone.
//!
//! Small kernels are up to 20 % faster or slower depending on where the pages of the executable are in memory, which
//! does not change while the file is in the page cache. A new file with the same bytes has other pages.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// glibc fetches large blocks from the kernel, page by page, and gives them back, until enough of them have been freed:
/// the time of building S3 varied by a tenth with what had been built before it, and so with `--filter`. With these
/// settings it keeps freed memory from the beginning, up to the largest block that its heap allows.
const ALLOCATOR: (&str, &str) =
    ("GLIBC_TUNABLES", "glibc.malloc.mmap_threshold=33554432:glibc.malloc.trim_threshold=1099511627776");

/// Copies `program` into a new folder beside it, runs the copy, waits for it and returns its output.
///
/// The copy and its folder are removed as soon as it runs, so that nothing remains, however the run ends.
///
/// # Errors
/// If it cannot be copied or run, or if it fails. Its own messages go to our standard error.
pub fn run(program: &Path, arguments: &[impl AsRef<OsStr>]) -> Result<String, String> {
    let failed = |error: std::io::Error| format!("{}: a copy cannot be run: {error}", program.display());
    let beside = program.parent().unwrap_or(Path::new("."));
    let folder = tempfile::Builder::new().prefix("copy-").tempdir_in(beside).map_err(failed)?;
    let copy = folder.path().join(program.file_name().unwrap_or(OsStr::new("copy")));
    std::fs::copy(program, &copy).map_err(failed)?;
    let child = start(&copy, arguments).map_err(failed)?;
    // It has been executed when `spawn` returns, and keeps the file's content for as long as it runs.
    folder.close().map_err(failed)?;
    let output = child.wait_with_output().map_err(failed)?;
    if !output.status.success() {
        return Err(format!("{}: a copy ended with {}", program.display(), output.status));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("{}: {error}", program.display()))
}

/// A file cannot be executed while a process that another thread has just forked still has it open for writing.
const BUSY_TRIES: usize = 100;

fn start(copy: &Path, arguments: &[impl AsRef<OsStr>]) -> std::io::Result<Child> {
    let mut command = Command::new(copy);
    command
        .args(arguments)
        .env(ALLOCATOR.0, ALLOCATOR.1)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit());
    for _ in 1..BUSY_TRIES {
        match command.spawn() {
            Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => {
                std::thread::sleep(Duration::from_millis(10));
            }
            other => return other,
        }
    }
    command.spawn()
}
