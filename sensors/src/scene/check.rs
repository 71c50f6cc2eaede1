//! Checks that untrusted slices form a valid scene.
//!
//! Each mesh, height field and texture has its own part of a slice. The parts are consecutive and fill the slice, so
//! checking them takes time proportional to their length, whatever the elements contain.

use super::fault::{Element, count};
use super::texture::{CUBE, mip_levels};
use super::tree::{Facet, TriangleBlock};
use super::validate::{validate_scratch_len, validate_tree};
use super::vertices::MAX_COORDINATE;
use super::{Form, HeightField, Kind, Mesh, MeshSlices, Scene, SceneFault, Triangles, build, limits};
use crate::Execution;
#[cfg(feature = "alloc")]
use crate::pose::Pose;
use crate::simd::WIDTH;
use bytemuck::Zeroable;

/// Checks everything except the meshes, which have been checked already.
pub(super) fn all_but_meshes(scene: &Scene<'_>) -> Result<(), SceneFault> {
    height_fields(scene)?;
    textures(scene)?;
    let air = Element::of("air", 0);
    air.accept(limits::air(&scene.air))?;
    air.accept(limits::texture_of_sky(&scene.air, |texture| scene.textures.get(texture as usize)))?;
    materials(scene)?;
    instances(scene)?;
    lights(scene)
}

/// Number of `u32` words of scratch memory for checking the meshes.
pub(super) fn scratch_len(meshes: &[Mesh]) -> usize {
    meshes.iter().map(scratch_of).max().unwrap_or(0)
}

/// Scratch words for one mesh: a position per vertex, and the scratch memory of the tree check.
fn scratch_of(mesh: &Mesh) -> usize {
    let [triangles, nodes, blocks] = [mesh.triangles, mesh.nodes, mesh.blocks].map(|count| count as usize);
    3 * mesh.vertices as usize + validate_scratch_len(triangles, nodes, blocks)
}

/// Checks that the parts of the meshes are consecutive and fill the slices.
pub(super) fn parts_of_meshes(meshes: &MeshSlices<'_>) -> Result<(), SceneFault> {
    let MeshSlices { uvs, triangles, nodes, blocks, .. } = meshes;
    let mut ends = [0; 4];
    for (index, mesh) in meshes.meshes.iter().enumerate() {
        let element = Element::of("meshes", index);
        let [of_vertices, of_triangles, of_nodes, of_blocks] = &mut ends;
        element.follows("vertices", mesh.first_vertex, mesh.vertices, of_vertices, uvs.len())?;
        element.follows("triangles", mesh.first_triangle, mesh.triangles, of_triangles, triangles.len())?;
        element.follows("nodes", mesh.first_node, mesh.nodes, of_nodes, nodes.len())?;
        element.follows("blocks", mesh.first_block, mesh.blocks, of_blocks, blocks.len())?;
    }
    count("uvs", uvs.len(), ends[0])?;
    if !meshes.normals.is_empty() {
        count("normals", meshes.normals.len(), ends[0])?;
    }
    count("triangles", triangles.len(), ends[1])?;
    count("nodes", nodes.len(), ends[2])?;
    count("blocks", blocks.len(), ends[3])?;
    count("facets", meshes.facets.len(), blocks.len().saturating_mul(WIDTH))
}

