//! Services of ROS 2 by which other nodes control a simulation: those of `simulation_interfaces`, which other simulators
//! serve, too.
//!
//! | file | is |
//! |---|---|
//! | `definitions` | the fields of messages |
//! | `refusal` | results other than success |
//! | `geometry` | poses and velocities in messages |
//! | `client` | questions and commands to the simulator |
//! | `resource` | descriptions of models |
//! | `state`, `stepping`, `entities`, `filters`, `spawning` | what the services do |
//!
//! A thread answers one request after the other. Steps, which may take minutes, have a thread of their own. Every request
//! is answered, with the reason if it cannot be fulfilled.

mod client;
mod definitions;
mod entities;
mod filters;
mod geometry;
mod refusal;
mod resource;
mod spawning;
mod state;
mod stepping;

use super::cdr::message;
use super::names::Naming;
use super::type_hash::service_hash;
use super::{Ros2Error, Ros2Options};
use belvedere_bridge::{Node, RosBytes};
use belvedere_rtps::{Participant, Request, Requests, Service, ServiceType};
use client::Client;
use definitions::MESSAGES;
use refusal::Refusal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest wait for a request before looking whether to stop.
const NAP: Duration = Duration::from_millis(100);
/// Time without a request after which the streams to the simulator, which have few places, are closed.
const QUIET: Duration = Duration::from_secs(3);
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
    answer: fn(&mut Client, &[u8], &mut RosBytes<'_>),
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

/// The services that are offered, and the threads that answer.
#[derive(Debug)]
pub(super) struct Services {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Services {
    /// Offers the services for the simulation of a domain, which may come and go.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub(super) fn start(
        participant: &Participant,
        node: &Node,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let requests = Requests::new();
        let mut offered = Vec::new();
        for interface in &INTERFACES {
            match interface.offer(participant, &requests, &options.naming) {
                Ok(service) => offered.push((service, interface)),
                Err(reason) => {
                    tracing::warn!("{reason}, so this service is left out; --remap gives it another name");
                }
            }
        }
        let offered: Offered = offered.into();
        let stop = Arc::new(AtomicBool::new(false));
        let client = || Client::new(node, &stop, options.no_commands);
        let (steps, waiting) = sync_channel(MOST_STEPS);
        let mut services = Self { stop: stop.clone(), threads: Vec::new() };
        let (mut own, stopped, of) = (client(), stop.clone(), offered.clone());
        services.spawn("services", move || serve(&requests, &of, &steps, &mut own, &stopped))?;
        let (mut own, stopped) = (client(), stop.clone());
        services.spawn("steps", move || serve_steps(&waiting, &offered, &mut own, &stopped))?;
        Ok(services)
    }

    fn spawn(&mut self, name: &str, run: impl FnOnce() + Send + 'static) -> Result<(), Ros2Error> {
        self.threads.push(std::thread::Builder::new().name(name.to_owned()).spawn(run)?);
        Ok(())
    }
}

impl Drop for Services {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

/// The services, each with what it does.
type Offered = Arc<[(Service, &'static Interface)]>;

/// Answers requests until `stop` is set, and passes those for steps on.
fn serve(
    requests: &Requests,
    offered: &Offered,
    steps: &SyncSender<Request>,
    client: &mut Client,
    stop: &AtomicBool,
) {
    let mut quiet = Duration::ZERO;
    while !stop.load(Ordering::Relaxed) {
        let Some(request) = requests.take(NAP) else {
            quiet += NAP;
            if quiet == QUIET {
                client.rest();
            }
            continue;
        };
        quiet = Duration::ZERO;
        let Some((service, interface)) = find(offered, &request) else { continue };
        if !interface.is_long() {
            answer(service, interface, &request, client);
        } else if let Err(TrySendError::Full(request) | TrySendError::Disconnected(request)) =
            steps.try_send(request)
        {
            let refusal = Refusal::failed(format!("{MOST_STEPS} requests for steps wait already"));
            service.reply(&request, message(|reply| refusal.write(reply)));
        }
    }
}

/// Answers requests for steps, one after the other.
fn serve_steps(waiting: &Receiver<Request>, offered: &Offered, client: &mut Client, stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        match waiting.recv_timeout(NAP) {
            Ok(request) => {
                if let Some((service, interface)) = find(offered, &request) {
                    answer(service, interface, &request, client);
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

fn answer(service: &Service, interface: &Interface, request: &Request, client: &mut Client) {
    let reply = message(|reply| (interface.answer)(client, &request.body, reply));
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
