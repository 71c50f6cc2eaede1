//! `belvedere urdf`: prints a robot as one plain URDF, for ROS's parameter `robot_description`.

use super::error::CliError;
use super::follow::print_line;
use crate::description::load::{default_robot_name, expand_robot, xacro_argument};
use crate::description::models::package_path;
use crate::description::{Diagnostics, Severity};
use std::path::PathBuf;

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Print a robot as one plain URDF, as needed for the ROS parameter robot_description.
///
/// All xacro is expanded, and `<gazebo>` is kept. Meshes and textures are referenced by file:/// URIs, so that rviz
/// finds them. To see how belvedere interprets the robot, use `belvedere check`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere urdf kobuki_hexagons_kinect > robot.urdf
  belvedere urdf my_robot.urdf.xacro --package-path ~/catkin_ws/src
  in a launch file: <param name=\"robot_description\" command=\"belvedere urdf kobuki_hexagons_kinect\"/>")]
pub struct UrdfArgs {
    /// A .urdf or .xacro file, or the name of a shipped robot; not a .sdf file, which the other commands accept
    /// [default: the robot that `belvedere run` uses]
    #[arg(value_name = "FILE|NAME")]
    pub file: Option<PathBuf>,
    /// xacro arguments of the robot, for $(arg NAME)
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub xacro_args: Vec<(String, String)>,
    /// A folder of ROS packages, searched before ROS_PACKAGE_PATH and the shipped packages; may be repeated
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Description`] if the file cannot be expanded; failures of standard output.
pub fn run(args: &UrdfArgs) -> Result<(), CliError> {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = package_path(args.package_path.iter().cloned(), ros_package_path.as_deref());
    let file = args.file.clone().unwrap_or_else(|| default_robot_name().into());
    let mut diagnostics = Diagnostics::default();
    let robot = expand_robot(&file, &packages, &args.xacro_args, &mut diagnostics);
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity == Severity::Warning) {
        tracing::warn!("{problem}");
    }
    match robot {
        Some(robot) => print_line(robot.to_string().trim_end()),
        None => Err(CliError::Description(diagnostics.errors().cloned().collect())),
    }
}
