//! Element names that belong to URDF and SDF, and so are not misspelt macros.

/// Elements that URDF allows directly inside `<robot>`.
pub(super) const TOP_LEVEL: [&str; 14] = [
    "chain_controller",
    "controller",
    "disable_collisions",
    "gazebo",
    "group",
    "group_state",
    "joint",
    "link",
    "material",
    "ros2_control",
    "sensor",
    "transmission",
    "velocity",
    "virtual_joint",
];

/// Elements that other programs read inside `<robot>`.
pub(super) const FOREIGN: [&str; 9] = [
    "capabilities",
    "compiler",
    "loop_joint",
    "mujoco",
    "passive_joint",
    "pybullet",
    "self_collision_checking",
    "sphere_approximation",
    "end_effector",
];

/// Names below the top that a macro call without the prefix `xacro:` does not capture.
const NESTED: [&str; 53] = [
    "actuator",
    "always_on",
    "axis",
    "box",
    "calibration",
    "camera",
    "capsule",
    "child",
    "clip",
    "collision",
    "color",
    "contact",
    "cylinder",
    "distortion",
    "dynamics",
    "far",
    "force_torque",
    "format",
    "geometry",
    "gps",
    "height",
    "horizontal",
    "image",
    "imu",
    "inertia",
    "inertial",
    "joint",
    "lens",
    "lidar",
    "limit",
    "link",
    "mass",
    "material",
    "mesh",
    "mimic",
    "name",
    "near",
    "noise",
    "origin",
    "parent",
    "plugin",
    "pose",
    "range",
    "ray",
    "safety_controller",
    "scan",
    "sensor",
    "sphere",
    "texture",
    "transmission",
    "vertical",
    "visual",
    "width",
];

/// Returns true if an element with this name and without a prefix is never a macro call.
pub(super) fn is_own(name: &str, at_top: bool) -> bool {
    if at_top { TOP_LEVEL.contains(&name) } else { NESTED.contains(&name) }
}
