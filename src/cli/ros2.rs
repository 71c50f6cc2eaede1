//! `belvedere ros2`: publishes a running simulation's streams in ROS 2.

use super::error::CliError;
use super::follow::{DomainArgs, NAP, check_topics, listen_for_stop, print_line, seconds, stop_wanted};
use super::robot_descriptions::{DescriptionReceiver, robot_descriptions};
use super::robots::RobotArgs;
use crate::description::models::package_path;
use crate::description::{Diagnostics, Rules};
use crate::ros2::{Descriptions, Naming, Range, Reliability, Remap, Ros2, Ros2Options, namespace};
use belvedere_bridge::{Domain, Node};
use std::collections::HashSet;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// How ROS 2 sees the streams.
#[derive(Clone, Debug, clap::Args)]
#[group(id = Ros2Args::GROUP)]
pub struct Ros2Args {
    /// The domain of ROS 2 [default: ROS_DOMAIN_ID, otherwise 0]
    #[arg(long, value_name = "0-232", value_parser = clap::value_parser!(u32).range(0..=232))]
    ros_domain_id: Option<u32>,
    /// A namespace before all topics except /tf, /tf_static and /clock
    #[arg(long, value_name = "NAMESPACE", value_parser = namespace, default_value = "")]
    ros_namespace: String,
    /// Another name for a topic; may be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<Remap>,
    /// `sensor_data` (best effort) or `reliable` for a topic [default: reliable, which serves readers of both kinds]; may
    /// be repeated
    #[arg(long, value_name = "TOPIC=PROFILE", value_parser = reliability)]
    qos: Vec<(String, Reliability)>,
    /// Quality of compressed images, 1 to 100, which are the topics that end in /compressed
    #[arg(long, value_name = "1-100", value_parser = clap::value_parser!(u8).range(1..=100), default_value_t = Ros2Options::JPEG_QUALITY)]
    jpeg_quality: u8,
    /// Let ROS 2 change nothing: velocities are ignored, and services that change something refuse
    #[arg(long)]
    no_commands: bool,
}

/// Parses TOPIC=PROFILE.
fn reliability(text: &str) -> Result<(String, Reliability), String> {
    let profile = |name: &str| match name {
        "sensor_data" => Some(Reliability::SensorData),
        "reliable" => Some(Reliability::Reliable),
        _ => None,
    };
    text.split_once('=')
        .and_then(|(topic, name)| Some((format!("/{}", topic.trim_start_matches('/')), profile(name)?)))
        .ok_or_else(|| "expected TOPIC=sensor_data or TOPIC=reliable, such as /scan=sensor_data".to_owned())
}

impl Ros2Args {
    /// All options, by which `belvedere run` refuses them without its `--ros2`.
    pub(super) const GROUP: &str = "ros2_options";

    /// Returns the options, some of which ROS 2's own variables of the environment give.
    pub(super) fn options(&self) -> Result<Ros2Options, CliError> {
        let (range, peers) = reach()?;
        Ok(Ros2Options {
            domain_id: self.ros_domain_id.map_or_else(domain_id, Ok)?,
            range,
            peers,
            naming: Naming { namespace: self.ros_namespace.clone(), remaps: self.remap.clone() },
            reliability: self.qos.clone(),
            jpeg_quality: self.jpeg_quality,
            no_commands: self.no_commands,
            ..Ros2Options::default()
        })
    }
}

/// Interval at which it is tried again to join a domain of ROS 2.
const TRY_AGAIN: Duration = Duration::from_secs(1);

/// A node of ROS 2 in the simulator's process, which dropping it ends.
pub(super) struct Ros2Thread {
    stop: Arc<AtomicBool>,
    descriptions: Descriptions,
    /// `None` once it has ended.
    thread: Option<JoinHandle<()>>,
}

