//! Parameters of plugins: what their originals do not know, or have and is not simulated, is told.

use belvedere::description::load::{LoadOptions, load, load_text, robot_names, world_names};
use belvedere::description::model::{Model, ModelPlugin};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};

fn options() -> LoadOptions {
    LoadOptions { packages: package_path([], None), rules: Rules::default(), xacro_args: Vec::new() }
}

fn loaded(text: &str) -> (Option<Model>, Vec<String>) {
    let mut diagnostics = Diagnostics::default();
    let described = load_text(text, "r.sdf", &options(), &mut diagnostics);
    let model = match described {
        Some(belvedere::description::load::Described::Model(model)) => Some(model),
        _ => None,
    };
    (model, diagnostics.problems().iter().map(ToString::to_string).collect())
}

/// What is told of the parameters of a plugin, in a sensor of that type or, without one, in a model.
fn told(file: &str, sensor: &str, parameters: &str) -> Vec<String> {
    let plugin = format!("<plugin name='p' filename='{file}'>\n{parameters}</plugin>");
    let inside = match sensor {
        "" => format!("<link name='base_link'/>{plugin}"),
        "ray" => format!(
            "<link name='base_link'><sensor name='s' type='ray'><ray><range><min>.1</min><max>9</max></range></ray>{plugin}\
             </sensor></link>"
        ),
        kind => format!("<link name='base_link'><sensor name='s' type='{kind}'>{plugin}</sensor></link>"),
    };
    let (_, problems) = loaded(&format!("<sdf version='1.7'><model name='m'>{inside}</model></sdf>"));
    problems.into_iter().filter(|problem| problem.contains(" of plugin 'p' ")).collect()
}

const MODEL_PLUGINS: &[&str] = &[
    "libgazebo_ros_ackermann_drive.so",
    "libgazebo_ros_create.so",
    "libgazebo_ros_diff_drive.so",
    "libgazebo_ros_force_based_move.so",
    "libgazebo_ros_ft_sensor.so",
    "libgazebo_ros_imu.so",
    "libgazebo_ros_joint_state_publisher.so",
    "libgazebo_ros_kobuki.so",
    "libgazebo_ros_p3d.so",
    "libgazebo_ros_planar_move.so",
    "libgazebo_ros_skid_steer_drive.so",
    "gz-sim-ackermann-steering-system",
    "gz-sim8-diff-drive-system",
    "libignition-gazebo-joint-state-publisher-system.so",
    "libhector_gazebo_ros_baro.so",
    "libhector_gazebo_ros_gps.so",
    "libhector_gazebo_ros_imu.so",
    "libhector_gazebo_ros_magnetic.so",
    "librotors_gazebo_imu_plugin.so",
    "librotors_gazebo_pressure_plugin.so",
];

const SENSOR_PLUGINS: &[(&str, &str)] = &[
    ("libgazebo_ros_camera.so", "camera"),
    ("libgazebo_ros_openni_kinect.so", "depth"),
    ("libgazebo_ros_laser.so", "ray"),
    ("libgazebo_ros_gpu_laser.so", "ray"),
    ("libgazebo_ros_block_laser.so", "ray"),
    ("libgazebo_ros_velodyne_laser.so", "ray"),
    ("libgazebo_ros_velodyne_gpu_laser.so", "ray"),
    ("libgazebo_ros_ray_sensor.so", "ray"),
    ("libgazebo_ros_range.so", "ray"),
    ("libhector_gazebo_ros_sonar.so", "ray"),
    ("libgazebo_ros_imu_sensor.so", "imu"),
    ("libgazebo_ros_gps_sensor.so", "gps"),
    ("libgazebo_ros_logical_camera.so", "logical_camera"),
    ("libgazebo_ros_bumper.so", "contact"),
];

#[test]
fn a_parameter_that_a_plugin_does_not_know_is_told_with_its_place() {
    let of_models = MODEL_PLUGINS.iter().map(|file| (*file, ""));
    for (file, sensor) in of_models.chain(SENSOR_PLUGINS.iter().copied()) {
        assert_eq!(
            told(file, sensor, "<zzqqxx>1</zzqqxx>"),
            [
                "r.sdf:2: warning: <zzqqxx> of plugin 'p' is not known, and is left out; check its spelling, and where it \
              belongs"
            ],
            "{file}"
        );
    }
}

