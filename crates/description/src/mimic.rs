//! Joints that follow each other in a circle.

use super::diagnostics::Diagnostics;
use super::model::Joint;

/// Frees each joint that follows itself, directly or through others, and reports an error.
pub(super) fn break_loops(joints: &mut [Joint], diagnostics: &mut Diagnostics) {
    // The first joint of the path on which each joint was visited.
    let mut visited: Vec<Option<usize>> = vec![None; joints.len()];
    let mut firsts = Vec::new();
    for start in 0..joints.len() {
        let mut at = start;
        while visited[at].is_none() {
            visited[at] = Some(start);
            let Some(mimic) = joints[at].dynamics.mimic else { break };
            at = mimic.leader;
        }
        let leader = |at: usize| joints[at].dynamics.mimic.map(|mimic| mimic.leader);
        if visited[at] != Some(start) || leader(at).is_none() {
            continue;
        }
        // The path returned to a joint of its own: the circle is freed at its first joint in the file.
        let mut first = at;
        let mut next = leader(at);
        while let Some(other) = next.filter(|other| *other != at) {
            first = first.min(other);
            next = leader(other);
        }
        firsts.push(first);
    }
    firsts.sort_unstable();
    for first in firsts {
        diagnostics.error(
            &joints[first].source,
            format!("the joint '{}' follows itself by its <mimic>", joints[first].name),
            "let it follow a joint that has no <mimic>",
        );
        joints[first].dynamics.mimic = None;
    }
}
