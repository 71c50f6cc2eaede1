//! Prints where each link of robots, worlds and models is before the simulation begins: its name, its position, and its
//! rotation as a quaternion x y z w. For models of SDF also `MODEL>LINK`, the canonical link, and
//! `MODEL::JOINT[PARENT>CHILD]`, the position of a joint and a quarter turn about its axis. `WARNED` or `REFUSED` is printed
//! with the first warning or error. An argument is a file, or the name of one of Belvedere's own robots or worlds. With
//! `--run SECONDS`, worlds are then simulated, and the poses of the links are printed again 100 times a second.
//!
//! `cargo run --example link_poses -- playground`

use belvedere::description::load::{Described, LoadOptions, load};
use belvedere::description::model::{Model, World};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules, Severity};
use belvedere::sensors::Pose;
use belvedere::world::physics::Physics;
use glam::DQuat;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::process::ExitCode;

/// The time between two poses, nanoseconds.
const EVERY_NS: u64 = 10_000_000;

fn print(model: &Model, link: &str, at: &Pose) {
    let ([x, y, z], [i, j, k, w]) = (at.translation().to_array(), at.rotation().to_array());
    println!("{}::{link} {x} {y} {z} {i} {j} {k} {w}", model.name);
}

/// The link that stands for the world, for joints whose parent is the world.
fn is_world(link: &str) -> bool {
    link == "world" || link.ends_with("::world")
}

fn print_all(model: &Model) {
    for link in model.links.iter().filter(|link| !is_world(&link.name)) {
        print(model, &link.name, &(model.world_from_model * link.model_from_link));
    }
}

/// Prints the canonical link and the joints.
fn print_joints(model: &Model) {
    let name = &model.name;
    println!("{name}>{} 0 0 0 0 0 0 1", model.links[model.canonical_link].name);
    for joint in &model.joints {
        let [parent, child] = [joint.parent, joint.child].map(|link| &model.links[link]);
        let before = if is_world(&parent.name) { String::new() } else { format!("{name}::") };
        let parent_name = if is_world(&parent.name) { "world" } else { &parent.name };
        let at = model.world_from_model * child.model_from_link;
        let turn = DQuat::from_axis_angle(at.transform_vector(joint.axis).normalize(), FRAC_PI_2);
        let joint_at = Pose::new(at.transform_point(joint.pivot), turn);
        print(model, &format!("{}[{before}{parent_name}>{name}::{}]", joint.name, child.name), &joint_at);
    }
}

fn run(world: &World, seconds: f64) -> Result<(), String> {
    let mut physics = Physics::new(world).map_err(|problem| problem.to_string())?;
    for frame in 1..=(seconds * 1e9) as u64 / EVERY_NS {
        while physics.time_ns() < frame * EVERY_NS {
            physics.step();
        }
        println!("TIME {}", frame as f64 * EVERY_NS as f64 / 1e9);
        for (at, model) in world.models.iter().enumerate() {
            for (number, link) in model.links.iter().enumerate() {
                print(model, &link.name, &physics.world_from_link_at(at, number, frame * EVERY_NS));
            }
        }
    }
    Ok(())
}

fn show(file: &str, options: &LoadOptions, seconds: Option<f64>) -> Result<(), String> {
    println!("FILE {file}");
    let mut diagnostics = Diagnostics::default();
    let described = load(file, options, &mut diagnostics);
    let errors: Vec<String> = diagnostics.errors().map(ToString::to_string).collect();
    if let Some(first) = errors.first() {
        println!("REFUSED {}", first.replace('\n', " "));
        return Err(errors.join("\n"));
    }
    let warning = diagnostics.problems().iter().find(|problem| problem.severity == Severity::Warning);
    if let (Some(warning), None) = (warning, seconds) {
        println!("WARNED {}", warning.to_string().replace('\n', " "));
    }
    match (described, seconds) {
        (Some(Described::World(world)), None) => {
            world.models.iter().for_each(print_all);
            world.models.iter().for_each(print_joints);
        }
        (Some(Described::World(world)), Some(seconds)) => run(&world, seconds)?,
        (Some(Described::Model(model)), _) => {
            print_all(&model);
            if Path::new(file).extension().is_none_or(|extension| extension != "urdf") {
                print_joints(&model);
            }
        }
        (None, _) => {}
    }
    Ok(())
}

fn main() -> ExitCode {
    let packages = package_path([], std::env::var_os("ROS_PACKAGE_PATH").as_deref());
    let options = LoadOptions { packages, rules: Rules::default(), xacro_args: Vec::new() };
    let mut arguments = std::env::args().skip(1);
    let (mut seconds, mut code) = (None, ExitCode::SUCCESS);
    while let Some(argument) = arguments.next() {
        if argument == "--run" {
            seconds = arguments.next().and_then(|seconds| seconds.parse().ok());
        } else if let Err(what) = show(&argument, &options, seconds) {
            eprintln!("{what}");
            code = ExitCode::FAILURE;
        }
    }
    code
}
