//! `belvedere check`: what a robot or world file is understood to be, and everything that is wrong with it.

use super::error::CliError;
use super::follow::print_line;
use crate::description::model::{
    CameraPlugin, CameraSensor, Geometry, Joint, JointKind, Light, LightKind, LinkIndex, Model, Noise,
    PixelFormat, Plugin, Radiation, RaySensor, Sensor, SensorKind, World,
};
use crate::description::package::PackagePath;
use crate::description::robot::{LoadOptions, default_robot_name, load_robot, robot_names};
use crate::description::world::{load_world, world_names};
use crate::description::xml::Element;
use crate::description::{Diagnostics, Severity};
use crate::rig::base;
use crate::robot::imu::Imu;
use crate::robot::kobuki::Wheels;
use belvedere_sensors::Pose;
use glam::{DVec3, EulerRot};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Show what a robot or world file is understood to be, and everything that is wrong with it.
///
/// Prints the tree of links with their joints, the sensors with all their parameters after defaults and plugins,
/// and every problem as `file:line: severity: what; remedy`. Of a world it prints models, lights and physics. The
/// exit code is 1 if there are errors.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere check
  belvedere check kobuki_hexagons_kinect
  belvedere check my_robot.urdf.xacro --package-path ~/catkin_ws/src
  belvedere check my.world")]
