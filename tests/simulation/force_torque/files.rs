//! How files describe force-torque sensors, and what is told of those that cannot measure.

use super::{Bench, G, at, driving, ground, hanging, joint, link, model, near, sensor};
use belvedere::description::diagnostics::{Diagnostics, Problem, Severity};
use belvedere::description::load;
use belvedere::description::model::Model;
use glam::DVec3;
use std::time::Duration;

/// A robot as in the files of iCub, with more inside.
fn robot(inside: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/>
               </inertial></link>"
        )
    };
    format!(
        "<robot name='r'><link name='world'/>{}{}<joint name='stand' type='fixed'><parent link='world'/>
           <child link='base'/></joint><joint name='ankle' type='fixed'><parent link='base'/><child link='foot'/>
           <origin xyz='0 0 -1'/></joint>\n{inside}</robot>",
        link("base"),
        link("foot")
    )
}

fn loaded(text: &str, gazebo_compat: bool) -> (Option<Model>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let rules = belvedere::description::Rules { gazebo_compat, ..Default::default() };
    let packages = belvedere::description::models::package_path([], None);
    let model = load::load_model_text(text, "text", &packages, rules, &mut diagnostics);
    (model, diagnostics.problems().to_vec())
}

#[test]
fn a_urdf_has_them_on_its_joints() {
    let on = |what: &str| format!("<gazebo reference='ankle'>{what}</gazebo>");
    let (model, problems) = loaded(&robot(&on("<sensor name='ft' type='force_torque'/>")), false);
    assert!(problems.is_empty(), "{problems:?}");
    let mut bench = Bench::new(ground(), &model.unwrap(), at(2.0));
    let topic = "/world/empty/model/r/joint/ankle/sensor/ft/forcetorque";
    assert!(
        bench.simulation.topics().unwrap().contains(&topic.to_owned()),
        "{:?}",
        bench.simulation.topics()
    );
    bench.simulation.run_for(Duration::from_millis(100));
    let (read, frame_id) = bench.read_from(topic);
    near(read.force, DVec3::NEG_Z * G, 1e-3);
    assert_eq!(frame_id, "foot");

    // Where a link has the name of the joint, the sensor is on the joint all the same.
    let named = robot(&on("<sensor name='ft' type='force_torque'/>")).replace("'foot'", "'ankle'");
    let (model, problems) = loaded(&named, false);
    assert!(problems.is_empty() && model.unwrap().sensors.len() == 1, "{problems:?}");

    // What only links have is left out of a joint, and what only joints have of a link.
    let link = "<gazebo reference='foot'><sensor name='ft' type='force_torque'/></gazebo>".to_owned();
    for (file, what) in [
        (on("<sensor name='s' type='imu'/>"), "'s' of type 'imu' is on the joint 'ankle': it is left out"),
        (on("<sensor name='s' type='nonsense'/>"), "of type 'nonsense' is on the joint 'ankle'"),
        (link, "'ft' of type 'force_torque' is on a link: it is left out"),
    ] {
        let (model, problems) = loaded(&robot(&file), false);
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        assert!(problem.severity == Severity::Warning && problem.what.contains(what), "{problem}");
        let mut bench = Bench::new(ground(), &model.unwrap(), at(2.0));
        bench.simulation.run_for(Duration::from_millis(10));
        assert!(bench.simulation.topics().unwrap().iter().all(|topic| !topic.contains("sensor")));
    }
}

#[test]
fn what_is_written_wrong_is_one_error() {
    for (inside, what) in [
        ("<frame>world</frame>", "<frame> of sensor 'ft' is 'world'; write child or parent or sensor"),
        ("<measure_direction>up</measure_direction>", "<measure_direction> of sensor 'ft' is 'up'"),
        (
            "<force><x><noise type='gaussian'><stddev>-1</stddev></noise></x></force>",
            "<stddev> of sensor 'ft' is -1",
        ),
    ] {
        let text = format!("<sdf version='1.7'><model name='m'>{}</model></sdf>", hanging("fixed", inside));
        let (_, problems) = loaded(&text, false);
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        let told = problem.to_string();
        assert!(problem.severity == Severity::Error && told.contains(what), "{told}");
    }
}

