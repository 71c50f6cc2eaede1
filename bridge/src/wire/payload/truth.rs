//! Ground truth about the objects in an image, about the models that a logical camera sees, and about a robot.

use super::{Message, each};
use crate::wire::{
    Kind, Text,
    fields::{Describe, Fields, RosType},
    layout::wire_structs,
};

wire_structs! {
    /// The visible and the complete extent of an object. The pose is in the optical frame of the sensor (x right, y
    /// down, z forward) at the header's stamp.
    with #[derive(PartialEq)]
    pub struct BoundingBox, 112 bytes, of [Kind::BoundingBoxes] {
        /// Instance number, as in the instance image.
        pub instance: u32 = 0,
        /// Class number, as in the class image.
        pub label: u32 = 4,
        /// Number of visible pixels.
        pub pixels: u32 = 8,
        /// First column and row of the visible pixels.
        pub min: [u32; 2] = 12,
        /// Last column and row of the visible pixels, inclusive.
        pub max: [u32; 2] = 20,
        /// Reserved; 0.
        pub reserved: u32 = 28,
        /// Centre of the oriented box around the complete object, metres.
        pub position: [f64; 3] = 32,
        /// Orientation of that box, x y z w.
        pub orientation: [f64; 4] = 56,
        /// Edge lengths of that box, metres.
        pub size: [f64; 3] = 88,
    }

    /// A fiducial tag with at least one corner in the image that is not occluded. The pose is in the optical frame of
    /// the sensor (x right, y down, z forward) at the header's stamp. The tag's own x is to the right and y up as one
    /// reads it, and z points towards the reader, as in OpenCV's `ArUco`.
    with #[derive(PartialEq)]
    pub struct TagDetection, 168 bytes, of [Kind::TagDetections] {
        /// The tag family, as in the world file: `tag36h11`, `qr`.
        pub family: Text<32> = 0,
        /// Its number in the family.
        pub id: u32 = 32,
        /// For each corner, 1 if it is in the image and not occluded, else 0.
        pub visible: [u8; 4] = 36,
        /// Edge length of its square without the white margin, metres.
        pub size: f64 = 40,
        /// Column and row of each corner at the time its row is exposed, with pixel centres at integers: top left, top
        /// right, bottom right, bottom left as one reads it (OpenCV's `ArUco`). NaN if no pixel of the lens sees in
        /// that direction.
        pub corners: [[f64; 2]; 4] = 48,
        /// Centre of the tag, metres.
        pub position: [f64; 3] = 112,
        /// Orientation of the tag, x y z w.
        pub orientation: [f64; 4] = 136,
    }

    /// A model in the frustum of a logical camera, with its pose in the frame of the camera (x forward, y left, z up).
    with #[derive(PartialEq)]
    pub struct SeenModel, 184 bytes, of [Kind::SeenModels] {
        /// The model's name in the world.
        pub name: Text<128> = 0,
        /// The origin of the model's frame, metres.
        pub position: [f64; 3] = 128,
        /// Orientation of the model's frame, x y z w.
        pub orientation: [f64; 4] = 152,
    }

    /// A pose in the header's `frame_id`, as in `geometry_msgs/PoseStamped`.
    with #[derive(PartialEq)]
    pub struct Pose, 56 bytes, of [Kind::Pose] {
        /// Position, metres.
        pub position: [f64; 3] = 0,
        /// Orientation, x y z w.
        pub orientation: [f64; 4] = 24,
    }
}

impl Describe for Pose {
    const ROS: &'static [RosType] =
        &[RosType::new("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.pose("pose", self.position, self.orientation);
        Some(())
    }
}

impl Describe for BoundingBox {
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("instance", self.instance);
        fields.put("label", self.label);
        fields.put("pixels", self.pixels);
        fields.put("min", &self.min[..]);
        fields.put("max", &self.max[..]);
        fields.pose("pose", self.position, self.orientation);
        fields.vector("size", self.size);
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        each("boxes", "belvedere/BoundingBox", messages, fields)
    }
}

impl Describe for SeenModel {
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("name", self.name.as_str());
        fields.pose("pose", self.position, self.orientation);
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        each("models", "belvedere/SeenModel", messages, fields)
    }
}

impl Describe for TagDetection {
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("family", self.family.as_str());
        fields.put("id", self.id);
        fields.put("size", self.size);
        fields.put("corners", &self.corners[..]);
        fields.put("visible", &self.visible[..]);
        fields.pose("pose", self.position, self.orientation);
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        each("tags", "belvedere/TagDetection", messages, fields)
    }
}
