//! Scenes as bytes: written once, then read or memory-mapped and traced in place, without building anything.
//!
//! ```text
//! line 0       header: magic, version, number of sections, length of all, environment
//! lines 1 … 5  table: offset in bytes and number of elements of each section
//! lines 6 …    sections in the order of the table, each starting at a cache line
//! ```
//!
//! Numbers are little-endian; on a machine with another byte order, the magic number does not match. The bytes need not
//! be trusted: [`Scene::from_baked`] checks everything that tracing relies on.

mod error;

pub use error::BakedError;

use super::air::PackedAir;
use super::builder::Packed;
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{
    Air, ColourSpace, Environment, HeightField, Instance, Light, Material, Mesh, MeshSlices, Meshes, Scene,
    SceneBuilder, SceneSlices, Texture, check,
};
use crate::memory::CacheLine;
use crate::pose::Pose;
use alloc::vec::Vec;
use bytemuck::allocation::zeroed_vec;
use bytemuck::{Pod, Zeroable};

/// `BLVDRSCN`, read as a little-endian number.
const MAGIC: u64 = u64::from_le_bytes(*b"BLVDRSCN");
/// Version of the layout of all elements.
const VERSION: u32 = 8;
const LINE: usize = size_of::<CacheLine>();

/// Names and element sizes of the sections, in file order.
const SECTIONS: [(&str, usize); 17] = [
    ("instances", size_of::<Instance>()),
    ("meshes", size_of::<Mesh>()),
    ("uvs", size_of::<[f32; 2]>()),
    ("triangles", size_of::<[u32; 3]>()),
    ("nodes", size_of::<WideNode>()),
    ("blocks", size_of::<TriangleBlock>()),
    ("facets", size_of::<Facet>()),
    ("height_fields", size_of::<HeightField>()),
    ("heights", size_of::<f32>()),
    ("extents", size_of::<[f32; 2]>()),
    ("materials", size_of::<Material>()),
    ("textures", size_of::<Texture>()),
    ("texels", size_of::<[u8; 4]>()),
    ("lights", size_of::<Light>()),
    ("poses", size_of::<Pose>()),
    ("air", size_of::<PackedAir>()),
    ("normals", size_of::<[f32; 3]>()),
];

/// The header, which fills the first cache line.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Header {
    magic: u64,
    version: u32,
    sections: u32,
    /// Length of the whole file in bytes.
    length: u64,
    ambient: [f32; 3],
    background: [f32; 3],
    /// 1 if colours are sRGB.
    is_srgb: u32,
    reserved: [u32; 3],
}

const _: () = assert!(size_of::<Header>() == LINE);

/// Position of a section.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Section {
    /// Offset from the start of the file, in bytes.
    offset: u64,
    /// Number of elements.
    count: u64,
}

/// Bytes of header and table, rounded up to whole cache lines.
const fn head_len() -> usize {
    (LINE + SECTIONS.len() * size_of::<Section>()).next_multiple_of(LINE)
}

impl SceneBuilder {
    /// Serialises the scene and the current poses to bytes that [`Scene::from_baked`] reads. `bytemuck::cast_slice`
    /// converts the result to a byte slice, for example to write it to a file.
    ///
    /// ```
    /// use belvedere_sensors::scene::*;
    /// let mut builder = SceneBuilder::new();
    /// let material = builder.add_material(&MaterialConfig::default())?;
    /// builder.add_instance(&InstanceConfig { material, ..Default::default() })?;
    /// let baked = builder.bake();
    /// let (scene, poses) = Scene::from_baked(bytemuck::cast_slice(&baked)).unwrap();
    /// assert_eq!((scene.instances().len(), poses.len()), (1, 1));
    /// # Ok::<(), SceneError>(())
    /// ```
    pub fn bake(&self) -> Vec<CacheLine> {
        let packed = Packed::new(self);
        let scene = packed.scene(self);
        let air = PackedAir::new(&scene.air);
        let sections: [&[u8]; SECTIONS.len()] = [
            bytemuck::cast_slice(scene.instances),
            bytemuck::cast_slice(scene.meshes),
            bytemuck::cast_slice(scene.uvs),
            bytemuck::cast_slice(scene.triangles),
            bytemuck::cast_slice(scene.nodes),
            bytemuck::cast_slice(scene.blocks),
            bytemuck::cast_slice(scene.facets),
            bytemuck::cast_slice(scene.height_fields),
            bytemuck::cast_slice(scene.heights),
            bytemuck::cast_slice(scene.extents),
            bytemuck::cast_slice(scene.materials),
            bytemuck::cast_slice(scene.textures),
            bytemuck::cast_slice(scene.texels),
            bytemuck::cast_slice(scene.lights),
            bytemuck::cast_slice(self.poses()),
            bytemuck::bytes_of(&air),
            bytemuck::cast_slice(scene.normals),
        ];
        let mut table = [Section::zeroed(); SECTIONS.len()];
        let mut length = head_len();
        for ((entry, bytes), (_, size)) in table.iter_mut().zip(sections).zip(SECTIONS) {
            *entry = Section { offset: length as u64, count: (bytes.len() / size) as u64 };
            length += bytes.len().next_multiple_of(LINE);
        }
        let header = Header {
            magic: MAGIC,
            version: VERSION,
            sections: SECTIONS.len() as u32,
            length: length as u64,
            ambient: scene.environment.ambient,
            background: scene.environment.background,
            is_srgb: u32::from(scene.colour_space == ColourSpace::Srgb),
            reserved: [0; 3],
        };
        let mut lines: Vec<CacheLine> = bytemuck::allocation::zeroed_vec(length / LINE);
        let all: &mut [u8] = bytemuck::cast_slice_mut(&mut lines);
        all[..LINE].copy_from_slice(bytemuck::bytes_of(&header));
        let table_bytes: &[u8] = bytemuck::cast_slice(&table);
        all[LINE..][..table_bytes.len()].copy_from_slice(table_bytes);
        for (entry, bytes) in table.iter().zip(sections) {
            all[entry.offset as usize..][..bytes.len()].copy_from_slice(bytes);
        }
        lines
    }
}

