//! Foxglove's WebSocket protocol, for Foxglove, Lichtblick and other clients: the streams as ROS 1 messages.
//!
//! A client that reads slowly gets fewer messages and slows down nothing else. While data for it waits to be sent,
//! frames stay in shared memory, where the oldest of each stream are overwritten, and the client's requests are not
//! read. A status reports the number of lost messages. The protocol has no latching; instead, a stream that keeps its
//! last message, such as static transforms, sends it at each subscription. A client can subscribe to a channel only
//! once at a time, so that it does not take other clients' places among a stream's subscribers.

use super::Shared;
use super::advertisement::Advertiser;
use super::assets;
use super::channels::{Channel, Channels};
use super::drivers::Drivers;
use super::parameters::Followed;
use super::socket::{Said, Socket};
use super::twist::Twist;
use super::waiting::wait;
use crate::recording::ros::RosStream;
use belvedere_bridge::{Frame, Node, Subscriber};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tungstenite::{Error, Message};

const NAP: Duration = Duration::from_millis(50);
/// Most streams that a client may subscribe to at a time.
const MAX_FOLLOWED: usize = 256;
/// Most channels that a client may publish on.
const MAX_ADVERTISED: usize = 64;
/// Time between two statuses about lost messages.
const STATUS_INTERVAL: Duration = Duration::from_millis(2500);

/// Opcodes of binary messages. `MESSAGE` is used in both directions.
const MESSAGE: u8 = 1;
const TIME: u8 = 2;

#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase", rename_all_fields = "camelCase")]
enum Request {
    Subscribe { subscriptions: Vec<Wanted> },
    Unsubscribe { subscription_ids: Vec<u32> },
    Advertise { channels: Vec<ClientChannel> },
    Unadvertise { channel_ids: Vec<u32> },
    GetParameters { parameter_names: Vec<String>, id: Option<String> },
    SetParameters { id: Option<String> },
    SubscribeParameterUpdates { parameter_names: Vec<String> },
    UnsubscribeParameterUpdates { parameter_names: Vec<String> },
    FetchAsset { uri: String, request_id: u32 },
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Wanted {
    id: u32,
    channel_id: u32,
}

/// A channel that a client publishes on.
#[derive(Debug, Deserialize)]
struct ClientChannel {
    id: u32,
    topic: String,
    encoding: String,
}

/// A subscription of the client.
struct Subscription {
    /// The number that the client has given it.
    id: u32,
    /// The number of its channel.
    channel: u32,
    ros: RosStream,
    /// Subscribers of the channel's streams.
    subscribers: Vec<Subscriber>,
}

impl Subscription {
    /// Returns true for images and clouds, of which only the newest is sent. All other messages are sent.
    fn is_large(&self) -> bool {
        matches!(self.ros.message_type.name, "sensor_msgs/Image" | "sensor_msgs/PointCloud2")
    }

    /// Subscribes to exactly the streams that its channel has now.
    fn follow(&mut self, node: &Node, channel: &Channel) -> Result<(), String> {
        self.subscribers.retain(|subscriber| channel.topics.contains(subscriber.topic()));
        for topic in &channel.topics {
            if self.subscribers.iter().all(|subscriber| subscriber.topic() != topic) {
                self.subscribers.push(node.subscriber(topic).map_err(|error| error.to_string())?);
            }
        }
        Ok(())
    }
}

/// A connected client.
pub(super) struct Foxglove<'a> {
    shared: &'a Shared,
    socket: Socket,
    advertiser: Advertiser,
    channels: Channels,
    listed: Option<u64>,
    subscriptions: Vec<Subscription>,
    /// The simulation's clock, which sets the client's time.
    clock: Option<Subscriber>,
    sent_ns: Option<u64>,
    published: BTreeMap<u32, ClientChannel>,
    drivers: Drivers,
    parameters: Followed,
    lost: u64,
    next_status: Instant,
    message: Vec<u8>,
}

impl<'a> Foxglove<'a> {
    /// Creates a client that uses this version of the protocol.
    pub(super) fn new(shared: &'a Shared, socket: Socket, protocol: &str) -> Self {
        Self {
            advertiser: Advertiser::new(protocol),
            clock: shared.node.subscriber("clock").ok(),
            shared,
            socket,
            channels: Channels::default(),
            listed: None,
            subscriptions: Vec::new(),
            sent_ns: None,
            published: BTreeMap::new(),
            drivers: Drivers::default(),
            parameters: Followed::default(),
            lost: 0,
            next_status: Instant::now(),
            message: Vec::new(),
        }
    }

