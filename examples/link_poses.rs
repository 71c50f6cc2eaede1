//! Prints where each link of robots, worlds and models is before the simulation begins: its name, its position, and its
//! rotation as a quaternion x y z w. An argument is a file, or the name of one of Belvedere's own robots or worlds. With
//! `--run SECONDS`, worlds are then simulated, and the poses are printed again 100 times a second.
//!
//! `cargo run --example link_poses -- playground`

use belvedere::description::load::{Described, LoadOptions, load};
use belvedere::description::model::{Model, World};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere::sensors::Pose;
use belvedere::world::physics::Physics;
use std::process::ExitCode;

/// The time between two poses, nanoseconds.
const EVERY_NS: u64 = 10_000_000;

fn print(model: &Model, link: &str, at: &Pose) {
    let ([x, y, z], [i, j, k, w]) = (at.translation().to_array(), at.rotation().to_array());
    println!("{}::{link} {x} {y} {z} {i} {j} {k} {w}", model.name);
}

fn print_all(model: &Model) {
    for link in &model.links {
        print(model, &link.name, &(model.world_from_model * link.model_from_link));
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
    if !errors.is_empty() {
        return Err(errors.join("\n"));
    }
    match (described, seconds) {
        (Some(Described::World(world)), None) => world.models.iter().for_each(print_all),
        (Some(Described::World(world)), Some(seconds)) => run(&world, seconds)?,
        (Some(Described::Model(model)), _) => print_all(&model),
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