impl<'a> Scene<'a> {
    /// Reads a scene that [`SceneBuilder::bake`] wrote, and the pose of each instance.
    ///
    /// The bytes must begin at a multiple of 64, as every memory-mapped file and every slice of [`CacheLine`]s does.
    /// The scene borrows them without copying. Everything is checked, so a scene that is returned can be traced even if
    /// the bytes come from an untrusted source. The time for the checks is proportional to the number of bytes.
    ///
    /// # Errors
    /// [`BakedError`] names the section, the element and what is wrong.
    pub fn from_baked(bytes: &'a [u8]) -> Result<(Self, &'a [Pose]), BakedError> {
        if !(bytes.as_ptr() as usize).is_multiple_of(LINE) {
            return Err(BakedError::Misaligned);
        }
        if bytes.len() < head_len() {
            return Err(BakedError::Length { have: bytes.len() as u64, need: head_len() as u64 });
        }
        let header: &Header = bytemuck::from_bytes(&bytes[..LINE]);
        if header.magic != MAGIC {
            return Err(BakedError::NotAScene { magic: header.magic });
        }
        if header.version != VERSION || header.sections as usize != SECTIONS.len() {
            return Err(BakedError::Version { found: header.version, known: VERSION });
        }
        if header.length != bytes.len() as u64 {
            return Err(BakedError::Length { have: bytes.len() as u64, need: header.length });
        }
        let table: &[Section] = bytemuck::cast_slice(&bytes[LINE..][..SECTIONS.len() * size_of::<Section>()]);
        let mut sections: [&'a [u8]; SECTIONS.len()] = [&[]; SECTIONS.len()];
        let mut end = head_len() as u64;
        for ((entry, bytes_of), (name, size)) in table.iter().zip(&mut sections).zip(SECTIONS) {
            let fault = BakedError::Section { section: name, offset: entry.offset, count: entry.count };
            // Sections are consecutive, so no two overlap.
            if entry.offset != end {
                return Err(fault);
            }
            let length = entry.count.checked_mul(size as u64).ok_or(fault)?;
            let next = length.checked_add(entry.offset).and_then(|next| next.checked_next_multiple_of(64));
            end = next.filter(|&next| next <= bytes.len() as u64).ok_or(fault)?;
            *bytes_of = &bytes[entry.offset as usize..][..length as usize];
        }
        let [
            instances,
            meshes,
            uvs,
            triangles,
            nodes,
            blocks,
            facets,
            height_fields,
            heights,
            extents,
            materials,
            textures,
            texels,
            lights,
            poses,
            air,
            normals,
        ] = sections;
        let meshes = MeshSlices {
            meshes: bytemuck::cast_slice(meshes),
            uvs: bytemuck::cast_slice(uvs),
            normals: bytemuck::cast_slice(normals),
            triangles: bytemuck::cast_slice(triangles),
            nodes: bytemuck::cast_slice(nodes),
            blocks: bytemuck::cast_slice(blocks),
            facets: bytemuck::cast_slice(facets),
        };
        // Checked before the mesh sizes determine an allocation.
        check::parts_of_meshes(&meshes)?;
        let meshes = Meshes::new(meshes, &mut zeroed_vec(Meshes::scratch_len(meshes.meshes)))?;
        let scene = Self::from_slices(&SceneSlices {
            instances: bytemuck::cast_slice(instances),
            meshes,
            height_fields: bytemuck::cast_slice(height_fields),
            heights: bytemuck::cast_slice(heights),
            extents: bytemuck::cast_slice(extents),
            materials: bytemuck::cast_slice(materials),
            textures: bytemuck::cast_slice(textures),
            texels: bytemuck::cast_slice(texels),
            lights: bytemuck::cast_slice(lights),
            environment: Environment { ambient: header.ambient, background: header.background },
            air: bytemuck::cast_slice(air).first().map_or(Air::default(), PackedAir::air),
            colour_space: if header.is_srgb == 0 { ColourSpace::AsGiven } else { ColourSpace::Srgb },
        })?;
        let poses = bytemuck::cast_slice(poses);
        check::poses(&scene, poses)?;
        Ok((scene, poses))
    }
}
