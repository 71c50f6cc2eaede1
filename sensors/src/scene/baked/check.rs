//! Whether the sections of a baked scene are a scene.

use super::BakedError;
use crate::scene::build::fill_facets;
use crate::scene::limits::{self, Refusal};
use crate::scene::texture::{mip_levels, mip_texels};
use crate::scene::tree::{Facet, TriangleBlock};
use crate::scene::vertices::MAX_COORDINATE;
use crate::scene::{
    Form, HeightField, Kind, Mesh, NO_TEXTURE, Scene, Triangles, validate_scratch_len, validate_tree,
};
use crate::simd::WIDTH;
use crate::{Execution, Pose};
use alloc::vec::Vec;
use bytemuck::Zeroable;

/// All checks.
pub(super) fn scene(scene: &Scene<'_>, world_from_instance: &[Pose]) -> Result<(), BakedError> {
    count("facets", scene.facets.len(), scene.blocks.len().saturating_mul(WIDTH))?;
    meshes(scene)?;
    facets(scene)?;
    height_fields(scene)?;
    textures(scene)?;
    materials(scene)?;
    instances(scene)?;
    poses(scene, world_from_instance)?;
    lights(scene)
}

fn count(section: &'static str, have: usize, need: usize) -> Result<(), BakedError> {
    if have == need {
        Ok(())
    } else {
        Err(BakedError::Count { section, have: have as u64, need: need as u64 })
    }
}

/// Names an element of a section in its errors.
#[derive(Clone, Copy)]
struct Element {
    section: &'static str,
    element: usize,
}

impl Element {
    fn of(section: &'static str, element: usize) -> Self {
        Self { section, element }
    }

    fn require(self, holds: bool, field: &'static str, value: f64) -> Result<(), BakedError> {
        let Self { section, element } = self;
        if holds { Ok(()) } else { Err(BakedError::Value { section, element, field, value }) }
    }

    /// The checks that a builder makes too.
    fn accept(self, checked: Result<(), Refusal>) -> Result<(), BakedError> {
        checked.or_else(|Refusal { field, value, .. }| self.require(false, field, value))
    }

    /// An index below a number of elements.
    fn index(self, field: &'static str, index: u32, count: usize) -> Result<(), BakedError> {
        self.require((index as usize) < count, field, f64::from(index))
    }

    /// The range of a section that follows the last one's.
    fn follows(
        self,
        field: &'static str,
        first: u32,
        count: usize,
        end: &mut usize,
        length: usize,
    ) -> Result<(), BakedError> {
        self.require(first as usize == *end && count <= length - *end, field, f64::from(first))?;
        *end += count;
        Ok(())
    }
}

/// Meshes lie one after the other, so that checking them takes time in proportion to the bytes.
fn meshes(scene: &Scene<'_>) -> Result<(), BakedError> {
    let [mut vertices, mut triangles, mut nodes, mut blocks] = [0; 4];
    let (mut scratch, mut positions) = (Vec::new(), Vec::new());
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let element = Element::of("meshes", index);
        let Mesh { first_vertex, first_triangle, first_node, first_block, min, max, .. } = *mesh;
        let [of_vertices, of_triangles, of_nodes, of_blocks] =
            [mesh.vertices, mesh.triangles, mesh.nodes, mesh.blocks].map(|count| count as usize);
        let (triangle, node, block) = (triangles, nodes, blocks);
        element.follows("vertices", first_vertex, of_vertices, &mut vertices, scene.uvs.len())?;
        element.follows("triangles", first_triangle, of_triangles, &mut triangles, scene.triangles.len())?;
        element.follows("nodes", first_node, of_nodes, &mut nodes, scene.nodes.len())?;
        element.follows("blocks", first_block, of_blocks, &mut blocks, scene.blocks.len())?;
        scratch.resize(validate_scratch_len(of_triangles, of_nodes, of_blocks), 0);
        let nodes_of_mesh = &scene.nodes[node..nodes];
        let (triangles_of_mesh, blocks_of_mesh) =
            (&scene.triangles[triangle..triangles], &scene.blocks[block..blocks]);
        positions.clear();
        positions.resize(of_vertices, [0.0; 3]);
        take_corners(blocks_of_mesh, triangles_of_mesh, &mut positions);
        validate_tree(&positions, triangles_of_mesh, nodes_of_mesh, blocks_of_mesh, &mut scratch)
            .map_err(|fault| BakedError::Tree { mesh: index, fault })?;
        // An empty tree has a root too, whose boxes hold nothing.
        let root = &nodes_of_mesh[0];
        for axis in 0..3 {
            let (low, high) = (min[axis], max[axis]);
            let empty = of_triangles == 0;
            let holds = |corner: f32| (low <= corner && corner <= high) || empty;
            let good = low.abs() <= MAX_COORDINATE
                && high.abs() <= MAX_COORDINATE
                && low <= high
                && root.min[axis].iter().chain(&root.max[axis]).all(|&corner| holds(corner));
            element.require(good, "bounds", f64::from(low))?;
        }
    }
    count("uvs", scene.uvs.len(), vertices)?;
    count("triangles", scene.triangles.len(), triangles)?;
    count("nodes", scene.nodes.len(), nodes)?;
    count("blocks", scene.blocks.len(), blocks)?;
    scene
        .uvs
        .iter()
        .enumerate()
        .try_for_each(|(index, &uv)| Element::of("uvs", index).accept(limits::uv(index, uv)))
}

