//! Prints the bounds, the area and the number of triangles of mesh files, and casts rays at them.
//!
//! `cargo run --example mesh_rays -- FILE RAYS…`
//!
//! RAYS has six little-endian `f32` for each ray: its origin and its direction, in the coordinates of the file. The
//! distances to the first hits, in lengths of the directions and infinite without a hit, are written as `f32` into a file
//! whose name is that of RAYS with `.out` behind it.

use belvedere::description::mesh::{UpAxis, load_mesh};
use belvedere::description::model::Mesh;
use belvedere::description::{Diagnostics, Source};
use belvedere::sensors::Execution;
use belvedere::sensors::scene::build::{Quality, Tree};
use belvedere::sensors::simd::best_level;
use belvedere::sensors::trace::rays::{MeshTree, Rays, cast_mesh};
use belvedere::sensors::trace::{Faces, Hits};
use glam::{DVec3, Vec3};
use std::path::Path;
use std::process::ExitCode;

fn print(mesh: &Mesh) {
    let corners =
        || mesh.triangles.iter().flatten().map(|corner| Vec3::from(mesh.positions[*corner as usize]));
    let (low, high) =
        (corners().fold(Vec3::INFINITY, Vec3::min), corners().fold(Vec3::NEG_INFINITY, Vec3::max));
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|corner| Vec3::from(mesh.positions[corner as usize]).as_dvec3());
            (b - a).cross(c - a).length() / 2.0
        })
        .sum();
    let bounds: Vec<String> = [low, high].iter().flat_map(Vec3::to_array).map(|v| v.to_string()).collect();
    println!("{} {area} {}", bounds.join(" "), mesh.triangles.len());
}

fn cast(mesh: &Mesh, rays: &[u8]) -> Result<Vec<u8>, String> {
    let numbers: Vec<f32> = rays.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let (origins, directions): (Vec<_>, Vec<_>) =
        numbers.as_chunks().0.iter().map(|&[a, b, c, x, y, z]| ([a, b, c], [x, y, z])).unzip();
    let tree = Tree::build(&mesh.positions, &mesh.triangles, Quality::High, Execution::default())
        .map_err(|error| format!("{error:?}"))?;
    let mut distance = vec![0.0; origins.len()];
    cast_mesh(
        best_level(),
        MeshTree { nodes: &tree.nodes, blocks: &tree.blocks },
        &Rays { origins: &origins, directions: &directions, ranges: None },
        Faces::Both,
        &mut Hits { distance: Some(&mut distance), ..Hits::default() },
    )
    .map_err(|error| error.to_string())?;
    Ok(distance.iter().flat_map(|distance| distance.to_le_bytes()).collect())
}

fn show(file: &str, rays: &str) -> Result<(), String> {
    let mut diagnostics = Diagnostics::default();
    let path = Path::new(file);
    let mesh = load_mesh(path, DVec3::ONE, UpAxis::Ignored, &Source::new(path, 0), &mut diagnostics);
    let problems: Vec<String> = diagnostics.problems().iter().map(ToString::to_string).collect();
    let mesh = mesh.ok_or_else(|| problems.join("\n"))?;
    print(&mesh);
    let distances = cast(&mesh, &std::fs::read(rays).map_err(|error| format!("{rays}: {error}"))?)?;
    std::fs::write(format!("{rays}.out"), distances).map_err(|error| format!("{rays}.out: {error}"))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut code = ExitCode::SUCCESS;
    for [file, rays] in arguments.as_chunks().0 {
        if let Err(what) = show(file, rays) {
            println!("REFUSED {}", what.replace('\n', " "));
            code = ExitCode::FAILURE;
        }
    }
    code
}
