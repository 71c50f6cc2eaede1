//! Logical cameras: which models they see, and where.

use belvedere::description::diagnostics::{Diagnostics, Problem, Severity};
use belvedere::description::model::Model;
use belvedere::description::{Rules, load, models};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::SeenModel;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

fn loaded(text: &str) -> (Option<Model>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let packages = models::package_path([], None);
    let model = load::load_model_text(text, "text", &packages, Rules::default(), &mut diagnostics);
    (model, diagnostics.problems().to_vec())
}

/// A static model with a camera that has a pose in its link.
fn camera(inside: &str) -> String {
    format!(
        "<sdf version='1.7'><model name='eye'><static>true</static><link name='l'><sensor name='s' type='logical_camera'>
           <pose>0 0 1 0 0 0</pose><update_rate>10</update_rate>{inside}</sensor></link></model></sdf>"
    )
}

fn frustum(inside: &str) -> String {
    format!("<logical_camera><near>1</near><far>5</far>{inside}</logical_camera>")
}

/// A static cube with edges of 0.2 m.
fn cube() -> Model {
    let text = "<sdf version='1.7'><model name='cube'><static>true</static><link name='l'><collision name='c'><geometry>
        <box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model></sdf>";
    loaded(text).0.unwrap()
}

/// What the camera at x = 1 that looks along y sees of cubes at these places in its own frame.
fn seen(inside: &str, topic: &str, places: &[DVec3]) -> (Vec<SeenModel>, String) {
    let (model, problems) = loaded(&camera(inside));
    assert!(problems.is_empty(), "{problems:?}");
    let world_from_eye = Pose::from_xyz_rpy(DVec3::X, DVec3::Z * FRAC_PI_2);
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let mut spawn = |model: &Model, name: String, world_from_model| {
        let options = SpawnOptions { name, world_from_model, ..SpawnOptions::default() };
        simulation.spawn(model, options).unwrap();
    };
    spawn(&model.unwrap(), "eye".into(), world_from_eye);
    for (number, place) in places.iter().enumerate() {
        let world_from_cube = world_from_eye * Pose::from_translation(DVec3::Z + *place);
        spawn(&cube(), format!("cube{number}"), world_from_cube);
    }
    let mut frame = FrameBuf::default();
    simulation.render(topic, &mut frame).unwrap();
    let models = bytemuck::pod_collect_to_vec(frame.payload());
    (models, frame.header().frame_id.as_str().to_owned())
}

#[test]
fn a_model_is_seen_if_its_box_reaches_into_the_frustum() {
    // At x = 3, half of the width is 3·tan(0.5) = 1.639, and half of the height is half of that.
    let (across, down) = (3.0 * 0.5_f64.tan(), 1.5 * 0.5_f64.tan());
    let cases = [
        (DVec3::new(3.0, 0.0, 0.0), true),
        (DVec3::new(-3.0, 0.0, 0.0), false),
        (DVec3::new(0.92, 0.0, 0.0), true),
        (DVec3::new(0.88, 0.0, 0.0), false),
        (DVec3::new(5.08, 0.0, 0.0), true),
        (DVec3::new(5.12, 0.0, 0.0), false),
        // The near corner of the box is 0.1 m farther out along both axes.
        (DVec3::new(3.0, across + 0.14, 0.0), true),
        (DVec3::new(3.0, -across - 0.14, 0.0), true),
        (DVec3::new(3.0, across + 0.17, 0.0), false),
        (DVec3::new(3.0, 0.0, down + 0.12), true),
        (DVec3::new(3.0, 0.0, -down - 0.14), false),
    ];
    let places = cases.map(|(place, _)| place);
    let inside =
        frustum("<horizontal_fov>1</horizontal_fov><aspect_ratio>2</aspect_ratio>") + "<topic>eye</topic>";
    let (models, frame_id) = seen(&inside, "eye", &places);
    let names: Vec<&str> = models.iter().map(|model| model.name.as_str()).collect();
    let expected: Vec<String> = cases
        .iter()
        .enumerate()
        .filter(|(_, (_, is_seen))| *is_seen)
        .map(|(number, _)| format!("cube{number}"))
        .collect();
    assert_eq!(names, expected);
    assert_eq!(frame_id, "eye/l/s");
    for model in &models {
        let number: usize = model.name.as_str()["cube".len()..].parse().unwrap();
        assert!((DVec3::from(model.position) - places[number]).length() < 1e-9, "{model:?}");
        assert!((model.orientation[3].abs() - 1.0).abs() < 1e-9, "{model:?}");
    }
}

#[test]
fn names_are_those_of_gz_sim_and_of_the_plugin_of_ros_2() {
    let plugin = |inside: &str| {
        format!("<plugin name='p' filename='libgazebo_ros_logical_camera.so'>{inside}</plugin>")
    };
    for (inside, topic) in [
        (String::new(), "/world/empty/model/eye/link/l/sensor/s/logical_camera"),
        ("<topic>t</topic>".to_owned() + &plugin(""), "/t"),
        (plugin("<ros><namespace>n</namespace></ros>"), "/n/s"),
        (
            "<topic>t</topic>".to_owned()
                + &plugin("<ros><namespace>n</namespace><remapping>t:=u</remapping></ros>"),
            "/n/u",
        ),
    ] {
        let (models, _) = seen(&(frustum("") + &inside), topic, &[DVec3::X * 2.0]);
        assert_eq!(models.len(), 1, "{topic}");
    }
}

#[test]
fn what_is_written_wrong_is_one_error() {
    for (inside, what) in [
        ("<near>5</near><far>5</far>", "sensor 's' has <near> 5 and <far> 5; write <near> below <far>"),
        ("<near>-1</near>", "<near> of sensor 's' is -1"),
        ("<horizontal_fov>3.2</horizontal_fov>", "<horizontal_fov> of sensor 's' is 3.2"),
        ("<aspect_ratio>0</aspect_ratio>", "<aspect_ratio> of sensor 's' is 0"),
    ] {
        let (_, problems) = loaded(&camera(&format!("<logical_camera>{inside}</logical_camera>")));
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        let told = problem.to_string();
        assert!(problem.severity == Severity::Error && told.contains(what), "{told}");
    }
}
