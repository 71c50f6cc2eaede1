//! The tree of links and joints, and the poses in it.

use super::Loader;
use crate::model::{Joint, JointKind, LinkIndex, Model};
use crate::xml::Element;

impl Loader<'_> {
    /// Checks that links and joints form one tree and fills in [`model_from_link`]; false if they do not.
    ///
    /// [`model_from_link`]: crate::model::Link::model_from_link
    pub(super) fn build_tree(&mut self, robot: &Element, model: &mut Model) -> bool {
        // After a broken link or joint the rest looks disconnected; reporting that too would only distract.
        let is_complete = model.links.len() == robot.elements_named("link").count()
            && model.joints.len() == robot.elements_named("joint").count();
        if !is_complete || model.links.is_empty() || !self.one_parent_each(model) {
            return false;
        }
        let roots: Vec<LinkIndex> = (0..)
            .zip(model.joints_above())
            .filter(|(_, above)| above.is_none())
            .map(|(link, _)| link)
            .collect();
        if let [first, second, ..] = roots[..] {
            let (one, other) = (&model.links[first], &model.links[second]);
            self.diagnostics.error(
                &other.source,
                format!(
                    "the robot has {} roots: no joint has '{}' ({}) or '{}' as its child",
                    roots.len(),
                    one.name,
                    one.source,
                    other.name
                ),
                "join them with a <joint>, or remove one",
            );
            return false;
        }
        let reached = place_links(&roots, model);
        if let Some(looped) = reached.iter().position(|reached| !reached) {
            self.report_loop(looped, model);
            return false;
        }
        if let Some(&root) = roots.first()
            && model.links[root].name == "world"
        {
            stand_on_world(root, model);
        }
        true
    }

    fn one_parent_each(&mut self, model: &Model) -> bool {
        let mut above: Vec<Option<&Joint>> = vec![None; model.links.len()];
        for joint in &model.joints {
            if let Some(first) = above[joint.child].replace(joint) {
                self.diagnostics.error(
                    &joint.source,
                    format!(
                        "the link '{}' is the child of two joints: '{}' ({}) and '{}'",
                        model.links[joint.child].name, first.name, first.source, joint.name
                    ),
                    "remove one: a robot is a tree",
                );
                return false;
            }
        }
        true
    }

    /// Reports a loop of joints that contains `link` or that `link` hangs on.
    fn report_loop(&mut self, link: LinkIndex, model: &Model) {
        let joints = model.joints_above();
        let joint_above = |link: LinkIndex| joints[link].map(|joint| &model.joints[joint]);
        let above = |link| joint_above(link).map_or(link, |joint| joint.parent);
        // After as many steps up as there are links, the walk is inside the loop.
        let start = (0..model.links.len()).fold(link, |link, _| above(link));
        let mut names = vec![model.links[start].name.as_str()];
        let mut at = above(start);
        while at != start {
            names.push(&model.links[at].name);
            at = above(at);
        }
        names.push(&model.links[start].name);
        names.reverse();
        let source = joint_above(start).map_or(&model.links[start].source, |joint| &joint.source);
        self.diagnostics.error(
            source,
            format!("joints make a loop: {}", names.join(" → ")),
            "remove one of these joints: a robot is a tree",
        );
    }
}

/// Makes a root link named `world` the world itself, as in Gazebo.
fn stand_on_world(world: LinkIndex, model: &mut Model) {
    model.links[world].is_static = true;
    model.is_static = model.joints.iter().all(|joint| joint.kind == JointKind::Fixed);
}

/// Sets each link's pose from its joints, from the roots on; returns which links were reached.
fn place_links(roots: &[LinkIndex], model: &mut Model) -> Vec<bool> {
    let mut children = vec![Vec::new(); model.links.len()];
    for joint in &model.joints {
        children[joint.parent].push((joint.child, joint.parent_from_child));
    }
    let mut reached = vec![false; model.links.len()];
    let mut open = roots.to_vec();
    while let Some(link) = open.pop() {
        reached[link] = true;
        let model_from_link = model.links[link].model_from_link;
        for &(child, link_from_child) in &children[link] {
            model.links[child].model_from_link = model_from_link * link_from_child;
            open.push(child);
        }
    }
    reached
}