    /// Serves the client until it disconnects.
    ///
    /// # Errors
    /// The reason why the connection ended.
    pub(super) fn serve(mut self) -> Result<(), Error> {
        self.say(&json!({
            "op": "serverInfo",
            "name": format!("belvedere {}", self.shared.node.domain()),
            "capabilities": ["time", "parameters", "parametersSubscribe", "clientPublish", "assets"],
            "supportedEncodings": ["ros1", "json"],
            "metadata": { "ROS_DISTRO": "noetic" },
            "sessionId": self.shared.session,
        }))?;
        while !self.shared.is_stopping() {
            self.socket.keep_alive(Instant::now())?;
            if !self.socket.has_unsent() {
                self.send_channels()?;
            }
            if !self.socket.has_unsent() {
                self.send_parameters()?;
            }
            let followed = self.subscriptions.iter_mut().flat_map(|known| &mut known.subscribers);
            wait(&self.socket, None, followed.chain(self.clock.as_mut()), NAP);
            self.socket.flush()?;
            while let Some(said) = self.socket.read()? {
                self.take(&said)?;
            }
            if !self.socket.has_unsent() {
                self.send_time()?;
                self.send_frames()?;
            }
            if !self.socket.has_unsent() {
                self.send_losses()?;
            }
        }
        Ok(())
    }

    /// Announces added and removed channels, and updates the streams of the client's subscriptions.
    fn send_channels(&mut self) -> Result<(), Error> {
        let (edition, streams) = self.shared.listing.now();
        if self.listed == Some(edition) {
            return Ok(());
        }
        self.listed = Some(edition);
        let changes = self.channels.update(&streams);
        if !changes.gone.is_empty() {
            self.subscriptions.retain(|known| !changes.gone.contains(&known.channel));
            self.say(&json!({ "op": "unadvertise", "channelIds": changes.gone }))?;
        }
        if !changes.came.is_empty() {
            let advertisement = self.advertiser.advertise(changes.came.iter().map(|(id, ros)| (*id, ros)));
            self.say(&advertisement)?;
        }
        let mut refused = None;
        for known in &mut self.subscriptions {
            if let Some(channel) = self.channels.get(known.channel) {
                refused = known.follow(&self.shared.node, channel).err().or(refused);
            }
        }
        refused.map_or(Ok(()), |reason| self.status(1, &reason))
    }

    /// Sends the values of the client's subscribed parameters that have changed.
    fn send_parameters(&mut self) -> Result<(), Error> {
        let changes = self.shared.parameters.changes(&mut self.parameters);
        if changes.is_empty() {
            return Ok(());
        }
        self.say(&json!({ "op": "parameterValues", "parameters": changes }))
    }

    fn take(&mut self, said: &Said) -> Result<(), Error> {
        let done = match said {
            Said::Binary(bytes) => self.take_message(bytes),
            Said::Text(text) => match serde_json::from_str(text) {
                Ok(request) => self.answer(request)?,
                Err(error) => Err(format!("this request is not understood: {error}")),
            },
        };
        done.or_else(|reason| self.status(1, &reason))
    }

    /// Answers a request. The inner error is a refusal; the outer one means that the client has disconnected.
    fn answer(&mut self, request: Request) -> Result<Result<(), String>, Error> {
        match request {
            Request::Subscribe { subscriptions } => {
                for wanted in subscriptions {
                    if let Err(reason) = self.subscribe(&wanted) {
                        return Ok(Err(reason));
                    }
                }
            }
            Request::Unsubscribe { subscription_ids } => {
                self.subscriptions.retain(|known| !subscription_ids.contains(&known.id));
            }
            Request::Advertise { channels } => {
                for channel in channels {
                    if self.published.len() >= MAX_ADVERTISED {
                        return Ok(Err(format!("at most {MAX_ADVERTISED} topics may be published")));
                    }
                    self.published.insert(channel.id, channel);
                }
            }
            Request::Unadvertise { channel_ids } => {
                self.published.retain(|id, _| !channel_ids.contains(id));
            }
            Request::GetParameters { parameter_names, id } => {
                let values = self.shared.parameters.values(&parameter_names);
                self.say(&json!({ "op": "parameterValues", "parameters": values, "id": id }))?;
            }
            Request::SetParameters { id } => {
                let values = self.shared.parameters.values(&[]);
                self.say(&json!({ "op": "parameterValues", "parameters": values, "id": id }))?;
                return Ok(Err(
                    "parameters are read-only; set sensor settings with belvedere control configure".into(),
                ));
            }
            Request::FetchAsset { uri, request_id } => {
                let file = self.shared.asset(&uri);
                self.socket.send(Message::binary(assets::response(request_id, file)))?;
            }
            Request::SubscribeParameterUpdates { parameter_names } => self.parameters.follow(parameter_names),
            Request::UnsubscribeParameterUpdates { parameter_names } => {
                self.parameters.leave(&parameter_names);
            }
        }
        Ok(Ok(()))
    }

