//! Baked scenes: they are read back as they were written, and corrupted ones do no harm.

#[path = "fuzz_entry.rs"]
mod entry;

use crate::common::random::tries;
use crate::common::{LIDAR, add_grey, camera, depth_camera, depth_image, picture, scan, scenery};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{BakedError, Scene, SceneBuilder, Shape};
use belvedere_sensors::trace::CacheLine;
use glam::DVec3;
use proptest::prelude::*;

/// A scene with every shape, texture and lamp, a height field, and an empty mesh.
fn everything() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let heights: Vec<_> = (0..7 * 9).map(|i| (i * 37 % 11) as f32 * 0.02).collect();
    let field = builder.add_height_field(7, 9, [2.0, 3.0], &heights).unwrap();
    add_grey(&mut builder, Shape::HeightField(field), Pose::from_translation(DVec3::new(1.0, 1.0, 0.4)));
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.2], [0.5, 0.5, 0.0]];
    let sail = builder.add_mesh(&corners, &[], &[[0, 1, 2], [1, 3, 2]]).unwrap();
    let normals = [[0.0, 0.0, 1.0], [0.3, 0.1, 1.0], [-0.2, 0.5, 0.9], [0.0, 0.4, 2.0]];
    builder.set_mesh_normals(sail, &normals).unwrap();
    add_grey(&mut builder, Shape::Mesh(sail), Pose::from_translation(DVec3::new(-1.0, 0.0, 1.0)));
    let nothing = builder.add_mesh(&[], &[], &[]).unwrap();
    add_grey(&mut builder, Shape::Mesh(nothing), Pose::IDENTITY);
    builder
}

/// The bytes at an address that is a multiple of 64.
fn aligned(bytes: &[u8]) -> Vec<CacheLine> {
    let mut lines = vec![CacheLine::ZERO; bytes.len().div_ceil(64)];
    bytemuck::cast_slice_mut::<_, u8>(&mut lines)[..bytes.len()].copy_from_slice(bytes);
    lines
}

#[test]
fn baked_scenes_give_the_frames_of_the_builder() {
    let builder = everything();
    let path = std::env::temp_dir().join(format!("belvedere-baked-{}.scene", std::process::id()));
    std::fs::write(&path, bytemuck::cast_slice::<_, u8>(&builder.bake())).unwrap();
    let bytes = std::fs::read(&path);
    std::fs::remove_file(&path).unwrap();
    let lines = aligned(&bytes.unwrap());
    let baked = Scene::from_baked(bytemuck::cast_slice(&lines)).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    assert!(picture(baked, camera(), pose) == picture(&builder, camera(), pose));
    assert!(depth_image(baked, depth_camera(), pose) == depth_image(&builder, depth_camera(), pose));
    assert!(scan(baked, LIDAR, pose) == scan(&builder, LIDAR, pose));
}

#[test]
fn an_empty_scene_is_read_back() {
    let lines = SceneBuilder::new().bake();
    let (scene, poses) = Scene::from_baked(bytemuck::cast_slice(&lines)).unwrap();
    assert!(scene.instances().is_empty() && poses.is_empty());
}

/// The error for a scene after `spoil` has changed its bytes.
fn fault_of(spoil: impl FnOnce(&mut [u8])) -> String {
    let mut lines = everything().bake();
    spoil(bytemuck::cast_slice_mut(&mut lines));
    Scene::from_baked(bytemuck::cast_slice(&lines)).unwrap_err().to_string()
}

/// The offset of a section.
fn section(bytes: &[u8], index: usize) -> usize {
    u64::from_le_bytes(bytes[64 + 16 * index..][..8].try_into().unwrap()) as usize
}

#[test]
fn errors_say_what_is_wrong() {
    let lines = everything().bake();
    let bytes: &[u8] = bytemuck::cast_slice(&lines);
    assert_eq!(Scene::from_baked(&bytes[1..]).unwrap_err(), BakedError::Misaligned);
    assert!(matches!(Scene::from_baked(&bytes[..64]).unwrap_err(), BakedError::Length { have: 64, .. }));
    let cut = Scene::from_baked(&bytes[..bytes.len() - 64]).unwrap_err().to_string();
    assert!(cut.contains("cut off"), "{cut}");
    assert!(fault_of(|bytes| bytes[0] ^= 1).contains("baked scene"));
    assert!(fault_of(|bytes| bytes[8] = 9).contains("version 9"));
    let fault = fault_of(|bytes| bytes[64 + 8 + 3] = 1);
    assert!(fault.contains("section `instances`"), "{fault}");
    // A child of the first node.
    let fault = fault_of(|bytes| {
        let nodes = section(bytes, 4);
        bytes[nodes + 384..][..4].copy_from_slice(&77_u32.to_le_bytes());
    });
    assert!(fault.contains("element 0 of `meshes`") && fault.contains("child 0 of node 0"), "{fault}");
    // The x of the third instance's position.
    let fault = fault_of(|bytes| {
        let third = section(bytes, 14) + 2 * 56;
        bytes[third + 32..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
    });
    assert!(fault.contains("element 2 of `poses` of the scene: translation cannot be NaN"), "{fault}");
}

proptest! {
    #![proptest_config(tries(1500))]

    #[test]
    fn spoilt_scenes_are_refused_or_sensed(
        spoils in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..5_u32), 1..4),
        rays in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let mut lines = everything().bake();
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut lines);
        let poses = section(bytes, 14);
        for (place, byte, kind) in &spoils {
            // Header, instances and poses, where few bytes have a large effect, are changed as often as everything
            // else.
            let range = match kind {
                0 => 0..384,
                1 => 0..384 + 72 * 30,
                2 => poses..bytes.len(),
                _ => 0..bytes.len(),
            };
            bytes[range.start + place.index(range.len())] ^= byte;
        }
        entry::sense_scene(bytes, &rays);
    }

    #[test]
    fn arbitrary_bytes_do_no_harm(data in prop::collection::vec(any::<u8>(), 0..3000)) {
        entry::sense(&data);
    }
}
