//! Foxglove's protocol on the page's port: channels, subscriptions, and what is forbidden to clients.
#![cfg(feature = "view")]

use crate::live::control::{done_with, named};
use crate::live::{PATIENCE, belvedere, own_domain};
use crate::page::{Page, Server};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Domain, Node, Operation, SimulationControl, Text};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const KINECT: [&str; 6] = ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "still"];
const PROTOCOL: &str = "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n";

/// The number of a topic's channel.
fn channel(client: &mut Page, topic: &str) -> Value {
    loop {
        let advertised = client.next_json("advertise");
        let channels = advertised["channels"].as_array().unwrap();
        if let Some(channel) = channels.iter().find(|channel| channel["topic"] == topic) {
            return channel["id"].clone();
        }
    }
}

fn subscribe(client: &mut Page, id: u32, channel: &Value) {
    client.say(&json!({ "op": "subscribe", "subscriptions": [{ "id": id, "channelId": channel }] }));
}

fn node(domain: &str) -> Node {
    Node::open(&Domain::new(domain).unwrap(), "control").unwrap()
}

/// A stream has eight places for subscribers, and a client uses one of them, however often it subscribes.
#[test]
fn a_channel_is_subscribed_to_once() {
    const PICTURE: &str = "camera/rgb/image_raw";
    let domain = own_domain();
    let server = Server::run(&domain, &KINECT);
    let mut client = server.connect(PROTOCOL);
    let picture = channel(&mut client, &format!("/{PICTURE}"));
    for id in 1..20 {
        subscribe(&mut client, id, &picture);
    }
    for _ in 2..20 {
        while !client.next_json("status")["message"].as_str().unwrap().contains("subscribed to already, as 1")
        {
        }
    }
    let streams = node(&domain).streams().unwrap();
    let stream = streams.iter().find(|stream| stream.topic == PICTURE).unwrap();
    assert_eq!(stream.subscribers, 1);
    // It can unsubscribe and subscribe again.
    client.say(&json!({ "op": "unsubscribe", "subscriptionIds": [1] }));
    subscribe(&mut client, 20, &picture);
    while client.binary(1)[1..5] != 20_u32.to_le_bytes() {}
}

/// `/tf` contains the transforms of all robots: a subscriber also receives those of a robot that is spawned later, and
/// none of a deleted one.
#[test]
fn the_transforms_of_a_robot_spawned_later_are_sent() {
    let domain = own_domain();
    let server = Server::run(&domain, &["--robot", "kobuki_hexagons_kinect", "--world", "empty"]);
    let mut client = server.connect(PROTOCOL);
    let transforms = channel(&mut client, "/tf");
    subscribe(&mut client, 1, &transforms);
    client.binary(1);
    let urdf = belvedere().args(["urdf", "kobuki_nostack_rplidar"]).output().unwrap();
    let urdf = String::from_utf8(urdf.stdout).unwrap();
    let node = node(&domain);
    let mut control = SimulationControl::open(&node).unwrap();
    let spawn = SimulationCommand {
        robot_namespace: Text::new("guest").unwrap(),
        position: [2.0, 0.0, 0.0],
        ..named(Operation::Spawn, "guest")
    };
    done_with(&mut control, &spawn, &urdf);
    let began = Instant::now();
    while !client.binary(1).windows(6).any(|bytes| bytes == b"guest/") {
        assert!(began.elapsed() < PATIENCE, "the transforms of the guest do not arrive");
    }
    done_with(&mut control, &named(Operation::Delete, "guest"), "");
    while node.streams().unwrap().iter().any(|stream| stream.topic == "guest/tf") {
        assert!(began.elapsed() < 2 * PATIENCE, "the stream of the guest remains");
        std::thread::sleep(Duration::from_millis(50));
    }
    // The transforms of the robot that stands still arrive.
    client.binary(1);
}

