//! `belvedere run`: the simulator.

use super::attachments::attachments;
use super::displays::Displays;
use super::error::CliError;
use super::follow::{NAP, listen_for_stop, print_line, seconds, stop_wanted};
use super::pacer::Pacer;
use super::record::RECORDER;
use super::recording_thread::RecordingThread;
use super::robot_descriptions::robot_descriptions;
use super::ros2::{Ros2Args, Ros2Thread};
use super::shown::Shown;
use super::simulated::SimulatedArgs;
use super::view::{PageArgs, open_page};
use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use crate::description::text::count;
use crate::description::{Diagnostics, Severity};
use crate::entities::Origin;
use crate::recording::Profile;
use crate::rig::Rig;
use crate::rig::packets::{Feed, PacketTarget};
use crate::server::attendance::{Attendance, Awaited, START_PATIENCE};
use crate::server::post::Post;
use crate::server::{ModelFiles, Server, ServerOptions, SharedMemory};
use crate::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::{Domain, Lossless, Node};
use clap::ArgGroup;
use clap::builder::{OsStringValueParser, TypedValueParser as _};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Write as _;
use std::net::SocketAddr;
use std::os::unix::ffi::OsStringExt as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::Xxh3;

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Run a robot in a world and publish what its sensors see, until Ctrl-C.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere run
  belvedere run --robot kobuki_hexagons_kinect --world playground --drive spin
  belvedere run --robot my_robot.urdf.xacro --package-path ~/catkin_ws/src --domain lab
  belvedere run --robot my_robot.urdf.xacro use_camera:=true --package-path ~/catkin_ws/src
  belvedere run --robot none --world my.world             (a world that has its own robot)
  belvedere run --view
  belvedere run --ros2 --remap /scan:=/front/scan --qos /image_raw=sensor_data
  belvedere run --truth
  belvedere run --rate max --duration 10 --hash
  belvedere run --record run.mcap --duration 60
  belvedere run --robot car.urdf --udp velodyne_points=127.0.0.1:2368
  belvedere run --rate max --wait-for recorder=3 --patience 30

The table of streams:
  RATE Hz   frames sent in a second of simulated time; idle: nobody reads them, so none are made
  ASKED Hz  the rate that is set
  SUBS      subscribers
  DROPPED   frames that could not be sent, each with a warning that says why
  FRAME ms  time to render a frame")]
#[command(mut_group(Ros2Args::GROUP, |group| group.requires("ros2")))]
#[command(group(ArgGroup::new("waited_for").args(["wait_for", "record"]).multiple(true)))]
#[command(mut_args(|arg| if PageArgs::is_option(arg.get_id().as_str()) { arg.requires("view") } else { arg }))]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub struct RunArgs {
    #[command(flatten)]
    simulated: SimulatedArgs,
    /// Name under which consumers find this simulation; several can run side by side under different names
    #[arg(long, value_name = "NAME", env = "BELVEDERE_DOMAIN", default_value_t)]
    domain: Domain,
    /// Seed of all noise: the same seed gives the same bytes
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Stop after this number of simulated seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
    /// Run in real time, or as fast as possible
    #[arg(long, value_enum, default_value_t)]
    rate: Pace,
    /// Start paused, until `belvedere control resume` or `step`
    #[arg(long)]
    paused: bool,
    /// At the end, print a hash of all published bytes, per stream and in total
    #[arg(long)]
    hash: bool,
    /// Record all streams into this MCAP file; simulated time waits if the file cannot be written fast enough
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// The version of ROS whose messages the file of --record contains
    #[arg(long, value_enum, default_value_t, requires = "record")]
    profile: Profile,
    /// Replace the files of --record, --pcap and --lidar-metadata if they exist
    #[arg(long)]
    force: bool,
    /// Publish all streams in ROS 2, and accept velocities and calls of services from there
    #[arg(long)]
    ros2: bool,
    #[command(flatten)]
    ros2_args: Ros2Args,
    /// Show the simulation on a page in the browser
    #[arg(long)]
    view: bool,
    #[command(flatten)]
    page: PageArgs,
    /// Send the data packets of a lidar with a Velodyne or Ouster preset, given by its name or topic, to this UDP
    /// address; may be repeated
    #[arg(long, value_name = "SENSOR=ADDRESS:PORT")]
    udp: Vec<Feed<SocketAddr>>,
    /// Write the lidar's packets to this pcap file, which Wireshark and drivers can read, and an Ouster's metadata to a
    /// file of the same name that ends in .json; may be repeated
    #[arg(long, value_name = "SENSOR=FILE", value_parser = OsStringValueParser::new().try_map(feed))]
    pcap: Vec<Feed<PathBuf>>,
    /// Write an Ouster's metadata to this file, for programs that receive its packets by --udp; may be repeated
    #[arg(long, value_name = "SENSOR=FILE", value_parser = OsStringValueParser::new().try_map(feed))]
    lidar_metadata: Vec<Feed<PathBuf>>,
    /// Lose no frame to this consumer (the name of its node): simulated time starts when it subscribes to a stream (or
    /// to the number of streams after =), and waits while its buffer is full; may be repeated
    #[arg(long, value_name = "NAME[=STREAMS]")]
    wait_for: Vec<Awaited>,
    /// Longest wait for one of these consumers; after it, the simulator names the consumer and exits with code 1
    /// [default: 10; at the start, when other programs may have to be started first, 60]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "waited_for")]
    patience: Option<Duration>,
}

