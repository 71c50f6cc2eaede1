//! Joint states on a separate topic: `libgazebo_ros_joint_state_publisher.so`.

use super::channel::Channel;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::description::model::{JointIndex, JointStatesPlugin};
use crate::entities::EntityId;
use belvedere_bridge::payload::JointState;
use belvedere_bridge::{Kind, StreamSpec, Text};

/// The channel of a joint state publisher.
pub(super) struct JointStatesChannel {
    id: EntityId,
    joints: Vec<(JointIndex, Text<64>)>,
    states: Outlet,
    messages: Vec<JointState>,
}

impl JointStatesChannel {
    pub(super) fn open(plugin: &JointStatesPlugin, opening: &Opening<'_>) -> Result<Self, RigError> {
        let model = &opening.entity.model;
        let moves = |joint: &JointIndex| opening.physics.joint_state(opening.id.index(), *joint).is_some();
        let named = |joint: &JointIndex| {
            plugin.joints.is_empty() || plugin.joints.contains(&model.joints[*joint].name)
        };
        let joints = (0..model.joints.len())
            .filter(moves)
            .filter(named)
            .map(|joint| {
                let name = &model.joints[joint].name;
                Ok((joint, Text::new(name).map_err(|error| RigError::name(name, &error))?))
            })
            .collect::<Result<Vec<_>, RigError>>()?;
        let spec = StreamSpec::structs(&plugin.topic, Kind::JointStates, joints.len());
        Ok(Self {
            id: opening.id,
            states: opening.open(&spec.rate_hz(opening.rate.hz()))?,
            messages: Vec::with_capacity(joints.len()),
            joints,
        })
    }
}

impl Channel for JointStatesChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.states]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let RigContext { physics, stamp_ns, .. } = *context;
        let model = self.id.index();
        self.messages.clear();
        self.messages.extend(self.joints.iter().map(|(joint, name)| {
            let state = physics.joint_state_at(model, *joint, stamp_ns).unwrap_or_default();
            JointState {
                name: *name,
                position: state.position,
                velocity: state.velocity,
                effort: state.effort,
            }
        }));
        self.states.send_structs(stamp_ns, &self.messages);
    }
}
