//! The descriptions of robots, plain URDFs, for the page and for ROS 2.

use super::attachments::robot_urdf;
use crate::description::model::Model;
use crate::description::package::PackagePath;
use crate::entities::{EntityId, Origin};
use crate::server::Server;
use crate::simulation::{Simulation, SpawnOptions};
use crate::view::ViewServer;
use std::collections::HashMap;

/// Returns namespace and plain URDF of each robot that has one.
pub(super) fn robot_descriptions(
    robots: &[(Model, SpawnOptions)],
    packages: &PackagePath,
    xacro_args: &[(String, String)],
) -> Vec<(String, String)> {
    let urdf = |(model, options): &(Model, SpawnOptions)| {
        Some((options.namespace.clone(), robot_urdf(model, packages, xacro_args)?))
    };
    robots.iter().filter_map(urdf).collect()
}

/// A program's part that shows or publishes the descriptions of robots by their namespaces.
pub(super) trait DescriptionReceiver {
    /// Adds or replaces a description.
    fn set(&self, namespace: &str, urdf: &str);
    /// Removes the description of a deleted robot.
    fn remove(&self, namespace: &str);
}

impl DescriptionReceiver for ViewServer {
    fn set(&self, namespace: &str, urdf: &str) {
        self.set_robot_description(namespace, urdf);
    }

    fn remove(&self, namespace: &str) {
        self.remove_robot_description(namespace);
    }
}

/// Gives receivers the descriptions of robots that are spawned, and removes those of robots that are deleted.
pub(super) struct RobotDescriptions<'a> {
    receivers: Vec<&'a dyn DescriptionReceiver>,
    /// Robots whose description the receivers have, with their namespaces.
    described: HashMap<EntityId, String>,
}

impl<'a> RobotDescriptions<'a> {
    /// Starts with descriptions that the receivers already have: (namespace, URDF).
    pub(super) fn new(
        receivers: Vec<&'a dyn DescriptionReceiver>,
        descriptions: &[(String, String)],
        simulation: &Simulation,
    ) -> Self {
        let robots = simulation.entities().iter().filter(|(_, entity)| entity.origin == Origin::Start);
        let is_described =
            |namespace: &str| descriptions.iter().any(|(described, _)| *described == namespace);
        let described = robots.filter(|(_, robot)| is_described(&robot.namespace));
        let described = described.map(|(id, robot)| (id, robot.namespace.clone())).collect();
        Self { receivers, described }
    }

    /// Returns true if there are no receivers.
    pub(super) fn is_unused(&self) -> bool {
        self.receivers.is_empty()
    }

    /// Gives the receivers the descriptions of new robots and removes those of deleted ones. If two robots share a
    /// namespace, the first is described.
    pub(super) fn update(&mut self, server: &Server<'_>) {
        let entities = server.simulation().entities();
        for (_, namespace) in self.described.extract_if(|id, _| entities.get(*id).is_none()) {
            self.receivers.iter().for_each(|receiver| receiver.remove(&namespace));
        }
        for (id, entity) in entities.iter() {
            if let Some(urdf) = server.description(id)
                && entity.robot.is_some()
                && !self.described.values().any(|described| *described == entity.namespace)
            {
                self.receivers.iter().for_each(|receiver| receiver.set(&entity.namespace, urdf));
                self.described.insert(id, entity.namespace.clone());
            }
        }
    }
}
