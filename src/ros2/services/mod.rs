//! [`Services`]: the services of the node, whose requests a thread answers.
//!
//! Each [`Group`] of services has a file here. Those that change the simulation send commands by the [`Simulator`].
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
    /// Answers a request, or returns it if it is for none of these services.
    fn answer(&mut self, request: Request, simulator: &mut Simulator) -> Option<Request>;

    /// Called often, also if there is no request.
    fn tend(&mut self) {}
}

/// All services of the node, with the thread that answers.
#[derive(Debug)]
pub(super) struct Services {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Services {
    /// Offers the services of the node `node_name`, such as `/belvedere`, for the simulation of a domain.
    ///
    /// # Errors
    /// If ROS 2 forbids a name, or the thread cannot be started.
    pub(super) fn start(
        participant: &Participant,
        node: &Node,
        node_name: &str,
        options: &Ros2Options,
    ) -> Result<Self, Ros2Error> {
        let requests = Requests::new();
        let parameters = Parameters::new(participant, &requests, node, node_name, options)?;
        let stop = Arc::new(AtomicBool::new(false));
        let interfaces = Interfaces::new(participant, &requests, node, &stop, options)?;
        let mut groups: Vec<Box<dyn Group>> = vec![Box::new(parameters), Box::new(interfaces)];
        let (stopped, mut simulator) = (stop.clone(), Simulator::new(node, &stop));
        let thread = std::thread::Builder::new().name("services".to_owned()).spawn(move || {
            while !stopped.load(Ordering::Relaxed) {
                if let Some(request) = requests.take(NAP) {
                    // A request of no group is for a service that has just been removed.
                    let _ = groups
                        .iter_mut()
                        .try_fold(request, |request, group| group.answer(request, &mut simulator));
                }
                for group in &mut groups {
                    group.tend();
                }
                simulator.tend();
            }
        })?;
        Ok(Self { stop, thread: Some(thread) })
    }
}

impl Drop for Services {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}