#[test]
fn a_misspelt_parameter_is_told_with_what_may_be_meant() {
    let meant = |file, sensor, parameters| {
        let problems = told(file, sensor, parameters);
        let [problem] = &problems[..] else { panic!("{file}: {problems:?}") };
        problem.split_once("; did you mean ").map(|(_, meant)| meant.to_owned()).unwrap_or_default()
    };
    for (file, sensor, parameters, expected) in [
        ("libgazebo_ros_diff_drive.so", "", "<updateRat>9</updateRat>", "'updateRate'?"),
        ("libgazebo_ros_diff_drive.so", "", "<wheel_seperation>.3</wheel_seperation>", "'wheel_separation'?"),
        ("libgazebo_ros_laser.so", "ray", "<topicname>scan</topicname>", "'topicName'?"),
        ("libgazebo_ros_velodyne_laser.so", "ray", "<max_rang>9</max_rang>", "'max_range'?"),
        ("libgazebo_ros_camera.so", "camera", "<imageTopicNam>i</imageTopicNam>", "'imageTopicName'?"),
        ("libgazebo_ros_camera.so", "camera", "<ros/><cameraname>c</cameraname>", "'camera_name'?"),
        ("libgazebo_ros_ray_sensor.so", "ray", "<output_typ>x</output_typ>", "'output_type'?"),
        ("gz-sim-diff-drive-system", "", "<odom_topc>o</odom_topc>", "'odom_topic'?"),
    ] {
        assert_eq!(meant(file, sensor, parameters), expected, "{parameters}");
    }
    let remapping = "<ros><remaping>cmd_vel:=go</remaping></ros>";
    let text = format!(
        "<sdf version='1.7'><model name='m'><link name='l'/><plugin name='p' filename='libgazebo_ros_planar_move.so'>\
         {remapping}</plugin></model></sdf>"
    );
    let problems = loaded(&text).1;
    assert_eq!(
        problems,
        ["r.sdf:1: warning: <remaping> of <ros> is not known, and is left out; did you mean 'remapping'?"]
    );
}

#[test]
fn a_parameter_that_is_not_simulated_is_told_with_the_difference() {
    for (file, sensor, parameters, expected) in [
        (
            "gz-sim-diff-drive-system",
            "",
            "<max_linear_velocity>1</max_linear_velocity>",
            "<max_linear_velocity> of plugin 'p' is '1' and is not simulated: the speed is not limited",
        ),
        (
            "libgazebo_ros_camera.so",
            "camera",
            "<ros/><triggered>true</triggered>",
            "<triggered> of plugin 'p' is 'true' and is not simulated: pictures are sent at the rate of the sensor",
        ),
        (
            "libhector_gazebo_ros_imu.so",
            "",
            "<accelScaleError>1 1 1.1</accelScaleError>",
            "<accelScaleError> of plugin 'p' is '1 1 1.1' and is not simulated: measurements have no error of scale",
        ),
    ] {
        assert_eq!(told(file, sensor, parameters), [format!("r.sdf:2: warning: {expected}")], "{file}");
    }
    // The default, and what has no effect on motion and measurements.
    for (file, parameters) in [
        (
            "libhector_gazebo_ros_imu.so",
            "<rateScaleError>1 1 1</rateScaleError><serviceName>calibrate</serviceName>",
        ),
        ("libgazebo_ros_diff_drive.so", "<legacyMode>true</legacyMode><rosDebugLevel>na</rosDebugLevel>"),
        ("libgazebo_ros_kobuki.so", "<wheel_drop_left_sensor_name>w</wheel_drop_left_sensor_name>"),
    ] {
        assert!(told(file, "", parameters).is_empty(), "{file}");
    }
}

/// No robot or world that is shipped with the program has a parameter that is told.
#[test]
fn shipped_files_have_known_parameters_only() {
    let packages = package_path([], None);
    let names = [robot_names(&packages), world_names(&packages)].concat();
    assert!(names.len() > 10, "{names:?}");
    let examples = std::fs::read_dir("examples").unwrap().map(|entry| entry.unwrap().path());
    let is_model =
        |path: &std::path::PathBuf| path.extension().is_some_and(|end| end == "urdf" || end == "sdf");
    let files: Vec<String> = examples.filter(is_model).map(|path| path.display().to_string()).collect();
    for name in names.iter().chain(&files) {
        let mut diagnostics = Diagnostics::default();
        assert!(load(name, &options(), &mut diagnostics).is_some(), "{name}");
        let told = diagnostics.problems().iter().find(|problem| problem.what.contains(" of plugin '"));
        assert!(told.is_none(), "{name}: {told:?}");
    }
}

/// In ROS 2, topics are put into the namespace of `<ros>` and are renamed by its remappings.
#[test]
fn plugins_of_ros_2_are_in_their_namespace_and_are_remapped() {
    let ros = "<ros><namespace>/robot</namespace><remapping>cmd_vel:=go</remapping><remapping>odom:=/where</remapping></ros>";
    let (model, problems) = loaded(&format!(
        "<sdf version='1.7'><model name='m'><link name='base_link'/>
         <plugin name='drive' filename='libgazebo_ros_planar_move.so'>{ros}</plugin>
         <plugin name='truth' filename='libgazebo_ros_p3d.so'>{ros}</plugin>
         <plugin name='joints' filename='libgazebo_ros_joint_state_publisher.so'>{ros}</plugin></model></sdf>"
    ));
    assert!(problems.is_empty(), "{problems:?}");
    let topics: Vec<String> = model
        .unwrap()
        .plugins
        .iter()
        .flat_map(|plugin| match plugin {
            ModelPlugin::Base(base) => vec![base.command_topic.clone(), base.odometry.topic.clone()],
            ModelPlugin::Pose(pose) => vec![pose.topic.clone()],
            ModelPlugin::JointStates(joints) => vec![joints.topic.clone()],
        })
        .collect();
    assert_eq!(topics, ["/robot/go", "/where", "/where", "/robot/joint_states"]);
}
