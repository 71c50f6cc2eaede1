//! `belvedere view`: shows a simulation on a page in the browser.

use super::error::CliError;
use super::follow::{DomainArgs, NAP, check_topics, listen_for_stop, print_line, stop_wanted};
use super::robot_descriptions::robot_descriptions;
use super::robots::{RobotArgs, argument};
use super::shown::Shown;
use super::terminal;
use super::view_recording::RecordingToView;
use crate::description::load::{default_world, load_world};
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use crate::description::{Diagnostics, Rules};
use crate::view::{DEFAULT_PORT, ViewOptions, ViewServer, token};
use belvedere_bridge::Node;
use clap::Args as _;
use clap::builder::{OsStringValueParser, TypedValueParser as _};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read as _};
use std::net::{IpAddr, Ipv4Addr};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Options of the page's server.
#[derive(Clone, Debug, clap::Args)]
#[group(skip)]
pub struct PageArgs {
    /// Port of the page; 0 for any free port
    #[arg(long, value_name = "PORT", default_value_t = DEFAULT_PORT)]
    port: u16,
    /// Address to listen at; any other than 127.0.0.1 gives access to other machines that know the token
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    listen: IpAddr,
    /// Token that a page must present, 8 or more letters and digits [default: random at each start]
    ///
    /// Other users of this machine can read a program's arguments, but not the environment variable or the file of
    /// --token-file.
    #[arg(long, value_name = "TEXT", env = "BELVEDERE_VIEW_TOKEN", value_parser = token, hide_env_values = true)]
    token: Option<String>,
    /// A file with the token, which must not be readable by other users
    #[arg(long, value_name = "FILE", value_parser = token_in, conflicts_with = "token")]
    token_file: Option<String>,
    /// Another page that may connect, such as `https://app.foxglove.dev`; may be repeated
    #[arg(long, value_name = "ORIGIN")]
    allow_origin: Vec<String>,
    /// Print the page's address without opening a browser
    #[arg(long)]
    no_browser: bool,
}

impl PageArgs {
    /// Returns true for the name of one of these options, which have no effect without a page. A token is left out,
    /// because an environment variable may give it to all commands.
    pub(super) fn is_option(name: &str) -> bool {
        let options = Self::augment_args(clap::Command::new("page"));
        name != "token" && options.get_arguments().any(|option| option.get_id() == name)
    }
}

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Show a running simulation, or a recording, on a page in the browser.
///
/// The page shows the world in 3D with the robot, its scans and depth clouds, and the images of its cameras. It can
/// pause, step and reset the simulation, and drive the robot by keys. The same port speaks Foxglove's protocol. Streams
/// that no panel shows are not rendered. The page reconnects when the simulator is restarted. `belvedere run --view` is
/// simulator and page in one.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere run --view
  belvedere view
  belvedere view run.mcap                  (a recording, with a time line)
  belvedere view --robot my_robot.urdf.xacro --world my.world    (as given to run: their shapes are shown)
  belvedere view --no-browser --port 0
  belvedere view --terminal /camera/rgb/image_raw
  ssh -L 8765:127.0.0.1:8765 robot belvedere view --no-browser")]
pub struct ViewArgs {
    /// A recording, which is played in the domain in place of a simulator
    #[arg(value_name = "RECORDING", value_parser = OsStringValueParser::new().try_map(given))]
    given: Option<Given>,
    #[command(flatten)]
    domain: DomainArgs,
    #[command(flatten)]
    page: PageArgs,
    #[command(flatten)]
    robots: RobotArgs,
    /// The world, as given to `belvedere run`
    #[arg(long, value_name = "FILE|NAME")]
    world: Option<PathBuf>,
    /// A folder of ROS packages, searched before ROS_PACKAGE_PATH and the shipped packages; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
    /// Show a topic in this terminal instead [default topic: that of the first camera]
    #[arg(long, value_name = "TOPIC", num_args = 0..=1, default_missing_value = "", conflicts_with = "given")]
    terminal: Option<String>,
    /// Stop after this number of pictures in the terminal
    #[arg(long, value_name = "N", requires = "terminal")]
    count: Option<u64>,
    /// Wait for the simulator if it is not running yet
    #[arg(long)]
    wait: bool,
}

/// The first positional argument.
#[derive(Clone, Debug)]
enum Given {
    Recording(PathBuf),
    /// A xacro argument of the robots.
    Argument((String, String)),
}

