//! Two simulators: in one domain, the second is refused with the name of the first; in two domains, they are separate.

use std::time::Duration;

use belvedere_bridge::{Domain, Encoding, Error, Kind, Node, StreamSpec, payload::VelocityCommand};
use iceoryx2::prelude::*;

use crate::{
    processes_kit::{PATIENCE, domain},
    world::{self, Actor, ROOT, image},
};

fn start(role: &str, domain: &Domain) -> Actor {
    Actor::start(role, domain.as_str(), ROOT, &[])
}

#[test]
fn a_second_simulator_is_told_the_name_of_the_first() {
    world::play();
    let domain = domain("held");
    let mut first = start("simulate", &domain);
    first.says("ready");
    let node = Node::open(&domain, "second").unwrap();
    let error = node.publisher(&image("image_raw")).unwrap_err();
    let Error::DomainInUse { holder, .. } = &error else { panic!("{error}") };
    assert_eq!((holder.name.as_str(), holder.pid), ("simulator", first.pid()));
    let text = error.to_string();
    for part in
        ["\"simulator\"", &format!("process {}", first.pid()), domain.as_str(), "image_raw", "--domain"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    // Its commands are separate, too: several processes may send commands, so one more publisher is not a second
    // simulator.
    assert!(node.publisher(&StreamSpec::velocity_command("cmd_vel")).is_ok());
    // The first continues unaffected; once it is killed, its slot is free at once.
    let mut subscriber = node.subscriber("image_raw").unwrap();
    assert!(subscriber.wait(PATIENCE).unwrap());
    drop(subscriber);
    first.kill();
    let _publisher = node.publisher(&image("image_raw")).unwrap();
}

#[test]
fn many_join_and_leave_at_once() {
    world::play();
    let domain = domain("restless");
    let mut restless: Vec<Actor> = (0..6).map(|_| start("join_often", &domain)).collect();
    for actor in &mut restless {
        actor.says("done");
    }
    for actor in restless {
        assert!(actor.leave().success());
    }
    assert_eq!(world::files_of(domain.as_str()), [] as [&std::path::Path; 0]);
}

#[test]
fn nothing_crosses_from_domain_to_domain() {
    world::play();
    let (one, other) = (domain("one"), domain("other"));
    let (mut first, mut second) = (start("simulate", &one), start("simulate", &other));
    first.says("ready");
    second.says("ready");
    let mut driver = start("drive", &one);
    driver.says("frame 10");
    first.says("command ");
    assert!(!second.has_said("command"), "it hears only what is said in its domain");

    // A domain whose name begins alike sees nothing, nor does another iceoryx2 program with the same service names.
    let alike = Domain::new(&format!("{}-x", other.as_str())).unwrap();
    let node = Node::open(&alike, "test").unwrap();
    assert!(node.streams().unwrap().is_empty());
    let drive = |speed| VelocityCommand { linear: [speed, 0.0, 0.0], angular: [0.0; 3] };
    let commands = node.publisher(&StreamSpec::velocity_command("cmd_vel")).unwrap();
    commands.send_structs(0, &[drive(1.0)]).unwrap();
    let foreign = NodeBuilder::new().create::<ipc::Service>().unwrap();
    let name = ServiceName::new("belvedere/cmd_vel").unwrap();
    let service = foreign.service_builder(&name).publish_subscribe::<[u8]>().open_or_create().unwrap();
    let publisher = service.publisher_builder().initial_max_slice_len(48).create().unwrap();
    publisher.loan_slice(48).unwrap().send().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert!(!second.has_said("command"));
    driver.kill();
    assert!(first.leave().success() && second.leave().success());
    // The next start removes what the killed one left.
    drop(Node::open(&one, "last").unwrap());
}

/// A frame that is not a command is not accepted as one from any sender.
#[test]
fn a_frame_of_another_kind_is_no_command() {
    let node = Node::open(&domain("kind"), "test").unwrap();
    let spec = StreamSpec::velocity_command("cmd_vel");
    let mut commands = node.command_subscriber(&spec).unwrap();
    let wrong = StreamSpec {
        max_publishers: 8,
        history: 0,
        ..StreamSpec::new("cmd_vel", Kind::Image, Encoding::Mono8, 48)
    };
    let publisher = node.publisher(&StreamSpec { buffer: 16, ..wrong }).unwrap();
    let mut frame = publisher.loan(48).unwrap();
    frame.header_mut().set_packed(48, 1);
    frame.payload_mut().fill(0x3f);
    frame.send().unwrap();
    let frame = commands.take_newest().unwrap().unwrap();
    assert!(frame.message::<VelocityCommand>().is_err());
}
