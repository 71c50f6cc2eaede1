//! A contact sensor with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::outlet::Outlet;
use super::report::Say;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::diagnostics::Severity;
use crate::description::model::{self, InstrumentPlugin, LinkIndex, Sensor, SensorKind};
use crate::entities::{Entities, EntityId};
use crate::robot::Pair;
use crate::world::physics::{Physics, ShapeHandle};
use belvedere_bridge::payload::Contact;
use belvedere_bridge::{Kind, StreamSpec, Text};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::collections::HashMap;

/// The most contacts in a frame of a sensor with one collision, and in any frame.
const MOST_CONTACTS: [usize; 2] = [64, 512];
/// Frames that wait for a subscriber. They are larger than those of other instruments.
const BUFFER: usize = 4;

impl Behaviour for model::ContactSensor {
    fn name(&self) -> &'static str {
        "contact sensor"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(ContactChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        if self.collisions.is_empty() {
            say("watches", "nothing".into());
        }
    }
}

/// A running sensor.
struct ContactChannel {
    id: EntityId,
    /// Its index among the model's contact sensors.
    number: usize,
    /// The link along whose axes it reports; none for the world.
    link: Option<LinkIndex>,
    /// The time of physics at the last frame, and the impulses that each pair had passed by then.
    last_ns: u64,
    last: HashMap<(ShapeHandle, ShapeHandle), DVec3>,
    most: usize,
    /// True if a name or the number of contacts was too great for a message and that was told.
    has_told: bool,
    rows: Vec<Contact>,
    contacts: Outlet,
}

impl ContactChannel {
    fn open(
        sensor: &Sensor,
        described: &model::ContactSensor,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let model = &opening.entity.model;
        let frame = plugin.frame_name.trim_start_matches('/');
        let is_world = matches!(frame, "world" | "map");
        let link = if is_world { None } else { model.link_named(frame) };
        if !is_world && link.is_none() {
            let what = format!(
                "the contacts of sensor '{}' are in the frame '{frame}', which is no link of its model: they are given in \
                 the world",
                sensor.name
            );
            opening.names.note(Severity::Warning, &sensor.source, what, "name a link, or world");
        }
        let all = opening.entity.sensors().iter();
        let all = all.filter(|sensor| matches!(sensor.kind, SensorKind::Contact(_)));
        let [of_one, of_all] = MOST_CONTACTS;
        let most = (of_one * described.collisions.len()).clamp(of_one, of_all);
        let (topic, _) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::Contacts, most).rate_hz(opening.rate.hz());
        let spec = StreamSpec { buffer: BUFFER, ..spec };
        let contacts = match link {
            Some(_) => opening.open(&spec.frame_id(frame))?,
            None => opening.open_in_world(&spec.frame_id(if is_world { frame } else { "world" }))?,
        };
        let mut channel = Self {
            id: opening.id,
            number: all.take_while(|other| !std::ptr::eq(*other, sensor)).count(),
            // Gazebo's plugins write the name of the frame, but the values are in the world.
            link: link.filter(|_| !opening.gazebo_compat),
            last_ns: opening.physics.time_ns(),
            last: HashMap::new(),
            most,
            has_told: false,
            rows: Vec::with_capacity(most),
            contacts,
        };
        if let Some(feeler) = opening.entity.feelers.get(channel.number) {
            channel.keep(feeler.pairs());
        }
        Ok(channel)
    }

    /// Remembers which impulses have been told.
    fn keep(&mut self, pairs: &[Pair]) {
        self.last.clear();
        self.last.extend(pairs.iter().map(|pair| (pair.shapes, pair.passed)));
    }

    /// Adds the contacts of a pair. The sum of their forces is the mean since the last frame. Each point has the force of the
    /// last step in which the pair touched, and its share of the rest by the force that it transmitted in that step.
    fn add(&mut self, pair: &Pair, names: [Text<128>; 2], frame: &Moment<'_>) {
        let told = self.last.get(&pair.shapes).copied().unwrap_or_default();
        let felt = pair.touches.iter().map(|touch| touch.impulse);
        let strength: f64 = felt.clone().map(DVec3::length).sum();
        let last: DVec3 = felt.sum::<DVec3>() / frame.step_s;
        let rest = match frame.period_s {
            Some(period_s) => (pair.passed - told) / period_s - last,
            None => DVec3::ZERO,
        };
        let centre = frame.physics.balance_point(self.id.index(), pair.own.0);
        for touch in &pair.touches {
            let share = if strength > 0.0 {
                touch.impulse.length() / strength
            } else {
                1.0 / pair.touches.len() as f64
            };
            let force = touch.impulse / frame.step_s + rest * share;
            let torque = (touch.point - centre).cross(force);
            let turned = |vector: DVec3| frame.frame_from_world.transform_vector(vector).to_array();
            let [collision1, collision2] = names;
            self.rows.push(Contact {
                collision1,
                collision2,
                position: frame.frame_from_world.transform_point(touch.point).to_array(),
                normal: turned(-touch.outward),
                depth: (-touch.gap_m).max(0.0),
                force: turned(force),
                torque: turned(torque),
            });
        }
    }

    /// Returns the name of a collision as Gazebo has it; `None` if its model was deleted.
    fn name(&mut self, entities: &Entities, place: (usize, LinkIndex, usize)) -> Option<Text<128>> {
        let (model, link, collision) = place;
        let entity = entities.at(model)?;
        let name = format!("{}::{}", entity.name, entity.model.collision_name(link, collision));
        let text = Text::cut(&name);
        if text.as_str() != name {
            self.tell(&format!("the name '{name}' has more than 127 bytes and is cut"));
        }
        Some(text)
    }

    fn tell(&mut self, what: &str) {
        if !std::mem::replace(&mut self.has_told, true) {
            tracing::warn!(topic = self.contacts.topic(), "{what}");
        }
    }

    /// Leaves out the weakest contacts if there is no room for all.
    fn fit(&mut self) {
        if self.rows.len() <= self.most {
            return;
        }
        let what = format!("{} contacts: a frame has the {} strongest", self.rows.len(), self.most);
        self.tell(&what);
        let strength = |row: &Contact| DVec3::from(row.force).length();
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        order.sort_by(|one, other| strength(&self.rows[*other]).total_cmp(&strength(&self.rows[*one])));
        order.truncate(self.most);
        order.sort_unstable();
        self.rows = order.into_iter().map(|row| self.rows[row]).collect();
    }
}

