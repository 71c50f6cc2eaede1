//! ROS 2: streams of a domain as topics of ROS 2, and velocities from ROS 2 as commands, without a ROS installation.
//!
//! [`Ros2`] is a consumer like any other: it works beside a simulator, a replay or any other publisher of the domain.
//! Messages are written from the frames in shared memory by the encoders of recordings
//! ([`RosStream`](crate::recording::ros::RosStream)), and sent by `belvedere-rtps`. What nobody reads is not rendered.

mod cdr;
mod commands;
mod compressed;
mod descriptions;
mod listing;
mod messages;
mod names;
mod outgoing;
mod rcl_interfaces;
mod services;
mod type_hash;

pub use belvedere_rtps::Range;
pub use descriptions::Descriptions;
pub use names::{Naming, Remap, namespace};

use belvedere_bridge::{Kind, Node, StreamInfo};
use belvedere_rtps::{JoinError, Participant, Qos, TopicError};
use commands::Commands;
use compressed::Compressed;
use descriptions::Described;
use listing::Listing;
use outgoing::{Outgoing, ros_stream};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use services::Services;
use std::collections::BTreeSet;
use std::net::Ipv4Addr;
use std::time::Duration;

/// Longest wait for something before looking whether to stop.
const NAP: Duration = Duration::from_millis(100);

/// The number of messages of a topic that are kept for readers that are slow.
const DEPTH: usize = 10;

