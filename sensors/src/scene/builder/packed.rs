//! A builder's scene without gaps, as it is written to a file.

use super::SceneBuilder;
use crate::scene::texture::COLOURS;
use crate::scene::tree::{Facet, NONE, TriangleBlock, WideNode};
use crate::scene::{HeightField, Mesh, Scene, Texture};
use crate::simd::WIDTH;
use alloc::vec::Vec;
use bytemuck::{Pod, Zeroable};

/// The contents of the pools without gaps, in the order of the tables. Where something was removed, there is the
/// smallest valid element: a mesh without triangles, a flat square, a single texel.
#[derive(Default)]
pub(in crate::scene) struct Packed {
    meshes: Vec<Mesh>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    nodes: Vec<WideNode>,
    blocks: Vec<TriangleBlock>,
    facets: Vec<Facet>,
    height_fields: Vec<HeightField>,
    heights: Vec<f32>,
    extents: Vec<[f32; 2]>,
    textures: Vec<Texture>,
    texels: Vec<[u8; 4]>,
}

/// Appends a range to a vector, and returns the index at which it starts there.
fn append<T: Pod>(to: &mut Vec<T>, from: &[T], first: u32, count: usize) -> u32 {
    let start = to.len() as u32;
    to.extend_from_slice(&from[first as usize..][..count]);
    start
}

impl Packed {
    pub(in crate::scene) fn new(builder: &SceneBuilder) -> Self {
        let mut packed = Self::default();
        let scene = builder.scene();
        for mesh in scene.meshes {
            packed.add_mesh(&scene, mesh);
        }
        for field in scene.height_fields {
            packed.add_height_field(&scene, field);
        }
        for texture in scene.textures {
            packed.add_texture(&scene, texture);
        }
        packed
    }

    fn add_mesh(&mut self, scene: &Scene<'_>, mesh: &Mesh) {
        let mut placed = Mesh {
            first_vertex: append(&mut self.uvs, scene.uvs, mesh.first_vertex, mesh.vertices as usize),
            first_triangle: append(
                &mut self.triangles,
                scene.triangles,
                mesh.first_triangle,
                mesh.triangles as usize,
            ),
            first_node: append(&mut self.nodes, scene.nodes, mesh.first_node, mesh.nodes as usize),
            first_block: append(&mut self.blocks, scene.blocks, mesh.first_block, mesh.blocks as usize),
            ..*mesh
        };
        if !scene.normals.is_empty() {
            append(&mut self.normals, scene.normals, mesh.first_vertex, mesh.vertices as usize);
        }
        let facets = &scene.facets[mesh.first_block as usize * WIDTH..][..mesh.blocks as usize * WIDTH];
        self.facets.extend_from_slice(facets);
        if mesh.nodes == 0 {
            self.nodes.push(WideNode { child: [NONE; WIDTH], ..WideNode::zeroed() });
            placed.nodes = 1;
        }
        self.meshes.push(placed);
    }

    fn add_height_field(&mut self, scene: &Scene<'_>, field: &HeightField) {
        let [rows, columns] = [field.rows(), field.columns()];
        if rows == 0 {
            let mut extents = [[0.0; 2]; HeightField::extents_len(2, 2)];
            let Ok(mut flat) = HeightField::build(2, 2, [1.0; 2], &[0.0; 4], &mut extents) else { return };
            flat.first_height = append(&mut self.heights, &[0.0; 4], 0, 4);
            flat.first_extent = append(&mut self.extents, &extents, 0, extents.len());
            self.height_fields.push(flat);
            return;
        }
        let heights = rows as usize * columns as usize;
        let extents = HeightField::extents_len(rows, columns);
        let mut placed = *field;
        placed.first_height = append(&mut self.heights, scene.heights, field.first_height, heights);
        placed.first_extent = append(&mut self.extents, scene.extents, field.first_extent, extents);
        self.height_fields.push(placed);
    }

    fn add_texture(&mut self, scene: &Scene<'_>, texture: &Texture) {
        if texture.width == 0 {
            let first_texel = append(&mut self.texels, &[[0; 4]], 0, 1);
            self.textures.push(Texture { first_texel, width: 1, height: 1, levels: 1, kind: COLOURS });
            return;
        }
        let count = texture.texels();
        let first_texel = append(&mut self.texels, scene.texels, texture.first_texel, count);
        self.textures.push(Texture { first_texel, ..*texture });
    }

    /// The builder's scene with its data taken from here.
    pub(in crate::scene) fn scene<'a>(&'a self, builder: &'a SceneBuilder) -> Scene<'a> {
        Scene {
            meshes: &self.meshes,
            uvs: &self.uvs,
            normals: &self.normals,
            triangles: &self.triangles,
            nodes: &self.nodes,
            blocks: &self.blocks,
            facets: &self.facets,
            height_fields: &self.height_fields,
            heights: &self.heights,
            extents: &self.extents,
            textures: &self.textures,
            texels: &self.texels,
            ..builder.scene()
        }
    }
}