    fn subscribe(&mut self, wanted: &Wanted) -> Result<(), String> {
        let Some(channel) = self.channels.get(wanted.channel_id) else {
            return Err(format!("there is no channel {}", wanted.channel_id));
        };
        if self.subscriptions.iter().any(|known| known.id == wanted.id) {
            return Err(format!("there is a subscription {} already", wanted.id));
        }
        if let Some(known) = self.subscriptions.iter().find(|known| known.channel == wanted.channel_id) {
            return Err(format!("{} is subscribed to already, as {}", channel.ros.topic, known.id));
        }
        let followed: usize = self.subscriptions.iter().map(|known| known.subscribers.len()).sum();
        if followed + channel.topics.len() > MAX_FOLLOWED {
            return Err(format!("a client can subscribe to at most {MAX_FOLLOWED} streams"));
        }
        let ros = channel.ros.clone();
        let mut subscription =
            Subscription { id: wanted.id, channel: channel.id, ros, subscribers: Vec::new() };
        subscription.follow(&self.shared.node, channel)?;
        self.subscriptions.push(subscription);
        Ok(())
    }

    /// Handles a message that the client publishes. Only velocities are accepted.
    fn take_message(&mut self, bytes: &[u8]) -> Result<(), String> {
        let wrong = || "this is not a message of a channel that was advertised".to_owned();
        let (&MESSAGE, rest) = bytes.split_first().ok_or_else(wrong)? else { return Err(wrong()) };
        let (id, payload) = rest.split_first_chunk::<4>().ok_or_else(wrong)?;
        let channel = self.published.get(&u32::from_le_bytes(*id)).ok_or_else(wrong)?;
        let Twist { linear, angular } = Twist::read(&channel.encoding, payload).map_err(|error| {
            format!("the message on {} is not a geometry_msgs/Twist{error}", channel.topic)
        })?;
        let (linear, angular) = (linear.array(), angular.array());
        let (_, streams) = self.shared.listing.now();
        self.drivers.drive(&self.shared.node, &streams, &channel.topic, linear, angular)
    }

    fn send_time(&mut self) -> Result<(), Error> {
        let newest = self.clock.as_mut().and_then(|clock| clock.take_newest().ok().flatten());
        match newest {
            Some(frame) => self.send_stamp(frame.header().stamp_ns),
            None => Ok(()),
        }
    }

    fn send_stamp(&mut self, now_ns: u64) -> Result<(), Error> {
        if self.sent_ns == Some(now_ns) {
            return Ok(());
        }
        self.sent_ns = Some(now_ns);
        let mut message = vec![TIME];
        message.extend_from_slice(&now_ns.to_le_bytes());
        self.socket.send(Message::binary(message))
    }

    fn send_frames(&mut self) -> Result<(), Error> {
        let mut failed = None;
        let mut subscriptions = std::mem::take(&mut self.subscriptions);
        for known in &mut subscriptions {
            let is_large = known.is_large();
            for subscriber in &mut known.subscribers {
                while !self.socket.has_unsent() {
                    match if is_large { subscriber.take_newest() } else { subscriber.take() } {
                        Ok(Some(frame)) => self.send_frame(known.id, &known.ros, &frame)?,
                        Ok(None) => break,
                        Err(error) => {
                            failed = Some(error.to_string());
                            break;
                        }
                    }
                }
            }
        }
        self.subscriptions = subscriptions;
        failed.map_or(Ok(()), |reason| self.status(1, &reason))
    }

    fn send_frame(&mut self, subscription: u32, ros: &RosStream, frame: &Frame) -> Result<(), Error> {
        self.lost += frame.missed();
        // Frames without a ROS message are skipped, as by the ROS node.
        if ros.write(&frame.view(), &mut self.message).is_none() {
            return Ok(());
        }
        let stamp_ns = frame.header().stamp_ns;
        // The time is sent before the frame. A frame from the history, for a new subscriber, does not set the time
        // back.
        if !frame.is_from_history() && self.sent_ns.is_none_or(|sent_ns| sent_ns < stamp_ns) {
            self.send_stamp(stamp_ns)?;
        }
        let mut message = Vec::with_capacity(13 + self.message.len());
        message.push(MESSAGE);
        message.extend_from_slice(&subscription.to_le_bytes());
        message.extend_from_slice(&stamp_ns.to_le_bytes());
        message.extend_from_slice(&self.message);
        self.socket.send(Message::binary(message))
    }

    fn send_losses(&mut self) -> Result<(), Error> {
        let now = Instant::now();
        if self.lost == 0 || now < self.next_status {
            return Ok(());
        }
        self.next_status = now + STATUS_INTERVAL;
        let lost = std::mem::take(&mut self.lost);
        // Clients recognize these words and suggest a remedy.
        self.status(1, &format!("Send buffer limit reached: {lost} messages were left out"))
    }

    fn status(&mut self, level: u8, message: &str) -> Result<(), Error> {
        self.say(&json!({ "op": "status", "level": level, "message": message }))
    }

    fn say(&mut self, message: &Value) -> Result<(), Error> {
        self.socket.send(Message::text(message.to_string()))
    }
}
