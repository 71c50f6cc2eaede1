//! Commands to a running simulator and their results, and the states of its models.

use super::{PATIENCE, Simulator, next_frame};
use belvedere_bridge::payload::{ModelState, SimulationCommand, SimulationResult};
use belvedere_bridge::{Domain, Kind, Node, Operation, SimulationControl, Subscriber, Text};

/// The robot of `belvedere run`.
pub(crate) const ROBOT: &str = "turtlebot";
/// A model of a box, 1 m high.
pub(crate) const BOX: &str = "<sdf version='1.6'><model name='box'><link name='body'>
  <inertial><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.1</izz></inertia></inertial>
  <collision name='c'><geometry><box><size>0.4 0.4 1</size></box></geometry></collision>
  <visual name='v'><geometry><box><size>0.4 0.4 1</size></box></geometry></visual>
</link></model></sdf>";

impl Simulator {
    /// A sender of commands.
    pub(crate) fn control(&self) -> SimulationControl {
        let node = Node::open(&Domain::new(&self.domain).unwrap(), "control").unwrap();
        SimulationControl::open(&node).unwrap()
    }
}

pub(crate) fn call(
    control: &mut SimulationControl,
    command: &SimulationCommand,
    text: &str,
) -> SimulationResult {
    control.call(command, text, PATIENCE).unwrap().expect("the simulator answers")
}

/// Sends a command that must succeed, and returns the time at which it was done.
pub(crate) fn done(control: &mut SimulationControl, operation: Operation) -> u64 {
    done_with(control, &SimulationCommand::new(operation), "")
}

pub(crate) fn done_with(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> u64 {
    let result = call(control, command, text);
    assert_eq!((result.done, result.reason.as_str(), result.id), (1, "", command.id));
    result.time_ns
}

pub(crate) fn refusal(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> String {
    let result = call(control, command, text);
    assert_eq!((result.done, result.id), (0, command.id), "{command:?}");
    result.reason.as_str().to_owned()
}

pub(crate) fn step(control: &mut SimulationControl, steps: u64) -> u64 {
    done_with(control, &SimulationCommand { steps, ..SimulationCommand::new(Operation::Step) }, "")
}

pub(crate) fn named(operation: Operation, name: &str) -> SimulationCommand {
    SimulationCommand { name: Text::new(name).unwrap(), ..SimulationCommand::new(operation) }
}

/// The latest states of the models while the simulation is paused.
pub(crate) fn states(subscriber: &mut Subscriber) -> Vec<ModelState> {
    while subscriber.take().unwrap().is_some() {}
    let frame = next_frame(subscriber);
    assert_eq!(frame.header().kind(), Some(Kind::ModelStates));
    assert_eq!(frame.header().frame_id.as_str(), "world");
    frame.view().structs().unwrap().collect()
}

pub(crate) fn state(subscriber: &mut Subscriber, name: &str) -> Option<ModelState> {
    states(subscriber).into_iter().find(|state| state.name.as_str() == name)
}

pub(crate) fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    let off =
        found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance, "{found:?} instead of {expected:?}");
}
