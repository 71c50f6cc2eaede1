//! Commands of a client to the simulator, sent and waited for by a thread of their own.

use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Node, Operation, SimulationControl, Text};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;
use std::time::Duration;

/// Commands that may wait.
const MOST_WAITING: usize = 16;
/// How long the simulator has for its answer; a step may take a while.
const PATIENCE: Duration = Duration::from_secs(5);

/// A command of the page's.
#[derive(Debug, Clone, Default, serde::Deserialize)]
#[serde(default)]
pub(super) struct Order {
    /// The client's own number, which comes back with the answer.
    pub(super) id: u64,
    pub(super) operation: String,
    steps: u64,
    name: String,
    text: String,
    /// In the world; x, y, z in metres.
    position: [f64; 3],
    /// x, y, z, w.
    orientation: [f64; 4],
}

/// The thread that sends commands. It ends before this is gone, since it keeps a node of the domain, whose files would
/// otherwise outlive the process.
pub(super) struct Commander {
    /// None once this is being dropped, which ends the thread.
    orders: Option<SyncSender<Order>>,
    answers: Receiver<Value>,
    /// Whether commands that still wait are left out.
    is_ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Commander {
    pub(super) fn start(node: &Node) -> std::io::Result<Self> {
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
                let (done, reason) = match carry_out(&node, &mut control, &order) {
                    Ok(()) => (true, String::new()),
                    Err(reason) => (false, reason),
                };
                let told = json!({ "op": "result", "id": order.id, "operation": order.operation, "done": done, "reason": reason });
                if answer.send(told).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders: Some(orders), answers, is_ending, thread: Some(thread) })
    }

    /// Hands a command over.
    ///
    /// # Errors
    /// In words, if too many wait.
    pub(super) fn send(&self, order: Order) -> Result<(), String> {
        let sent = self.orders.as_ref().is_some_and(|orders| orders.try_send(order).is_ok());
        if sent { Ok(()) } else { Err("too many commands at once; wait for their answers".to_owned()) }
    }

    /// The next answer.
    pub(super) fn answer(&self) -> Option<Value> {
        self.answers.try_recv().ok()
    }
}

impl Drop for Commander {
    fn drop(&mut self) {
        self.is_ending.store(true, Ordering::Relaxed);
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            // One that panicked has said so.
            let _ = thread.join();
        }
    }
}

fn carry_out(node: &Node, control: &mut Option<SimulationControl>, order: &Order) -> Result<(), String> {
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
    match control.call(&command, &order.text, PATIENCE) {
        Ok(Some(result)) if result.done == 1 => Ok(()),
        Ok(Some(result)) => Err(result.reason.as_str().to_owned()),
        Ok(None) => Err("no simulator answers; is it running?".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}