/// What the contacts of a frame have in common.
struct Moment<'a> {
    physics: &'a Physics,
    frame_from_world: Pose,
    step_s: f64,
    /// Time since the last frame; `None` if physics has made no step since.
    period_s: Option<f64>,
}

impl Channel for ContactChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.contacts]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let RigContext { physics, entities, stamp_ns, .. } = *context;
        let entity = entities.get(self.id);
        let Some(feeler) = entity.and_then(|entity| entity.feelers.get(self.number)) else { return };
        let (model, now_ns) = (self.id.index(), physics.time_ns());
        let passed_ns = now_ns.saturating_sub(self.last_ns);
        let world_from_frame = self.link.map(|link| physics.world_from_link_at(model, link, stamp_ns));
        let frame = Moment {
            physics,
            frame_from_world: world_from_frame.unwrap_or(Pose::IDENTITY).inverse(),
            step_s: physics.step_s(),
            period_s: (passed_ns > 0).then_some(passed_ns as f64 * 1e-9),
        };
        self.rows.clear();
        for pair in feeler.pairs() {
            // Without a step since the last frame, that of the last step is told again.
            let is_new =
                if passed_ns > 0 { pair.touched_ns > self.last_ns } else { pair.touched_ns == now_ns };
            let Some(other) = physics.collision_of(pair.shapes.1).filter(|_| is_new) else { continue };
            let (link, collision) = pair.own;
            let names = (self.name(entities, (model, link, collision)), self.name(entities, other));
            if let (Some(own), Some(other)) = names {
                self.add(pair, [own, other], &frame);
            }
        }
        self.fit();
        self.keep(feeler.pairs());
        self.last_ns = now_ns;
        self.contacts.send_structs(stamp_ns, &self.rows);
    }

    fn restart(&mut self) {
        self.last_ns = 0;
        self.last.clear();
    }
}