pub struct CheckArgs {
    /// A .urdf, .xacro, .world or .sdf file, or the name of a robot or world of ours
    /// [default: the robot that `belvedere run` takes]
    #[arg(value_name = "FILE|NAME")]
    pub file: Option<String>,
    /// A folder of ROS packages, looked into before ROS_PACKAGE_PATH and our own; may be repeated
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Go on as Gazebo classic does where something is missing, with a warning in place of the error
    #[arg(long)]
    pub gazebo_compat: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Description`] with every error in the file; failures of standard output.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = PackagePath::new(args.package_path.iter().cloned(), ros_package_path.as_deref());
    let file = args.file.clone().unwrap_or_else(default_robot_name);
    let mut diagnostics = Diagnostics::default();
    let report = if is_world(&file, &packages) {
        load_world(&file, &packages, args.gazebo_compat, &mut diagnostics).map(|world| world_report(&world))
    } else {
        let options = LoadOptions { packages, gazebo_compat: args.gazebo_compat, xacro_args: Vec::new() };
        load_robot(&file, &options, &mut diagnostics).map(|robot| {
            if let Err(problem) = Wheels::of(&robot) {
                diagnostics.add(problem);
            }
            robot_report(&robot)
        })
    };
    for line in report.into_iter().flatten() {
        print_line(&line)?;
    }
    // Errors are the command's own end: they are printed there.
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity != Severity::Error) {
        print_line(&problem.to_string())?;
    }
    if diagnostics.has_errors() {
        return Err(CliError::Description(diagnostics.errors().cloned().collect()));
    }
    let count = diagnostics.problems().len();
    print_line(&match count {
        0 => "no problems".to_owned(),
        1 => "no errors, 1 remark".to_owned(),
        _ => format!("no errors, {count} remarks"),
    })
}

/// Whether it is a world: a file that says so in its first element, or else a name that only worlds have.
fn is_world(file: &str, packages: &PackagePath) -> bool {
    let path = Path::new(file);
    if path.is_file() {
        return match Element::parse_file(path) {
            Ok(root) => root.name == "sdf" || root.name == "gazebo",
            Err(_) => path.extension().is_some_and(|extension| extension == "world" || extension == "sdf"),
        };
    }
    let stem = file.strip_suffix(".world").or(file.strip_suffix(".sdf")).unwrap_or(file);
    let has = |names: Vec<String>| names.iter().any(|name| name == stem);
    stem != file || (!has(robot_names(packages)) && has(world_names(packages)))
}

fn robot_report(robot: &Model) -> Vec<String> {
    let mut lines = vec![format!("robot {} ({})", robot.name, robot.source)];
    let roots = (0..robot.links.len()).filter(|link| robot.joint_above(*link).is_none());
    for root in roots {
        lines.push(link_line(robot, root));
        branch(robot, root, "", &mut lines);
    }
    for sensor in &robot.sensors {
        lines.push(String::new());
        lines.extend(sensor_report(robot, sensor));
    }
    if Wheels::of(robot).is_ok() {
        lines.push(String::new());
        lines.extend(base_report(robot));
    }
    lines.push(String::new());
    lines
}

/// What the base tells and is told, as a Kobuki's driver.
fn base_report(robot: &Model) -> Vec<String> {
    let mut lines = vec!["base kobuki".to_owned()];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    say("topics", "/odom, /joint_states, /tf, /tf_static".into());
    say("", format!("{}, {}", base::IMU_TOPIC, base::CORE_TOPIC));
    say("", format!("{}, {}", base::BUMPER_TOPIC, base::CLIFF_TOPIC));
    say("", base::WHEEL_DROP_TOPIC.into());
    say("commands", "/cmd_vel".into());
    say("", format!("{}, {}", base::RESET_ODOMETRY_TOPIC, base::MOTOR_POWER_TOPIC));
    say("IMU frame", robot.links[Imu::mount(robot)].name.clone());
    lines
}

/// The joints below a link, drawn with lines. As deep as the tree, which the loader has checked to be one.
fn branch(model: &Model, parent: LinkIndex, indent: &str, lines: &mut Vec<String>) {
    let below: Vec<&Joint> = model.joints.iter().filter(|joint| joint.parent == parent).collect();
    for (number, joint) in below.iter().enumerate() {
        let is_last = number + 1 == below.len();
        let (fork, further) = if is_last { ("└─ ", "   ") } else { ("├─ ", "│  ") };
        let place = pose(&joint.parent_from_child);
        lines.push(format!("{indent}{fork}{}  {} {place}", link_line(model, joint.child), joint_kind(joint)));
        branch(model, joint.child, &format!("{indent}{further}"), lines);
    }
}

fn link_line(model: &Model, link: LinkIndex) -> String {
    let link = &model.links[link];
    let mass =
        link.inertial.map(|inertial| format!(" [{} kg]", number(inertial.mass_kg))).unwrap_or_default();
    format!("{}{mass}", link.name)
}

fn joint_kind(joint: &Joint) -> String {
    let axis = || vector(joint.axis);
    match joint.kind {
        JointKind::Fixed => "fixed".into(),
        JointKind::Floating => "floating".into(),
        JointKind::Continuous => format!("continuous about {}", axis()),
        JointKind::Revolute { lower, upper } => {
            format!("revolute about {} from {} to {} rad", axis(), number(lower), number(upper))
        }
        JointKind::Prismatic { lower, upper } => {
            format!("prismatic along {} from {} to {} m", axis(), number(lower), number(upper))
        }
    }
}

fn sensor_report(model: &Model, sensor: &Sensor) -> Vec<String> {
    let kind = match sensor.kind {
        SensorKind::Camera(_) => "camera",
        SensorKind::Depth(_) => "depth camera",
        SensorKind::Ray(_) if matches!(sensor.plugin, Some(Plugin::Range(_))) => "rangefinder",
        SensorKind::Ray(_) => "lidar",
    };
    let mut lines = vec![format!("{kind} {} ({})", sensor.name, sensor.source)];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    let link = &model.links[sensor.link].name;
    say("link", format!("{link} {}", pose(&sensor.link_from_sensor)));
    say("rate", rate(sensor));
    match &sensor.kind {
        SensorKind::Camera(camera) | SensorKind::Depth(camera) => camera_report(camera, &mut say),
        SensorKind::Ray(ray) => ray_report(ray, &mut say),
    }
    match &sensor.plugin {
        None => say("topics", "none: it has no plugin that is simulated".into()),
        Some(Plugin::Laser(laser)) => {
            say("topic", laser.topic.clone());
            say("frame", laser.frame_name.clone());
        }
        Some(Plugin::Range(range)) => {
            say("topic", range.topic.clone());
            say("frame", range.frame_name.clone());
            let radiation = match range.radiation {
                Radiation::Ultrasound => "ultrasound",
                Radiation::Infrared => "infrared",
            };
            say("cone", format!("{} of {radiation}", angle(range.field_of_view_rad)));
        }
        Some(Plugin::Camera(camera)) => {
            say("topics", format!("{}, {}", camera.image_topic, camera.camera_info_topic));
            camera_plugin_report(camera, &mut say);
        }
        Some(Plugin::DepthCamera(depth)) => {
            say("topics", format!("{}, {}", depth.camera.image_topic, depth.camera.camera_info_topic));
            say("", format!("{}, {}", depth.depth_image_topic, depth.depth_camera_info_topic));
            say("", depth.point_cloud_topic.clone());
            let coding = if depth.depth_16uc1 { "16UC1 in millimetres" } else { "32FC1 in metres" };
            let (from, to) = (number(depth.cutoff_m), number(depth.cutoff_max_m));
            say("depth", format!("{coding}, valid from {from} to {to} m"));
            camera_plugin_report(&depth.camera, &mut say);
        }
    }
    lines
}

fn rate(sensor: &Sensor) -> String {
    let Some(effective) = sensor.effective_rate_hz() else { return "every step of physics".into() };
    match sensor.update_rate_hz {
        Some(own) if own > effective => {
            format!("{} Hz (the sensor's own {} Hz, limited by its plugin)", number(effective), number(own))
        }
        _ => format!("{} Hz", number(effective)),
    }
}

fn camera_report(camera: &CameraSensor, say: &mut impl FnMut(&str, String)) {
    let format = match camera.format {
        PixelFormat::Rgb8 => "rgb8",
        PixelFormat::Bgr8 => "bgr8",
        PixelFormat::Mono8 => "mono8",
    };
    let (width, height) = (camera.width, camera.height);
    say("picture", format!("{width} x {height} {format}"));
    let focal_length = 0.5 * f64::from(width) / libm::tan(0.5 * camera.horizontal_fov_rad);
    let vertical_fov_rad = 2.0 * libm::atan(0.5 * f64::from(height) / focal_length);
    say("view", format!("{} across, {} down", angle(camera.horizontal_fov_rad), angle(vertical_fov_rad)));
    say("focal length", format!("{focal_length:.4} pixels"));
    say("clip", format!("{} to {} m", number(camera.near_m), number(camera.far_m)));
    say("noise", noise(&camera.noise, "of [0, 1]"));
    if camera.distortion != [0.0; 5] {
        say("lens", format!("k1, k2, k3, p1, p2 = {:?}", camera.distortion));
    }
}

fn camera_plugin_report(camera: &CameraPlugin, say: &mut impl FnMut(&str, String)) {
    say("frame", if camera.frame_name.is_empty() { "none".into() } else { camera.frame_name.clone() });
    let mut info = Vec::new();
    if camera.hack_baseline_m != 0.0 {
        info.push(format!("baseline {} m", number(camera.hack_baseline_m)));
    }
    if camera.distortion != [0.0; 5] {
        info.push(format!("k1, k2, k3, t1, t2 = {:?}", camera.distortion));
    }
    for (name, value) in [
        ("cx", camera.principal_point[0]),
        ("cy", camera.principal_point[1]),
        ("focal length", camera.focal_length),
    ] {
        info.extend(value.map(|value| format!("{name} {}", number(value))));
    }
    if !info.is_empty() {
        say("camera_info", info.join(", "));
    }
}

fn ray_report(ray: &RaySensor, say: &mut impl FnMut(&str, String)) {
    for (name, axis) in [("beams", ray.horizontal), ("lines", ray.vertical)] {
        if name == "beams" || axis.samples > 1 {
            let (from, to) = (angle(axis.min_angle_rad), angle(axis.max_angle_rad));
            say(name, format!("{} from {from} to {to}", axis.samples));
        }
    }
    say("range", format!("{} to {} m", number(ray.range_min_m), number(ray.range_max_m)));
    if ray.range_resolution_m > 0.0 {
        say("resolution", format!("{} m, not applied, as in Gazebo", number(ray.range_resolution_m)));
    }
    say("noise", noise(&ray.noise, "m"));
}

fn noise(noise: &Noise, unit: &str) -> String {
    if *noise == Noise::default() {
        return "none".into();
    }
    let mut parts =
        vec![format!("gaussian, mean {}, stddev {} {unit}", number(noise.mean), number(noise.stddev))];
    if noise.bias_mean != 0.0 || noise.bias_stddev != 0.0 {
        let (mean, stddev) = (number(noise.bias_mean), number(noise.bias_stddev));
        parts.push(format!("bias mean {mean}, bias stddev {stddev}"));
    }
    if noise.precision > 0.0 {
        parts.push(format!("rounded to {}", number(noise.precision)));
    }
    parts.join(", ")
}

fn world_report(world: &World) -> Vec<String> {
    let mut lines = vec![format!("world {} ({})", world.name, world.source)];
    lines.push(format!(
        "physics: step {} s, gravity {} m/s²",
        number(world.max_step_size_s),
        vector(world.gravity)
    ));
    let shadows = if world.shadows { "with shadows" } else { "without shadows" };
    lines.push(format!("scene: ambient {:?}, background {:?}, {shadows}", world.ambient, world.background));
    lines.extend(world.lights.iter().map(light_line));
    for model in &world.models {
        let fixed = if model.is_static { "static" } else { "moving" };
        lines.push(format!("model {} {fixed} {}", model.name, pose(&model.world_from_model)));
        for link in &model.links {
            let shapes: Vec<_> = link.visuals.iter().map(|visual| shape(&visual.geometry)).collect();
            let shown = if shapes.is_empty() { "nothing to see".into() } else { counted(&shapes) };
            lines.push(format!("  {} {}: {shown}", link.name, pose(&link.model_from_link)));
        }
        for joint in &model.joints {
            let (parent, child) = (&model.links[joint.parent].name, &model.links[joint.child].name);
            lines.push(format!("  joint {} {parent} → {child}: {}", joint.name, joint_kind(joint)));
        }
        for sensor in &model.sensors {
            lines.extend(sensor_report(model, sensor).iter().map(|line| format!("  {line}")));
        }
    }
    lines.push(String::new());
    lines
}

fn light_line(light: &Light) -> String {
    let kind = match light.kind {
        LightKind::Point => "point".to_owned(),
        LightKind::Directional => "directional".to_owned(),
        LightKind::Spot { inner_angle, outer_angle, .. } => {
            format!("spot {} to {}", angle(inner_angle), angle(outer_angle))
        }
    };
    let direction = match light.kind {
        LightKind::Point => String::new(),
        _ => {
            format!(" towards {}", vector(light.world_from_light.transform_vector(light.direction)))
        }
    };
    format!(
        "light {} {kind} {}{direction}, diffuse {:?}, range {} m{}",
        light.name,
        pose(&light.world_from_light),
        light.diffuse,
        number(light.range_m),
        if light.cast_shadows { ", casts shadows" } else { "" }
    )
}

fn shape(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Box { size } => format!("box {}", vector(*size)),
        Geometry::Cylinder { radius, length } => {
            format!("cylinder r {} l {}", number(*radius), number(*length))
        }
        Geometry::Sphere { radius } => format!("sphere r {}", number(*radius)),
        Geometry::Capsule { radius, length } => {
            format!("capsule r {} l {}", number(*radius), number(*length))
        }
        Geometry::Plane { size: [x, y], .. } => format!("plane {} {}", number(*x), number(*y)),
        Geometry::Mesh(mesh) => format!("mesh {} of {} triangles", mesh.path.display(), mesh.triangles.len()),
    }
}

/// Shapes in order, those alike counted where the first of them stands.
fn counted(shapes: &[String]) -> String {
    let mut groups: Vec<(&str, usize)> = Vec::new();
    for shape in shapes {
        match groups.iter_mut().find(|(other, _)| other == shape) {
            Some((_, count)) => *count += 1,
            None => groups.push((shape, 1)),
        }
    }
    let texts = groups.iter().map(|(shape, count)| match count {
        1 => (*shape).to_owned(),
        many => format!("{many} × {shape}"),
    });
    texts.collect::<Vec<_>>().join(", ")
}

/// `xyz … rpy …`, as URDF writes it; what is zero is left out.
fn pose(pose: &Pose) -> String {
    let xyz = pose.translation();
    let (yaw, pitch, roll) = pose.rotation().to_euler(EulerRot::ZYX);
    // Every rotation is written in two ways. Beyond a quarter turn the one that only pitches is what files say.
    let flipped = DVec3::new(roll - PI.copysign(roll), PI.copysign(pitch) - pitch, yaw - PI.copysign(yaw));
    let is_tilted = roll.abs() + yaw.abs() > PI;
    let rpy = if is_tilted { flipped } else { DVec3::new(roll, pitch, yaw) };
    let mut parts = vec![format!("xyz {}", vector(xyz))];
    if rpy.abs().max_element() > 5e-7 {
        parts.push(format!("rpy {}", vector(rpy)));
    }
    parts.join(" ")
}

fn vector(vector: DVec3) -> String {
    vector.to_array().map(number).join(" ")
}

fn angle(radians: f64) -> String {
    format!("{} rad ({:.2}°)", number(radians), radians.to_degrees())
}

/// At most seven decimals, and none that say nothing.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value != 0.0 && value.abs() < 1e-6 {
        return format!("{value:e}");
    }
    let text = format!("{value:.7}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (30.0, "30"),
            (0.35, "0.35"),
            (-1.308_996_9, "-1.3089969"),
            (1e-7, "1e-7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    #[allow(clippy::approx_constant, reason = "the articles' number, which is not π/2")]
    fn poses_are_written_as_urdf_writes_them() {
        let turned = Pose::from_xyz_rpy(DVec3::new(0.15, 0.0, 0.35), DVec3::new(0.1, -0.2, 0.3));
        assert_eq!(pose(&turned), "xyz 0.15 0 0.35 rpy 0.1 -0.2 0.3");
        assert_eq!(pose(&Pose::IDENTITY), "xyz 0 0 0");
        let upwards = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, -1.5708, 0.0));
        assert_eq!(pose(&upwards), "xyz 0 0 0 rpy 0 -1.5708 0");
        let around = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0));
        assert_eq!(pose(&around), "xyz 0 0 0 rpy 0 0 3");
    }

    #[test]
    fn shapes_alike_are_counted() {
        assert_eq!(counted(&["a", "b", "a"].map(str::to_owned)), "2 × a, b");
    }

    #[test]
    fn names_of_robots_and_worlds_are_told_apart() {
        let packages = PackagePath::new([], None);
        for (name, expected) in [
            ("kobuki_nostack_camera", false),
            ("tag_ceiling", true),
            ("playground.world", true),
            ("no_such_thing", false),
            ("no/such.urdf", false),
        ] {
            assert_eq!(is_world(name, &packages), expected, "{name}");
        }
    }
}
