//! `belvedere run`: the simulator.

use super::error::CliError;
use super::follow::{NAP, listen_for_stop, print_line, seconds, stop_wanted};
use super::pacer::Pacer;
use super::status::Status;
use crate::control::SpawnOptions;
use crate::control::roster::model_name;
use crate::description::mesh::UpAxis;
use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use crate::description::robot::{LoadOptions, default_robot_name, load_robot, xacro_argument};
use crate::description::world::{default_world, load_world};
use crate::description::{Diagnostics, Rules, Severity};
use crate::rig::attendance::{Attendance, Awaited};
use crate::rig::post::Post;
use crate::rig::{Rig, RigOptions};
use crate::robot::Drive;
use crate::simulation::Simulation;
use belvedere_bridge::{Domain, Lossless, Node};
use belvedere_sensors::Execution;
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
  belvedere run --truth
  belvedere run --rate max --duration 10 --hash
  belvedere run --rate max --wait-for recorder=3 --patience 30")]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub struct RunArgs {
    /// The robot: a .urdf or .xacro file, or the name of one in turtlebot_description/robots
    /// [default: kobuki_nostack_camera, or what TURTLEBOT_BASE, _STACKS and _3D_SENSOR choose]
    #[arg(long, value_name = "FILE|NAME")]
    robot: Option<String>,
    /// Arguments of the robot's xacro, for its $(arg NAME)
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    xacro_args: Vec<(String, String)>,
    /// What the robot is called in the world [default: as its description has it]
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    name: Option<String>,
    /// The world: an SDF file, or the name of one of ours
    /// [default: tag_ceiling, or TURTLEBOT_GAZEBO_WORLD_FILE]
    #[arg(long, value_name = "FILE|NAME")]
    world: Option<String>,
    /// Name under which consumers find this simulation; several run side by side under different names
    #[arg(long, value_name = "NAME", env = "BELVEDERE_DOMAIN", default_value_t)]
    domain: Domain,
    /// Seed of all noise: same seed, same bytes
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// End after so many simulated seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
    /// Keep to the clock, or go as fast as it can
    #[arg(long, value_enum, default_value_t)]
    rate: Pace,
    /// Begin with simulated time standing, until `belvedere control resume` or `step`
    #[arg(long)]
    paused: bool,
    /// What the robot does when nobody sends velocity commands
    #[arg(long, value_enum, default_value_t)]
    drive: Drive,
    /// Behave as Gazebo classic where it differs from what is right: its principal point, NaN for depths out of
    /// range, ranges that begin at the minimum, sensors on missing links left out
    #[arg(long)]
    gazebo_compat: bool,
    /// Turn Collada meshes as their <up_axis> says. Gazebo and rviz ignore it, and so does belvedere without this
    #[arg(long)]
    apply_up_axis: bool,
    /// Publish what is true of every pixel and beam as well: TOPIC/truth/depth, range, normal, instance, class,
    /// incidence, flow_back, flow_forward
    #[arg(long)]
    truth: bool,
    /// A folder of ROS packages, looked into before ROS_PACKAGE_PATH and our own; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
    /// Print at the end a hash of every byte published, per stream and over all
    #[arg(long)]
    hash: bool,
    /// Lose no frame of this consumer (the name of its node): simulated time begins when it follows a stream (or as
    /// many as follow =) and waits while it has no room; may be repeated
    #[arg(long, value_name = "NAME[=STREAMS]")]
    wait_for: Vec<Awaited>,
    /// How long it waits for one of them before it ends with a report of who held it up
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "wait_for", default_value = "10")]
    patience: Duration,
}

impl RunArgs {
    fn rules(&self) -> Rules {
        let up_axis = if self.apply_up_axis { UpAxis::Applied } else { UpAxis::Ignored };
        Rules { gazebo_compat: self.gazebo_compat, up_axis }
    }
}

/// How simulated time runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Pace {
    /// As the clock on the wall.
    #[default]
    Realtime,
    /// As fast as it can.
    Max,
}

/// Runs the simulator.
///
/// # Errors
/// What is wrong with the files, the sensors or the domain.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    render_on_this_thread();
    let (world, robot) = load(args)?;
    listen_for_stop()?;
    let node = Node::open(&args.domain, "belvedere")?;
    // Who is waited for sets the pace himself.
    let holds_frames = args.rate == Pace::Realtime && args.wait_for.is_empty();
    let post = holds_frames.then(Post::open).transpose().map_err(CliError::NoThread)?.map(Arc::new);
    let options = RigOptions {
        seed: args.seed,
        gazebo_compat: args.gazebo_compat,
        truth: args.truth,
        hashed: args.hash,
        lossless: (!args.wait_for.is_empty()).then(|| Lossless {
            consumers: args.wait_for.iter().map(|awaited| awaited.name.clone()).collect(),
            patience: args.patience,
        }),
        post: post.clone(),
        execution: Execution::parallel(),
    };
    let mut notes = Vec::new();
    let packages = packages(args);
    let mut simulation = Simulation::new(&world, &robot, args.drive, &node, &options, &mut notes)?;
    simulation.set_spawn_options(SpawnOptions { packages, rules: args.rules() });
    if args.paused {
        simulation.pause();
    }
    for note in &notes {
        tracing::info!("{note}");
    }
    tracing::info!(
        "robot {} in world {}, domain {}; a second terminal: belvedere list, belvedere hz TOPIC",
        robot.name,
        world.name,
        args.domain
    );
    let mut status = Status::new(simulation.rig());
    let ended = run_loop(&mut simulation, args, &node, &mut status, post.as_deref());
    if let Some(post) = &post {
        post.flush();
    }
    let table = status.finish(simulation.rig(), simulation.simulated_ns());
    eprint!("{table}");
    ended?;
    if args.hash { print_hashes(simulation.rig()) } else { Ok(()) }
}