/// Parses SENSOR=FILE. The file's name need not be UTF-8.
fn feed(text: OsString) -> Result<Feed<PathBuf>, String> {
    let bytes = text.into_vec();
    match bytes.iter().position(|byte| *byte == b'=').map(|equals| (&bytes[..equals], &bytes[equals + 1..])) {
        Some((sensor, file)) if !sensor.is_empty() && !file.is_empty() => {
            let sensor = String::from_utf8_lossy(sensor).into_owned();
            Ok(Feed { sensor, to: OsString::from_vec(file.to_vec()).into() })
        }
        _ => Err("expected SENSOR=FILE, where SENSOR is the name of a lidar or one of its topics".into()),
    }
}

impl RunArgs {
    /// Refuses to replace existing files of packets, unless --force is given.
    fn check_files(&self) -> Result<(), CliError> {
        // An Ouster's metadata is written next to its packets.
        let pcap = self.pcap.iter().flat_map(|feed| [feed.to.clone(), feed.to.with_extension("json")]);
        let mut files = pcap.chain(self.lidar_metadata.iter().map(|feed| feed.to.clone()));
        match files.find(|file| !self.force && file.exists()) {
            Some(path) => Err(CliError::FileExists { path }),
            None => Ok(()),
        }
    }

    /// Returns the sensors whose packets are sent, and where to.
    fn packets(&self) -> Vec<(&str, PacketTarget)> {
        let udp = self.udp.iter().map(|feed| (feed.sensor.as_str(), PacketTarget::Udp(feed.to)));
        let pcap = self.pcap.iter().map(|feed| (feed.sensor.as_str(), PacketTarget::Pcap(feed.to.clone())));
        let metadata = self.lidar_metadata.iter();
        let metadata = metadata.map(|feed| (feed.sensor.as_str(), PacketTarget::Metadata(feed.to.clone())));
        udp.chain(pcap).chain(metadata).collect()
    }

    /// Returns the consumers that the simulation waits for, before and during the run.
    fn awaited(&self) -> Vec<Awaited> {
        let recorder = self.record.as_ref().map(|_| Awaited { name: RECORDER.into(), streams: Awaited::ALL });
        self.wait_for.iter().cloned().chain(recorder).collect()
    }
}

/// The speed of simulated time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Pace {
    /// In step with the wall clock.
    #[default]
    Realtime,
    /// As fast as possible.
    Max,
}

