//! `<plugin>` of a model: bases that drive it, sensors, and publishers of its state. A plugin is a file here and a row in
//! [`reader`], and its parameters are a context in `elements/plugins.txt`.

mod ackermann;
mod differential;
mod force_torque;
mod imu;
mod instruments;
mod joint_states;
mod kobuki;
mod parameters;
mod planar;
mod pose;

use super::Rules;
use super::diagnostics::Diagnostics;
use super::label::is_label;
use super::model::{Model, ModelPlugin, Sensor};
use super::xml::Element;
use parameters::Parameters;

/// The supported plugins, for messages.
const SUPPORTED: &str = "libgazebo_ros_kobuki.so, libgazebo_ros_create.so, libgazebo_ros_diff_drive.so, \
    libgazebo_ros_skid_steer_drive.so, libgazebo_ros_planar_move.so, libgazebo_ros_force_based_move.so, libgazebo_ros_ackermann_drive.so, gz-sim's DiffDrive, \
    AckermannSteering and JointStatePublisher, libgazebo_ros_imu.so, libhector_gazebo_ros_imu.so, librotors_gazebo_imu_plugin.so, libhector_gazebo_ros_gps.so, libhector_gazebo_ros_magnetic.so, libhector_gazebo_ros_baro.so, librotors_gazebo_pressure_plugin.so, libgazebo_ros_ft_sensor.so, libgazebo_ros_p3d.so and libgazebo_ros_joint_state_publisher.so";

/// Returns the plugin's file name without `lib` and `.so`, with gz-sim's old names converted to its new one.
fn plain_name(file: &str) -> String {
    let name = file.rsplit('/').next().unwrap_or(file);
    let name = name.strip_prefix("lib").unwrap_or(name);
    let name = name.strip_suffix(".so").unwrap_or(name);
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
    // Releases before Jetty have their number in the name: gz-sim8-diff-drive-system, ignition-gazebo6-….
    for release in ["ignition-gazebo", "gz-sim"] {
        if let Some(rest) = name.strip_prefix(release) {
            let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit());
            if rest.is_empty() || rest.starts_with('-') {
                return format!("gz-sim{rest}");
            }
        }
    }
    name.to_owned()
}

/// How a plugin is read.
enum Read {
    /// It is a sensor.
    Sensor(fn(&mut Parameters<'_>) -> Option<Sensor>),
    /// It drives the model, or publishes its state.
    Plugin(fn(&mut Parameters<'_>) -> Option<ModelPlugin>),
}

/// Returns how the plugin of a name is read; none for one that is not simulated.
fn reader(name: &str) -> Option<Read> {
    Some(match name {
        "gazebo_ros_imu" => Read::Sensor(imu::imu),
        "hector_gazebo_ros_imu" => Read::Sensor(imu::hector),
        "rotors_gazebo_imu_plugin" => Read::Sensor(imu::rotors),
        "hector_gazebo_ros_gps" => Read::Sensor(instruments::gps),
        "hector_gazebo_ros_magnetic" => Read::Sensor(instruments::magnetic),
        "hector_gazebo_ros_baro" => Read::Sensor(instruments::baro),
        "rotors_gazebo_pressure_plugin" => Read::Sensor(instruments::pressure),
        "gazebo_ros_ft_sensor" => Read::Sensor(force_torque::force_torque),
        "gazebo_ros_kobuki" => Read::Plugin(kobuki::kobuki),
        "gazebo_ros_create" => Read::Plugin(differential::create),
        "gazebo_ros_diff_drive" => Read::Plugin(differential::differential),
        "gazebo_ros_skid_steer_drive" => Read::Plugin(differential::skid_steer),
        "gz-sim-diff-drive" => Read::Plugin(differential::gz),
        "gazebo_ros_force_based_move" => Read::Plugin(planar::force_based),
        "gazebo_ros_planar_move" => Read::Plugin(planar::planar),
        "gazebo_ros_ackermann_drive" => Read::Plugin(ackermann::ackermann),
        "gz-sim-ackermann-steering" => Read::Plugin(ackermann::gz),
        "gazebo_ros_p3d" => Read::Plugin(pose::pose),
        "gz-sim-joint-state-publisher" => Read::Plugin(joint_states::gz),
        "gazebo_ros_joint_state_publisher" => Read::Plugin(joint_states::joint_states),
        _ => return None,
    })
}

/// Systems of gz-sim, and plugins of Gazebo classic, whose work the simulator does without them, for each world and
/// sensor.
const PROVIDED: [&str; 13] = [
    "gazebo_ros_init",
    "gz-sim-air-pressure",
    "gz-sim-altimeter",
    "gz-sim-contact",
    "gz-sim-forcetorque",
    "gz-sim-imu",
    "gz-sim-logical-camera",
    "gz-sim-magnetometer",
    "gz-sim-navsat",
    "gz-sim-physics",
    "gz-sim-scene-broadcaster",
    "gz-sim-sensors",
    "gz-sim-user-commands",
];

/// Returns true if nothing is missing without a plugin, because the simulator does its work anyway.
pub(super) fn is_provided(plugin: &Element) -> bool {
    let name = plain_name(plugin.attribute("filename").unwrap_or_default());
    PROVIDED.contains(&name.strip_suffix("-system").unwrap_or(&name))
}

/// Reads the plugins in an element into a model whose links and joints have been read.
pub(super) fn read(parent: &Element, model: &mut Model, rules: Rules, diagnostics: &mut Diagnostics) {
    for element in parent.elements_named("plugin").filter(|plugin| !is_label(plugin) && !is_provided(plugin))
    {
        let file = element.attribute("filename").unwrap_or_default();
        let name = plain_name(file);
        let name = name.strip_suffix("-system").unwrap_or(&name);
        let Some(read) = reader(name) else {
            // A copter has one for each rotor.
            diagnostics.warning_once(
                &element.source,
                format!("the plugin '{file}' of model '{}' is not simulated and is left out", model.name),
                format!("these are: {SUPPORTED}"),
            );
            continue;
        };
        let mut given = Parameters::new(element, name, model, rules, diagnostics);
        let plugin = match read {
            Read::Sensor(read) => {
                let sensor = read(&mut given);
                model.sensors.extend(sensor);
                continue;
            }
            Read::Plugin(read) => read(&mut given),
        };
        let Some(plugin) = plugin else { continue };
        let drives = |plugin: &ModelPlugin| matches!(plugin, ModelPlugin::Base(_));
        if drives(&plugin) && model.plugins.iter().any(drives) {
            diagnostics.warning(
                &element.source,
                format!("model '{}' has a second base, '{file}', which is left out", model.name),
                "keep one of the two",
            );
            continue;
        }
        model.plugins.push(plugin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each name below `SUPPORTED` has a reader, and the table knows its parameters.
    #[test]
    fn each_plugin_has_parameters_and_a_name_in_the_remedy() {
        let contexts = include_str!("../elements/plugins.txt").lines().filter(|line| !line.starts_with(' '));
        let readers: Vec<&str> = contexts.filter(|context| reader(context).is_some()).collect();
        assert_eq!(readers.len(), 20, "{readers:?}");
        let files =
            SUPPORTED.split([',', ' ']).filter_map(|word| word.strip_prefix("lib")?.strip_suffix(".so"));
        for name in files {
            assert!(readers.contains(&name), "{name}");
        }
    }
}
