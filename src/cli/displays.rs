//! [`Displays`]: what `belvedere run` shows of itself in the terminal, on the page and in ROS 2.

use super::isolated::Isolated;
use super::robot_descriptions::{DescriptionReceiver, RobotDescriptions};
use super::ros2::Ros2Thread;
use super::shown_scene::ShownScene;
use super::status::Status;
use crate::server::Server;
use crate::view::ViewServer;

/// The displays of the run, which do not influence it.
pub(super) struct Displays<'a> {
    status: Isolated<Status>,
    scene: Isolated<ShownScene<'a>>,
}

impl<'a> Displays<'a> {
    pub(super) fn new(
        server: &Server<'_>,
        page: Option<&'a ViewServer>,
        ros2: Option<&'a Ros2Thread>,
        described: &[(String, String)],
    ) -> Self {
        let ros2 = ros2.map(|ros2| ros2 as &dyn DescriptionReceiver);
        let receivers = page.map(|page| page as &dyn DescriptionReceiver).into_iter().chain(ros2);
        let scene = || {
            let simulation = server.simulation();
            let descriptions = RobotDescriptions::new(receivers.collect(), described, simulation);
            ShownScene::new(page, descriptions, simulation)
        };
        Self {
            status: Isolated::new("the table of streams", || Status::new(server.rig())),
            scene: Isolated::new("the models of the page and of ROS 2", scene),
        }
    }

    pub(super) fn refresh(&mut self, server: &Server<'_>) {
        self.status.show(|status| status.refresh(server.rig(), server.simulated_ns()));
        self.scene.show(|scene| scene.refresh(server));
    }

    /// Hides the table, so that other text can be printed.
    pub(super) fn hide(&mut self) {
        self.status.show(Status::hide);
    }

    /// Ends the displays and returns the table of the whole run.
    pub(super) fn end(self, server: &Server<'_>) -> Option<String> {
        self.status.end(|status| status.finish(server.rig(), server.simulated_ns()))
    }
}
