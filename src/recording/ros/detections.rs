//! The boxes around the objects in an image as a `vision_msgs/msg/Detection2DArray` of ROS 2. ROS 1 has another type of the same
//! name, which is not written.

use super::Payload;
use super::types::{Definition, MessageType};
use belvedere_bridge::payload::BoundingBox;
use belvedere_bridge::{Fields, FrameView, RosBytes};

pub(super) const DETECTIONS: MessageType =
    MessageType { name: "vision_msgs/Detection2DArray", definition: Definition::Fields(describe) };

/// The covariance of a pose that is known exactly.
const EXACT: [f64; 36] = [0.0; 36];

fn describe(fields: &mut dyn Fields) {
    fields.header(None);
    fields.list("detections", "vision_msgs/Detection2D", 1, &mut |_, fields| {
        fields.header(None);
        fields.list("results", "vision_msgs/ObjectHypothesisWithPose", 1, &mut |_, fields| {
            fields.part("hypothesis", "vision_msgs/ObjectHypothesis", &mut |fields| {
                fields.put("class_id", "");
                fields.put("score", 0.0_f64);
            });
            fields.part("pose", "geometry_msgs/PoseWithCovariance", &mut |fields| {
                fields.pose("pose", [0.0; 3], [0.0; 4]);
                fields.put("covariance", &EXACT);
            });
        });
        fields.part("bbox", "vision_msgs/BoundingBox2D", &mut |fields| {
            fields.part("center", "vision_msgs/Pose2D", &mut |fields| {
                fields.part("position", "vision_msgs/Point2D", &mut |fields| {
                    fields.put("x", 0.0_f64);
                    fields.put("y", 0.0_f64);
                });
                fields.put("theta", 0.0_f64);
            });
            fields.put("size_x", 0.0_f64);
            fields.put("size_y", 0.0_f64);
        });
        fields.put("id", "");
    });
}

/// Writes a detection for each object. Its class is the class number, its `id` the instance number, and its score 1. The box
/// in the image is that of the visible pixels, whose centres are at integers; the pose is that of the centre of the whole
/// object, in the optical frame.
pub(super) fn detections(frame: &FrameView<'_>, out: &mut RosBytes<'_>) -> Option<Payload> {
    let boxes = frame.structs::<BoundingBox>().ok()?;
    out.header(frame.header(), None);
    out.count(boxes.len());
    for each in boxes {
        out.header(frame.header(), None);
        out.count(1);
        out.text(&each.label.to_string());
        out.f64(1.0);
        each.position.iter().chain(&each.orientation).chain(&EXACT).for_each(|value| out.f64(*value));
        let [from, to] = [each.min, each.max].map(|corner| corner.map(f64::from));
        out.f64(f64::midpoint(from[0], to[0]));
        out.f64(f64::midpoint(from[1], to[1]));
        out.f64(0.0);
        out.f64(to[0] - from[0] + 1.0);
        out.f64(to[1] - from[1] + 1.0);
        out.text(&each.instance.to_string());
    }
    Some(Payload::Elsewhere)
}