impl Ros2Thread {
    /// Joins a domain of ROS 2, and publishes the streams of a simulation there, and the descriptions of its robots by
    /// their namespaces. If the domain cannot be joined, the simulation goes on, and it is tried again every second.
    pub(super) fn start(
        domain: &Domain,
        args: &Ros2Args,
        robots: &[(String, String)],
    ) -> Result<Self, CliError> {
        let descriptions = described(robots);
        let options = Ros2Options { descriptions: descriptions.clone(), ..args.options()? };
        let node = Node::open(domain, "ros2")?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let turn = move || {
            let Some(mut ros2) = join(&node, &options, &stopped) else { return };
            while !stopped.load(Ordering::Relaxed) {
                if let Err(error) = ros2.turn(NAP) {
                    // The simulation goes on.
                    tracing::error!(%error, "ROS 2 gets no more messages");
                    break;
                }
            }
        };
        let thread =
            std::thread::Builder::new().name("ros2".into()).spawn(turn).map_err(CliError::NoThread)?;
        Ok(Self { stop, descriptions, thread: Some(thread) })
    }
}

/// Returns the descriptions of robots by their namespaces. If two robots share a namespace, the first is described.
fn described(robots: &[(String, String)]) -> Descriptions {
    let descriptions = Descriptions::default();
    for (namespace, urdf) in robots.iter().rev() {
        descriptions.set(namespace, urdf);
    }
    descriptions
}

impl DescriptionReceiver for Ros2Thread {
    fn set(&self, namespace: &str, urdf: &str) {
        self.descriptions.set(namespace, urdf);
    }

    fn remove(&self, namespace: &str) {
        self.descriptions.remove(namespace);
    }
}

/// Joins the domain of ROS 2, and tries again until it can be joined or `stopped` is set.
fn join(node: &Node, options: &Ros2Options, stopped: &AtomicBool) -> Option<Ros2> {
    let mut has_failed = false;
    while !stopped.load(Ordering::Relaxed) {
        match Ros2::start(node.clone(), options.clone()) {
            Ok(ros2) => {
                if has_failed {
                    tracing::info!("ROS 2 gets messages now");
                }
                return Some(ros2);
            }
            Err(error) if !has_failed => {
                tracing::warn!("{error}; the simulation goes on, and joins when it can");
            }
            Err(_) => {}
        }
        has_failed = true;
        let next = Instant::now() + TRY_AGAIN;
        while Instant::now() < next && !stopped.load(Ordering::Relaxed) {
            std::thread::sleep(NAP);
        }
    }
    None
}

