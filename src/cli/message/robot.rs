//! Messages about a robot's state: odometry, transforms, joints, and the events and sensors of its base.

use super::parts::{Entries, array, pose, text, twist, xyz, xyzw};
use super::tree::Tree::{self, List, Map, Number, Whole};
use belvedere_bridge::FrameView;
use belvedere_bridge::payload::{CoreSensors, JointState, Odometry, RobotEvent, Transform};

pub(super) fn odometry(odometry: &Odometry) -> Entries {
    vec![
        ("child_frame_id", text(odometry.child_frame_id.as_str())),
        (
            "pose",
            Map(vec![
                ("pose", pose(odometry.position, odometry.orientation)),
                ("covariance", array(&odometry.pose_covariance)),
            ]),
        ),
        (
            "twist",
            Map(vec![
                ("twist", twist(odometry.linear, odometry.angular)),
                ("covariance", array(&odometry.twist_covariance)),
            ]),
        ),
    ]
}

pub(super) fn transform(transform: &Transform) -> Tree {
    Map(vec![
        ("frame_id", text(transform.parent.as_str())),
        ("child_frame_id", text(transform.child.as_str())),
        (
            "transform",
            Map(vec![("translation", xyz(transform.translation)), ("rotation", xyzw(transform.rotation))]),
        ),
    ])
}

pub(super) fn joints(frame: &FrameView<'_>) -> Option<Entries> {
    let joints: Vec<JointState> = frame.structs().ok()?.collect();
    let column = |value: fn(&JointState) -> Tree| List(joints.iter().map(value).collect(), 0);
    Some(vec![
        ("name", column(|joint| text(joint.name.as_str()))),
        ("position", column(|joint| Number(joint.position))),
        ("velocity", column(|joint| Number(joint.velocity))),
        ("effort", column(|joint| Number(joint.effort))),
    ])
}

/// Shows an event with names for its numbers; the name of a state depends on the source.
pub(super) fn event(event: &RobotEvent) -> Entries {
    let (source, states) = match event.source {
        RobotEvent::BUMPER => ("bumper", ["released", "pressed"]),
        RobotEvent::CLIFF => ("cliff", ["floor", "cliff"]),
        RobotEvent::WHEEL_DROP => ("wheel_drop", ["raised", "dropped"]),
        _ => ("unknown", ["unknown"; 2]),
    };
    let index = match event.index {
        RobotEvent::LEFT => "left",
        RobotEvent::CENTRE => "centre",
        RobotEvent::RIGHT => "right",
        _ => "unknown",
    };
    vec![
        ("source", text(source)),
        ("index", text(index)),
        ("state", text(states.get(event.state as usize).copied().unwrap_or("unknown"))),
        ("value", Whole(event.value.into())),
    ]
}

pub(super) fn core_sensors(core: &CoreSensors) -> Entries {
    let signed = |value: i8| Number(value.into());
    vec![
        ("time_stamp", Whole(core.time_stamp.into())),
        ("bumper", Whole(core.bumper.into())),
        ("wheel_drop", Whole(core.wheel_drop.into())),
        ("cliff", Whole(core.cliff.into())),
        ("left_encoder", Whole(core.left_encoder.into())),
        ("right_encoder", Whole(core.right_encoder.into())),
        ("left_pwm", signed(core.left_pwm)),
        ("right_pwm", signed(core.right_pwm)),
        ("buttons", Whole(core.buttons.into())),
        ("charger", Whole(core.charger.into())),
        ("battery", Whole(core.battery.into())),
        ("bottom", List(core.bottom.iter().map(|&reading| Whole(reading.into())).collect(), 0)),
    ]
}
