//! Building scenes, and its cost.

use crate::common::{camera_of, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{
    InstanceConfig, InstanceId, LightConfig, LightId, LightKind, MaterialConfig, MaterialId, Scene,
    SceneBuilder, SceneError, Shape, TextureId,
};
use glam::DVec3;
use std::time::{Duration, Instant};

/// The shortest time that adding this many instances took, over a few tries.
fn time_to_add(count: u32) -> Duration {
    let add = || {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).unwrap();
        let shape = Shape::Mesh(builder.add_mesh(&[[0.0; 3]; 3], &[], &[[0, 1, 2]]).unwrap());
        let config = InstanceConfig { shape, material, ..Default::default() };
        let start = Instant::now();
        for _ in 0..count {
            builder.add_instance(&config).unwrap();
        }
        assert_eq!(builder.scene().instances().len(), count as usize);
        start.elapsed()
    };
    (0..5).map(|_| add()).min().unwrap()
}

#[test]
fn the_cost_of_an_instance_does_not_depend_on_their_number() {
    // Compares with ten times as many. When adding computed sums over all instances, it took a hundred times as long.
    // Other load on the machine may slow some tries down. Both counts are so large that the process allocates new
    // pages, whose cost exceeds that of the code under test.
    let is_linear = || {
        let (few, many) = (time_to_add(50_000), time_to_add(500_000));
        println!("50 thousand in {few:?}, 500 thousand in {many:?}");
        many < few * 30
    };
    assert!((0..10).any(|_| is_linear()), "half a million cost more than ten times 50 thousand");
}

/// Corners, texture coordinates, triangles.
type Patch = (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

/// A patch of n × n squares, 1 m wide, with heights that depend on n.
fn patch(n: u32) -> Patch {
    let side = n + 1;
    let corners = (0..side * side).map(|i| {
        let (x, y) = ((i % side) as f32 / n as f32 - 0.5, (i / side) as f32 / n as f32 - 0.5);
        [x, y, 0.1 * x * y]
    });
    let uvs = (0..side * side).map(|i| [(i % side) as f32 / n as f32, (i / side) as f32 / n as f32]);
    let faces = (0..n * n).flat_map(|square| {
        let corner = square / n * side + square % n;
        [[corner, corner + 1, corner + side], [corner + 1, corner + side + 1, corner + side]]
    });
    (corners.collect(), uvs.collect(), faces.collect())
}

/// The ids of what was added in one round.
struct Thing {
    size: u32,
    kind: u32,
    place: DVec3,
    texture: TextureId,
    material: MaterialId,
    shape: Shape,
    instance: InstanceId,
    light: LightId,
}

fn add_thing(builder: &mut SceneBuilder, size: u32, kind: u32, place: DVec3) -> Thing {
    let texels: Vec<_> = (0..size * size).map(|i| [(i * 37 + size) as u8, (i * 11) as u8, 90, 255]).collect();
    let texture = builder.add_texture(size, size, &texels).unwrap();
    let config = MaterialConfig { texture: Some(texture), emissive: [0.1; 3], ..Default::default() };
    let material = builder.add_material(&config).unwrap();
    let shape = if kind == 0 {
        let heights: Vec<_> = (0..size * size).map(|i| (i % 7) as f32 * 0.02).collect();
        Shape::HeightField(builder.add_height_field(size, size, [1.0; 2], &heights).unwrap())
    } else {
        let (corners, uvs, faces) = patch(size);
        Shape::Mesh(builder.add_mesh(&corners, &uvs, &faces).unwrap())
    };
    let world_from_instance = Pose::from_xyz_rpy(place, DVec3::new(0.0, -1.2, 0.0));
    let config = InstanceConfig { shape, world_from_instance, material, ..Default::default() };
    let instance = builder.add_instance(&config).unwrap();
    let light = builder.add_light(&lamp(place)).unwrap();
    Thing { size, kind, place, texture, material, shape, instance, light }
}

fn lamp(place: DVec3) -> LightConfig {
    LightConfig {
        kind: LightKind::Point { position: (place - DVec3::X).to_array() },
        diffuse: [0.2; 3],
        range_m: 3.0,
        attenuation: [1.0, 0.1, 0.0],
        cast_shadows: true,
        ..LightConfig::default()
    }
}

fn remove_thing(builder: &mut SceneBuilder, thing: &Thing) {
    builder.remove_instance(thing.instance).unwrap();
    match thing.shape {
        Shape::Mesh(mesh) => builder.remove_mesh(mesh).unwrap(),
        Shape::HeightField(field) => builder.remove_height_field(field).unwrap(),
        _ => unreachable!("no other shapes here"),
    }
    builder.remove_material(thing.material).unwrap();
    builder.remove_texture(thing.texture).unwrap();
    builder.remove_light(thing.light).unwrap();
}

#[test]
fn memory_stays_bounded_while_instances_come_and_go() {
    let mut builder = SceneBuilder::new();
    let mut things: Vec<Thing> = Vec::new();
    let mut state = 1_u32;
    let mut random = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((u64::from(state) * u64::from(below)) >> 32) as u32
    };
    let camera = camera_of([64, 48], 1.2);
    // The largest number of the largest meshes that exist at a time, and half as much for gaps.
    let mut largest = SceneBuilder::new();
    for _ in 0..12 {
        add_thing(&mut largest, 13, 1, DVec3::X);
    }
    let (mut most, limit) = (0, largest.memory_len() * 3 / 2);
    for round in 1..=10_000 {
        if things.len() >= 12 || (things.len() > 4 && random(2) == 0) {
            let gone = things.swap_remove(random(things.len() as u32) as usize);
            remove_thing(&mut builder, &gone);
        } else {
            // No two objects are in the same plane, where either might be seen.
            let place = [random(5), random(4)].map(|step| f64::from(step) - 1.5);
            let place = DVec3::new(3.0 + f64::from(round) * 1e-4, place[0], place[1]);
            things.push(add_thing(&mut builder, 2 + random(12), random(3), place));
        }
        most = builder.memory_len().max(most);
        if round % 1000 == 0 {
            let mut fresh = SceneBuilder::new();
            things.sort_by_key(|thing| thing.light.0);
            for thing in &things {
                add_thing(&mut fresh, thing.size, thing.kind, thing.place);
            }
            assert!(
                picture(&builder, camera, Pose::IDENTITY) == picture(&fresh, camera, Pose::IDENTITY),
                "round {round}"
            );
            let baked = builder.bake();
            let read = Scene::from_baked(bytemuck::cast_slice(&baked)).unwrap();
            assert!(picture(read, camera, Pose::IDENTITY) == picture(&builder, camera, Pose::IDENTITY));
        }
    }
    println!("{most} bytes at most, of {limit}");
    assert!(most <= limit, "{most} bytes, of {limit}");
    for thing in &things {
        remove_thing(&mut builder, thing);
    }
    let baked = builder.bake();
    let (scene, _) = Scene::from_baked(bytemuck::cast_slice(&baked)).unwrap();
    assert!(
        picture(&builder, camera, Pose::IDENTITY) == picture(&SceneBuilder::new(), camera, Pose::IDENTITY)
    );
    assert_eq!(scene.instances().len(), builder.scene().instances().len());
}

