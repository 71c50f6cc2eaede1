//! Makes the tag-ceiling room: its world, models, textures, and the list of the codes' corners.
//!
//! ```text
//! cargo run --example make_tag_room              writes them into models/
//! cargo run --example make_tag_room -- --check   compares; fails if a file differs
//! ```

mod ceiling;
mod codes;
mod floor;
mod output;
mod room;
mod sdf;

use output::Generated;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let check = std::env::args().skip(1).any(|argument| argument == "--check");
    let files = match generate() {
        Ok(files) => files,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let mut failed = false;
    for Generated { path, content } in &files {
        let file = models.join(path);
        let result = if check { content.compare(&file) } else { content.write(&file) };
        if let Err(error) = result {
            eprintln!("{}: {error}", file.display());
            failed = true;
        }
    }
    println!("{} files {}", files.len(), if check { "compared" } else { "written" });
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Generates all files of the room, with paths relative to `models/`.
fn generate() -> Result<Vec<Generated>, qrcode::types::QrError> {
    let codes = codes::all()?;
    let mut files = room::files();
    files.extend(ceiling::files(&codes));
    files.push(floor::file());
    Ok(files)
}
