//! Joints that follow each other in a circle.

use super::diagnostics::Diagnostics;
use super::model::Joint;

/// Frees each joint that follows itself, directly or through others, and reports an error.
pub(super) fn break_loops(joints: &mut [Joint], diagnostics: &mut Diagnostics) {
    for first in 0..joints.len() {
        let mut at = first;
        // A path that does not return ends after at most as many steps as there are joints.
        for _ in 0..joints.len() {
            let Some(mimic) = joints[at].dynamics.mimic else { break };
            at = mimic.leader;
            if at == first {
                diagnostics.error(
                    &joints[first].source,
                    format!("the joint '{}' follows itself by its <mimic>", joints[first].name),
                    "let it follow a joint that has no <mimic>",
                );
                joints[first].dynamics.mimic = None;
                break;
            }
        }
    }
}
