//! Foxglove's WebSocket protocol, for Foxglove, Lichtblick and whatever else speaks it: the streams as ROS 1's messages.
//!
//! A client that reads slowly gets fewer messages and slows nobody: while something waits for room on its way, frames stay
//! where they are, and the oldest of each stream give way; nor is it answered, as nothing is read of it. It is told of
//! messages that were left out by a status. There is no latching in the protocol; a stream that keeps its last message, as
//! static transforms do, gives it at each subscription. A channel has one subscription of a client at a time, so that no
//! client takes the places of others among a stream's subscribers.

use super::Shared;
use super::advertisement::Advertiser;
use super::assets;
use super::channels::{Channel, Channels};
use super::drivers::Drivers;
use super::parameters::Followed;
use super::socket::{Said, Socket};
use super::twist::Twist;
use super::waiting::wait;
use crate::recording::ros1::RosStream;
use belvedere_bridge::{Frame, Node, Subscriber};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tungstenite::{Error, Message};

const NAP: Duration = Duration::from_millis(50);
/// Streams that a client may follow at a time.
const MAX_FOLLOWED: usize = 256;
/// Channels that a client may publish on.
const MAX_ADVERTISED: usize = 64;
/// Time between two statuses about lost messages.
const STATUS_INTERVAL: Duration = Duration::from_millis(2500);

/// Opcodes of binary messages; a client's message has the same one as ours.
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

/// What a client publishes.
#[derive(Debug, Deserialize)]
struct ClientChannel {
    id: u32,
    topic: String,
    encoding: String,
}

/// A subscription of the client's.
struct Subscription {
    /// The client's number.
    id: u32,
    /// The number of its channel.
    channel: u32,
    ros: RosStream,
    /// Of each stream of the channel.
    subscribers: Vec<Subscriber>,
}

impl Subscription {
    /// Whether only the newest counts: of pictures and clouds, as opposed to messages of which each does.
    fn is_large(&self) -> bool {
        matches!(self.ros.message_type.name, "sensor_msgs/Image" | "sensor_msgs/PointCloud2")
    }

    /// Follows the streams that its channel has now, and no others.
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

/// A client that is connected.
pub(super) struct Foxglove<'a> {
    shared: &'a Shared,
    socket: Socket,
    advertiser: Advertiser,
    channels: Channels,
    listed: Option<u64>,
    subscriptions: Vec<Subscription>,
    /// Of the simulation; the client's time is what it says.
    clock: Option<Subscriber>,
    told_ns: Option<u64>,
    published: BTreeMap<u32, ClientChannel>,
    drivers: Drivers,
    parameters: Followed,
    lost: u64,
    next_status: Instant,
    message: Vec<u8>,
}

impl<'a> Foxglove<'a> {
    /// Who speaks the protocol of this name.
    pub(super) fn new(shared: &'a Shared, socket: Socket, protocol: &str) -> Self {
        Self {
            advertiser: Advertiser::new(protocol),
            clock: shared.node.subscriber("clock").ok(),
            shared,
            socket,
            channels: Channels::default(),
            listed: None,
            subscriptions: Vec::new(),
            told_ns: None,
            published: BTreeMap::new(),
            drivers: Drivers::default(),
            parameters: Followed::default(),
            lost: 0,
            next_status: Instant::now(),
            message: Vec::new(),
        }
    }

    /// Serves it until it goes.
    ///
    /// # Errors
    /// How it went.
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
                self.tell_of_channels()?;
            }
            if !self.socket.has_unsent() {
                self.tell_of_parameters()?;
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
                self.tell_of_losses()?;
            }
        }
        Ok(())
    }

    /// Tells of channels that came and went, and follows the streams that those have now that the client has subscribed to.
    fn tell_of_channels(&mut self) -> Result<(), Error> {
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

    /// Sends the values of followed parameters that have changed.
    fn tell_of_parameters(&mut self) -> Result<(), Error> {
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
                Err(error) => Err(format!("this is not understood: {error}")),
            },
        };
        done.or_else(|reason| self.status(1, &reason))
    }

    /// What is refused is an inner error; an outer one, that the client has gone.
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
                    "parameters cannot be set; settings of sensors can: belvedere control configure".into(),
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
            return Err(format!("at most {MAX_FOLLOWED} streams are followed for a client"));
        }
        let ros = channel.ros.clone();
        let mut subscription =
            Subscription { id: wanted.id, channel: channel.id, ros, subscribers: Vec::new() };
        subscription.follow(&self.shared.node, channel)?;
        self.subscriptions.push(subscription);
        Ok(())
    }

    /// A message that the client publishes: velocities are taken.
    fn take_message(&mut self, bytes: &[u8]) -> Result<(), String> {
        let wrong = || "this is not a message of a channel that was advertised".to_owned();
        let (&MESSAGE, rest) = bytes.split_first().ok_or_else(wrong)? else { return Err(wrong()) };
        let (id, payload) = rest.split_first_chunk::<4>().ok_or_else(wrong)?;
        let channel = self.published.get(&u32::from_le_bytes(*id)).ok_or_else(wrong)?;
        let Twist { linear, angular } = Twist::read(&channel.encoding, payload)
            .map_err(|error| format!("what is sent on {} is no geometry_msgs/Twist{error}", channel.topic))?;
        let (linear, angular) = (linear.array(), angular.array());
        let (_, streams) = self.shared.listing.now();
        self.drivers.drive(&self.shared.node, &streams, &channel.topic, linear, angular)
    }

    fn send_time(&mut self) -> Result<(), Error> {
        let newest = self.clock.as_mut().and_then(|clock| clock.take_newest().ok().flatten());
        match newest {
            Some(frame) => self.tell_time(frame.header().stamp_ns),
            None => Ok(()),
        }
    }

    fn tell_time(&mut self, now_ns: u64) -> Result<(), Error> {
        if self.told_ns == Some(now_ns) {
            return Ok(());
        }
        self.told_ns = Some(now_ns);
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
        // What has no message of ROS's is left out, as by the node for ROS.
        if ros.write(&frame.view(), &mut self.message).is_none() {
            return Ok(());
        }
        let stamp_ns = frame.header().stamp_ns;
        // Nothing comes before its time; what was kept for who comes late does not turn it back.
        if !frame.is_from_history() && self.told_ns.is_none_or(|told_ns| told_ns < stamp_ns) {
            self.tell_time(stamp_ns)?;
        }
        let mut message = Vec::with_capacity(13 + self.message.len());
        message.push(MESSAGE);
        message.extend_from_slice(&subscription.to_le_bytes());
        message.extend_from_slice(&stamp_ns.to_le_bytes());
        message.extend_from_slice(&self.message);
        self.socket.send(Message::binary(message))
    }

    fn tell_of_losses(&mut self) -> Result<(), Error> {
        let now = Instant::now();
        if self.lost == 0 || now < self.next_status {
            return Ok(());
        }
        self.next_status = now + STATUS_INTERVAL;
        let lost = std::mem::take(&mut self.lost);
        // Clients know these words and say what to do.
        self.status(1, &format!("Send buffer limit reached: {lost} messages were left out"))
    }

    fn status(&mut self, level: u8, message: &str) -> Result<(), Error> {
        self.say(&json!({ "op": "status", "level": level, "message": message }))
    }

    fn say(&mut self, message: &Value) -> Result<(), Error> {
        self.socket.send(Message::text(message.to_string()))
    }
}
