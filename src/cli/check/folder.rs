//! `belvedere check --all`: a line for each robot, model and world of a folder.

mod search;

use super::{CheckArgs, counts, diagnose};
use crate::cli::error::CliError;
use crate::cli::follow::print_line;
use crate::cli::log::status_lines;
use crate::description::diagnostics::Source;
use crate::description::load::{LoadOptions, is_world, xacro_argument};
use crate::description::model_index::ModelIndex;
use crate::description::xacro::{self, Element};
use crate::description::xml::read_text;
use crate::description::{Diagnostics, Problem};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use search::{Found, config_error, search};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Longest time to check one file. The readers' own limits end nearly every long check earlier.
const PATIENCE: Duration = Duration::from_secs(60);
/// Stack size of the thread that checks a file; the command has the same.
const STACK: usize = 8 << 20;
/// Widest column of file names. Longer names shift the rest of their line.
const WIDEST: usize = 80;

/// The kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Robot,
    Model,
    World,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Model => "model",
            Self::World => "world",
        }
    }
}

/// The result of checking a file.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Outcome {
    /// It can be run. The text gives the number of warnings and notes.
    Runs(String),
    /// It has no links of its own, because it is included by other files.
    MacrosOnly,
    /// It cannot be run. The text is the first error.
    Fails(String),
}

/// Checks the files of a folder, and prints a line for each and their counts.
///
/// # Errors
/// If there is no such folder, if it has no file to check, or if a file has errors; failures of standard output.
pub(super) fn check_all(folder: &Path, args: &CheckArgs) -> Result<(), CliError> {
    let mut job = Job::of(folder, args)?;
    let Found { files, models } =
        search(folder).map_err(|source| CliError::Input { path: folder.to_owned(), source })?;
    job.options.packages = job.options.packages.with_models(ModelIndex::new(models));
    if files.is_empty() {
        let what = "there is no .urdf, .xacro, .sdf or .world file in this folder";
        return Err(problem(folder, what, "name the folder that has robots, models or worlds"));
    }
    let names: Vec<String> = files.iter().map(|file| below(folder, file)).collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or_default().min(WIDEST);
    let bar = progress(files.len());
    print_line(&format!("{:<width$}  KIND   RESULT", "FILE"))?;
    let mut counted: BTreeMap<&str, usize> = BTreeMap::new();
    let mut failed = 0;
    in_order(&files, &job, |index, kind, outcome| {
        let (result, count) = match outcome {
            Outcome::Runs(counts) if counts == "no problems" => ("ok".to_owned(), "ok"),
            Outcome::Runs(counts) => {
                let counts = counts.trim_start_matches("no errors, ").to_owned();
                let has_warnings = counts.contains("warning");
                (counts, if has_warnings { "with warnings" } else { "with notes" })
            }
            Outcome::MacrosOnly => ("macros only".to_owned(), "macros only"),
            Outcome::Fails(error) => {
                failed += 1;
                (format!("error: {}", paths_below(folder, &error)), "failed")
            }
        };
        *counted.entry(count).or_default() += 1;
        bar.inc(1);
        let name = &names[index];
        status_lines().suspend(|| print_line(&format!("{name:<width$}  {:<5}  {result}", kind.name())))
    })?;
    bar.finish_and_clear();
    let counts = ["ok", "with notes", "with warnings", "macros only", "failed"]
        .iter()
        .filter_map(|what| Some(format!("{} {what}", counted.get(what)?)));
    print_line("")?;
    for choice in choices(folder, &job) {
        print_line(&choice)?;
    }
    let plural = if files.len() == 1 { "file" } else { "files" };
    print_line(&format!("{} {plural}: {}", files.len(), counts.collect::<Vec<_>>().join(", ")))?;
    if failed > 0 {
        return Err(CliError::FilesFail { failed, files: files.len() });
    }
    Ok(())
}

