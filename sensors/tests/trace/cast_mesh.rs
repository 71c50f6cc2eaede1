//! A mesh without a scene gives the same hits as a scene that contains only this mesh.

use belvedere_sensors::scene::build::{Quality, Tree};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::rays::{MeshTree, Rays, cast_mesh, cast_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;

#[derive(Debug, PartialEq, Clone)]
struct Answers {
    distance: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    primitive: Vec<u32>,
    barycentrics: Vec<[f32; 2]>,
}

impl Answers {
    fn hits(&mut self) -> Hits<'_> {
        Hits {
            distance: Some(&mut self.distance),
            normal: Some(&mut self.normal),
            instance: Some(&mut self.instance),
            primitive: Some(&mut self.primitive),
            barycentrics: Some(&mut self.barycentrics),
        }
    }
}

#[test]
fn all_requested_outputs_are_written() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, 2.0]];
    let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let directions: Vec<[f32; 3]> =
        (0..200).map(|ray| [-1.0, (ray % 20) as f32 * 0.02 - 0.2, (ray / 20) as f32 * 0.04 - 0.2]).collect();
    let rays = Rays { origins: &[[3.0, 0.4, 0.5]], directions: &directions, ranges: None };
    let unwritten = Answers {
        distance: vec![7.0; 200],
        normal: vec![[7.0; 3]; 200],
        instance: vec![7; 200],
        primitive: vec![7; 200],
        barycentrics: vec![[7.0; 2]; 200],
    };

    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let mesh = Shape::Mesh(builder.add_mesh(&corners, &[], &triangles).unwrap());
    let world_from_instance = Pose::IDENTITY;
    builder
        .add_instance(&InstanceConfig { shape: mesh, world_from_instance, material, ..Default::default() })
        .unwrap();
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    let tree = Tree::build(&corners, &triangles, Quality::High, Execution::default()).unwrap();
    let tree = MeshTree { nodes: &tree.nodes, blocks: &tree.blocks };
    for faces in [Faces::Front, Faces::Both] {
        let (mut of_scene, mut of_mesh) = (unwritten.clone(), unwritten.clone());
        let mut workspace = workspace.lend(workspace_len(&scene));
        cast_rays(
            &scene,
            builder.poses(),
            DVec3::ZERO,
            &rays,
            VISUAL,
            faces,
            &mut workspace,
            of_scene.hits(),
        )
        .expect("outputs of the right size");
        cast_mesh(Level::new(), tree, &rays, faces, &mut of_mesh.hits()).expect("outputs of the right size");
        let hits = of_mesh.distance.iter().filter(|distance| distance.is_finite()).count();
        assert!((20..180).contains(&hits), "{hits} hits");
        for ray in 0..200 {
            if of_mesh.distance[ray].is_finite() {
                assert_eq!(of_mesh.instance[ray], 0, "ray {ray}");
                let weights = of_mesh.barycentrics[ray];
                assert!(weights.iter().all(|&weight| (-1e-6..=1.0 + 1e-6).contains(&weight)), "{weights:?}");
            } else {
                assert_eq!((of_mesh.instance[ray], of_mesh.primitive[ray]), (u32::MAX, u32::MAX));
            }
        }
        assert_eq!(of_mesh.distance, of_scene.distance);
        assert_eq!(of_mesh.instance, of_scene.instance);
        assert_eq!(of_mesh.primitive, of_scene.primitive);
        assert_eq!(of_mesh.barycentrics, of_scene.barycentrics);
    }
}