#[test]
fn the_plugins_of_ros_publish_a_joint() {
    let plugin = |inside: &str| {
        format!("<gazebo><plugin name='p' filename='libgazebo_ros_ft_sensor.so'>{inside}</plugin></gazebo>")
    };
    for (inside, topic, rate_hz) in [
        (
            "<jointName>ankle</jointName><topicName>foot/wrench</topicName><robotNamespace>r</robotNamespace>
             <updateRate>50</updateRate>",
            "/r/foot/wrench",
            50.0,
        ),
        (
            "<ros><namespace>ns</namespace><remapping>wrench:=foot_ft</remapping></ros><joint_name>ankle</joint_name>
             <update_rate>25</update_rate>",
            "/ns/foot_ft",
            25.0,
        ),
    ] {
        let (model, problems) = loaded(&robot(&plugin(inside)), false);
        assert!(problems.is_empty(), "{problems:?}");
        let model = model.unwrap();
        assert_eq!(model.sensors[0].effective_rate_hz(), Some(rate_hz));
        let mut bench = Bench::new(ground(), &model, at(2.0));
        bench.simulation.run_for(Duration::from_millis(100));
        let (read, frame_id) = bench.read_from(topic);
        near(read.force, DVec3::NEG_Z * G, 1e-3);
        assert_eq!(frame_id, "foot");
    }
    for (inside, what) in [
        ("<jointName>ankel</jointName>", "'ankel', and there is no such joint"),
        ("<topicName>t</topicName>", "plugin 'p' has no <jointName>"),
    ] {
        let told = |gazebo_compat: bool| {
            let (_, problems) = loaded(&robot(&plugin(inside)), gazebo_compat);
            let [problem] = &problems[..] else { panic!("{problems:?}") };
            assert!(problem.what.contains(what), "{problem}");
            problem.severity
        };
        assert_eq!([told(false), told(true)], [Severity::Error, Severity::Warning]);
    }
    // ROS 2's plugin can measure a link instead.
    let (model, problems) = loaded(&robot(&plugin("<body_name>foot</body_name>")), false);
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert!(problem.severity == Severity::Warning && problem.source.line > 0, "{problem}");
    assert!(problem.what.contains("the forces on the link of its <body_name>"), "{problem}");
    assert!(model.unwrap().sensors.is_empty());
    let noisy =
        plugin("<jointName>ankle</jointName><topicName>t</topicName><gaussianNoise>0.5</gaussianNoise>");
    let mut bench = Bench::new(ground(), &loaded(&robot(&noisy), false).0.unwrap(), at(2.0));
    bench.simulation.run_for(Duration::from_millis(100));
    let off = DVec3::from(bench.read_from("t").0.force) + DVec3::Z * G;
    assert!((1e-3..3.0).contains(&off.length()), "{off}");
}

/// The joint of a nested model keeps its sensor, whatever comes before it.
#[test]
fn a_nested_model_keeps_its_sensor() {
    let inside = link("first", "0 0 0 0 0 0", 1.0, "")
        + &link("second", "0 0 0 0 0 0", 1.0, "")
        + &joint("other", "fixed", "first", "second", "");
    let nested = format!("{inside}<model name='in'>{}</model>", hanging("revolute", ""));
    let text = nested.replace("<topic>ft</topic>", "");
    let mut bench = Bench::new(ground(), &model(&text), at(2.0));
    bench.simulation.run_for(Duration::from_millis(50));
    let topic = "/world/empty/model/m/model/in/joint/hinge/sensor/ft/forcetorque";
    near(bench.read_from(topic).0.force, DVec3::NEG_Z * G, 1e-3);
}

#[test]
fn a_joint_that_cannot_be_measured_is_told() {
    let loop_of_joints = link("a", "0 0 0 0 0 0", 1.0, "")
        + &link("b", "1 0 0 0 0 0", 1.0, "")
        + &link("c", "0 1 0 0 0 0", 1.0, "")
        + &joint("ab", "revolute", "a", "b", &format!("<axis><xyz>0 0 1</xyz></axis>{}", sensor("")))
        + &joint("bc", "revolute", "b", "c", "<axis><xyz>0 0 1</xyz></axis>")
        + &joint("ca", "revolute", "c", "a", "<axis><xyz>0 0 1</xyz></axis>");
    let standing = "<static>true</static>".to_owned()
        + &link("a", "0 0 0 0 0 0", 1.0, "")
        + &link("b", "1 0 0 0 0 0", 1.0, "")
        + &joint("ab", "fixed", "a", "b", &sensor(""));
    let wheel = driving(&sensor(""), "");
    for (inside, what) in [
        (loop_of_joints, "cannot measure the joint 'ab': it is part of a loop of joints"),
        (standing, "cannot measure the joint 'ab': both of its sides stand still"),
        (wheel, "cannot measure the joint 'left_joint': it is that of a wheel"),
    ] {
        let mut bench = Bench::new(ground(), &model(&inside), at(0.5));
        let notes = bench.simulation.notes();
        let told: Vec<_> = notes.iter().filter(|note| note.what.contains(what)).collect();
        let [only] = told[..] else { panic!("{what}: {notes:#?}") };
        assert!(only.severity == Severity::Warning && only.source.line > 0, "{only}");
        bench.simulation.run_for(Duration::from_millis(50));
        assert!(bench.simulation.topics().unwrap().iter().all(|topic| topic != "/ft"));
    }
}
