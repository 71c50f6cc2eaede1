//! Meshes and height fields of a builder.

use super::{SceneBuilder, room, unused};
use crate::execution::Execution;
use crate::scene::build::owned::Tree;
use crate::scene::build::quality::Quality;
use crate::scene::meshes::store_normals;
use crate::scene::tree::Facet;
use crate::scene::{HeightField, HeightFieldId, Kind, Mesh, MeshId, SceneError, Triangles, limits};
use crate::simd::WIDTH;
use alloc::vec;
use bytemuck::Zeroable;

/// Slots are counted in 32 bits, sixteen per block.
const BLOCK_BITS: u32 = 32 - WIDTH.ilog2();

impl SceneBuilder {
    /// Adds a mesh of triangles, counter-clockwise seen from outside, and builds its tree. `uvs` holds one texture
    /// coordinate per vertex, or is empty.
    ///
    /// # Errors
    /// [`SceneError::BadVertex`], [`SceneError::VertexTooFar`], [`SceneError::BadTriangle`] with the index of the
    /// element, [`SceneError::TooMany`] if 32 bits cannot count the elements, [`SceneError::UvCount`],
    /// [`SceneError::BadUv`].
    pub fn add_mesh(
        &mut self,
        positions: &[[f32; 3]],
        uvs: &[[f32; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<MeshId, SceneError> {
        room(&self.meshes)?;
        let tree = checked_tree(positions, uvs, triangles)?;
        let mesh = self.store_mesh(&tree, positions.len(), uvs, triangles)?;
        Ok(MeshId(self.meshes.add(mesh)))
    }

    /// Replaces a mesh. All its instances show the new one, which has no
    /// [normals](Self::set_mesh_normals).
    ///
    /// # Errors
    /// [`SceneError::NoSuchMesh`], [`SceneError::TooMany`] and those of [`SceneBuilder::add_mesh`]; the old mesh is
    /// then kept.
    pub fn set_mesh(
        &mut self,
        mesh: MeshId,
        positions: &[[f32; 3]],
        uvs: &[[f32; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<(), SceneError> {
        let old = *self.meshes.get(mesh.0).ok_or(SceneError::NoSuchMesh(mesh.0))?;
        let tree = checked_tree(positions, uvs, triangles)?;
        let uses = self.meshes.uses(mesh.0).unwrap_or(0);
        let slots = self.slots_with(uses, old.blocks, tree.blocks.len())?;
        let new = self.store_mesh(&tree, positions.len(), uvs, triangles)?;
        self.release_mesh(&old);
        self.slots = slots;
        if let Some(place) = self.meshes.get_mut(mesh.0) {
            *place = new;
        }
        Ok(())
    }

    /// Sets the normals of the vertices of a mesh, of any length but 0. Where light falls on the mesh, normals are
    /// interpolated between them, so that it looks round; its shape, and with it distances, shadows and the truth about
    /// normals, remains that of the triangles. With an empty slice, the mesh becomes flat again, as it is when it is
    /// added or [replaced](Self::set_mesh).
    ///
    /// ```
    /// use belvedere_sensors::scene::*;
    /// let mut builder = SceneBuilder::new();
    /// let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let mesh = builder.add_mesh(&corners, &[], &[[0, 1, 2]])?;
    /// // An eighth of a ball around the origin.
    /// builder.set_mesh_normals(mesh, &corners)?;
    /// assert_eq!(builder.set_mesh_normals(mesh, &[[0.0; 3]; 3]), Err(SceneError::BadNormal(0)));
    /// # Ok::<(), SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::NoSuchMesh`]; [`SceneError::NormalCount`] if the number of normals is neither 0 nor that of the
    /// vertices; [`SceneError::BadNormal`]. The mesh then keeps the normals that it had.
    pub fn set_mesh_normals(&mut self, mesh: MeshId, normals: &[[f32; 3]]) -> Result<(), SceneError> {
        let of = *self.meshes.get(mesh.0).ok_or(SceneError::NoSuchMesh(mesh.0))?;
        limits::normals(normals, of.vertices as usize)?;
        if !normals.is_empty() {
            self.normals.resize(self.uvs.items().len(), [0.0; 3]);
        }
        self.write_normals(&of, normals);
        Ok(())
    }

    /// Stores the normals of a mesh if there is memory for normals.
    fn write_normals(&mut self, of: &Mesh, normals: &[[f32; 3]]) {
        if !self.normals.is_empty() {
            let own = &mut self.normals[of.first_vertex as usize..][..of.vertices as usize];
            store_normals(normals, own);
        }
    }

    /// Removes a mesh.
    ///
    /// # Errors
    /// [`SceneError::NoSuchMesh`], [`SceneError::InUse`] by an instance.
    pub fn remove_mesh(&mut self, mesh: MeshId) -> Result<(), SceneError> {
        let old = unused(&self.meshes, mesh.0, SceneError::NoSuchMesh(mesh.0), || {
            self.used_by_instance(|instance| {
                instance.kind() == Kind::Triangles(Triangles::Mesh) && instance.mesh == mesh.0
            })
        })?;
        self.release_mesh(&old);
        self.meshes.remove(mesh.0, Mesh::zeroed());
        Ok(())
    }

    fn store_mesh(
        &mut self,
        tree: &Tree,
        vertices: usize,
        uvs: &[[f32; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<Mesh, SceneError> {
        let first_vertex = self.uvs.place(vertices, 32)?;
        let first_triangle = self.triangles.place(triangles.len(), 32)?;
        let first_node = self.nodes.place(tree.nodes.len(), 32)?;
        let first_block = self.blocks.place(tree.blocks.len(), BLOCK_BITS)?;
        if uvs.is_empty() {
            self.uvs.put(first_vertex, &vec![[0.0; 2]; vertices]);
        } else {
            self.uvs.put(first_vertex, uvs);
        }
        self.triangles.put(first_triangle, triangles);
        self.nodes.put(first_node, &tree.nodes);
        self.blocks.put(first_block, &tree.blocks);
        self.facets.resize(self.blocks.items().len() * WIDTH, Facet::zeroed());
        self.facets[first_block * WIDTH..][..tree.blocks.len() * WIDTH].copy_from_slice(&tree.facets());
        let [min, max] = tree.nodes[0].bounds();
        let mesh = Mesh {
            first_vertex: first_vertex as u32,
            vertices: vertices as u32,
            first_triangle: first_triangle as u32,
            triangles: triangles.len() as u32,
            first_node: first_node as u32,
            nodes: tree.nodes.len() as u32,
            first_block: first_block as u32,
            blocks: tree.blocks.len() as u32,
            min,
            max,
        };
        if !self.normals.is_empty() {
            self.normals.resize(self.uvs.items().len(), [0.0; 3]);
            self.write_normals(&mesh, &[]);
        }
        Ok(mesh)
    }

    fn release_mesh(&mut self, mesh: &Mesh) {
        self.uvs.release(mesh.first_vertex, mesh.vertices as usize);
        self.normals.truncate(self.uvs.items().len());
        self.triangles.release(mesh.first_triangle, mesh.triangles as usize);
        self.nodes.release(mesh.first_node, mesh.nodes as usize);
        self.blocks.release(mesh.first_block, mesh.blocks as usize);
        self.facets.truncate(self.blocks.items().len() * WIDTH);
    }

    /// Total number of slots after `uses` instances change their number of blocks.
    fn slots_with(&self, uses: u32, old_blocks: u32, new_blocks: usize) -> Result<u64, SceneError> {
        let slots_of = |blocks: u64| u64::from(uses) * blocks * WIDTH as u64;
        let slots = self.slots - slots_of(old_blocks.into()) + slots_of(new_blocks as u64);
        if slots >= 1 << 31 { Err(SceneError::TooMany) } else { Ok(slots) }
    }

    /// Adds a terrain of `rows` × `columns` heights in metres, row by row from +y to −y, each row from −x to +x. `size`
    /// holds its full lengths along x and y; a height of 0 is at z = 0.
    ///
    /// # Errors
    /// The errors of [`HeightField::build`].
    pub fn add_height_field(
        &mut self,
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
    ) -> Result<HeightFieldId, SceneError> {
        room(&self.height_fields)?;
        let field = self.store_height_field(rows, columns, size, heights, |_| Ok(()))?;
        Ok(HeightFieldId(self.height_fields.add(field)))
    }

    /// Replaces a terrain. All its instances show the new one.
    ///
    /// # Errors
    /// [`SceneError::NoSuchHeightField`], [`SceneError::TooMany`] and those of [`HeightField::build`]; the old terrain
    /// is then kept.
    pub fn set_height_field(
        &mut self,
        field: HeightFieldId,
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
    ) -> Result<(), SceneError> {
        let old = *self.height_fields.get(field.0).ok_or(SceneError::NoSuchHeightField(field.0))?;
        let uses = self.height_fields.uses(field.0).unwrap_or(0);
        let slots =
            |builder: &Self, new: &HeightField| builder.slots_with(uses, old.blocks(), new.blocks() as usize);
        let mut sum = 0;
        let new = self.store_height_field(rows, columns, size, heights, |checked| {
            sum = slots(checked.0, checked.1)?;
            Ok(())
        })?;
        self.release_height_field(&old);
        self.slots = sum;
        if let Some(place) = self.height_fields.get_mut(field.0) {
            *place = new;
        }
        Ok(())
    }

    /// Removes a terrain.
    ///
    /// # Errors
    /// [`SceneError::NoSuchHeightField`], [`SceneError::InUse`] by an instance.
    pub fn remove_height_field(&mut self, field: HeightFieldId) -> Result<(), SceneError> {
        let old = unused(&self.height_fields, field.0, SceneError::NoSuchHeightField(field.0), || {
            self.used_by_instance(|instance| {
                instance.kind() == Kind::Triangles(Triangles::HeightField) && instance.mesh == field.0
            })
        })?;
        self.release_height_field(&old);
        self.height_fields.remove(field.0, HeightField::zeroed());
        Ok(())
    }

    fn store_height_field(
        &mut self,
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
        check: impl FnOnce((&Self, &HeightField)) -> Result<(), SceneError>,
    ) -> Result<HeightField, SceneError> {
        // Nothing is allocated if the number of heights is wrong.
        let fits = u64::from(rows) * u64::from(columns) == heights.len() as u64;
        let need = if fits { HeightField::extents_len(rows, columns) } else { 0 };
        let first_height = self.heights.place(heights.len(), 32)?;
        let first_extent = self.extents.place(need, 32)?;
        let mut extents = vec![[0.0; 2]; need];
        let mut field = HeightField::build(rows, columns, size, heights, &mut extents)?;
        check((&*self, &field))?;
        (field.first_height, field.first_extent) = (first_height as u32, first_extent as u32);
        self.heights.put(first_height, heights);
        self.extents.put(first_extent, &extents);
        Ok(field)
    }

    fn release_height_field(&mut self, field: &HeightField) {
        let [rows, columns] = [field.rows(), field.columns()];
        self.heights.release(field.first_height, rows as usize * columns as usize);
        self.extents.release(field.first_extent, HeightField::extents_len(rows, columns));
    }
}

fn checked_tree(
    positions: &[[f32; 3]],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
) -> Result<Tree, SceneError> {
    limits::uvs(uvs, positions.len())?;
    Tree::build(positions, triangles, Quality::High, Execution::default())
}
