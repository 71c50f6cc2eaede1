//! Robot files: our own robots, the robots of the articles, and all errors that a file can have.
#![expect(clippy::approx_constant, reason = "angles to the digits that the articles' files give")]

use belvedere::description::load::{LoadOptions, load_robot, robot_names, xacro_argument};
use belvedere::description::model::{Camera, DepthCamera, JointKind, Lidar, Model, Sensor, SensorKind};
use belvedere::description::models::package_path;
use belvedere::description::package::PackagePath;
use belvedere::description::{Diagnostics, Problem, Rules, Severity};
use glam::DVec3;
use std::f64::consts::FRAC_PI_3;
use std::path::PathBuf;
use tempfile::TempDir;

/// The tolerance of poses: a tenth of a micrometre, far below the precision of any number in a description.
const POSE_TOLERANCE_M: f64 = 1e-7;

fn load_from(packages: PackagePath, name: &str, gazebo_compat: bool) -> (Option<Model>, Vec<Problem>) {
    let options =
        LoadOptions { packages, rules: Rules { gazebo_compat, ..Rules::default() }, xacro_args: Vec::new() };
    let mut diagnostics = Diagnostics::default();
    let robot = load_robot(name, &options, &mut diagnostics);
    (robot, diagnostics.problems().to_vec())
}

/// One of our own robots, which must load without any message.
#[track_caller]
fn ours(name: &str) -> Model {
    let (robot, problems) = load_from(package_path([], None), name, false);
    assert!(problems.is_empty(), "{name}: {problems:#?}");
    robot.unwrap()
}

fn sensor<'m>(robot: &'m Model, name: &str) -> &'m Sensor {
    robot.sensors.iter().find(|sensor| sensor.name == name).unwrap()
}

/// The position of a link in another link, with all joints at zero.
fn place(robot: &Model, outer: &str, inner: &str) -> DVec3 {
    let rest = robot.rest_poses();
    let pose = |name| rest[robot.link_named(name).unwrap_or_else(|| panic!("no link {name}"))];
    (pose(outer).inverse() * pose(inner)).translation()
}

#[track_caller]
fn assert_place(robot: &Model, inner: &str, xyz: [f64; 3]) {
    let found = place(robot, "base_link", inner);
    assert!(found.distance(DVec3::from_array(xyz)) < POSE_TOLERANCE_M, "{inner} is at {found}");
}

#[test]
fn all_our_robots_load_without_messages() {
    let names = robot_names(&package_path([], None));
    for wanted in [
        "kobuki_nostack_camera",
        "kobuki_nostack_rplidar",
        "kobuki_hexagons_kinect",
        "kobuki_hexagons_rplidar",
        "kobuki_hexagons_camera",
        "kobuki_hexagons_KinectHokuyo",
    ] {
        assert!(names.iter().any(|name| name == wanted), "{wanted} is not in {names:?}");
    }
    for name in &names {
        let robot = ours(name);
        assert!(!robot.sensors.is_empty(), "{name}");
        let is_published = |sensor: &Sensor| match &sensor.kind {
            SensorKind::Camera(camera) => camera.plugin.is_some(),
            SensorKind::Depth(depth) => depth.plugin.is_some(),
            SensorKind::Ray(lidar) => lidar.plugin.is_some(),
            SensorKind::Range(range) => range.plugin.is_some(),
            other => panic!("{other:?}"),
        };
        assert!(robot.sensors.iter().all(is_published), "{name}");
    }
}