/// Runs the simulator.
///
/// # Errors
/// Problems with the files, the sensors or the domain.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    args.check_files()?;
    render_on_this_thread();
    let packages = args.simulated.packages();
    let (world, robots) = load(args, &packages)?;
    listen_for_stop()?;
    let xacro_args = args.simulated.robots.xacro_args();
    let kept = args.record.as_ref().map(|_| attachments(&world, &robots, &packages, xacro_args));
    let described =
        if args.view || args.ros2 { robot_descriptions(&robots, &packages, xacro_args) } else { Vec::new() };
    let shown = args.view.then(|| Shown::new(&world.models, &robots, described.clone()));
    let node = Node::open(&args.domain, "belvedere")?;
    let mut simulation =
        Simulation::builder(world).seed(args.seed).gazebo_compat(args.simulated.gazebo_compat).build()?;
    args.simulated.spawn(&mut simulation, &robots)?;
    // Consumers that the simulation waits for set its pace, so frames are not held back for a clock.
    let awaited = args.awaited();
    let holds_frames = args.rate == Pace::Realtime && awaited.is_empty();
    let post = holds_frames.then(Post::open).transpose().map_err(CliError::NoThread)?.map(Arc::new);
    let sink = SharedMemory {
        lossless: (!awaited.is_empty()).then(|| Lossless {
            consumers: awaited.iter().map(|awaited| awaited.name.clone()).collect(),
            patience: args.patience.unwrap_or(Lossless::PATIENCE),
            // The recording gets every frame up to the end.
            gives_up: |consumer| stop_wanted() && consumer.name != RECORDER,
        }),
        post: post.clone(),
        ..SharedMemory::new(node.clone())
    };
    let files = ModelFiles { packages, rules: args.simulated.rules() };
    let options = ServerOptions { truth: args.simulated.truth, hashed: args.hash, files };
    for note in simulation.notes() {
        match note.severity {
            Severity::Note => tracing::info!("{note}"),
            Severity::Warning | Severity::Error => tracing::warn!("{note}"),
        }
    }
    tracing::info!("{}", headline(&simulation, args));
    let mut server = Server::attach_to(&mut simulation, sink, options)?;
    server.send_packets(&args.packets()).map_err(CliError::Packets)?;
    if args.paused {
        server.pause();
    }
    let recording = args
        .record
        .as_ref()
        .zip(kept)
        .map(|(path, kept)| {
            RecordingThread::start(&args.domain, path, args.profile, args.force, words(args), kept)
        })
        .transpose()?;
    let page =
        shown.map(|shown| open_page(&Node::open(&args.domain, "view")?, &args.page, shown)).transpose()?;
    let ros2 = args.ros2.then(|| Ros2Thread::start(&args.domain, &args.ros2_args, &described)).transpose()?;
    let mut displays = Displays::new(&server, page.as_ref(), ros2.as_ref(), &described);
    let ended = run_loop(&mut server, args, &node, &mut displays, post.as_deref());
    if let Some(post) = &post {
        post.flush();
    }
    displays.hide();
    // The recording is completed first, so that nothing below can leave it incomplete.
    let recorded = recording.map_or(Ok(()), RecordingThread::finish);
    let table = displays.end(&server);
    drop((page, ros2));
    // If standard error is closed, the table is not needed.
    let _ = std::io::stderr().write_all(table.unwrap_or_default().as_bytes());
    // If the recording failed, it is the reason why the run ended.
    recorded.and(ended)?;
    if args.hash { print_hashes(server.rig()) } else { Ok(()) }
}

/// Returns the description of the run that is added to its recording.
fn words(args: &RunArgs) -> BTreeMap<String, String> {
    let world = args.simulated.world();
    BTreeMap::from([
        ("seed".to_owned(), args.seed.to_string()),
        ("world".to_owned(), world.to_string_lossy().into_owned()),
    ])
}

/// Returns the line that names the robots, the world and the domain.
fn headline(simulation: &Simulation, args: &RunArgs) -> String {
    let robots = simulation.entities().iter().filter(|(_, entity)| entity.origin == Origin::Start);
    let robots: Vec<&str> = robots.map(|(_, entity)| entity.name.as_str()).collect();
    let robots = match robots[..] {
        [] => "no robot".to_owned(),
        [robot] => format!("robot {robot}"),
        _ => format!("robots {}", robots.join(", ")),
    };
    format!(
        "{robots} in world {}, domain {}; a second terminal: belvedere list, belvedere hz TOPIC",
        simulation.world_name(),
        args.domain
    )
}

