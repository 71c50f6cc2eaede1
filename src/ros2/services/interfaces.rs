//! [`Interfaces`]: the services of `simulation_interfaces`, by which other nodes control a simulation. Other simulators
//! serve them, too.
//!
//! Every request is answered, with the reason if it cannot be fulfilled. Steps, which may take minutes, have a thread of
//! their own.

use super::Group;
use super::client::Client;
use super::definitions::MESSAGES;
use super::refusal::Refusal;
use super::simulator::Simulator;
use super::{entities, spawning, state, stepping};
use crate::ros2::cdr::message;
use crate::ros2::names::Naming;
use crate::ros2::type_hash::service_hash;
use crate::ros2::{Ros2Error, Ros2Options};
use belvedere_bridge::{Node, RosBytes};
use belvedere_rtps::{Participant, Request, Requests, Service, ServiceType};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest wait for a request for steps before looking whether to stop.
const NAP: Duration = Duration::from_millis(100);
/// Most requests for steps that wait for others.
const MOST_STEPS: usize = 16;
/// The longest request, and the longest one that describes models.
const MOST_BYTES: usize = 64 << 10;
const MOST_BYTES_OF_MODELS: usize = 8 << 20;

/// A service of `simulation_interfaces`.
struct Interface {
    name: &'static str,
    /// The last part of its type.
    service: &'static str,
    /// The fields of its request and of its response.
    definition: &'static str,
    /// Answers a request.
    answer: fn(&mut Client<'_>, &[u8], &mut RosBytes<'_>),
}

/// All services.
const INTERFACES: [Interface; 13] = [
    Interface {
        name: "/get_simulator_features",
        service: "GetSimulatorFeatures",
        definition: "---\nsimulation_interfaces/SimulatorFeatures features",
        answer: state::get_simulator_features,
    },
    Interface {
        name: "/get_simulation_state",
        service: "GetSimulationState",
        definition: "---\nsimulation_interfaces/SimulationState state\nsimulation_interfaces/Result result",
        answer: state::get_simulation_state,
    },
    Interface {
        name: "/set_simulation_state",
        service: "SetSimulationState",
        definition: "simulation_interfaces/SimulationState state\n---\nsimulation_interfaces/Result result",
        answer: state::set_simulation_state,
    },
    Interface {
        name: "/reset_simulation",
        service: "ResetSimulation",
        definition: "uint8 scope\n---\nsimulation_interfaces/Result result",
        answer: state::reset_simulation,
    },
    Interface {
        name: "/step_simulation",
        service: "StepSimulation",
        definition: "uint64 steps\n---\nsimulation_interfaces/Result result",
        answer: stepping::step_simulation,
    },
    Interface {
        name: "/get_entities",
        service: "GetEntities",
        definition: "simulation_interfaces/EntityFilters filters\n---\nsimulation_interfaces/Result result\nstring[] \
                     entities",
        answer: entities::get_entities,
    },
    Interface {
        name: "/get_entities_states",
        service: "GetEntitiesStates",
        definition: "simulation_interfaces/EntityFilters filters\n---\nsimulation_interfaces/Result result\nstring[] \
                     entities\nsimulation_interfaces/EntityState[] states",
        answer: entities::get_entities_states,
    },
    Interface {
        name: "/get_entity_state",
        service: "GetEntityState",
        definition: "string entity\n---\nsimulation_interfaces/Result result\nsimulation_interfaces/EntityState state",
        answer: entities::get_entity_state,
    },
    Interface {
        name: "/set_entity_state",
        service: "SetEntityState",
        definition: "string entity\nsimulation_interfaces/EntityState state\n---\nsimulation_interfaces/Result result",
        answer: entities::set_entity_state,
    },
    Interface {
        name: "/get_entity_info",
        service: "GetEntityInfo",
        definition: "string entity\n---\nsimulation_interfaces/Result result\nsimulation_interfaces/EntityInfo info",
        answer: entities::get_entity_info,
    },
    Interface {
        name: "/delete_entity",
        service: "DeleteEntity",
        definition: "string entity\n---\nsimulation_interfaces/Result result",
        answer: entities::delete_entity,
    },
    Interface {
        name: "/spawn_entity",
        service: "SpawnEntity",
        definition: "string name\nbool allow_renaming\nstring uri\nstring resource_string\nstring \
                     entity_namespace\ngeometry_msgs/PoseStamped initial_pose\n---\nsimulation_interfaces/Result \
                     result\nstring entity_name",
        answer: spawning::spawn_entity,
    },
    Interface {
        name: "/spawn_entities",
        service: "SpawnEntities",
        definition: "simulation_interfaces/SpawnEntity[] spawn_requests\n---\nsimulation_interfaces/Result \
                     result\nsimulation_interfaces/SpawnResult[] results",
        answer: spawning::spawn_entities,
    },
];

