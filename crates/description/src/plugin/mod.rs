//! `<plugin>` of a model: bases that drive it, sensors, and publishers of its state. A plugin is a file here and a row in
//! [`read`].

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
use super::model::{Model, ModelPlugin};
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

/// Reads the plugins in an element into a model whose links and joints have been read.
pub(super) fn read(parent: &Element, model: &mut Model, rules: Rules, diagnostics: &mut Diagnostics) {
    for element in parent.elements_named("plugin").filter(|plugin| !is_label(plugin)) {
        let file = element.attribute("filename").unwrap_or_default();
        let mut given = Parameters::new(element, model, rules, diagnostics);
        let sensor = match plain_name(file).as_str() {
            "gazebo_ros_imu" => Some(imu::imu(&mut given)),
            "hector_gazebo_ros_imu" => Some(imu::hector(&mut given)),
            "rotors_gazebo_imu_plugin" => Some(imu::rotors(&mut given)),
            "hector_gazebo_ros_gps" => Some(instruments::gps(&mut given)),
            "hector_gazebo_ros_magnetic" => Some(instruments::magnetic(&mut given)),
            "hector_gazebo_ros_baro" => Some(instruments::baro(&mut given)),
            "rotors_gazebo_pressure_plugin" => Some(instruments::pressure(&mut given)),
            "gazebo_ros_ft_sensor" => Some(force_torque::force_torque(&mut given)),
            _ => None,
        };
        if let Some(sensor) = sensor {
            model.sensors.extend(sensor);
            continue;
        }
        let plugin = match plain_name(file).trim_end_matches("-system") {
            "gazebo_ros_kobuki" => kobuki::kobuki(&mut given),
            "gazebo_ros_create" => differential::create(&mut given),
            "gazebo_ros_diff_drive" => differential::differential(&mut given),
            "gazebo_ros_skid_steer_drive" => differential::skid_steer(&mut given),
            "gz-sim-diff-drive" => differential::gz(&mut given),
            "gazebo_ros_force_based_move" => planar::force_based(&mut given),
            "gazebo_ros_planar_move" => planar::planar(&mut given),
            "gazebo_ros_ackermann_drive" => ackermann::ackermann(&mut given),
            "gz-sim-ackermann-steering" => ackermann::gz(&mut given),
            "gazebo_ros_p3d" => pose::pose(&mut given),
            "gz-sim-joint-state-publisher" => joint_states::gz(&mut given),
            "gazebo_ros_joint_state_publisher" => joint_states::joint_states(&mut given),
            _ => {
                diagnostics.warning(
                    &element.source,
                    format!("the plugin '{file}' of model '{}' is not simulated and is left out", model.name),
                    format!("these are: {SUPPORTED}"),
                );
                continue;
            }
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