#[test]
fn elements_in_use_cannot_be_removed() {
    let mut builder = SceneBuilder::new();
    let unused = builder.add_material(&MaterialConfig::default()).unwrap();
    let thing = add_thing(&mut builder, 5, 1, DVec3::X);
    let Shape::Mesh(mesh) = thing.shape else { unreachable!("a mesh was added") };
    let by = |user| Err(SceneError::InUse { user, index: u32::from(user == "material") });
    let text = SceneError::InUse { user: "instance", index: 0 }.to_string();
    assert_eq!(text, "it is still used by instance 0: remove that first");
    assert_eq!(builder.remove_mesh(mesh), by("instance"));
    assert_eq!(builder.remove_material(thing.material), by("instance"));
    assert_eq!(builder.remove_texture(thing.texture), by("material"));
    remove_thing(&mut builder, &thing);
    // Removed elements do not exist.
    assert_eq!(builder.remove_instance(thing.instance), Err(SceneError::NoSuchInstance(thing.instance.0)));
    assert_eq!(
        builder.set_pose(thing.instance, Pose::IDENTITY),
        Err(SceneError::NoSuchInstance(thing.instance.0))
    );
    assert_eq!(builder.pose(thing.instance), None);
    assert_eq!(builder.remove_mesh(mesh), Err(SceneError::NoSuchMesh(mesh.0)));
    let config = InstanceConfig { shape: thing.shape, material: unused, ..Default::default() };
    assert_eq!(builder.add_instance(&config), Err(SceneError::NoSuchMesh(mesh.0)));
    let config = InstanceConfig { material: thing.material, ..Default::default() };
    assert_eq!(builder.add_instance(&config), Err(SceneError::NoSuchMaterial(thing.material.0)));
    assert_eq!(builder.remove_light(thing.light), Err(SceneError::NoSuchLight(thing.light.0)));
    assert_eq!(builder.set_light(thing.light, &lamp(DVec3::X)), Err(SceneError::NoSuchLight(thing.light.0)));
    // Their ids are reused by the next.
    let next = add_thing(&mut builder, 3, 1, DVec3::X);
    assert_eq!((next.instance, next.material, next.light), (thing.instance, thing.material, thing.light));
}

#[test]
fn changed_elements_look_like_new_ones() {
    let camera = camera_of([64, 48], 1.2);
    for kind in [0, 1] {
        let mut builder = SceneBuilder::new();
        let thing = add_thing(&mut builder, 9, kind, DVec3::X * 3.0);
        let mut expected = SceneBuilder::new();
        let other = add_thing(&mut expected, 4, kind, DVec3::X * 3.0);
        assert!(picture(&builder, camera, Pose::IDENTITY) != picture(&expected, camera, Pose::IDENTITY));
        let (corners, uvs, faces) = patch(4);
        match thing.shape {
            Shape::Mesh(mesh) => builder.set_mesh(mesh, &corners, &uvs, &faces).unwrap(),
            Shape::HeightField(field) => {
                let heights: Vec<_> = (0..16).map(|i| (i % 7) as f32 * 0.02).collect();
                builder.set_height_field(field, 4, 4, [1.0; 2], &heights).unwrap();
            }
            _ => unreachable!("no other shapes here"),
        }
        let texels: Vec<_> = (0..16_u32).map(|i| [(i * 37 + 4) as u8, (i * 11) as u8, 90, 255]).collect();
        builder.set_texture(thing.texture, 4, 4, &texels).unwrap();
        assert!(picture(&builder, camera, Pose::IDENTITY) == picture(&expected, camera, Pose::IDENTITY));
        // One material and one lamp, changed in the same way in both.
        let red = MaterialConfig { diffuse: [1.0, 0.0, 0.0], ..Default::default() };
        for (builder, thing) in [(&mut builder, &thing), (&mut expected, &other)] {
            builder.set_material(thing.material, &red).unwrap();
            builder.set_light(thing.light, &lamp(DVec3::X * 2.5)).unwrap();
            builder.remove_texture(thing.texture).unwrap();
        }
        assert!(picture(&builder, camera, Pose::IDENTITY) == picture(&expected, camera, Pose::IDENTITY));
    }
}