/// Why streams cannot be published, or commands not be received.
#[derive(Debug, thiserror::Error)]
pub enum Ros2Error {
    /// The domain of ROS 2 cannot be joined.
    #[error("ROS 2's network: {0}")]
    Join(#[from] JoinError),
    /// The domain of the simulation cannot be used.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
    /// A topic has a name or type that ROS 2 forbids.
    #[error(transparent)]
    Type(#[from] TopicError),
    /// A thread cannot be started.
    #[error("starting a thread: {0}")]
    Thread(#[from] std::io::Error),
}

/// Reliability of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reliability {
    /// Messages that are lost are sent again.
    Reliable,
    /// The profile for sensor data: messages that are lost stay lost.
    SensorData,
}

/// What is published, and how.
#[derive(Debug, Clone)]
pub struct Ros2Options {
    /// The domain, as `ROS_DOMAIN_ID` gives it: 0 to 232.
    pub domain_id: u32,
    /// Who can see the node.
    pub range: Range,
    /// Hosts whose nodes are found without multicast.
    pub peers: Vec<Ipv4Addr>,
    /// The names of topics.
    pub naming: Naming,
    /// The reliability of topics, by their names in ROS 2; all others are reliable.
    pub reliability: Vec<(String, Reliability)>,
    /// The quality of compressed images that are JPEG, 1 to 100.
    pub jpeg_quality: u8,
    /// True if velocities from ROS 2 are ignored, and services that change something refuse.
    pub no_commands: bool,
    /// The descriptions of robots. A clone of them, which the caller keeps, changes what is published.
    pub descriptions: Descriptions,
}

impl Ros2Options {
    /// The quality of JPEG unless another one is chosen.
    pub const JPEG_QUALITY: u8 = 95;
}

impl Default for Ros2Options {
    fn default() -> Self {
        Self {
            domain_id: 0,
            range: Range::default(),
            peers: Vec::new(),
            naming: Naming::default(),
            reliability: Vec::new(),
            jpeg_quality: Self::JPEG_QUALITY,
            no_commands: false,
            descriptions: Descriptions::default(),
        }
    }
}

/// The node `belvedere` of ROS 2.
#[derive(Debug)]
pub struct Ros2 {
    node: Node,
    options: Ros2Options,
    outgoing: Vec<Outgoing>,
    commands: Vec<Commands>,
    described: Described,
    /// Streams that cannot be published, which are reported once.
    refused: BTreeSet<String>,
    /// No network takes announcements, which is reported once.
    is_cut: bool,
    listing: Listing,
    /// Only kept, since a thread answers their requests.
    _services: Services,
    // Dropped last: what it serves must be removed first.
    participant: Participant,
}

impl Ros2 {
    /// Joins a domain of ROS 2 for a domain of simulations.
    ///
    /// # Errors
    /// [`Ros2Error::Join`] if no port can be opened; [`Ros2Error::Bridge`] if the domain of simulations cannot be used;
    /// [`Ros2Error::Thread`].
    pub fn start(node: Node, options: Ros2Options) -> Result<Self, Ros2Error> {
        let namespace = format!("/{}", options.naming.namespace);
        let participant = Participant::join(&belvedere_rtps::Node {
            domain: options.domain_id,
            range: options.range,
            peers: &options.peers,
            namespace: &namespace,
            name: "belvedere",
        })?;
        let node_name = format!("{}/belvedere", namespace.trim_end_matches('/'));
        Ok(Self {
            listing: Listing::start(node.clone())?,
            _services: Services::start(&participant, &node, &node_name, &options)?,
            node,
            options,
            outgoing: Vec::new(),
            commands: Vec::new(),
            described: Described::default(),
            refused: BTreeSet::new(),
            is_cut: false,
            participant,
        })
    }

    /// Waits at most for this time until frames arrive, and publishes them.
    ///
    /// # Errors
    /// If the domain of simulations cannot be used any more.
    pub fn turn(&mut self, at_most: Duration) -> Result<(), Ros2Error> {
        if let Some(streams) = self.listing.take()? {
            self.look(&streams);
            self.report_network();
        }
        for outgoing in &mut self.outgoing {
            outgoing.follow(&self.node);
        }
        self.wait(at_most);
        for outgoing in &mut self.outgoing {
            outgoing.send();
        }
        Ok(())
    }

    /// Updates the topics to the streams and descriptions that there are now.
    fn look(&mut self, streams: &[StreamInfo]) {
        self.described.update(&self.options.descriptions, &self.participant, &self.options.naming);
        let is_there = |topic: &str, is_wanted: &dyn Fn(&StreamInfo) -> bool| {
            streams.iter().any(|stream| stream.topic == topic && is_wanted(stream))
        };
        self.outgoing.retain(|known| is_there(known.topic(), &|stream| stream.publishers > 0));
        self.commands.retain(|known| is_there(known.topic(), &|stream| stream.subscribers > 0));
        for stream in streams {
            let is_known = self.outgoing.iter().any(|known| known.topic() == stream.topic)
                || self.commands.iter().any(|known| known.topic() == stream.topic)
                || self.refused.contains(&stream.topic);
            if is_known {
                continue;
            }
            if let Err(reason) = self.add(stream) {
                tracing::warn!(
                    topic = stream.topic,
                    "{reason}, so it is left out; --remap gives it another name"
                );
                self.refused.insert(stream.topic.clone());
            }
        }
    }

    /// Reports that no other node can be found, and that the network is back.
    fn report_network(&mut self) {
        let is_cut = self.participant.is_cut();
        match (std::mem::replace(&mut self.is_cut, is_cut), is_cut) {
            (false, true) => tracing::warn!(
                "no network takes multicast datagrams, so nodes of ROS 2 cannot be found; bring one up, for this host \
                 alone with: ip link set lo up multicast on"
            ),
            (true, false) => tracing::info!("a network takes multicast datagrams again"),
            _ => {}
        }
    }

    /// Publishes a stream, or accepts commands for it.
    fn add(&mut self, stream: &StreamInfo) -> Result<(), String> {
        let because = |error: Ros2Error| error.to_string();
        if stream.kind == Some(Kind::VelocityCommand) && stream.subscribers > 0 {
            if !self.options.no_commands {
                let name = self.options.naming.name(&format!("/{}", stream.topic))?;
                let commands = Commands::new(&self.participant, &self.node, &stream.topic, &name);
                self.commands.push(commands.map_err(because)?);
            }
            return Ok(());
        }
        let Some(ros) = ros_stream(stream).filter(|_| stream.publishers > 0) else { return Ok(()) };
        let name = self.options.naming.name(&ros.topic)?;
        if let Some(message) = self.outgoing.iter().find_map(|known| known.conflict(&name, &ros)) {
            return Err(format!("the topic {name} has the type {message} already"));
        }
        let compressed = Compressed::is_possible(stream)
            .then(|| self.options.naming.name_below(&ros.topic, &name, "compressed"))
            .map(|name| self.compressed(stream, &name))
            .transpose()
            .map_err(because)?;
        let qos = self.qos(&name);
        let outgoing =
            Outgoing::new(&self.participant, stream, ros, &name, qos, compressed).map_err(because)?;
        self.outgoing.push(outgoing);
        Ok(())
    }

    fn compressed(&self, stream: &StreamInfo, name: &str) -> Result<Compressed, Ros2Error> {
        let (qos, quality) = (self.qos(name), self.options.jpeg_quality);
        Compressed::new(&self.participant, &self.node, &stream.topic, name, qos, quality)
    }

    /// Returns the quality of service of a topic that is not latched.
    fn qos(&self, name: &str) -> Qos {
        match self.options.reliability.iter().find(|(topic, _)| topic == name) {
            Some((_, Reliability::SensorData)) => Qos::best_effort(5),
            Some((_, Reliability::Reliable)) | None => Qos::volatile(DEPTH),
        }
    }

    /// Sleeps until a frame of a followed stream arrives.
    fn wait(&mut self, at_most: Duration) {
        let followed = self.outgoing.iter_mut().filter_map(Outgoing::subscriber);
        let ready = followed.filter_map(|subscriber| subscriber.readiness().ok());
        let mut fds: Vec<PollFd<'_>> = ready.map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN)).collect();
        let nap = Timespec { tv_sec: at_most.as_secs() as i64, tv_nsec: i64::from(at_most.subsec_nanos()) };
        // If the sleep is interrupted, the caller just looks again earlier.
        let _ = poll(&mut fds, Some(&nap));
    }
}