impl Drop for Ros2Thread {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

/// Returns the domain that the environment names. As in ROS 2, an empty variable is the same as none.
fn domain_id() -> Result<u32, CliError> {
    let (name, value) = ("ROS_DOMAIN_ID", variable("ROS_DOMAIN_ID"));
    match value.parse() {
        Ok(number @ 0..=232) => Ok(number),
        _ if value.is_empty() => Ok(0),
        _ => Err(CliError::Variable { name, value, expected: "a number from 0 to 232" }),
    }
}

/// Returns the value of a variable of the environment; an empty text if it does not exist, as in ROS 2.
fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// Returns who can see the node, and the peers that are found without multicast, as ROS 2's variables say.
fn reach() -> Result<(Range, Vec<Ipv4Addr>), CliError> {
    let (name, value) = ("ROS_AUTOMATIC_DISCOVERY_RANGE", variable("ROS_AUTOMATIC_DISCOVERY_RANGE"));
    let range = match value.as_str() {
        "OFF" => Range::Off,
        "" | "SUBNET" | "SYSTEM_DEFAULT" if variable("ROS_LOCALHOST_ONLY") != "1" => Range::Subnet,
        "" | "LOCALHOST" | "SUBNET" | "SYSTEM_DEFAULT" => Range::Localhost,
        _ => {
            let expected = "SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT";
            return Err(CliError::Variable { name, value, expected });
        }
    };
    if range == Range::Off {
        tracing::warn!(
            "{name} is OFF, so no node of ROS 2 finds this one; SUBNET or LOCALHOST makes it visible"
        );
    }
    let peers = peers()?;
    if peers.is_empty() || !["OFF", "SYSTEM_DEFAULT"].contains(&value.as_str()) {
        return Ok((range, peers));
    }
    if range != Range::Off {
        tracing::warn!("ROS_STATIC_PEERS is ignored while {name} is {value}, as in ROS 2");
    }
    Ok((range, Vec::new()))
}

/// Returns the addresses of the hosts in `ROS_STATIC_PEERS`.
fn peers() -> Result<Vec<Ipv4Addr>, CliError> {
    let value = variable("ROS_STATIC_PEERS");
    value.split(';').map(str::trim).filter(|host| !host.is_empty()).map(address).collect()
}

/// Returns the address of a host, given by an address or a name.
fn address(host: &str) -> Result<Ipv4Addr, CliError> {
    let found = (host, 0).to_socket_addrs().into_iter().flatten();
    let mut found = found.filter_map(|address| match address {
        SocketAddr::V4(address) => Some(*address.ip()),
        SocketAddr::V6(_) => None,
    });
    found.next().ok_or_else(|| CliError::Variable {
        name: "a host in ROS_STATIC_PEERS",
        value: host.to_owned(),
        expected: "an IPv4 address, or a name that has one; hosts are separated by ;",
    })
}

/// Publish the streams of a running simulation as topics of ROS 2, and drive its robots by the velocities that arrive
/// there, until Ctrl-C.
///
/// No installation of ROS is needed: the program speaks the protocol of DDS, as rmw_fastrtps and rmw_cyclonedds do. A
/// sensor is rendered only while somebody reads its topic. ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS
/// and ROS_LOCALHOST_ONLY have their usual meaning. With --robot and other options as given to `belvedere run`, the robot's
/// description is published, too. `belvedere run --ros2` is simulator and node in one.
#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere ros2                      (beside belvedere run, in a second terminal)
  ros2 topic hz /image_raw
  ros2 run teleop_twist_keyboard teleop_twist_keyboard
  belvedere ros2 --robot my_robot.urdf.xacro     (as given to run: its description is published)
  belvedere ros2 --remap /scan:=/front/scan --qos /image_raw=sensor_data
  ROS_DOMAIN_ID=7 belvedere ros2 --ros-namespace robot1 --no-commands")]
pub struct Ros2Command {
    #[command(flatten)]
    domain: DomainArgs,
    #[command(flatten)]
    ros2: Ros2Args,
    #[command(flatten)]
    robots: RobotArgs,
    /// A folder of ROS packages, searched before ROS_PACKAGE_PATH and the shipped packages; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
    /// Stop after this number of seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
    /// Wait for the simulator if it is not running yet
    #[arg(long)]
    wait: bool,
}

impl Ros2Command {
    /// Loads the descriptions of robots of a simulator in another process, from the same arguments. Without arguments
    /// there are none, since another robot than the default one may run.
    fn descriptions(&self) -> Result<Descriptions, CliError> {
        if self.robots.are_ours() && self.robots.xacro_args().is_empty() {
            return Ok(Descriptions::default());
        }
        let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
        let packages = package_path(self.package_path.iter().cloned(), ros_package_path.as_deref());
        let mut diagnostics = Diagnostics::default();
        // The simulator has already reported problems in these files.
        let rules = Rules { skip_missing: true, ..Rules::default() };
        let robots = self.robots.load(&packages, rules, &HashSet::new(), &mut diagnostics);
        if diagnostics.has_errors() {
            return Err(CliError::Description(diagnostics.errors().cloned().collect()));
        }
        Ok(described(&robot_descriptions(&robots, &packages, self.robots.xacro_args())))
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Description`] if a robot cannot be loaded; [`CliError::NoSimulator`]; [`CliError::Ros2`] if ROS 2's network cannot be used; [`CliError::Variable`].
pub fn run(args: &Ros2Command) -> Result<(), CliError> {
    listen_for_stop()?;
    let options = Ros2Options { descriptions: args.descriptions()?, ..args.ros2.options()? };
    let node = Node::open(&args.domain.domain, "ros2")?;
    if !args.wait {
        check_topics(&node, &args.domain.domain, &[])?;
    }
    let end = args.duration.map(|duration| Instant::now() + duration);
    let number = options.domain_id;
    let mut ros2 = Ros2::start(node, options)?;
    print_line(&format!("node /belvedere in domain {number} of ROS 2; stop with Ctrl-C"))?;
    while !stop_wanted() && end.is_none_or(|end| Instant::now() < end) {
        ros2.turn(NAP)?;
    }
    Ok(())
}
