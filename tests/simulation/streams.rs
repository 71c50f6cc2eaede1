//! Streams, their frames, and the noise of sensors depend on names, not on other sensors.

use belvedere::description::load;
use belvedere::description::model::{Model, World};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_sensors::Pose;
use glam::DVec3;

/// A model with links that have sensors: `(link, [(sensor, topic)])`.
fn thing(links: &[(&str, &[(&str, &str)])]) -> Model {
    let sensor = |(name, topic): &(&str, &str)| {
        format!(
            "<sensor name='{name}' type='imu'><topic>{topic}</topic><imu><angular_velocity><x>
             <noise type='gaussian'><stddev>0.1</stddev></noise></x></angular_velocity></imu></sensor>"
        )
    };
    let link = |(name, sensors): &(&str, &[(&str, &str)])| {
        let sensors: String = sensors.iter().map(sensor).collect();
        format!("<link name='{name}'><gravity>false</gravity>{sensors}</link>")
    };
    let links: String = links.iter().map(link).collect();
    load::model(&format!("<sdf version='1.6'><model name='thing'><static>true</static>{links}</model></sdf>"))
        .unwrap()
}

fn spawn(simulation: &mut Simulation, model: &Model, name: &str, x: f64) {
    let world_from_model = Pose::from_translation(DVec3::X * x);
    let options = SpawnOptions { name: name.into(), world_from_model, ..SpawnOptions::default() };
    simulation.spawn(model, options).unwrap();
}

fn rendered(simulation: &mut Simulation, topic: &str) -> Vec<u8> {
    let mut frame = FrameBuf::default();
    simulation.render(topic, &mut frame).unwrap();
    frame.payload().to_vec()
}

fn noise(links: &[(&str, &[(&str, &str)])], topic: &str) -> Vec<u8> {
    let mut simulation = Simulation::builder(World::empty()).build().unwrap();
    spawn(&mut simulation, &thing(links), "thing", 0.0);
    rendered(&mut simulation, topic)
}

#[test]
fn noise_depends_on_the_name_of_a_sensor_not_on_its_position() {
    let alone = noise(&[("body", &[("c", "/c")])], "/c");
    // With other sensors beside it, before it and after it, on its link and on others, even with the same name.
    assert_eq!(noise(&[("body", &[("a", "/a"), ("c", "/c"), ("d", "/d")])], "/c"), alone);
    assert_eq!(noise(&[("arm", &[("a", "/a"), ("c", "/arm/c")]), ("body", &[("c", "/c")])], "/c"), alone);
    // The topic does not matter.
    assert_eq!(noise(&[("body", &[("c", "/x")])], "/x"), alone);
    assert_ne!(noise(&[("body", &[("x", "/c")])], "/c"), alone);
    let both: &[_] = &[("arm", &[("c", "/arm/c")][..]), ("body", &[("c", "/c")])];
    assert_ne!(noise(both, "/arm/c"), noise(both, "/c"));
    // Files should not do this, but two sensors on one link may have the same name.
    let twins: &[_] = &[("body", &[("c", "/c"), ("c", "/d")][..])];
    assert_eq!(noise(twins, "/c"), alone);
    assert_ne!(noise(twins, "/d"), alone);
}

#[test]
fn models_without_namespaces_have_different_noise() {
    let mut simulation = Simulation::builder(World::empty()).build().unwrap();
    spawn(&mut simulation, &thing(&[("body", &[("c", "/c")])]), "one", 0.0);
    let alone = rendered(&mut simulation, "/c");
    spawn(&mut simulation, &thing(&[("body", &[("c", "/d")])]), "two", 5.0);
    let [one, two] = ["/c", "/d"].map(|topic| rendered(&mut simulation, topic));
    assert_eq!(one, alone);
    assert_ne!(one, two);
}

#[test]
fn no_frame_within_a_namespace_begins_with_a_slash() {
    // Gazebo's plugin uses the frame /world if the file names none.
    let model = load::model(
        "<sdf version='1.6'><model name='m'><link name='l'><sensor name='s' type='ray'><ray><range><max>9</max></range></ray>
         <plugin name='p' filename='libgazebo_ros_laser.so'><topicName>scan</topicName></plugin></sensor></link></model></sdf>",
    )
    .unwrap();
    for (namespace, topic, frame) in [("", "/scan", "/world"), ("r_1", "/r_1/scan", "r_1/world")] {
        let mut simulation = Simulation::builder(World::empty()).build().unwrap();
        let options = SpawnOptions { namespace: namespace.into(), ..SpawnOptions::default() };
        simulation.spawn(&model, options).unwrap();
        let rig = simulation.streams(false).unwrap();
        let outlets = rig.outlets();
        let scan = outlets.iter().find(|outlet| outlet.topic() == topic).unwrap();
        assert_eq!(scan.frame_id(), frame);
        assert_eq!(scan.owner().name, "sensor 's' of model 'm'");
    }
}

#[test]
fn notes_report_decisions_made_when_streams_are_opened() {
    let model = load::model(
        "<sdf version='1.6'><model name='m'><static>true</static><link name='l'>
         <sensor name='gps' type='navsat'><topic>fix</topic></sensor></link></model></sdf>",
    )
    .unwrap();
    let mut simulation = Simulation::builder(World::empty()).build().unwrap();
    simulation.spawn(&model, SpawnOptions::default()).unwrap();
    for _ in 0..2 {
        simulation.topics().unwrap();
        simulation.streams(false).unwrap();
    }
    let notes: Vec<String> = simulation.notes().iter().map(ToString::to_string).collect();
    let words = "the world has no <spherical_coordinates>";
    assert_eq!(notes.iter().filter(|note| note.contains(words)).count(), 1, "{notes:?}");
}
