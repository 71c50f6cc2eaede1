//! Whether a plugin is written for ROS 1 or for ROS 2, where plugins of both have the same file name.

use crate::xml::Element;

/// Elements that only plugins of ROS 2 have.
const MARKS: [&str; 4] = ["ros", "frame_name", "camera_name", "output_type"];

/// Parameters of the camera plugins of ROS 1, without the distortion coefficients.
const CAMERA_PARAMETERS: [&str; 12] = [
    "robotNamespace",
    "cameraName",
    "imageTopicName",
    "cameraInfoTopicName",
    "frameName",
    "updateRate",
    "hackBaseline",
    "autoDistortion",
    "CxPrime",
    "Cx",
    "Cy",
    "focalLength",
];

/// Returns true if a plugin is written for ROS 2.
pub(super) fn is_ros2(plugin: &Element) -> bool {
    MARKS.iter().any(|mark| plugin.child(mark).is_some())
}

/// Returns true for the camera plugin of ROS 2.
pub(super) fn is_ros2_camera(plugin: &Element) -> bool {
    let of_ros1 = |child: &Element| CAMERA_PARAMETERS.contains(&child.name.as_str());
    is_ros2(plugin) && !plugin.elements().any(of_ros1)
}
