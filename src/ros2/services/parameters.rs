//! [`Parameters`]: the settings of sensors as parameters of the node.

mod codec;
mod table;

use super::Group;
use super::simulator::Simulator;
use crate::ros2::cdr::{Unreadable, message};
use crate::ros2::rcl_interfaces::{MESSAGES, PARAMETER_EVENT, SERVICES, Task};
use crate::ros2::type_hash::{message_hash, service_hash};
use crate::ros2::{Ros2Error, Ros2Options};
use belvedere_bridge::payload::{SensorSettings, SimulationCommand};
use belvedere_bridge::{Error, Node, Operation, StreamSpec, Subscriber, Text};
use belvedere_rtps::{Participant, Qos, Request, Requests, Service, ServiceType, Topic, Writer};
use std::time::Duration;
use table::{Change, Table, Value};

/// The largest request that is accepted, and the most parameters in it.
const MOST_BYTES: usize = 64 * 1024;
const MOST_PARAMETERS: usize = 1000;

/// How long the simulator may take for a change, which it makes between two frames.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Why nothing can be set with `--no-commands`.
const NO_COMMANDS: &str =
    "belvedere ros2 was started with --no-commands, so it sets no parameters; start it without this option";

/// The parameter services of the node, and its topic of changes.
pub(super) struct Parameters {
    /// In the order of [`SERVICES`].
    services: Vec<Service>,
    settings: Subscriber,
    table: Table,
    /// Simulated time of the last change.
    changed_ns: u64,
    events: Writer,
    node_name: String,
    no_commands: bool,
    /// True if the settings could not be read last time, which has been reported.
    has_failed: bool,
}

impl Parameters {
    /// Offers the services of the node with this name.
    pub(super) fn new(
        participant: &Participant,
        requests: &Requests,
        node: &Node,
        node_name: &str,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let mut services = Vec::new();
        for of in SERVICES {
            let (name, service) = (format!("{node_name}/{}", of.name), of.service);
            let hash = service_hash(service, of.definition, MESSAGES);
            let of = ServiceType { name: &name, service, hash: &hash };
            services.push(participant.service(requests, of, MOST_BYTES)?);
        }
        let name = "rcl_interfaces/msg/ParameterEvent";
        let hash = message_hash(name, PARAMETER_EVENT, MESSAGES);
        // The profile that ROS 2 has for this topic.
        let qos = Qos::volatile(1000);
        let events = Topic { name: "/parameter_events", message: name, hash: &hash };
        Ok(Self {
            services,
            settings: node.subscriber(StreamSpec::SENSOR_SETTINGS)?,
            table: Table::new(&[]),
            changed_ns: 0,
            events: participant.writer(events, qos)?,
            node_name: node_name.to_owned(),
            no_commands: options.no_commands,
            has_failed: false,
        })
    }

    /// Returns the response to a request.
    ///
    /// # Errors
    /// If the request cannot be read.
    fn respond(&mut self, task: Task, body: &[u8], simulator: &mut Simulator) -> Result<Vec<u8>, Unreadable> {
        match task {
            Task::List => {
                let (prefixes, depth) = codec::prefixes(body)?;
                let found = self.table.list(&prefixes, depth);
                return Ok(message(|to| {
                    let [names, prefixes] = &found;
                    codec::write_texts(to, names);
                    codec::write_texts(to, prefixes);
                }));
            }
            Task::Set => {
                let wanted = codec::parameters(body)?;
                let one = |parameter| self.set(&[parameter], simulator);
                let results: Vec<_> = wanted.into_iter().map(one).collect();
                return Ok(message(|to| {
                    to.count(results.len());
                    for result in &results {
                        codec::write_result(to, result);
                    }
                }));
            }
            Task::SetAtomically => {
                let result = self.set(&codec::parameters(body)?, simulator);
                return Ok(message(|to| codec::write_result(to, &result)));
            }
            Task::Get | Task::GetTypes | Task::Describe => {}
        }
        let names = codec::names(body)?;
        let found: Vec<_> = names.iter().map(|name| self.table.find(name)).collect();
        Ok(message(|to| match task {
            Task::Get => codec::write_values(to, &found),
            Task::GetTypes => codec::write_types(to, &found),
            _ => {
                to.count(names.len());
                for name in &names {
                    codec::write_descriptor(to, name, self.table.get(name));
                }
            }
        }))
    }