/// Says, for each model that was looked up and is in several folders, which of them was used.
fn choices(folder: &Path, job: &Job) -> Vec<String> {
    let choices = job.options.packages.models().map(ModelIndex::choices).unwrap_or_default();
    let say = |(name, folders): (String, Vec<&Path>)| {
        let shown: Vec<String> = folders.iter().map(|model| below(folder, model)).collect();
        let (used, others) = shown.split_first()?;
        Some(format!(
            "note: model://{name} is {used}, the first in alphabetical order, and not {}; to use another one, add the \
             folder that contains it with --package-path or GAZEBO_MODEL_PATH",
            others.join(", ")
        ))
    };
    choices.into_iter().filter_map(say).collect()
}

/// The arguments and options with which each file is checked. Packages are searched only once.
#[derive(Clone)]
struct Job {
    args: CheckArgs,
    options: LoadOptions,
}

impl Job {
    /// Creates the job for a folder, which is also searched for packages.
    fn of(folder: &Path, args: &CheckArgs) -> Result<Self, CliError> {
        let mut args = CheckArgs { all: None, ..args.clone() };
        // A xacro argument may be in the position of the file.
        if let Some(file) = args.file.take() {
            let argument = file.to_str().and_then(|text| xacro_argument(text).ok());
            let Some(argument) = argument else {
                let what = format!("'{}' is given together with --all", file.display());
                return Err(problem(Path::new("the command line"), &what, "leave one of them out"));
            };
            args.simulated.robots.add_argument(argument);
        }
        args.simulated.add_package_folder(folder.to_owned());
        let options = LoadOptions {
            packages: args.simulated.packages(),
            rules: args.simulated.rules(),
            xacro_args: args.simulated.robots.xacro_args().to_vec(),
        };
        Ok(Self { args, options })
    }
}

fn problem(place: &Path, what: &str, remedy: &str) -> CliError {
    let mut diagnostics = Diagnostics::default();
    diagnostics.error(&Source::new(place, 0), what, remedy);
    CliError::Description(diagnostics.errors().cloned().collect())
}