/// Makes this thread part of the rendering pool. In addition to a separate pool it would be one more thread to wake
/// before and after each frame, which delivered one image in three 0.2 ms later.
fn render_on_this_thread() {
    if let Err(error) = rayon::ThreadPoolBuilder::new().use_current_thread().build_global() {
        tracing::debug!(%error, "this thread does not render");
    }
}

fn load(args: &RunArgs, packages: &PackagePath) -> Result<(World, Vec<(Model, SpawnOptions)>), CliError> {
    let mut diagnostics = Diagnostics::default();
    let (world, robots) = args.simulated.load(packages, &mut diagnostics);
    for problem in diagnostics.problems() {
        match problem.severity {
            Severity::Error => {}
            Severity::Warning => tracing::warn!("{problem}"),
            Severity::Note => tracing::debug!("{problem}"),
        }
    }
    match world {
        Some(world) if !diagnostics.has_errors() => Ok((world, robots)),
        _ => Err(CliError::Description(diagnostics.errors().cloned().collect())),
    }
}

fn run_loop(
    server: &mut Server<'_>,
    args: &RunArgs,
    node: &Node,
    displays: &mut Displays<'_>,
    post: Option<&Post>,
) -> Result<(), CliError> {
    let end_ns =
        args.duration.map_or(u64::MAX, |duration| u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX));
    let awaited = args.awaited();
    let mut attendance = Attendance::new(&awaited);
    gather(&mut attendance, server, node, args, true)?;
    let mut pacer = Pacer::new(server, post);
    while !stop_wanted() {
        if server.is_paused() {
            server.idle(NAP);
            displays.refresh(server);
            continue;
        }
        let keeps_time = args.rate == Pace::Realtime;
        if server.next_simulated_ns() >= end_ns || keeps_time && !pacer.wait_for_next(server) {
            break;
        }
        gather(&mut attendance, server, node, args, false)?;
        let epoch = server.epoch();
        server.serve();
        if server.is_paused() || server.epoch() != epoch {
            continue;
        }
        server.advance();
        if !awaited.is_empty()
            && let Some(error) = server.rig().held_up()
        {
            return Err(CliError::HeldUp { error: error.to_string(), time_ns: server.time_ns() });
        }
        displays.refresh(server);
    }
    Ok(())
}

/// Pauses simulated time until all consumers given with --wait-for are connected.
fn gather(
    attendance: &mut Attendance,
    server: &mut Server<'_>,
    node: &Node,
    args: &RunArgs,
    is_start: bool,
) -> Result<(), CliError> {
    let since = Instant::now();
    let usual = if is_start { START_PATIENCE } else { Lossless::PATIENCE };
    let patience = args.patience.unwrap_or(usual);
    let mut reported = String::new();
    loop {
        let missing = attendance.missing(server.rig());
        if missing.is_empty() {
            if !reported.is_empty() {
                tracing::info!("all consumers given with --wait-for are connected");
            }
            return Ok(());
        }
        let names = missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        if stop_wanted() {
            return Ok(());
        }
        let waited = since.elapsed();
        if waited >= patience {
            return Err(if is_start {
                CliError::ConsumersMissing { names, waited }
            } else {
                CliError::ConsumersGone { names, waited }
            });
        }
        if reported != names {
            tracing::info!("simulated time waits for {names}");
            reported = names;
        }
        // This removes consumers that were killed, which would otherwise keep their places.
        node.clean_up_dead();
        server.idle(NAP);
    }
}

fn print_hashes(rig: &Rig) -> Result<(), CliError> {
    let mut all = Xxh3::new();
    for outlet in rig.outlets() {
        let hash = outlet.hash().unwrap_or(0);
        all.update(outlet.topic().as_bytes());
        all.update(&hash.to_le_bytes());
        print_line(&format!("{hash:032x}  {}  {}", outlet.topic(), count(outlet.tally().frames, "frame")))?;
    }
    print_line(&format!("{:032x}  total", all.digest128()))
}