    /// Sets all these parameters, or none of them.
    ///
    /// # Errors
    /// The reason, in a sentence.
    fn set(&mut self, wanted: &[(&str, Value)], simulator: &mut Simulator) -> Result<(), String> {
        if self.no_commands {
            return Err(NO_COMMANDS.to_owned());
        }
        let check = |(name, value): &(&str, Value)| self.table.check(name, *value).transpose();
        let changes: Result<Vec<Change>, String> = wanted.iter().filter_map(check).collect();
        let changes = match changes {
            // Nobody has parameters then, which says more than that a name is wrong.
            Err(_) if !self.table.has_sensors() => return Err(simulator.absence()),
            changes => changes?,
        };
        let mut sensors: Vec<(Text<64>, Vec<Change>)> = Vec::new();
        for change in changes {
            match sensors.iter_mut().find(|(sensor, _)| *sensor == change.setting.sensor) {
                Some((_, of)) => of.push(change),
                None => sensors.push((change.setting.sensor, vec![change])),
            }
        }
        let result = configure_all(&sensors, simulator);
        // The new values were published before the result.
        self.tend();
        result
    }

    /// Reads the settings that the simulator publishes; `None` if they are the same as before.
    fn read(&mut self) -> Result<Option<Table>, Error> {
        let Some(frame) = self.settings.take_newest()? else {
            // The parameters of a simulator that has ended are gone.
            let is_gone = self.settings.publishers() == 0 && self.table.has_sensors();
            return Ok(is_gone.then(|| Table::new(&[])));
        };
        self.changed_ns = frame.header().stamp_ns;
        let topic = StreamSpec::SENSOR_SETTINGS.to_owned();
        let sensors = frame.view().structs().map_err(|error| Error::Frame { topic, error })?;
        Ok(Some(Table::new(&sensors.collect::<Vec<SensorSettings>>())))
    }

    /// Publishes what is different in a new table.
    fn publish(&self, now: &Table) {
        let changes = now.since(&self.table);
        if changes.iter().all(Vec::is_empty) {
            return;
        }
        self.events.write(message(|to| {
            to.time(self.changed_ns);
            to.text(&self.node_name);
            for parameters in &changes {
                codec::write_parameters(to, parameters);
            }
        }));
    }
}

impl Group for Parameters {
    fn answer(&mut self, request: Request, simulator: &mut Simulator) {
        let number = self.services.iter().position(|service| service.number() == request.service);
        let Some((index, of)) = number.and_then(|index| Some((index, SERVICES.get(index)?))) else {
            return;
        };
        let response = self.respond(of.task, &request.body, simulator).unwrap_or_else(|error| {
            tracing::warn!(service = of.name, "a request is refused, since {error}");
            refusal(of.task, &format!("the request cannot be read: {error}"))
        });
        if let Some(service) = self.services.get(index) {
            service.reply(&request, response);
        }
    }

    /// Follows the settings that the simulator publishes, and publishes what is different.
    fn tend(&mut self) {
        match self.read() {
            Ok(None) => {}
            Ok(Some(table)) => {
                self.publish(&table);
                (self.table, self.has_failed) = (table, false);
            }
            Err(error) => {
                if !std::mem::replace(&mut self.has_failed, true) {
                    tracing::warn!(%error, "parameters do not follow the settings of sensors");
                }
            }
        }
    }
}

/// Changes the settings of several sensors. If one is refused, those before it get their old values again.
fn configure_all(sensors: &[(Text<64>, Vec<Change>)], simulator: &mut Simulator) -> Result<(), String> {
    for (index, (sensor, changes)) in sensors.iter().enumerate() {
        if let Err(reason) = configure(*sensor, changes, |change| change.to, simulator) {
            let mut before = sensors[..index].iter().rev();
            let undo = |(sensor, changes): &(Text<64>, Vec<Change>)| {
                configure(*sensor, changes, |change| change.from, simulator).is_ok()
            };
            return Err(if before.all(undo) {
                reason
            } else {
                format!("{reason}; sensors before {sensor} may have their new settings")
            });
        }
    }
    Ok(())
}

/// Changes the settings of one sensor.
fn configure(
    sensor: Text<64>,
    changes: &[Change],
    value: impl Fn(&Change) -> f64,
    simulator: &mut Simulator,
) -> Result<(), String> {
    let words: Vec<_> =
        changes.iter().map(|change| format!("{}={}", change.setting.name, value(change))).collect();
    let mut command = SimulationCommand::new(Operation::Configure);
    command.name = sensor;
    simulator.call(&command, &words.join(" "), TIMEOUT).map(drop)
}

/// Returns the response to a request that cannot be read.
fn refusal(task: Task, reason: &str) -> Vec<u8> {
    let refused = Err(reason.to_owned());
    message(|to| match task {
        Task::List => {
            codec::write_texts(to, &[]);
            codec::write_texts(to, &[]);
        }
        Task::Get | Task::GetTypes | Task::Describe => to.count(0),
        Task::Set => {
            to.count(1);
            codec::write_result(to, &refused);
        }
        Task::SetAtomically => codec::write_result(to, &refused),
    })
}