/// Returns a progress bar, which is hidden if standard error is not a terminal.
fn progress(files: usize) -> ProgressBar {
    let bar = if std::io::stderr().is_terminal() {
        status_lines().add(ProgressBar::new(files as u64))
    } else {
        ProgressBar::with_draw_target(Some(files as u64), ProgressDrawTarget::hidden())
    };
    let style = "{bar:30} {pos}/{len} files, {elapsed} elapsed, {eta} left";
    bar.with_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Returns the path of a file relative to a folder.
fn below(folder: &Path, file: &Path) -> String {
    file.strip_prefix(folder).unwrap_or(file).display().to_string()
}

/// Returns a text in which the paths below a folder are relative to it, as in the column of files.
fn paths_below(folder: &Path, text: &str) -> String {
    let absolute = std::path::absolute(folder).unwrap_or_default();
    let mut text = text.to_owned();
    for folder in [&absolute, folder] {
        let folder = folder.display().to_string();
        let prefix = format!("{}/", folder.trim_end_matches('/'));
        if prefix != "/" {
            text = without_prefix(&text, &prefix);
        }
    }
    text
}

/// Removes the beginning of each path that begins so; one that has the same characters inside is left as it is.
fn without_prefix(text: &str, prefix: &str) -> String {
    let begins =
        |before: &str| before.chars().next_back().is_none_or(|c| c.is_whitespace() || "'\"(=".contains(c));
    let mut kept = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(prefix) {
        kept.push_str(before);
        if !begins(&kept) {
            kept.push_str(prefix);
        } else if after.is_empty() || after.starts_with([',', ';', '\'', ')', ' ']) {
            // The folder itself.
            kept.push('.');
        }
        rest = after;
    }
    kept + rest
}

/// Checks files on all cores, and passes the results to `done` in the order of the files.
fn in_order(
    files: &[PathBuf],
    job: &Job,
    mut done: impl FnMut(usize, Kind, Outcome) -> Result<(), CliError>,
) -> Result<(), CliError> {
    let next = AtomicUsize::new(0);
    let workers = thread::available_parallelism().map_or(1, usize::from).min(files.len());
    thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for _ in 0..workers {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                while let Some((index, file)) = Some(next.fetch_add(1, Ordering::Relaxed))
                    .and_then(|index| Some((index, files.get(index)?)))
                {
                    let (kind, outcome) = check_isolated(file, job);
                    if send.send((index, kind, outcome)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        let mut waiting = BTreeMap::new();
        let mut turn = 0;
        for (index, kind, outcome) in receive {
            waiting.insert(index, (kind, outcome));
            while let Some((kind, outcome)) = waiting.remove(&turn) {
                done(turn, kind, outcome)?;
                turn += 1;
            }
        }
        Ok(())
    })
}

/// Checks a file in a separate thread, so that a panic or a very slow file does not affect the others.
fn check_isolated(file: &Path, job: &Job) -> (Kind, Outcome) {
    let (send, receive) = mpsc::channel();
    let (path, job) = (file.to_owned(), job.clone());
    let work = move || {
        let kind = kind_of(&path, &job);
        // Sent first, so that the kind is known even if the check never ends.
        let _ = send.send((kind, None));
        let outcome = catch_unwind(AssertUnwindSafe(|| check_file(kind, &path, &job)));
        let outcome = outcome.unwrap_or_else(|panic| {
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no words");
            Outcome::Fails(format!("belvedere panics ({words}); please report this file"))
        });
        let _ = send.send((kind, Some(outcome)));
    };
    let fails = |what: String| (Kind::Robot, Outcome::Fails(what));
    if let Err(error) = thread::Builder::new().stack_size(STACK).spawn(work) {
        return fails(format!("cannot start a thread to check it: {error}; end other programs"));
    }
    let mut kind = Kind::Robot;
    loop {
        match receive.recv_timeout(PATIENCE) {
            Ok((known, None)) => kind = known,
            Ok((kind, Some(outcome))) => return (kind, outcome),
            Err(_) => {
                let what = format!("checking it takes more than {} s", PATIENCE.as_secs());
                return (kind, Outcome::Fails(what));
            }
        }
    }
}

fn kind_of(file: &Path, job: &Job) -> Kind {
    let extension = file.extension().unwrap_or_default();
    if file.file_name().is_some_and(|name| name == "model.config") {
        Kind::Model
    } else if is_world(file, &job.options) {
        Kind::World
    } else if extension.eq_ignore_ascii_case("sdf") || extension.eq_ignore_ascii_case("world") {
        Kind::Model
    } else {
        Kind::Robot
    }
}

fn check_file(kind: Kind, file: &Path, job: &Job) -> Outcome {
    if let Some(error) =
        (file.extension().is_some_and(|it| it == "config")).then(|| config_error(file)).flatten()
    {
        return Outcome::Fails(error);
    }
    if kind == Kind::Robot && has_only_macros(file, &job.options) {
        return Outcome::MacrosOnly;
    }
    let mut args = CheckArgs { file: Some(file.to_owned()), ..job.args.clone() };
    args.simulated.be_alone(kind == Kind::World);
    let mut diagnostics = Diagnostics::default();
    diagnose(&args, &job.options.packages, &mut diagnostics);
    match diagnostics.errors().next() {
        Some(error) => Outcome::Fails(first_line(error)),
        None => Outcome::Runs(counts(&diagnostics)),
    }
}

fn first_line(problem: &Problem) -> String {
    problem.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Returns true if a xacro file has no links, because it is meant to be included by other files. If it cannot be
/// expanded by itself, because it needs their definitions, this is the case if it has only macros and other xacro
/// directives.
fn has_only_macros(file: &Path, options: &LoadOptions) -> bool {
    let Ok(written) = Element::parse_file(file) else { return false };
    let is_xacro = file.extension().is_some_and(|extension| extension == "xacro")
        || read_text(file).is_ok_and(|text| text.contains("xmlns:xacro"));
    if !is_xacro || written.name == "sdf" {
        return false;
    }
    let mut diagnostics = Diagnostics::default();
    if let Ok(expanded) = xacro::expand(file, &options.packages, &options.xacro_args, &mut diagnostics) {
        return expanded.child("link").is_none();
    }
    let plain = |element: &Element| element.name.trim_start_matches("xacro:").to_owned();
    let is_directive =
        |element: &Element| ["macro", "property", "arg", "include"].contains(&plain(element).as_str());
    written.elements().all(is_directive) && written.elements().any(|element| plain(element) == "macro")
}