/// Checks the meshes. `scratch` must be large enough for the mesh that needs most.
pub(super) fn meshes(meshes: &MeshSlices<'_>, scratch: &mut [u32]) -> Result<(), SceneFault> {
    parts_of_meshes(meshes)?;
    count_scratch(scratch.len(), scratch_len(meshes.meshes))?;
    for (index, mesh) in meshes.meshes.iter().enumerate() {
        let triangles = part(meshes.triangles, mesh.first_triangle, mesh.triangles);
        let nodes = part(meshes.nodes, mesh.first_node, mesh.nodes);
        let blocks = part(meshes.blocks, mesh.first_block, mesh.blocks);
        let (positions, scratch) = scratch.split_at_mut(3 * mesh.vertices as usize);
        positions.fill(0);
        let positions: &mut [[f32; 3]] = bytemuck::cast_slice_mut(positions);
        take_corners(blocks, triangles, positions);
        validate_tree(positions, triangles, nodes, blocks, scratch)
            .map_err(|fault| SceneFault::Tree { mesh: index, fault })?;
        // An empty tree also has a root, whose box is empty.
        let root = &nodes[0];
        for axis in 0..3 {
            let (low, high) = (mesh.min[axis], mesh.max[axis]);
            let holds = |corner: f32| (low <= corner && corner <= high) || triangles.is_empty();
            let good = low.abs() <= MAX_COORDINATE
                && high.abs() <= MAX_COORDINATE
                && low <= high
                && root.min[axis].iter().chain(&root.max[axis]).all(|&corner| holds(corner));
            Element::of("meshes", index).require(good, "bounds", f64::from(low))?;
        }
    }
    for (index, &uv) in meshes.uvs.iter().enumerate() {
        Element::of("uvs", index).accept(limits::uv(index, uv))?;
    }
    normals(meshes)?;
    facets(meshes)
}

fn count_scratch(have: usize, need: usize) -> Result<(), SceneFault> {
    if have < need { count("scratch", have, need) } else { Ok(()) }
}

/// The part of a slice that belongs to a mesh.
fn part<T>(slice: &[T], first: u32, count: u32) -> &[T] {
    &slice[first as usize..][..count as usize]
}

/// Collects the vertex positions, which are stored only in the blocks. If two blocks disagree about a vertex, one of
/// them differs from the collected position, and the check of the tree finds that.
fn take_corners(blocks: &[TriangleBlock], triangles: &[[u32; 3]], positions: &mut [[f32; 3]]) {
    for block in blocks {
        for lane in 0..WIDTH {
            let Some(triangle) = triangles.get(block.triangle[lane] as usize) else { continue };
            for (corner, &vertex) in block.corners.iter().zip(triangle) {
                if let Some(position) = positions.get_mut(vertex as usize) {
                    *position = corner.map(|axis| axis[lane]);
                }
            }
        }
    }
}

/// Checks that the vertices of a mesh have unit normals, all or none.
fn normals(meshes: &MeshSlices<'_>) -> Result<(), SceneFault> {
    if meshes.normals.is_empty() {
        return Ok(());
    }
    for mesh in meshes.meshes {
        let own = part(meshes.normals, mesh.first_vertex, mesh.vertices);
        if own.iter().all(|normal| *normal == [0.0; 3]) {
            continue;
        }
        for (offset, &normal) in own.iter().enumerate() {
            let index = mesh.first_vertex as usize + offset;
            Element::of("normals", index).accept(limits::stored_normal(index, normal))?;
        }
    }
    Ok(())
}

/// Checks that the facets are bit for bit those computed from the blocks.
fn facets(meshes: &MeshSlices<'_>) -> Result<(), SceneFault> {
    let execution = Execution::default();
    let mut expected = [Facet::zeroed(); WIDTH];
    for (index, block) in meshes.blocks.iter().enumerate() {
        build::facets::fill_facets(core::slice::from_ref(block), execution, &mut expected);
        let held = &meshes.facets[index * WIDTH..][..WIDTH];
        for (lane, (held, expected)) in held.iter().zip(&expected).enumerate() {
            let element = Element::of("facets", index * WIDTH + lane);
            element.require(held.triangle == expected.triangle, "triangle", f64::from(held.triangle))?;
            let same = held.normal.map(f32::to_bits) == expected.normal.map(f32::to_bits);
            element.require(same, "normal", f64::from(held.normal[0]))?;
        }
    }
    Ok(())
}

