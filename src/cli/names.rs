//! `belvedere robots` and `belvedere worlds`: the names that `--robot` and `--world` accept.

use super::error::CliError;
use super::follow::print_line;
use crate::description::load::{robot_names, world_names};
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use std::path::PathBuf;

/// The folders in which names are searched.
#[derive(Clone, Debug, clap::Args)]
pub struct NamesArgs {
    /// A folder of ROS packages, searched before `ROS_PACKAGE_PATH` and Belvedere's own; may be repeated
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
}

impl NamesArgs {
    fn print(&self, names: impl Fn(&PackagePath) -> Vec<String>) -> Result<(), CliError> {
        let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
        let packages = package_path(self.package_path.iter().cloned(), ros_package_path.as_deref());
        names(&packages).iter().try_for_each(|name| print_line(name))
    }
}

/// Prints the names of robots, one per line.
///
/// # Errors
/// Failures of standard output.
pub fn robots(args: &NamesArgs) -> Result<(), CliError> {
    args.print(robot_names)
}

/// Prints the names of worlds, one per line.
///
/// # Errors
/// Failures of standard output.
pub fn worlds(args: &NamesArgs) -> Result<(), CliError> {
    args.print(world_names)
}
