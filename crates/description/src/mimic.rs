//! Joints that follow each other in a circle.

use super::diagnostics::Diagnostics;
use super::model::Joint;

/// Frees one joint of each circle, the first of them in the file, and reports an error.
pub(super) fn break_loops(joints: &mut [Joint], diagnostics: &mut Diagnostics) {
    for first in first_of_circles(joints) {
        diagnostics.error(
            &joints[first].source,
            format!("the joint '{}' follows itself by its <mimic>", joints[first].name),
            "let it follow a joint that has no <mimic>",
        );
        joints[first].dynamics.mimic = None;
    }
}

/// Returns the lowest number in each circle of joints, in ascending order. Each joint is visited once, so that the time is
/// linear.
fn first_of_circles(joints: &[Joint]) -> Vec<usize> {
    // The number of the walk that has visited a joint.
    let mut visited_by: Vec<Option<usize>> = vec![None; joints.len()];
    let leader = |joint: usize| joints[joint].dynamics.mimic.map(|mimic| mimic.leader);
    let mut found = Vec::new();
    for walk in 0..joints.len() {
        let mut at = Some(walk);
        while let Some(joint) = at.filter(|joint| visited_by[*joint].is_none()) {
            visited_by[joint] = Some(walk);
            at = leader(joint);
        }
        // A walk that returns to a joint of its own has gone round a circle.
        let Some(entry) = at.filter(|joint| visited_by[*joint] == Some(walk)) else { continue };
        let round = std::iter::successors(leader(entry), |joint| leader(*joint).filter(|_| *joint != entry));
        found.extend(round.min());
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::Source;
    use crate::model::{JointDynamics, JointKind, Mimic};
    use belvedere_sensors::Pose;
    use glam::DVec3;

    fn joints(leaders: &[usize]) -> Vec<Joint> {
        let joint = |(index, leader): (usize, &usize)| Joint {
            name: format!("j{index}"),
            kind: JointKind::Continuous,
            parent: 0,
            child: 0,
            parent_from_child: Pose::IDENTITY,
            axis: DVec3::X,
            pivot: DVec3::ZERO,
            dynamics: JointDynamics {
                mimic: Some(Mimic { leader: *leader, multiplier: 1.0, offset: 0.0 }),
                ..JointDynamics::default()
            },
            source: Source::new("r.urdf", index as u32),
        };
        leaders.iter().enumerate().map(joint).collect()
    }

    fn freed(joints: &mut [Joint]) -> Vec<usize> {
        let mut diagnostics = Diagnostics::default();
        break_loops(joints, &mut diagnostics);
        let told: Vec<usize> = diagnostics.problems().iter().map(|it| it.source.line as usize).collect();
        let freed = joints.iter().enumerate().filter(|(_, joint)| joint.dynamics.mimic.is_none());
        assert_eq!(told, freed.map(|(index, _)| index).collect::<Vec<_>>());
        told
    }

    #[test]
    fn one_joint_of_each_circle_is_freed() {
        // 0 leads to the circle 3 5; 1 follows itself; 2 leads to 1; 4 6 7 is another circle.
        assert_eq!(freed(&mut joints(&[5, 1, 1, 5, 7, 3, 4, 6])), [1, 3, 4]);
    }

    /// Each of 200 000 joints follows the next one: walks from each of them would be 2·10¹⁰ steps.
    #[test]
    fn a_long_chain_is_followed_once() {
        let count = 200_000;
        let mut chain = joints(&(0..count).map(|index| (index + 1) % count).collect::<Vec<_>>());
        chain[count - 1].dynamics.mimic = None;
        break_loops(&mut chain, &mut Diagnostics::default());
        assert_eq!(chain.iter().filter(|joint| joint.dynamics.mimic.is_none()).count(), 1);
        chain[count - 1].dynamics.mimic = Some(Mimic { leader: 0, multiplier: 1.0, offset: 0.0 });
        assert_eq!(freed(&mut chain), [0]);
    }
}