/// Like robots in ROS's own packages: limits in a YAML file, an option on the command line.
#[test]
fn xacro_reads_yaml_and_takes_arguments() {
    let folder = TempDir::new().unwrap();
    let package = folder.path().join("src/vendor/arm");
    std::fs::create_dir_all(package.join("config")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(package.join(name), text).unwrap();
    write("package.xml", "<package><name>arm_description</name></package>");
    write(
        "config/limits.yaml",
        "joint_limits:\n  lift: {max_position: !degrees 90.0, has_limits: true}\n  turn:\n    max_position: 7.0\n    max_position: 2.5\n",
    );
    write(
        "arm.xacro",
        "<robot name='arm' xmlns:xacro='http://x'><xacro:arg name='length' default='1'/>
        <xacro:property name='file' value='$(find arm_description)/config/limits.yaml'/>
        <xacro:property name='limits' value=\"${xacro.load_yaml(file)['joint_limits']}\"/>
        <xacro:property name='near' value=\"${load_yaml('config/limits.yaml')}\"/>
        <xacro:macro name='joint_of' params='name limits length'><link name='${name}_link'/>
          <joint name='${name}' type='revolute'><parent link='base_link'/><child link='${name}_link'/><origin xyz='${length} 0 0'/>
          <limit lower='0' upper=\"${limits[name]['max_position']}\" effort='1' velocity='1'/></joint></xacro:macro>
        <link name='base_link'/>
        <xacro:joint_of name='lift' limits='${limits}' length='$(arg length)'/>
        <xacro:if value=\"${'turn' in near.joint_limits and near['joint_limits'].lift.has_limits}\">
          <xacro:joint_of name='turn' limits='${near.joint_limits}' length='0'/></xacro:if></robot>",
    );
    let packages = package_path([folder.path().join("src")], None);
    let xacro_args = vec![xacro_argument("length:=3").unwrap()];
    let options = LoadOptions { packages, rules: Rules::default(), xacro_args };
    let mut diagnostics = Diagnostics::default();
    let robot = load_robot(package.join("arm.xacro").to_str().unwrap(), &options, &mut diagnostics).unwrap();
    assert!(
        diagnostics.problems().iter().all(|problem| problem.severity == Severity::Note),
        "{diagnostics:#?}"
    );
    let upper = |name: &str| match robot.joints.iter().find(|joint| joint.name == name).unwrap().kind {
        JointKind::Revolute { upper, .. } => upper,
        other => panic!("{other:?}"),
    };
    assert_eq!((upper("lift"), upper("turn")), (std::f64::consts::FRAC_PI_2, 2.5));
    assert_place(&robot, "lift_link", [3.0, 0.0, 0.0]);
    for text in ["length", ":=3", "a b:=3"] {
        assert!(xacro_argument(text).unwrap_err().contains("name:=value"));
    }
}

/// Every part that a user's robot file can include, on both bases.
#[test]
fn every_part_of_the_library_can_be_mounted() {
    let folder = TempDir::new().unwrap();
    let sensors =
        ["kinect", "asus_xtion_pro", "asus_xtion_pro_offset", "astra", "r200", "rplidar", "hokuyo", "camera"];
    for (base, stack) in [("kobuki", "hexagons"), ("create", "circles"), ("kobuki", "circles")] {
        for sensor in sensors {
            let path = folder.path().join(format!("{base}_{stack}_{sensor}.urdf.xacro"));
            let text = format!(
                "<robot name='t' xmlns:xacro='http://ros.org/wiki/xacro'>
                <xacro:include filename='$(find turtlebot_description)/urdf/turtlebot_library.urdf.xacro'/>
                <{base}/><stack_{stack} parent='base_link'/><sensor_{sensor} parent='base_link'/></robot>"
            );
            std::fs::write(&path, text).unwrap();
            let robot = ours(path.to_str().unwrap());
            assert_eq!(robot.sensors.len(), 1, "{sensor}");
            let housing = &robot.links[robot.sensors[0].link];
            assert!(!housing.visuals.is_empty() && housing.collisions.is_empty(), "{}", housing.name);
        }
    }
}

#[test]
fn the_kobuki_has_its_published_measures() {
    let robot = ours("kobuki_nostack_camera");
    assert_eq!(robot.name, "turtlebot");
    assert_place(&robot, "base_footprint", [0.0, 0.0, -0.0102]);
    assert_place(&robot, "wheel_left_link", [0.0, 0.115, 0.025]);
    assert_place(&robot, "wheel_right_link", [0.0, -0.115, 0.025]);
    assert_place(&robot, "caster_front_link", [0.115, 0.0, 0.007]);
    assert_place(&robot, "caster_back_link", [-0.135, 0.0, 0.009]);
    assert_place(&robot, "gyro_link", [0.056, 0.062, 0.0202]);
    assert_place(&robot, "cliff_sensor_left_link", [0.08734, 0.13601, 0.0214]);
    assert_place(&robot, "cliff_sensor_right_link", [0.085, -0.13601, 0.0214]);
    assert_place(&robot, "cliff_sensor_front_link", [0.156, 0.0, 0.0214]);
    let base = robot.links[robot.link_named("base_link").unwrap()].inertial.unwrap();
    assert_eq!((base.mass_kg, &base.inertia[..3]), (2.4, &[0.019_995, 0.019_995, 0.036_75][..]));
    let wheel = robot.joints.iter().find(|joint| joint.name == "wheel_left_joint").unwrap();
    assert_eq!((wheel.kind, wheel.axis), (JointKind::Continuous, DVec3::Z));
    assert!(belvedere::robot::has_base(&robot));
}

/// The intrinsics of the ceiling camera, as computed in its article: fx = fy = 381.3612.
#[test]
fn the_ceiling_camera_matches_the_article() {
    let robot = ours("kobuki_nostack_camera");
    assert_place(&robot, "base_camera_link", [0.15, 0.0, 0.35]);
    assert_camera(&robot);
    assert_place(&robot, "base_laser_link", [0.10, 0.0, 0.425]);
    assert_rplidar(&robot);
}

fn assert_camera(robot: &Model) {
    let camera = sensor(robot, "camera1");
    assert_eq!(robot.links[camera.link].name, "base_camera_link");
    assert_eq!(camera.effective_rate_hz(), Some(30.0));
    let looks = robot.rest_poses()[camera.link].transform_vector(DVec3::X);
    assert!(looks.distance(DVec3::Z) < 1e-5, "it looks along {looks}");
    let SensorKind::Camera(Camera { camera: lens, plugin: Some(plugin) }) = &camera.kind else {
        panic!("{:?}", camera.kind)
    };
    assert_eq!((lens.width, lens.height, lens.horizontal_fov_rad), (640, 480, 1.396_263_4));
    let focal_length = 320.0 / (lens.horizontal_fov_rad / 2.0).tan();
    assert!((focal_length - 381.3612).abs() < 1e-4, "{focal_length}");
    assert_eq!((lens.near_m, lens.far_m), (0.02, 300.0));
    assert_eq!((lens.noise.mean, lens.noise.stddev), (0.0, 0.007));
    assert_eq!(
        (plugin.image_topic.as_str(), plugin.camera_info_topic.as_str()),
        ("/image_raw", "/camera_info")
    );
    assert_eq!((plugin.frame_name.as_str(), plugin.hack_baseline_m), ("base_camera_link", 0.07));
    assert_eq!(plugin.distortion, [0.0; 5]);
}

fn assert_rplidar(robot: &Model) {
    let lidar = sensor(robot, "laser");
    assert_eq!(
        (lidar.effective_rate_hz(), robot.links[lidar.link].name.as_str()),
        (Some(5.5), "base_laser_link")
    );
    assert_scan(lidar, 360, 3.141_592_6, 6.0, "/scan", "base_laser_link");
}

fn assert_scan(
    lidar: &Sensor,
    samples: u32,
    half_angle_rad: f64,
    range_max_m: f64,
    topic: &str,
    frame: &str,
) {
    let SensorKind::Ray(Lidar { ray, plugin: Some(plugin), preset: None, .. }) = &lidar.kind else {
        panic!("{:?}", lidar.kind)
    };
    let scan = ray.horizontal;
    assert_eq!((scan.samples, ray.vertical.samples), (samples, 1));
    assert_eq!((scan.min_angle_rad, scan.max_angle_rad), (-half_angle_rad, half_angle_rad));
    assert_eq!((ray.range_min_m, ray.range_max_m, ray.range_resolution_m), (0.10, range_max_m, 0.01));
    assert_eq!((ray.noise.mean, ray.noise.stddev), (0.0, 0.01));
    assert_eq!((plugin.topic.as_str(), plugin.frame_name.as_str()), (topic, frame));
}

#[test]
fn the_kinect_and_the_hokuyo_match_the_articles() {
    let robot = ours("kobuki_hexagons_KinectHokuyo");
    assert_place(&robot, "camera_rgb_frame", [-0.087, -0.0125, 0.287]);
    assert_place(&robot, "camera_link", [-0.118, 0.0, 0.271]);
    assert_place(&robot, "camera_depth_frame", [-0.087, 0.0125, 0.287]);
    assert_place(&robot, "camera_depth_optical_frame", [-0.087, 0.0125, 0.287]);
    assert_place(&robot, "hokuyo_link", [0.10, 0.0, 0.425]);
    let kinect = sensor(&robot, "camera");
    assert_eq!((kinect.update_rate_hz, kinect.effective_rate_hz()), (Some(20.0), Some(10.0)));
    let SensorKind::Depth(DepthCamera { camera: lens, plugin: Some(plugin), preset: None, .. }) =
        &kinect.kind
    else {
        panic!("{:?}", kinect.kind)
    };
    assert_eq!((lens.width, lens.height, lens.near_m, lens.far_m), (640, 480, 0.05, 8.0));
    assert!((lens.horizontal_fov_rad - FRAC_PI_3).abs() < 1e-12);
    let topics = [
        &plugin.camera.image_topic,
        &plugin.camera.camera_info_topic,
        &plugin.depth_image_topic,
        &plugin.depth_camera_info_topic,
        &plugin.point_cloud_topic,
    ];
    let wanted = ["rgb/image_raw", "rgb/camera_info", "depth/image_raw", "depth/camera_info", "depth/points"];
    assert_eq!(topics.map(String::as_str), wanted.map(|topic| format!("/camera/{topic}")));
    assert_eq!((plugin.cutoff_m, plugin.camera.frame_name.as_str()), (0.4, "camera_depth_optical_frame"));
    let hokuyo = sensor(&robot, "head_hokuyo_sensor");
    assert_eq!(hokuyo.effective_rate_hz(), Some(40.0));
    assert_eq!(robot.links[hokuyo.link].name, "hokuyo_link");
    assert_scan(hokuyo, 720, 1.570_796, 30.0, "/rrbot/laser/scan", "hokuyo_link");
}

/// The articles' own files, if they are available.
fn article(folder: &str) -> Option<PackagePath> {
    let seed = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/seed-robot")).join(folder);
    seed.is_dir().then(|| package_path([seed], None))
}

/// A file that is taken from our packages because the user's copy lacks it is reported once.
#[track_caller]
fn assert_notes_of_our_files(problems: &[Problem], files: &[&str]) {
    for file in files {
        let notes = problems.iter().filter(|problem| problem.what.contains(file)).collect::<Vec<_>>();
        let [note] = notes[..] else { panic!("{file}: {problems:#?}") };
        assert_eq!(note.severity, Severity::Note, "{note}");
        assert!(note.source.line > 0, "{note}");
    }
}

#[test]
fn the_ceiling_articles_robot_loads() {
    let Some(packages) = article("ceiling-camera") else { return };
    let (robot, problems) = load_from(packages, "kobuki_nostack_camera", false);
    assert!(problems.iter().all(|problem| problem.severity == Severity::Note), "{problems:#?}");
    assert_notes_of_our_files(&problems, &["sensors/rplidar.urdf.xacro", "stacks/hexagons.urdf.xacro"]);
    let robot = robot.unwrap();
    assert!(
        robot.source.file.components().any(|part| part.as_os_str() == "ceiling-camera"),
        "{}",
        robot.source
    );
    assert_camera(&robot);
    assert_rplidar(&robot);
    assert_place(&robot, "base_camera_link", [0.15, 0.0, 0.35]);
    let camera = &robot.links[robot.link_named("base_camera_link").unwrap()];
    let own = ours("kobuki_nostack_camera");
    let own = &own.links[own.link_named("base_camera_link").unwrap()];
    assert_eq!(camera.visuals[0].material, own.visuals[0].material, "Red is our Red");
}

#[test]
fn the_mapping_articles_hokuyo_is_one_error() {
    let Some(packages) = article("kinect-hokuyo") else { return };
    let name = "kobuki_hexagons_KinectHokuyo";
    let (_, problems) = load_from(packages.clone(), name, false);
    let errors = problems.iter().filter(|problem| problem.severity == Severity::Error).collect::<Vec<_>>();
    let [error] = errors[..] else { panic!("{problems:#?}") };
    let text = error.to_string();
    assert!(error.source.file.ends_with("turtlebot_gazebo.urdf.xacro") && error.source.line > 0, "{text}");
    for word in ["hokuyo_link", "did you mean", "--gazebo-compat", "head_hokuyo_sensor"] {
        assert!(text.contains(word), "no '{word}' in {text}");
    }

    let (robot, problems) = load_from(packages, name, true);
    let robot = robot.unwrap();
    assert_eq!(robot.sensors.iter().map(|sensor| sensor.name.as_str()).collect::<Vec<_>>(), ["camera"]);
    let warnings =
        problems.iter().filter(|problem| problem.severity == Severity::Warning).collect::<Vec<_>>();
    let [warning] = warnings[..] else { panic!("{problems:#?}") };
    assert!(warning.what.contains("hokuyo_link"), "{warning}");
}

/// A complete robot; each faulty one differs from it in one place.
const GOOD: &str = r#"<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
<link name="base_link"/>
<link name="eye"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="fixed"><parent link="base_link"/><child link="eye"/></joint>
<gazebo reference="eye"><sensor type="camera" name="c">
<camera><horizontal_fov>1.0</horizontal_fov>
<image><width>64</width><height>48</height></image>
<clip><near>0.1</near><far>10</far></clip></camera></sensor>
<sensor type="ray" name="l"><ray>
<scan><horizontal><samples>8</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
<range><min>0.1</min><max>5</max></range></ray></sensor></gazebo>
</robot>"#;

#[test]
fn each_fault_gives_one_error_with_place_and_remedy() {
    let missing_mesh = "<mesh filename=\"package://none/such.stl\"/>";
    for (find, replace, line, words) in [
        ("", "", 0, &[][..]),
        ("</gazebo>\n</robot>", "</robot>", 11, &["XML"]),
        (
            "<link name=\"base_link\"/>",
            "<link name=\"base_link\"/><xacro:kobuky/>",
            2,
            &["unknown macro 'kobuky'"],
        ),
        ("<far>10</far>", "<far>${farr}</far>", 8, &["farr"]),
        ("name=\"base_link\"/>", "name=\"base_link\"/><link name=\"lost\"/>", 2, &["lost", "base_link"]),
        ("<parent link=\"base_link\"/>", "<parent link=\"bass_link\"/>", 4, &["bass_link", "base_link"]),
        ("<child link=\"eye\"/>", "<child link=\"base_link\"/>", 4, &["base_link"]),
        (
            "<link name=\"eye\">",
            "<link name=\"base_link\"/><link name=\"eye\">",
            3,
            &["base_link", "two links"],
        ),
        ("<box size=\"1 1 1\"/>", "<mesh filename=\"eye.step\"/>", 3, &["step", "stl"]),
        ("<box size=\"1 1 1\"/>", missing_mesh, 3, &["such.stl", "--package-path"]),
        ("<box size=\"1 1 1\"/>", "<box size=\"1 nan 1\"/>", 3, &["nan", "size"]),
        ("<box size=\"1 1 1\"/>", "<box size=\"1 -1 1\"/>", 3, &["-1", "size"]),
        ("<width>64</width>", "<width>0</width>", 7, &["<width>", "'c'", "0"]),
        ("<height>48</height>", "<height>100000</height>", 7, &["<height>", "'c'", "100000"]),
        ("<horizontal_fov>1.0<", "<horizontal_fov>7<", 6, &["<horizontal_fov>", "7"]),
        ("<near>0.1</near>", "<near>11</near>", 8, &["near", "far", "11"]),
        ("<samples>8</samples>", "<samples>-8</samples>", 10, &["<samples>", "'l'", "-8"]),
        ("<min_angle>-1<", "<min_angle>left<", 10, &["min_angle", "'left'"]),
        ("<max>5</max>", "<max>nan</max>", 11, &["<max>", "nan"]),
        ("<min>0.1</min>", "<min>-0.1</min>", 11, &["<min>", "-0.1"]),
        ("<min>0.1</min>", "<min>6</min>", 11, &["<min> 6", "<max> 5"]),
    ] {
        let folder = TempDir::new().unwrap();
        std::fs::write(folder.path().join("eye.step"), "no mesh").unwrap();
        let path = folder.path().join("bad.urdf.xacro");
        assert!(GOOD.contains(find), "{find}");
        std::fs::write(&path, GOOD.replacen(find, replace, 1)).unwrap();
        let (_, problems) = load_from(package_path([], None), path.to_str().unwrap(), false);
        if line == 0 {
            assert!(problems.is_empty(), "{problems:#?}");
            continue;
        }
        let [problem] = &problems[..] else { panic!("{replace}: {problems:#?}") };
        let text = problem.to_string();
        assert_eq!((problem.severity, problem.source.line), (Severity::Error, line), "{replace}: {text}");
        assert!(problem.source.file.ends_with("bad.urdf.xacro"), "{text}");
        assert!(!problem.remedy.is_empty(), "no remedy: {text}");
        for word in words {
            assert!(text.contains(word), "no '{word}' in: {text}");
        }
    }
}

#[test]
fn an_include_cycle_and_a_missing_include_are_one_error() {
    for (included, words) in [("bad.urdf.xacro", "bad.urdf.xacro"), ("none.xacro", "none.xacro")] {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("bad.urdf.xacro");
        let text = format!(
            "<robot name='r' xmlns:xacro='http://x'>\n<xacro:include filename='{included}'/></robot>"
        );
        std::fs::write(&path, text).unwrap();
        let (robot, problems) = load_from(package_path([], None), path.to_str().unwrap(), false);
        let [problem] = &problems[..] else { panic!("{problems:#?}") };
        assert!(robot.is_none() && problem.source.line == 2 && problem.what.contains(words), "{problem}");
        assert!(!problem.remedy.is_empty(), "{problem}");
    }
}

/// With `--package-path src` on the command line, `$(find …)` is relative to the working directory, not to the file.
#[test]
fn a_relative_package_path_finds_files() {
    let folder = tempfile::tempdir_in(".").unwrap();
    let relative = PathBuf::from(folder.path().file_name().unwrap());
    let robots = relative.join("turtlebot_description/robots");
    std::fs::create_dir_all(&robots).unwrap();
    let text = "<robot name='r' xmlns:xacro='http://x'>
        <xacro:include filename='$(find turtlebot_description)/robots/part.xacro'/>
        <xacro:property name='here' value='$(find turtlebot_description)/robots'/>
        <xacro:include filename='${here}/part.xacro'/><link name='l'/></robot>";
    std::fs::write(robots.join("part.xacro"), "<robot/>").unwrap();
    std::fs::write(robots.join("mine.urdf.xacro"), text).unwrap();
    let (robot, problems) = load_from(package_path([relative], None), "mine", false);
    assert!(problems.is_empty() && robot.is_some(), "{problems:#?}");
}
