//! `belvedere snapshot`: saves one frame of a topic as a picture.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use image::{ImageFormat, RgbImage};

use super::{
    error::CliError,
    follow::{
        DomainArgs, listen_for_stop, no_frame, print_line, seconds, stop_wanted, subscribe, with_slash,
    },
};
use crate::picture;

/// Save the next frame of a topic as a picture.
///
/// Images are saved unchanged, depth in colours from near (red) to far (blue), scans as a plan seen from above with a
/// ring every metre and the sensor in the middle, clouds as a depth image or a plan.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  belvedere snapshot /camera/rgb/image_raw picture.png\n  belvedere snapshot scan scan.png --timeout 2"
)]
pub struct SnapshotArgs {
    /// The topic, with or without a leading slash
    pub topic: String,
    /// The file to write: .png, .jpg, .bmp or .tga
    pub output: PathBuf,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub domain: DomainArgs,
    /// Give up if no frame arrives within this number of seconds
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = seconds)]
    pub timeout: Duration,
    /// Wait for the topic if it does not exist yet
    #[arg(long)]
    pub wait: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Format`] and [`CliError::Output`], before anything is written, if the file cannot be written;
/// [`CliError::UnknownTopic`], [`CliError::NoSimulator`], [`CliError::NoFrame`], [`CliError::Picture`].
pub fn run(args: &SnapshotArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let mut output = OutputPicture::create(&args.output)?;
    let mut subscriber = subscribe(&args.domain.domain, &args.topic, args.wait)?;
    let topic = with_slash(&args.topic);
    let deadline = Instant::now() + args.timeout;
    while !stop_wanted() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(no_frame(&subscriber, args.timeout));
        }
        if !subscriber.wait(left.min(Duration::from_millis(200)))? {
            continue;
        }
        let Some(frame) = subscriber.take_newest()? else { continue };
        let picture = picture::draw(&frame.view())
            .map_err(|source| CliError::Picture { topic: topic.clone(), source })?;
        output.save(&picture)?;
        let colours = picture::depth_range(&frame.view())
            .map_or_else(String::new, |[near, far]| format!(", red {near:.2} m to blue {far:.2} m"));
        return print_line(&format!(
            "{topic} at {:.3} s: {} ({} x {}{colours})",
            frame.header().stamp_ns as f64 / 1e9,
            args.output.display(),
            picture.width(),
            picture.height()
        ));
    }
    Ok(())
}

/// A picture file that either is complete or does not exist: it is written under a temporary name, then moved.
#[derive(Debug)]
pub struct OutputPicture {
    path: PathBuf,
    format: ImageFormat,
    /// The temporary file next to `path`; removed on drop unless it was moved.
    temporary: Option<PathBuf>,
}

impl OutputPicture {
    /// Makes sure that `path` can be written, before any other work is done.
    ///
    /// # Errors
    /// [`CliError::Format`] for an unknown extension, [`CliError::Output`] if the file cannot be written.
    pub fn create(path: &Path) -> Result<Self, CliError> {
        let failed = |source| CliError::Output { path: path.to_owned(), source };
        let format = ImageFormat::from_path(path)
            .ok()
            .filter(ImageFormat::writing_enabled)
            .ok_or_else(|| CliError::Format { path: path.to_owned(), formats: ".png, .jpg, .bmp, .tga" })?;
        if path.is_dir() {
            return Err(failed(io::ErrorKind::IsADirectory.into()));
        }
        if fs::metadata(path).is_ok_and(|metadata| metadata.permissions().readonly()) {
            return Err(failed(io::ErrorKind::PermissionDenied.into()));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let temporary = path.with_file_name(format!(".{name}.{}", std::process::id()));
        fs::File::create(&temporary).map_err(failed)?;
        Ok(Self { path: path.to_owned(), format, temporary: Some(temporary) })
    }

    /// Writes the picture and moves it to its path.
    ///
    /// # Errors
    /// [`CliError::Output`]; then no file remains.
    pub fn save(&mut self, picture: &RgbImage) -> Result<(), CliError> {
        let failed = |source| CliError::Output { path: self.path.clone(), source };
        let Some(temporary) = &self.temporary else { return Ok(()) };
        picture
            .save_with_format(temporary, self.format)
            .map_err(|error| match error {
                image::ImageError::IoError(error) => error,
                other => io::Error::other(other),
            })
            .and_then(|()| fs::rename(temporary, &self.path))
            .map_err(failed)?;
        self.temporary = None;
        Ok(())
    }
}

impl Drop for OutputPicture {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            let _ = fs::remove_file(temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_complete_or_absent() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out.png");
        drop(OutputPicture::create(&path).unwrap());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0, "unused, nothing is left");
        OutputPicture::create(&path).unwrap().save(&RgbImage::new(4, 3)).unwrap();
        assert_eq!(image::open(&path).unwrap().width(), 4);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn paths_that_cannot_be_written_are_refused_first() {
        let dir = tempfile::tempdir().unwrap();
        for (name, says) in [("no/such/dir.png", "no/such/dir.png"), ("x.xyz", ".png"), ("none", ".png")] {
            let error = OutputPicture::create(&dir.path().join(name)).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        let folder = dir.path().join("folder.png");
        fs::create_dir(&folder).unwrap();
        assert!(OutputPicture::create(&folder).is_err());
    }
}
