//! [`Services`]: the services of the node, whose requests threads answer.
//!
//! Each [`Group`] of services has a file here, and a thread, so that none waits for another. Those that change the simulation send commands by the [`Simulator`].
//!
//! | file | is |
//! |---|---|
//! | `simulator` | commands to the simulator |
//! | `parameters` | the settings of sensors as parameters |
//! | `interfaces` | the services of `simulation_interfaces` |
//! | `definitions`, `refusal`, `geometry` | parts of their messages |
//! | `client`, `resource`, `filters` | questions to the simulator, descriptions of models, filters of entities |
//! | `state`, `stepping`, `entities`, `spawning` | what these services do |

mod client;
mod definitions;
mod entities;
mod filters;
mod geometry;
mod interfaces;
mod parameters;
mod refusal;
mod resource;
mod simulator;
mod spawning;
mod state;
mod stepping;

use super::{Ros2Error, Ros2Options};
use belvedere_bridge::Node;
use belvedere_rtps::{Participant, Request, Requests};
use interfaces::Interfaces;
use parameters::Parameters;
use simulator::Simulator;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest wait for a request before looking whether to stop, and whether anything has changed.
const NAP: Duration = Duration::from_millis(50);

/// Services that belong together.
trait Group: Send {
    /// Answers a request, unless its service has just been removed.
    fn answer(&mut self, request: Request, simulator: &mut Simulator);

    /// Called often, also if there is no request.
    fn tend(&mut self) {}
}

/// All services of the node, with the threads that answer.
#[derive(Debug)]
pub(super) struct Services {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Services {
    /// Offers the services of the node `node_name`, such as `/belvedere`, for the simulation of a domain.
    ///
    /// # Errors
    /// If ROS 2 forbids a name, or a thread cannot be started.
    pub(super) fn start(
        participant: &Participant,
        node: &Node,
        node_name: &str,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let stop = Arc::new(AtomicBool::new(false));
        let (for_parameters, for_interfaces) = (Requests::new(), Requests::new());
        let parameters = Parameters::new(participant, &for_parameters, node, node_name, options)?;
        let interfaces = Interfaces::new(participant, &for_interfaces, node, &stop, options)?;
        let mut services = Self { stop, threads: Vec::new() };
        services.serve("parameters", parameters, for_parameters, node)?;
        services.serve("services", interfaces, for_interfaces, node)?;
        Ok(services)
    }

    /// Starts the thread of a group.
    fn serve(
        &mut self,
        name: &str,
        mut group: impl Group + 'static,
        requests: Requests,
        node: &Node,
    ) -> Result<(), Ros2Error> {
        let (stop, mut simulator) = (self.stop.clone(), Simulator::new(node, &self.stop));
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            while !stop.load(Ordering::Relaxed) {
                if let Some(request) = requests.take(NAP) {
                    group.answer(request, &mut simulator);
                }
                group.tend();
                simulator.tend();
            }
        })?;
        self.threads.push(thread);
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