/// Makes this thread one of those that render. Beside a pool of its own it would be one more to wake, before and after
/// each frame: consumers got one picture in three 0.2 ms later.
fn render_on_this_thread() {
    if let Err(error) = rayon::ThreadPoolBuilder::new().use_current_thread().build_global() {
        tracing::debug!(%error, "this thread does not render");
    }
}

fn packages(args: &RunArgs) -> PackagePath {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    PackagePath::new(args.package_path.iter().cloned(), ros_package_path.as_deref())
}

fn load(args: &RunArgs) -> Result<(World, Model), CliError> {
    let mut diagnostics = Diagnostics::default();
    let packages = packages(args);
    let world = args.world.clone().unwrap_or_else(default_world);
    let world = load_world(&world, &packages, args.rules(), &mut diagnostics);
    let options = LoadOptions { packages, rules: args.rules(), xacro_args: args.xacro_args.clone() };
    let robot = args.robot.clone().unwrap_or_else(default_robot_name);
    let mut robot = load_robot(&robot, &options, &mut diagnostics);
    if let (Some(robot), Some(name)) = (&mut robot, &args.name) {
        robot.name.clone_from(name);
        let models = world.iter().flat_map(|world| &world.models);
        for model in models.filter(|model| model.name == *name) {
            diagnostics.error(
                &model.source,
                format!("a model of the world is called '{name}'"),
                "give the robot another --name",
            );
        }
    }
    for problem in diagnostics.problems() {
        match problem.severity {
            Severity::Error => {}
            Severity::Warning => tracing::warn!("{problem}"),
            Severity::Note => tracing::debug!("{problem}"),
        }
    }
    match (world, robot) {
        (Some(world), Some(robot)) if !diagnostics.has_errors() => Ok((world, robot)),
        _ => Err(CliError::Description(diagnostics.errors().cloned().collect())),
    }
}

fn run_loop(
    simulation: &mut Simulation,
    args: &RunArgs,
    node: &Node,
    status: &mut Status,
    post: Option<&Post>,
) -> Result<(), CliError> {
    let end_ns =
        args.duration.map_or(u64::MAX, |duration| u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX));
    let mut attendance = Attendance::new(&args.wait_for);
    gather(&mut attendance, simulation, node, None)?;
    let mut pacer = Pacer::new(simulation, post);
    while !stop_wanted() {
        if simulation.is_paused() {
            simulation.idle(NAP);
            status.refresh(simulation.rig(), simulation.simulated_ns());
            continue;
        }
        let keeps_time = args.rate == Pace::Realtime;
        if simulation.next_simulated_ns() >= end_ns || keeps_time && !pacer.wait_for_next(simulation) {
            break;
        }
        gather(&mut attendance, simulation, node, Some(args.patience))?;
        let epoch = simulation.epoch();
        simulation.serve();
        if simulation.is_paused() || simulation.epoch() != epoch {
            continue;
        }
        simulation.advance();
        if !args.wait_for.is_empty()
            && let Some(error) = simulation.rig().held_up()
        {
            return Err(CliError::HeldUp { error: error.to_string(), time_ns: simulation.time_ns() });
        }
        status.refresh(simulation.rig(), simulation.simulated_ns());
    }
    Ok(())
}

/// Lets simulated time stand until all that are waited for are there; at the start for as long as it takes.
fn gather(
    attendance: &mut Attendance,
    simulation: &mut Simulation,
    node: &Node,
    patience: Option<Duration>,
) -> Result<(), CliError> {
    let since = Instant::now();
    let mut told = String::new();
    loop {
        let missing = attendance.missing(simulation.rig());
        if missing.is_empty() {
            if !told.is_empty() {
                tracing::info!("all consumers that are waited for are there");
            }
            return Ok(());
        }
        let names = missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        if stop_wanted() {
            return Ok(());
        }
        if patience.is_some_and(|patience| since.elapsed() >= patience) {
            return Err(CliError::ConsumersGone { names, waited: since.elapsed() });
        }
        if told != names {
            tracing::info!("simulated time waits for {names}");
            told = names;
        }
        // One that was killed leaves its place only by this.
        node.clean_up_dead();
        simulation.idle(NAP);
    }
}

fn print_hashes(rig: &Rig) -> Result<(), CliError> {
    let mut all = Xxh3::new();
    for outlet in rig.outlets() {
        let hash = outlet.hash().unwrap_or(0);
        all.update(outlet.topic().as_bytes());
        all.update(&hash.to_le_bytes());
        print_line(&format!("{hash:032x}  {}  {} frames", outlet.topic(), outlet.tally().frames))?;
    }
    print_line(&format!("{:032x}  total", all.digest128()))
}