impl Interface {
    fn is_long(&self) -> bool {
        self.service == "StepSimulation"
    }

    fn most_bytes(&self) -> usize {
        if self.service.starts_with("Spawn") { MOST_BYTES_OF_MODELS } else { MOST_BYTES }
    }

    fn type_name(&self) -> String {
        format!("simulation_interfaces/srv/{}", self.service)
    }

    fn offer(
        &self,
        participant: &Participant,
        requests: &Requests,
        naming: &Naming,
    ) -> Result<Service, String> {
        let name = naming.name(self.name)?;
        let service = &self.type_name();
        let hash = &service_hash(service, self.definition, MESSAGES);
        let of = ServiceType { name: &name, service, hash };
        participant.service(requests, of, self.most_bytes()).map_err(|error| error.to_string())
    }
}

/// The services, each with what it does.
type Offered = Arc<[(Service, &'static Interface)]>;

/// The services that are offered.
pub(super) struct Interfaces {
    offered: Offered,
    no_commands: bool,
    is_paused_at_start: bool,
    /// Requests for steps, which a thread answers.
    steps: Option<SyncSender<Request>>,
    thread: Option<JoinHandle<()>>,
}

impl Interfaces {
    /// Offers the services. One whose name ROS 2 forbids is left out, with a warning.
    ///
    /// # Errors
    /// If the thread for steps cannot be started.
    pub(super) fn new(
        participant: &Participant,
        requests: &Requests,
        node: &Node,
        stop: &Arc<AtomicBool>,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let offer = |interface: &'static Interface| {
            let service = interface.offer(participant, requests, &options.naming);
            let service = service.inspect_err(|reason| {
                tracing::warn!("{reason}, so this service is left out; --remap gives it another name");
            });
            Some((service.ok()?, interface))
        };
        let offered: Offered = INTERFACES.iter().filter_map(offer).collect();
        let (steps, waiting) = sync_channel(MOST_STEPS);
        let (mut simulator, stop, of) = (Simulator::new(node, stop), stop.clone(), offered.clone());
        let no_commands = options.no_commands;
        let thread = std::thread::Builder::new()
            .name("steps".to_owned())
            .spawn(move || serve_steps(&waiting, &of, &mut simulator, no_commands, &stop))?;
        Ok(Self { offered, no_commands, is_paused_at_start: false, steps: Some(steps), thread: Some(thread) })
    }
}

impl Group for Interfaces {
    fn answer(&mut self, request: Request, simulator: &mut Simulator) {
        let Some((service, interface)) = find(&self.offered, &request) else { return };
        if !interface.is_long() {
            let (no_commands, is_paused_at_start) = (self.no_commands, &mut self.is_paused_at_start);
            answer(service, interface, &request, Client { simulator, no_commands, is_paused_at_start });
        } else if let Some(Err(TrySendError::Full(request) | TrySendError::Disconnected(request))) =
            self.steps.as_ref().map(|steps| steps.try_send(request))
        {
            let refusal = Refusal::failed(format!("{MOST_STEPS} requests for steps wait already"));
            service.reply(&request, message(|reply| refusal.write(reply)));
        }
    }
}

impl Drop for Interfaces {
    fn drop(&mut self) {
        // Without a sender, the thread ends after the request that it answers now.
        self.steps = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

/// Answers requests for steps, one after the other.
fn serve_steps(
    waiting: &Receiver<Request>,
    offered: &Offered,
    simulator: &mut Simulator,
    no_commands: bool,
    stop: &AtomicBool,
) {
    while !stop.load(Ordering::Relaxed) {
        match waiting.recv_timeout(NAP) {
            Ok(request) => {
                if let Some((service, interface)) = find(offered, &request) {
                    let is_paused_at_start = &mut false;
                    answer(
                        service,
                        interface,
                        &request,
                        Client { simulator, no_commands, is_paused_at_start },
                    );
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

fn find<'a>(offered: &'a Offered, request: &Request) -> Option<&'a (Service, &'static Interface)> {
    offered.iter().find(|(service, _)| service.number() == request.service)
}

fn answer(service: &Service, interface: &Interface, request: &Request, mut client: Client<'_>) {
    let reply = message(|reply| (interface.answer)(&mut client, &request.body, reply));
    service.reply(request, reply);
    tracing::debug!(service = interface.service, "answered");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hashes are those of the packages of Jazzy, as ROS 2's own generator computes them.
    #[test]
    fn services_have_the_hashes_of_ros2() {
        let hashes = include_str!("hashes.txt");
        for interface in &INTERFACES {
            let name = interface.type_name();
            let expected = hashes.lines().find_map(|line| line.strip_prefix(&*name)).unwrap().trim();
            assert_eq!(service_hash(&name, interface.definition, MESSAGES), expected, "{name}");
        }
        assert_eq!(hashes.lines().count(), INTERFACES.len());
    }
}
