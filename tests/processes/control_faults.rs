//! Commands to a running simulation that cannot be done, are invalid, or are never answered.

use crate::live;

use crate::live::control::{BOX, ROBOT, done, named, refusal, states};
use crate::live::{PATIENCE, Simulator, next_frame};
use belvedere_bridge::payload::{SimulationCommand, SimulationResult};
use belvedere_bridge::{Domain, Node, Operation, SimulationControl, StreamSpec, Text};
use rustix::process::Signal;
use std::time::{Duration, Instant};

#[test]
fn impossible_commands_are_refused_with_a_reason() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    let say = |control: &mut SimulationControl, command: &SimulationCommand, text: &str, words: &[&str]| {
        let reason = refusal(control, command, text);
        assert!(words.iter().all(|word| reason.contains(word)), "no {words:?} in: {reason}");
    };
    let unknown = SimulationCommand { operation: 999, ..SimulationCommand::new(Operation::Pause) };
    say(&mut control, &unknown, "", &["operation 999", "1 pause"]);
    say(&mut control, &SimulationCommand::new(Operation::Step), "", &["0 steps"]);
    let endless = SimulationCommand { steps: u64::MAX, ..SimulationCommand::new(Operation::Step) };
    say(&mut control, &endless, "", &["steps cannot be run"]);
    let turtle = named(Operation::SetModelState, "turtlebt");
    say(&mut control, &turtle, "", &["no model 'turtlebt'", "did you mean 'turtlebot'"]);
    let robot = named(Operation::SetModelState, ROBOT);
    let nan = SimulationCommand { position: [f64::NAN, 0.0, 0.0], ..robot };
    say(&mut control, &nan, "", &["position"]);
    let nowhere = SimulationCommand { reference: Text::new("nowhere").unwrap(), ..robot };
    say(&mut control, &nowhere, "", &["no reference frame 'nowhere'"]);
    say(&mut control, &named(Operation::Delete, "ghost"), "", &["no model 'ghost'"]);
    let spawn = named(Operation::Spawn, "thing");
    say(&mut control, &spawn, "", &["broken XML"]);
    say(&mut control, &spawn, "<sdf version='1.6'>\n<model>", &["thing:", "broken XML"]);
    say(&mut control, &spawn, "<gltf/>", &["<gltf>"]);
    say(&mut control, &named(Operation::Spawn, ROBOT), BOX, &["a model 'turtlebot' already"]);
    say(&mut control, &named(Operation::Spawn, "world"), BOX, &["'world' is the world itself"]);
    // Its stream would have the name of an existing one.
    let sensing = BOX.replace(
        "</link>",
        "<sensor name='eye' type='camera'><camera><horizontal_fov>1</horizontal_fov></camera>
         <plugin name='p' filename='libgazebo_ros_camera.so'><imageTopicName>/image_raw</imageTopicName>
         <cameraInfoTopicName>/eye_info</cameraInfoTopicName></plugin></sensor></link>",
    );
    say(&mut control, &spawn, &sensing, &["/image_raw", "'thing'", "namespace"]);
    let missing =
        BOX.replace("<box><size>0.4 0.4 1</size></box>", "<mesh><uri>model://no/such.dae</uri></mesh>");
    say(&mut control, &spawn, &missing, &["no/such.dae"]);
    let inside_out = BOX.replace("0.4 0.4 1", "-1 1 1");
    say(&mut control, &spawn, &inside_out, &["size"]);
    let deep = format!("<sdf version='1.6'>{}", "<a>".repeat(200_000));
    refusal(&mut control, &spawn, &deep);
    refusal(&mut control, &spawn, &format!("{deep}{}</sdf>", "</a>".repeat(200_000)));
    // The simulation is unchanged.
    let mut models = simulator.subscribe(StreamSpec::MODEL_STATES);
    assert_eq!(states(&mut models).len(), 3);
}

/// The size of a command without its text.
const COMMAND: usize = size_of::<SimulationCommand>();

/// A sender that violates the protocol: it gets an answer if possible, and other messages are dropped.
#[test]
fn invalid_commands_do_no_harm() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    done(&mut control, Operation::Pause);
    let node = simulator.node();
    let mut results = node.subscriber(StreamSpec::SIMULATION_RESULT).unwrap();
    results.take().unwrap();
    let sender = node.publisher(&StreamSpec::simulation_command(1024)).unwrap();
    let mut send = |command: SimulationCommand, tail: &[u8]| {
        let mut frame = sender.loan(COMMAND + tail.len()).unwrap();
        frame.payload_mut()[..COMMAND].copy_from_slice(bytemuck::bytes_of(&command));
        frame.payload_mut()[COMMAND..].copy_from_slice(tail);
        let header = frame.header_mut();
        (header.width, header.height, header.elem_stride, header.row_stride) =
            (1, 1, COMMAND as u32, COMMAND as u32);
        frame.send().unwrap();
        let result: SimulationResult = next_frame(&mut results).message().unwrap();
        assert_eq!((result.id, result.done), (command.id, 0));
        result.reason.as_str().to_owned()
    };
    let spawn = |text_len| SimulationCommand { text_len, ..named(Operation::Spawn, "thing") };
    assert!(send(spawn(1000), b"<sdf/>").contains("cut off: 1000 bytes announced, 6 received"));
    assert!(send(spawn(u32::MAX), b"<sdf/>").contains("the limit is"));
    assert!(send(spawn(4), b"ab\xff\xff").contains("not UTF-8 from byte 2 on"));
    // A message that is not a command.
    let mut frame = sender.loan(100).unwrap();
    let header = frame.header_mut();
    (header.width, header.height, header.elem_stride, header.row_stride) = (0, 0, 0, 0);
    frame.send().unwrap();
    done(&mut control, Operation::Resume);
}

#[test]
fn the_end_of_a_simulator_is_noticed_while_its_answer_is_waited_for() {
    let domain = live::own_domain();
    let node = Node::open(&Domain::new(&domain).unwrap(), "control").unwrap();
    let mut control = SimulationControl::open(&node).unwrap();
    assert!(!control.is_connected().unwrap());
    let simulator = Simulator::start_in(domain.clone(), &["--drive", "still"]);
    done(&mut control, Operation::Pause);
    simulator.signal(Signal::STOP);
    let ended = std::thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            let asked = Instant::now();
            let pause = SimulationCommand::new(Operation::Pause);
            assert!(control.call(&pause, "", 10 * PATIENCE).unwrap().is_none());
            asked.elapsed()
        });
        std::thread::sleep(Duration::from_millis(200));
        simulator.kill();
        waiting.join().unwrap()
    });
    assert!(ended < PATIENCE, "{ended:?}");
    assert!(!control.is_connected().unwrap());
    let _successor = Simulator::start_in(domain, &["--drive", "still"]);
    done(&mut control, Operation::Pause);
    assert!(control.is_connected().unwrap());
}