/// A spawned robot has a description with meshes that can be fetched, until it is deleted.
#[test]
fn a_robot_that_is_spawned_is_described_until_it_is_deleted() {
    const PARAMETER: &str = "/guest/robot_description";
    let domain = own_domain();
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("shapes");
    std::fs::create_dir_all(&package).unwrap();
    std::fs::write(package.join("package.xml"), "<package><name>shapes</name></package>").unwrap();
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet";
    std::fs::write(package.join("one.stl"), format!("solid one\n{facet}\nendsolid one\n")).unwrap();
    let path = folder.path().to_str().unwrap();
    let server = Server::run(&domain, &["--robot", "none", "--world", "empty", "--package-path", path]);
    let mut client = server.connect(PROTOCOL);
    client.say(&json!({ "op": "subscribeParameterUpdates", "parameterNames": [PARAMETER] }));
    let value = |client: &mut Page, id: &str| {
        client.say(&json!({ "op": "getParameters", "parameterNames": [PARAMETER], "id": id }));
        loop {
            let told = client.next_json("parameterValues");
            if told["id"] == id {
                return told["parameters"][0]["value"].clone();
            }
        }
    };
    assert!(value(&mut client, "before").is_null());
    // As in files by other people, with a mesh in a package.
    let mesh = "package://shapes/one.stl";
    let urdf = format!(
        "<robot name='r'><link name='base'><visual><geometry><mesh filename='{mesh}'/></geometry></visual>
         <inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
         <gazebo><plugin name='p' filename='libgazebo_ros_planar_move.so'/></gazebo></robot>"
    );
    let mut control = SimulationControl::open(&node(&domain)).unwrap();
    let spawn = SimulationCommand {
        robot_namespace: Text::new("guest").unwrap(),
        ..named(Operation::Spawn, "guest")
    };
    done_with(&mut control, &spawn, &urdf);
    let told = client.next_json("parameterValues")["parameters"][0].clone();
    assert_eq!(told["name"], PARAMETER);
    let described = told["value"].as_str().unwrap();
    assert!(described.contains("<robot name=\"r\"") && !described.contains(mesh), "{described}");
    let (_, asset) = described.split_once("filename=\"").unwrap();
    let (asset, _) = asset.split_once('"').unwrap();
    client.say(&json!({ "op": "fetchAsset", "uri": asset, "requestId": 5 }));
    let answer = client.binary(4);
    assert_eq!((&answer[1..5], answer[5]), (&5_u32.to_le_bytes()[..], 0), "{asset} is given");
    assert_eq!(value(&mut client, "with"), told["value"]);
    done_with(&mut control, &named(Operation::Delete, "guest"), "");
    let told = client.next_json("parameterValues")["parameters"][0].clone();
    assert_eq!(told, json!({ "name": PARAMETER }));
    assert!(value(&mut client, "after").is_null());
}

#[test]
fn foxglove_is_served_on_the_same_port() {
    let server = Server::run(&own_domain(), &KINECT);
    let latest = "foxglove.sdk.v1, foxglove.sdk.v1.1";
    for protocol in ["foxglove.websocket.v1", "foxglove.sdk.v1, foxglove.websocket.v1", latest] {
        let mut client = server.connect(&format!("Sec-WebSocket-Protocol: {protocol}\r\n"));
        assert_eq!(client.next_json("serverInfo")["metadata"]["ROS_DISTRO"], "noetic");
        let advertised = client.next_json("advertise");
        let channel = |topic: &str| {
            let channels = advertised["channels"].as_array().unwrap().iter();
            channels.clone().find(|channel| channel["topic"] == topic).cloned()
        };
        assert!(channel("/cmd_vel").is_none() && channel("/simulation/command").is_none());
        let fixed = channel("/tf_static").unwrap();
        let schema = match fixed["schemaId"].as_u64() {
            Some(id) => &advertised["schemas"][id as usize - 1]["name"],
            None => &fixed["schemaName"],
        };
        assert_eq!((schema, &fixed["encoding"]), (&json!("tf2_msgs/TFMessage"), &json!("ros1")));
        assert_eq!(fixed["schemaId"].is_u64(), protocol == latest);
        // A latched message is sent for each subscription.
        for id in [7_u32, 8] {
            client.say(
                &json!({ "op": "subscribe", "subscriptions": [{ "id": id, "channelId": fixed["id"] }] }),
            );
            let message = client.binary(1);
            assert_eq!(message[1..5], id.to_le_bytes());
            // The number of transforms, and the header of the first one.
            assert!(u32::from_le_bytes(message[13..17].try_into().unwrap()) > 5);
            client.say(&json!({ "op": "unsubscribe", "subscriptionIds": [id] }));
        }
        let picture = channel("/camera/rgb/image_raw").unwrap();
        client.say(&json!({ "op": "subscribe", "subscriptions": [{ "id": 9, "channelId": picture["id"] }] }));
        let image = loop {
            let message = client.binary(1);
            if message[1..5] == 9_u32.to_le_bytes() {
                break message;
            }
        };
        assert!(image.len() > 640 * 480 * 3);
        // Time was sent before.
        let stamp_ns = u64::from_le_bytes(image[5..13].try_into().unwrap());
        let now_ns = u64::from_le_bytes(client.binary(2)[1..9].try_into().unwrap());
        assert!(now_ns.abs_diff(stamp_ns) < 10_000_000_000, "{now_ns} and {stamp_ns}");
        client.say(&json!({ "op": "getParameters", "parameterNames": ["/robot_description"], "id": "a" }));
        let values = client.next_json("parameterValues");
        assert_eq!(values["id"], "a");
        assert!(values["parameters"][0]["value"].as_str().unwrap().contains("<robot"));
        for wrong in [
            json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 4711 }] }),
            json!({ "op": 1 }),
        ] {
            client.say(&wrong);
            assert_eq!(client.next_json("status")["level"], 1);
        }
    }
    let (host, token) = (&server.host, &server.token);
    let answer = server.ask(&format!(
        "GET /?token={token} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Protocol: mqtt\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    ));
    assert!(answer.starts_with("HTTP/1.1 400 ") && answer.contains("foxglove.sdk.v1"), "{answer}");
}