/// Positions of vertices, which lie nowhere but in the blocks: where two of these disagree, one of them is not
/// bit for bit the position any more, which the check of the tree finds.
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

/// Facets follow from blocks, to the last bit.
fn facets(scene: &Scene<'_>) -> Result<(), BakedError> {
    let execution = Execution::default();
    let mut expected = [Facet::zeroed(); WIDTH];
    for (index, block) in scene.blocks.iter().enumerate() {
        fill_facets(core::slice::from_ref(block), execution, &mut expected);
        let held = &scene.facets[index * WIDTH..][..WIDTH];
        for (lane, (held, expected)) in held.iter().zip(&expected).enumerate() {
            let element = Element::of("facets", index * WIDTH + lane);
            element.require(held.triangle == expected.triangle, "triangle", f64::from(held.triangle))?;
            let same = held.normal.map(f32::to_bits) == expected.normal.map(f32::to_bits);
            element.require(same, "normal", f64::from(held.normal[0]))?;
        }
    }
    Ok(())
}

fn height_fields(scene: &Scene<'_>) -> Result<(), BakedError> {
    let [mut heights, mut extents] = [0; 2];
    for (index, field) in scene.height_fields.iter().enumerate() {
        let element = Element::of("height_fields", index);
        let [rows, columns] = [field.rows(), field.columns()];
        let of_heights = rows as usize * columns as usize;
        element.follows("heights", field.first_height, of_heights, &mut heights, scene.heights.len())?;
        let of_extents = HeightField::extents_len(rows, columns);
        element.follows("extents", field.first_extent, of_extents, &mut extents, scene.extents.len())?;
        field
            .validate(scene.heights, scene.extents)
            .map_err(|error| BakedError::HeightField { element: index, error })?;
    }
    count("heights", scene.heights.len(), heights)?;
    count("extents", scene.extents.len(), extents)
}

fn textures(scene: &Scene<'_>) -> Result<(), BakedError> {
    let mut texels = 0;
    for (index, texture) in scene.textures.iter().enumerate() {
        let element = Element::of("textures", index);
        let (width, height) = (texture.width, texture.height);
        element.require(width > 0, "width", f64::from(width))?;
        // The finest level alone must fit, so that no count of all levels overflows.
        let fits = u64::from(width) * u64::from(height) <= scene.texels.len() as u64;
        element.require(height > 0 && fits, "height", f64::from(height))?;
        element.require(texture.levels == mip_levels(width, height), "levels", f64::from(texture.levels))?;
        let of_texels = mip_texels(width, height);
        element.follows("texels", texture.first_texel, of_texels, &mut texels, scene.texels.len())?;
    }
    count("texels", scene.texels.len(), texels)
}

fn materials(scene: &Scene<'_>) -> Result<(), BakedError> {
    for (index, material) in scene.materials.iter().enumerate() {
        let element = Element::of("materials", index);
        if material.texture != NO_TEXTURE {
            element.index("texture", material.texture, scene.textures.len())?;
        }
        element.accept(limits::material(material))?;
    }
    Ok(())
}

fn instances(scene: &Scene<'_>) -> Result<(), BakedError> {
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
        // What nobody sees is given none.
        slots += if instance.visibility == 0 { 0 } else { u64::from(scene.slots(instance)) };
        if slots >= 1 << 31 {
            return Err(BakedError::TooManyTriangles);
        }
    }
    Ok(())
}

fn poses(scene: &Scene<'_>, poses: &[Pose]) -> Result<(), BakedError> {
    count("poses", poses.len(), scene.instances.len())?;
    for (index, pose) in poses.iter().enumerate() {
        Element::of("poses", index).accept(limits::pose(pose))?;
    }
    Ok(())
}

fn lights(scene: &Scene<'_>) -> Result<(), BakedError> {
    for (index, light) in scene.lights.iter().enumerate() {
        let element = Element::of("lights", index);
        element.require(Form::from_number(light.form).is_some(), "kind", f64::from(light.form))?;
        element.accept(limits::light(light))?;
    }
    Ok(())
}
