//! The files of a run that are stored in its recording.

use crate::description::load::expand_robot;
use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use crate::description::{Diagnostics, Source};
use crate::recording::Attachment;
use crate::simulation::SpawnOptions;
use std::path::Path;

/// Returns the world's file, and each robot as one plain URDF, because a robot's own file lacks what xacro and ROS
/// packages added.
pub(super) fn attachments(
    world: &World,
    robots: &[(Model, SpawnOptions)],
    packages: &PackagePath,
    xacro_args: &[(String, String)],
) -> Vec<Attachment> {
    let robots = robots.iter().filter_map(|(model, _)| robot_file(model, packages, xacro_args));
    file(&world.source).into_iter().chain(robots).collect()
}

fn robot_file(model: &Model, packages: &PackagePath, xacro_args: &[(String, String)]) -> Option<Attachment> {
    let path: &Path = &model.source.file;
    if path.extension().is_some_and(|extension| extension == "sdf") {
        return file(&model.source);
    }
    let urdf = robot_urdf(model, packages, xacro_args)?;
    Some(xml(format!("{}.urdf", model.name), urdf.into_bytes()))
}

/// Returns a robot as one plain URDF, or `None` for an SDF file.
pub(super) fn robot_urdf(
    model: &Model,
    packages: &PackagePath,
    xacro_args: &[(String, String)],
) -> Option<String> {
    let path: &Path = &model.source.file;
    if path.extension().is_some_and(|extension| extension == "sdf") {
        return None;
    }
    // Problems were already reported when the robot was loaded.
    let robot = expand_robot(path, packages, xacro_args, &mut Diagnostics::default())?;
    Some(robot.to_string())
}

/// Returns a file unchanged, or `None` if the source is not a file, such as the empty world.
fn file(source: &Source) -> Option<Attachment> {
    let name = source.file.file_name()?.to_string_lossy();
    Some(xml(name.into_owned(), std::fs::read(&source.file).ok()?))
}

fn xml(name: String, data: Vec<u8>) -> Attachment {
    Attachment { name, media_type: "application/xml".into(), data }
}