fn height_fields(scene: &Scene<'_>) -> Result<(), SceneFault> {
    let [mut heights, mut extents] = [0; 2];
    for (index, field) in scene.height_fields.iter().enumerate() {
        let element = Element::of("height_fields", index);
        let [rows, columns] = [field.rows(), field.columns()];
        let of_heights = rows as usize * columns as usize;
        element.follows(
            "heights",
            field.first_height,
            of_heights as u32,
            &mut heights,
            scene.heights.len(),
        )?;
        let of_extents = HeightField::extents_len(rows, columns);
        element.follows(
            "extents",
            field.first_extent,
            of_extents as u32,
            &mut extents,
            scene.extents.len(),
        )?;
        field
            .validate(scene.heights, scene.extents)
            .map_err(|error| SceneFault::HeightField { element: index, error })?;
    }
    count("heights", scene.heights.len(), heights)?;
    count("extents", scene.extents.len(), extents)
}

fn textures(scene: &Scene<'_>) -> Result<(), SceneFault> {
    let mut end = 0;
    for (index, texture) in scene.textures.iter().enumerate() {
        let element = Element::of("textures", index);
        let (width, height) = (texture.width, texture.height);
        element.require(width > 0, "width", f64::from(width))?;
        // The finest level alone must fit, so that no count of all levels overflows.
        let faces = if texture.is_cube() { 6 } else { 1 };
        let texels = u128::from(width) * u128::from(height) * faces;
        let fits = texels <= scene.texels.len() as u128;
        element.require(height > 0 && fits, "height", f64::from(height))?;
        element.require(texture.levels == mip_levels(width, height), "levels", f64::from(texture.levels))?;
        element.require(texture.kind <= CUBE, "kind", f64::from(texture.kind))?;
        element.require(!texture.is_cube() || width == height, "height of a cube", f64::from(height))?;
        let of_texels = texture.texels();
        element.follows("texels", texture.first_texel, of_texels as u32, &mut end, scene.texels.len())?;
    }
    count("texels", scene.texels.len(), end)
}

fn materials(scene: &Scene<'_>) -> Result<(), SceneFault> {
    for (index, material) in scene.materials.iter().enumerate() {
        let element = Element::of("materials", index);
        element.accept(limits::textures_of(material, |texture| scene.textures.get(texture as usize)))?;
        element.accept(limits::material(material))?;
    }
    Ok(())
}

fn instances(scene: &Scene<'_>) -> Result<(), SceneFault> {
    let mut slots = 0_u64;
    for (index, instance) in scene.instances.iter().enumerate() {
        let element = Element::of("instances", index);
        let known = Kind::from_number(instance.kind).is_some();
        element.require(known, "kind", f64::from(instance.kind))?;
        element.index("material", instance.material, scene.materials.len())?;
        match instance.kind() {
            Kind::Triangles(Triangles::Mesh) => element.index("mesh", instance.mesh, scene.meshes.len())?,
            Kind::Triangles(Triangles::HeightField) => {
                element.index("height field", instance.mesh, scene.height_fields.len())?;
            }
            Kind::Solid(_) => {}
        }
        element.accept(limits::instance(instance.size, instance.scale))?;
        // Invisible instances get no slots.
        slots += if instance.visibility == 0 { 0 } else { u64::from(scene.slots(instance)) };
        if slots >= 1 << 31 {
            return Err(SceneFault::TooManyTriangles);
        }
    }
    Ok(())
}

#[cfg(feature = "alloc")]
pub(super) fn poses(scene: &Scene<'_>, poses: &[Pose]) -> Result<(), SceneFault> {
    count("poses", poses.len(), scene.instances.len())?;
    for (index, pose) in poses.iter().enumerate() {
        Element::of("poses", index).accept(limits::pose(pose))?;
    }
    Ok(())
}

fn lights(scene: &Scene<'_>) -> Result<(), SceneFault> {
    for (index, light) in scene.lights.iter().enumerate() {
        let element = Element::of("lights", index);
        element.require(Form::from_number(light.form).is_some(), "kind", f64::from(light.form))?;
        element.accept(limits::light(light))?;
    }
    Ok(())
}
