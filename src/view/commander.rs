//! [`Commander`]: a thread that sends a client's commands to the simulator and waits for the results.

use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Node, Operation, SimulationControl, Text};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;
use std::time::Duration;

/// Most commands that may wait.
const MOST_WAITING: usize = 16;
/// Longest wait for the simulator's answer, as a step may take a while.
const PATIENCE: Duration = Duration::from_secs(5);

/// A command from the page.
#[derive(Debug, Clone, Default, serde::Deserialize)]
#[serde(default)]
pub(super) struct Order {
    /// The client's number, which is returned with the answer.
    pub(super) id: u64,
    pub(super) operation: String,
    steps: u64,
    name: String,
    text: String,
    /// In the world frame; x, y, z in metres.
    position: [f64; 3],
    /// x, y, z, w.
    orientation: [f64; 4],
}

/// The thread that sends commands. Dropping this waits for the thread, because the thread holds a node of the domain,
/// whose files would otherwise remain after the process ends.
pub(super) struct Commander {
    /// `None` while this is being dropped, which ends the thread.
    orders: Option<SyncSender<Order>>,
    answers: Receiver<Value>,
    /// If true, waiting commands are discarded, and the thread does not wait for the answer to the command in progress.
    is_ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Commander {
    pub(super) fn start(node: &Node) -> std::io::Result<Self> {
        Self::with_patience(node, PATIENCE)
    }

    /// Starts a commander that waits this long for each answer.
    fn with_patience(node: &Node, patience: Duration) -> std::io::Result<Self> {
        let (orders, given) = mpsc::sync_channel::<Order>(MOST_WAITING);
        let (answer, answers) = mpsc::channel();
        let node = node.clone();
        let is_ending = Arc::new(AtomicBool::new(false));
        let ends = is_ending.clone();
        let thread = std::thread::Builder::new().name("view commands".into()).spawn(move || {
            let mut control = None;
            for order in given {
                if ends.load(Ordering::Relaxed) {
                    break;
                }
                let go_on = || !ends.load(Ordering::Relaxed);
                let (done, reason) = match carry_out(&node, &mut control, &order, patience, go_on) {
                    Ok(()) => (true, String::new()),
                    Err(reason) => (false, reason),
                };
                let result = json!({ "op": "result", "id": order.id, "operation": order.operation, "done": done, "reason": reason });
                if answer.send(result).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders: Some(orders), answers, is_ending, thread: Some(thread) })
    }

    /// Queues a command.
    ///
    /// # Errors
    /// A message, if too many commands wait.
    pub(super) fn send(&self, order: Order) -> Result<(), String> {
        let sent = self.orders.as_ref().is_some_and(|orders| orders.try_send(order).is_ok());
        if sent { Ok(()) } else { Err("too many commands at once; wait for their answers".to_owned()) }
    }

    /// Returns the next answer, if there is one.
    pub(super) fn answer(&self) -> Option<Value> {
        self.answers.try_recv().ok()
    }
}

impl Drop for Commander {
    fn drop(&mut self) {
        self.is_ending.store(true, Ordering::Relaxed);
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

fn carry_out(
    node: &Node,
    control: &mut Option<SimulationControl>,
    order: &Order,
    patience: Duration,
    go_on: impl FnMut() -> bool,
) -> Result<(), String> {
    let operation: Operation =
        order.operation.parse().map_err(|()| format!("there is no operation '{}'", order.operation))?;
    let mut command = SimulationCommand::new(operation);
    command.steps = order.steps;
    command.name = Text::new(&order.name).map_err(|error| error.to_string())?;
    command.position = order.position;
    if order.orientation != [0.0; 4] {
        command.orientation = order.orientation;
    }
    let control = match control {
        Some(control) => control,
        None => control.insert(SimulationControl::open(node).map_err(|error| error.to_string())?),
    };
    match control.call_while(&command, &order.text, patience, go_on) {
        Ok(Some(result)) if result.done == 1 => Ok(()),
        Ok(Some(result)) => Err(result.reason.as_str().to_owned()),
        Ok(None) => Err("no simulator answers; is it running?".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::inbox::Inbox;
    use belvedere_bridge::Domain;

    /// Longest wait of a test for an event that must happen.
    const WATCHDOG: Duration = Duration::from_secs(60);

    #[test]
    fn it_ends_while_a_command_is_unanswered() {
        let domain = Domain::new(&format!("commander-{}", std::process::id())).unwrap();
        let node = Node::open(&domain, "belvedere").unwrap();
        let mut inbox = Inbox::open(&node).unwrap();
        let commander = Commander::with_patience(&node, 60 * WATCHDOG).unwrap();
        let order = || Order { operation: "pause".into(), ..Order::default() };
        // One command that is sent and never answered, and one that waits behind it.
        commander.send(order()).unwrap();
        commander.send(order()).unwrap();
        let began = std::time::Instant::now();
        while inbox.take().is_none() {
            assert!(began.elapsed() < WATCHDOG, "no command comes");
            inbox.wait(Duration::from_millis(10));
        }
        let (ended, end) = mpsc::channel();
        std::thread::spawn(move || {
            drop(commander);
            let _ = ended.send(());
        });
        end.recv_timeout(WATCHDOG).expect("the commander ends");
        assert!(inbox.take().is_none(), "the command that waited is left out");
    }
}
