//! The `belvedere` command and its subcommands.

mod attachments;
pub mod check;
pub mod control;
pub mod dataset;
mod displays;
pub mod echo;
mod environment;
pub mod error;
pub mod follow;
pub mod hz;
pub mod info;
mod isolated;
#[cfg(feature = "link")]
pub mod link;
pub mod list;
mod live_lines;
pub mod log;
pub mod message;
pub mod models;
pub mod names;
mod pacer;
pub mod place;
pub mod record;
mod recording_thread;
pub mod replay;
mod robot_descriptions;
pub mod robots;
pub mod ros2;
pub mod run;
mod sensor_models;
mod shown;
mod shown_scene;
mod simulated;
pub mod snapshot;
pub mod statistics;
mod status;
mod terminal;
pub mod urdf;
pub mod view;
mod view_recording;

use crate::dataset::DatasetError;
use clap::{CommandFactory as _, Parser, Subcommand};
use clap_complete::Shell;
use error::CliError;
use rustix::process::Resource;
use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

/// A robot sensor simulator: cameras, depth cameras and lidars on the CPU, exact and repeatable, shared with other
/// processes without copying.
///
/// Without a subcommand it starts the simulator: the TurtleBot with its ceiling camera drives a loop in a room whose
/// ceiling is covered with tags, and publishes all its streams until Ctrl-C. Inspect them from a second terminal with
/// `list`, `hz`, `echo` and `snapshot`.
#[derive(Debug, Parser)]
#[command(name = "belvedere", version, args_conflicts_with_subcommands = true)]
#[command(after_help = "Environment:
  TURTLEBOT_BASE, TURTLEBOT_STACKS, TURTLEBOT_3D_SENSOR   choose the robot BASE_STACKS_3D_SENSOR
  TURTLEBOT_GAZEBO_WORLD_FILE                             chooses the world
  ROS_PACKAGE_PATH                                        searched for packages after --package-path
  BELVEDERE_DOMAIN                                        the domain, if --domain is not given
  BELVEDERE_MODELS                                        folder of belvedere's own models, instead of the installed one
  XDG_CACHE_HOME                                          where the models in the program are unpacked, instead of ~/.cache
  RAYON_NUM_THREADS                                       number of threads that render
  ROS_DOMAIN_ID                                           ROS 2's domain, if --ros-domain-id is not given
  RUST_LOG                                                log filter, for example belvedere=debug")]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: run::RunArgs,
}

/// Exit codes, beside the 2 of invalid arguments.
const SUCCESS: u8 = 0;
const FAILURE: u8 = 1;

/// Stack size of a command, in bytes: the usual limit (`ulimit -s`).
const STACK: u64 = 8 << 20;

#[derive(Debug, Subcommand)]
enum Command {
    Run(run::RunArgs),
    List(list::ListArgs),
    Hz(hz::HzArgs),
    Echo(echo::EchoArgs),
    Snapshot(snapshot::SnapshotArgs),
    View(view::ViewArgs),
    Record(record::RecordArgs),
    Replay(replay::ReplayArgs),
    Ros2(ros2::Ros2Command),
    #[cfg(feature = "link")]
    Link(link::LinkArgs),
    Info(info::InfoArgs),
    Check(check::CheckArgs),
    Urdf(urdf::UrdfArgs),
    /// Print the names of the robots that `--robot` finds, one per line.
    Robots(names::NamesArgs),
    /// Print the names of the worlds that `--world` finds, one per line.
    Worlds(names::NamesArgs),
    Control(control::ControlArgs),
    Dataset(dataset::DatasetArgs),
    /// Print a script that completes this command in a shell.
    ///
    /// For bash: belvedere completions bash > ~/.local/share/bash-completion/completions/belvedere
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// Names of all commands.
fn command_names() -> impl Iterator<Item = &'static str> {
    [
        "run",
        "list",
        "hz",
        "echo",
        "snapshot",
        "view",
        "record",
        "replay",
        "ros2",
        #[cfg(feature = "link")]
        "link",
        "info",
        "check",
        "urdf",
        "robots",
        "worlds",
        "control",
        "dataset",
        "completions",
    ]
    .into_iter()
}

/// Runs the command line of this process and returns its exit code. `models` are the robots and worlds that the program
/// contains.
pub fn main(models: models::Files) -> ExitCode {
    models::carry(models);
    run_words(&std::env::args_os().collect::<Vec<_>>()).into()
}

/// Runs a command line, whose first word is the name of the program, and returns its exit code: 0, 1 if something went
/// wrong, 2 if the arguments are invalid.
pub fn run_words(words: &[OsString]) -> u8 {
    // A thread is used only if the main thread's stack is too small, because signals interrupt only the main thread's
    // sleep.
    if rustix::process::getrlimit(Resource::Stack).current.is_none_or(|bytes| bytes >= STACK) {
        return run_command(words);
    }
    std::thread::scope(|threads| {
        let thread = std::thread::Builder::new().stack_size(STACK as usize);
        match thread.spawn_scoped(threads, || run_command(words)) {
            Ok(thread) => thread.join().unwrap_or(FAILURE),
            Err(_) => run_command(words),
        }
    })
}

fn run_command(words: &[OsString]) -> u8 {
    let cli = match environment::parse::<Cli>(words) {
        Ok(cli) => cli,
        Err(error) => {
            // If the output is closed, the exit code alone reports the error.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(FAILURE);
        }
    };
    log::start();
    // Eight robots have more streams than the default limit of open files allows.
    if let Err(error) = belvedere_bridge::open_files::raise_limit() {
        tracing::debug!(%error, "the limit of open files could not be raised");
    }
    let done = match &cli.command {
        None => run::run(&cli.run),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::List(args)) => list::run(args),
        Some(Command::Hz(args)) => hz::run(args),
        Some(Command::Echo(args)) => echo::run(args),
        Some(Command::Snapshot(args)) => snapshot::run(args),
        Some(Command::View(args)) => view::run(args),
        Some(Command::Record(args)) => record::run(args),
        Some(Command::Replay(args)) => replay::run(args),
        Some(Command::Ros2(args)) => ros2::run(args),
        #[cfg(feature = "link")]
        Some(Command::Link(args)) => link::run(args),
        Some(Command::Info(args)) => info::run(args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Urdf(args)) => urdf::run(args),
        Some(Command::Robots(args)) => names::robots(args),
        Some(Command::Worlds(args)) => names::worlds(args),
        Some(Command::Control(args)) => control::run(args),
        Some(Command::Dataset(args)) => dataset::run(args),
        Some(Command::Completions { shell }) => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "belvedere", &mut script);
            follow::print_line(String::from_utf8_lossy(&script).trim_end())
        }
    };
    match done {
        Ok(()) => SUCCESS,
        Err(error) if error.is_closed_pipe() => SUCCESS,
        Err(error) => {
            // If standard error is closed, the exit code alone reports the failure.
            let _ = writeln!(std::io::stderr(), "{}", failure(&error));
            FAILURE
        }
    }
}

/// Formats an error. Problems in a file already begin with `file:line: error:`; all others get the prefix `error:`.
fn failure(error: &CliError) -> String {
    match error {
        CliError::Description(_)
        | CliError::Checked { .. }
        | CliError::Dataset(DatasetError::Description(_)) => error.to_string(),
        _ => format!("error: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
        let command = Cli::command();
        let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(command_names().collect::<Vec<_>>(), names);
    }
}
