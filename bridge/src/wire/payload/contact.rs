//! Contacts of collision shapes.

use super::Message;
use crate::wire::{
    Kind, Text,
    fields::{Describe, Fields, RosType},
    layout::wire_structs,
};

const CONTACTS_STATE: &str = include_str!("../../../ros1/gazebo_msgs/msg/ContactsState.msg");

wire_structs! {
    /// A point at which two collision shapes touch each other. The contacts of a pair follow each other.
    with #[derive(PartialEq)]
    pub struct Contact, 360 bytes, of [Kind::Contacts] {
        /// The collision that the sensor watches, as in Gazebo: `MODEL::LINK::COLLISION`.
        pub collision1: Text<128> = 0,
        /// The other collision.
        pub collision2: Text<128> = 128,
        /// The point, metres.
        pub position: [f64; 3] = 256,
        /// Unit normal of the contact, which points into the first collision.
        pub normal: [f64; 3] = 280,
        /// Depth to which the shapes overlap, metres.
        pub depth: f64 = 304,
        /// Force on the first collision, newtons.
        pub force: [f64; 3] = 312,
        /// Torque of that force about the centre of mass of the first collision's body, newton metres.
        pub torque: [f64; 3] = 336,
    }
}

impl Contact {
    fn is_of(&self, other: &Self) -> bool {
        self.collision1 == other.collision1 && self.collision2 == other.collision2
    }
}

impl Describe for Contact {
    const ROS: &'static [RosType] =
        &[RosType::in_file("gazebo_msgs/ContactsState", "acbcb1601a8e525bf72509f18e6f668d", CONTACTS_STATE)];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        Self::describe_all(&[*self], fields)
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        let pairs: Vec<&[Self]> = messages.chunk_by(Self::is_of).collect();
        fields.header(None);
        fields.list("states", "gazebo_msgs/ContactState", pairs.len(), &mut |index, fields| {
            describe_pair(pairs[index], fields);
        });
        Some(())
    }
}

/// Passes the contacts of a pair, of which there is at least one.
fn describe_pair(contacts: &[Contact], fields: &mut dyn Fields) {
    if fields.ros().is_some() {
        // A text for debugging in Gazebo.
        fields.put("info", "");
    }
    fields.put("collision1_name", contacts[0].collision1.as_str());
    fields.put("collision2_name", contacts[0].collision2.as_str());
    fields.list("wrenches", "geometry_msgs/Wrench", contacts.len(), &mut |index, fields| {
        fields.vector("force", contacts[index].force);
        fields.vector("torque", contacts[index].torque);
    });
    fields.part("total_wrench", "geometry_msgs/Wrench", &mut |fields| {
        fields.vector("force", sum(contacts, |contact| contact.force));
        fields.vector("torque", sum(contacts, |contact| contact.torque));
    });
    for (name, of) in [
        ("contact_positions", (|contact| contact.position) as fn(&Contact) -> [f64; 3]),
        ("contact_normals", |contact| contact.normal),
    ] {
        fields.list(name, "geometry_msgs/Vector3", contacts.len(), &mut |index, fields| {
            let [x, y, z] = of(&contacts[index]);
            fields.put("x", x);
            fields.put("y", y);
            fields.put("z", z);
        });
    }
    let depths: Vec<f64> = contacts.iter().map(|contact| contact.depth).collect();
    fields.put("depths", &depths[..]);
}

fn sum(contacts: &[Contact], of: fn(&Contact) -> [f64; 3]) -> [f64; 3] {
    contacts.iter().map(of).fold([0.0; 3], |sum, part| [sum[0] + part[0], sum[1] + part[1], sum[2] + part[2]])
}