fn given(text: OsString) -> Result<Given, String> {
    match text.to_str().filter(|text| text.contains(":=")) {
        Some(text) => argument(text).map(Given::Argument),
        None => Ok(Given::Recording(text.into())),
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::NoSimulator`]; [`CliError::View`] if the page cannot be served; [`CliError::Recording`].
pub fn run(args: &ViewArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let mut args = args.clone();
    match args.given.take() {
        Some(Given::Recording(file)) => return view_recording(&file, &args),
        Some(Given::Argument(argument)) => args.robots.add_argument(argument),
        None => {}
    }
    let args = &args;
    let node = Node::open(&args.domain.domain, "view")?;
    if !args.wait {
        check_topics(&node, &args.domain.domain, &[])?;
    }
    if let Some(topic) = &args.terminal {
        return terminal::show(&node, topic, args.count);
    }
    let page = open_page(&node, &args.page, load(args)?)?;
    while !stop_wanted() {
        std::thread::sleep(NAP);
    }
    page.stop();
    Ok(())
}

/// Plays a recording and shows it on the page.
fn view_recording(file: &Path, args: &ViewArgs) -> Result<(), CliError> {
    let played = RecordingToView::open(file)?;
    let shown = if args.robots.are_ours() && args.world.is_none() {
        played.models(&packages(args))
    } else {
        load(args)?
    };
    let domain = &args.domain.domain;
    // Created first, so that a running simulator is detected before the page is opened.
    let player = played.player(Node::open(domain, "belvedere")?)?;
    let page = open_page(&Node::open(domain, "view")?, &args.page, shown)?;
    page.set_timeline(played.timeline().clone());
    played.play(player)
}

fn packages(args: &ViewArgs) -> PackagePath {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    package_path(args.package_path.iter().cloned(), ros_package_path.as_deref())
}

/// Loads the models of a simulator in another process, from the same arguments.
fn load(args: &ViewArgs) -> Result<Shown, CliError> {
    let packages = packages(args);
    let mut diagnostics = Diagnostics::default();
    // The simulator has already reported problems in these files.
    let rules = Rules { skip_missing: true, ..Rules::default() };
    let world = args.world.clone().unwrap_or_else(default_world);
    let world = load_world(&world, &packages, rules, &mut diagnostics);
    let taken = world.iter().flat_map(|world| &world.models).map(|model| model.name.as_str());
    let robots = args.robots.load(&packages, rules, &taken.collect(), &mut diagnostics);
    match world {
        Some(world) if !diagnostics.has_errors() => {
            let descriptions = robot_descriptions(&robots, &packages, args.robots.xacro_args());
            Ok(Shown::new(&world.models, &robots, descriptions))
        }
        _ => Err(CliError::Description(diagnostics.errors().cloned().collect())),
    }
}

/// Reads the token from a file.
fn token_in(path: &str) -> Result<String, String> {
    let failed = |error: io::Error| format!("it cannot be read: {error}");
    let mut file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.mode() & 0o004 != 0 {
        return Err(format!("other users can read it; chmod 600 {path}"));
    }
    let mut text = String::new();
    file.read_to_string(&mut text).map_err(failed)?;
    token(text.trim())
}

/// Serves the page, prints its address, and opens it in a browser.
pub(super) fn open_page(node: &Node, args: &PageArgs, shown: Shown) -> Result<ViewServer, CliError> {
    let options = ViewOptions {
        address: args.listen,
        port: args.port,
        token: args.token_file.clone().or_else(|| args.token.clone()),
        origins: args.allow_origin.clone(),
    };
    let page = ViewServer::start(node.clone(), options)?;
    page.set_scene(shown.scene);
    for (namespace, urdf) in shown.robots {
        page.set_robot_description(&namespace, &urdf);
    }
    print_line(&format!("page: {}", page.url()))?;
    if !args.no_browser {
        open_browser(page.opening_url());
    }
    Ok(page)
}

/// Asks the desktop to open a browser. If there is none, a warning asks the user to open the page.
fn open_browser(url: &str) {
    let opened = Command::new("xdg-open")
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let failed = match opened {
        Ok(mut child) => {
            // A thread waits for it, since some browsers do not return until they are closed.
            let watched = std::thread::Builder::new().name("browser".into()).spawn(move || {
                if !child.wait().is_ok_and(|status| status.success()) {
                    warn_no_browser("xdg-open found none");
                }
            });
            watched.err()
        }
        Err(error) => Some(error),
    };
    if let Some(error) = failed {
        warn_no_browser(&format!("xdg-open: {error}"));
    }
}

fn warn_no_browser(why: &str) {
    tracing::warn!(
        "no browser was opened ({why}); open the page's address in one yourself, or give --no-browser"
    );
}
