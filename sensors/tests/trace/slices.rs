//! Scenes of the caller's own arrays: they equal those of a builder to the last bit, and are checked in the same way.
#![allow(clippy::large_stack_arrays, reason = "arrays are what is tested")]

use crate::common::{LIDAR, camera, depth_camera};
use belvedere_sensors::depth::{DepthCamera, DepthFrame, POINT_STEP};
use belvedere_sensors::lidar::{Lidar, Scan};
use belvedere_sensors::scene::build::{Scratch, max_size, scratch_len};
use belvedere_sensors::scene::tree::{Facet, TriangleBlock, WideNode};
use belvedere_sensors::scene::*;
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Moment, Pose, Sensor};
use bytemuck::Zeroable;
use glam::DVec3;

type Soup = (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

/// A bumpy sheet of 2 × cells² triangles.
fn sheet(cells: u32, textured: bool) -> Soup {
    let side = cells + 1;
    let at = |index: u32| [index % side, index / side].map(|place| place as f32 / cells as f32);
    let positions = (0..side * side).map(|index| {
        let [u, v] = at(index);
        [u * 2.0 - 1.0, v * 2.0 - 1.0, 0.1 * ((index * 7 % 5) as f32 - 2.0)]
    });
    let uvs = (0..side * side).map(at).filter(|_| textured);
    let triangles = (0..cells * cells).flat_map(|cell| {
        let a = cell / cells * side + cell % cells;
        [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
    });
    (positions.collect(), uvs.collect(), triangles.collect())
}

/// Normals of the vertices of the smaller sheet, of various lengths.
fn normals() -> Vec<[f32; 3]> {
    (0..25)
        .map(|index| [0.1 * (index % 5) as f32 - 0.2, 0.05 * (index / 5) as f32, 0.5 + index as f32])
        .collect()
}

const TEXTURE: [u32; 2] = [5, 3];
const FIELD: [u32; 2] = [7, 9];

fn soups() -> [Soup; 2] {
    [sheet(9, true), sheet(4, false)]
}

fn pixels() -> Vec<[u8; 4]> {
    (0..15).map(|index| [index * 17, 255 - index * 11, index * 5, 255]).collect()
}

fn heights() -> Vec<f32> {
    (0..63).map(|index| (index * 37 % 11) as f32 * 0.02).collect()
}

fn materials() -> [MaterialConfig; 2] {
    let textured =
        MaterialConfig { texture: Some(TextureId(0)), texture_repeat: [2.0, 3.0], ..Default::default() };
    [MaterialConfig { specular: [0.5; 3], shininess: 9.0, ..Default::default() }, textured]
}

fn lights() -> [LightConfig; 2] {
    let lamp = LightConfig {
        kind: LightKind::Point { position: [-1.0, 2.0, 3.0] },
        diffuse: [0.9, 0.8, 0.7],
        specular: [0.2, 0.3, 0.4],
        range_m: 30.0,
        attenuation: [0.5, 0.05, 0.01],
        cast_shadows: true,
    };
    [lamp, LightConfig { kind: LightKind::Directional { direction: [0.3, 0.2, -1.0] }, ..lamp }]
}

fn instances() -> Vec<InstanceConfig> {
    let shapes = [
        Shape::Mesh(MeshId(0)),
        Shape::Mesh(MeshId(1)),
        Shape::HeightField(HeightFieldId(0)),
        Shape::Box { size: [0.5, 0.6, 0.7] },
        Shape::Sphere { radius: 0.4 },
        Shape::Plane,
        Shape::Mesh(MeshId(0)),
    ];
    let one = |(index, shape): (usize, Shape)| {
        let turn = DVec3::new(0.3, -0.4, 0.5) * index as f64;
        let place = DVec3::new(2.5 + 0.3 * index as f64, index as f64 - 3.0, -0.4);
        let world_from_instance = match shape {
            Shape::Plane => Pose::from_translation(DVec3::NEG_Z),
            Shape::HeightField(_) => Pose::from_translation(place),
            _ => Pose::from_xyz_rpy(place, turn),
        };
        let material = MaterialId(index as u32 % 2);
        let (scale, class) = ([1.0, 1.0, if index == 6 { -1.5 } else { 1.0 }], index as u32 * 3);
        InstanceConfig {
            shape,
            world_from_instance,
            material,
            scale,
            class,
            laser_retro: 2.0,
            ..Default::default()
        }
    };
    shapes.into_iter().enumerate().map(one).collect()
}

fn built() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    for (positions, uvs, triangles) in soups() {
        builder.add_mesh(&positions, &uvs, &triangles).unwrap();
    }
    builder.set_mesh_normals(MeshId(1), &normals()).unwrap();
    builder.add_height_field(FIELD[0], FIELD[1], [2.0, 3.0], &heights()).unwrap();
    builder.add_texture(TEXTURE[0], TEXTURE[1], &pixels()).unwrap();
    for material in &materials() {
        builder.add_material(material).unwrap();
    }
    for light in &lights() {
        builder.add_light(light).unwrap();
    }
    for instance in &instances() {
        builder.add_instance(instance).unwrap();
    }
    builder
}

/// Arrays that hold the elements of the slices.
struct Arrays {
    meshes: [Mesh; 2],
    uvs: [[f32; 2]; 125],
    normals: [[f32; 3]; 125],
    triangles: [[u32; 3]; 194],
    nodes: [WideNode; 64],
    blocks: [TriangleBlock; 64],
    facets: [Facet; 1024],
    scratch: [Scratch; 512],
}

impl Arrays {
    fn new() -> Box<Self> {
        Box::new(Self {
            meshes: [Mesh::zeroed(); 2],
            uvs: [[0.0; 2]; 125],
            normals: [[0.0; 3]; 125],
            triangles: [[0; 3]; 194],
            nodes: [WideNode::zeroed(); 64],
            blocks: [TriangleBlock::zeroed(); 64],
            facets: [Facet::zeroed(); 1024],
            scratch: [Scratch::zeroed(); 512],
        })
    }

    fn store(&mut self) -> MeshStore<'_> {
        let Self { meshes, uvs, normals, triangles, nodes, blocks, facets, scratch } = self;
        MeshStore::new(MeshMemory { meshes, uvs, normals, triangles, nodes, blocks, facets, scratch })
    }
}

/// The slices of everything except the meshes.
struct Rest {
    instances: Vec<Instance>,
    poses: Vec<Pose>,
    heights: Vec<f32>,
    extents: Vec<[f32; 2]>,
    fields: [HeightField; 1],
    textures: [Texture; 1],
    texels: Vec<[u8; 4]>,
    materials: Vec<Material>,
    lights: Vec<Light>,
}

impl Rest {
    fn new() -> Self {
        let (heights, [rows, columns]) = (heights(), FIELD);
        let mut extents = vec![[0.0; 2]; HeightField::extents_len(rows, columns)];
        let fields = [HeightField::build(rows, columns, [2.0, 3.0], &heights, &mut extents).unwrap()];
        let [width, height] = TEXTURE;
        let mut texels = pixels();
        texels.resize(mip_texels(width, height), [0; 4]);
        fill_mip_levels(width, height, &mut texels);
        Self {
            instances: instances().iter().map(|config| Instance::new(config).unwrap()).collect(),
            poses: instances().iter().map(|config| config.world_from_instance).collect(),
            heights,
            extents,
            fields,
            textures: [Texture::new(width, height, 0)],
            texels,
            materials: materials().iter().map(Material::new).collect(),
            lights: lights().iter().map(Light::new).collect(),
        }
    }

    fn slices<'a>(&'a self, meshes: Meshes<'a>) -> SceneSlices<'a> {
        SceneSlices::new()
            .meshes(meshes)
            .instances(&self.instances)
            .height_fields(&self.fields, &self.heights, &self.extents)
            .textures(&self.textures, &self.texels)
            .materials(&self.materials)
            .lights(&self.lights)
    }
}

/// Every channel of every sensor, as bytes.
fn sense(scene: &Scene<'_>, poses: &[Pose]) -> Vec<(&'static str, Vec<u8>)> {
    let world_from_sensor = Pose::from_xyz_rpy(DVec3::new(-1.0, 0.3, 1.0), DVec3::new(0.1, 0.25, -0.05));
    let now = Moment { world_from_sensor, world_from_instance: poses };
    let before = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: poses };
    let capture = Capture::new(3, now).before(before);
    let mut memory = WorkspaceBuf::default();
    let sensor = DepthCamera::new(depth_camera().camera(camera())).unwrap();
    let count = sensor.pixels();
    let (mut depth, mut colour) = (vec![0.0_f32; count], vec![0_u8; sensor.camera().frame_len()]);
    let mut points = vec![0_u8; count * POINT_STEP];
    let (mut distance, mut normal) = (vec![0.0_f32; count], vec![[0.0_f32; 3]; count]);
    let (mut instance, mut class) = (vec![0_u32; count], vec![0_u32; count]);
    let (mut incidence, mut flow) = (vec![0.0_f32; count], vec![[0.0_f32; 2]; count]);
    let truth = Truth::new()
        .depth(&mut distance)
        .normal(&mut normal)
        .instance(&mut instance)
        .class(&mut class)
        .incidence(&mut incidence)
        .flow_back(&mut flow);
    let frame =
        DepthFrame::new().depth_32fc1(&mut depth).colour(&mut colour).points(&mut points).truth(truth);
    sensor.sense_in(&mut memory, scene, &capture, frame).unwrap();

    let lidar = Lidar::new(LIDAR).unwrap();
    let (mut ranges, mut intensities) = (vec![0.0_f32; lidar.beams()], vec![0.0_f32; lidar.beams()]);
    let scan = Scan::new().ranges(&mut ranges).intensities(&mut intensities);
    lidar.sense_in(&mut memory, scene, &capture, scan).unwrap();

    let seen: std::collections::BTreeSet<_> = instance.iter().collect();
    assert_eq!(seen.len(), 8, "all seven instances are seen, and the sky: {seen:?}");
    vec![
        ("depth", bytemuck::cast_slice(&depth).to_vec()),
        ("colour", colour),
        ("points", points),
        ("true depth", bytemuck::cast_slice(&distance).to_vec()),
        ("normal", bytemuck::cast_slice(&normal).to_vec()),
        ("instance", bytemuck::cast_slice(&instance).to_vec()),
        ("class", bytemuck::cast_slice(&class).to_vec()),
        ("incidence", bytemuck::cast_slice(&incidence).to_vec()),
        ("flow", bytemuck::cast_slice(&flow).to_vec()),
        ("ranges", bytemuck::cast_slice(&ranges).to_vec()),
        ("intensities", bytemuck::cast_slice(&intensities).to_vec()),
    ]
}

#[test]
fn frames_are_those_of_a_builder() {
    let mut arrays = Arrays::new();
    let mut store = arrays.store();
    for (positions, uvs, triangles) in soups() {
        store.add(&positions, &uvs, &triangles, Execution::default()).unwrap();
    }
    store.set_normals(MeshId(1), &normals()).unwrap();
    let (rest, builder) = (Rest::new(), built());
    let scene = Scene::from_slices(&rest.slices(store.meshes())).unwrap();
    let expected = sense(&builder.scene(), builder.poses());
    for ((name, bytes), (_, expected)) in sense(&scene, &rest.poses).into_iter().zip(expected) {
        assert!(bytes == expected, "{name} of slices is not that of a builder");
    }
}

#[test]
fn errors_name_the_invalid_element() {
    let mut arrays = Arrays::new();
    let mut store = arrays.store();
    let [(positions, uvs, triangles), _] = soups();
    store.add(&positions, &uvs, &triangles, Execution::default()).unwrap();
    let mut rest = Rest::new();
    let fault = |rest: &Rest, store: &MeshStore<'_>| {
        Scene::from_slices(&rest.slices(store.meshes())).unwrap_err().to_string()
    };
    assert_eq!(fault(&rest, &store), "element 1 of `instances` of the scene: mesh cannot be 1");
    let [_, (positions, uvs, triangles)] = soups();
    store.add(&positions, &uvs, &triangles, Execution::default()).unwrap();
    assert!(Scene::from_slices(&rest.slices(store.meshes())).is_ok());

    rest.materials.pop();
    assert_eq!(fault(&rest, &store), "element 1 of `instances` of the scene: material cannot be 1");
    rest = Rest::new();
    rest.texels.pop();
    assert_eq!(fault(&rest, &store), "element 0 of `textures` of the scene: texels cannot be 0");
    rest = Rest::new();
    rest.heights[3] = f32::NAN;
    assert_eq!(
        fault(&rest, &store),
        "element 0 of `height_fields` of the scene: height 3 is not finite, or beyond 1e12 m"
    );
    rest = Rest::new();
    rest.lights[1] =
        Light::new(&LightConfig { kind: LightKind::Point { position: [f64::NAN; 3] }, ..lights()[0] });
    assert_eq!(fault(&rest, &store), "element 1 of `lights` of the scene: position cannot be NaN");
}

#[test]
fn memory_that_is_too_small_is_named() {
    let (positions, uvs, triangles) = sheet(9, true);
    let mut arrays = Arrays::new();
    let mut store = arrays.store();
    let add = |store: &mut MeshStore<'_>, uvs: &[[f32; 2]]| {
        store.add(&positions, uvs, &triangles, Execution::default()).map_err(|error| error.to_string())
    };
    assert_eq!(add(&mut store, &uvs[1..]).unwrap_err(), "texture coordinates must be none or one per vertex");
    assert_eq!(add(&mut store, &uvs), Ok(MeshId(0)));
    // A second mesh of the same size does not fit, and the first is kept.
    assert_eq!(add(&mut store, &uvs).unwrap_err(), "the buffer `uvs` holds 125 elements, and 200 are needed");
    let instance =
        Instance::new(&InstanceConfig { shape: Shape::Mesh(MeshId(0)), ..Default::default() }).unwrap();
    let material = [Material::new(&MaterialConfig::default())];
    let slices = SceneSlices::new().meshes(store.meshes()).materials(&material);
    assert!(Scene::from_slices(&slices.instances(&[instance])).is_ok());
    assert_eq!(max_size(162).blocks, 22);
    assert!(scratch_len(162) <= 512);
}

#[test]
fn meshes_from_elsewhere_are_checked() {
    let mut arrays = Arrays::new();
    let mut store = arrays.store();
    for (positions, uvs, triangles) in soups() {
        store.add(&positions, &uvs, &triangles, Execution::default()).unwrap();
    }
    let slices = store.meshes().slices();
    let mut scratch = vec![0; Meshes::scratch_len(slices.meshes)];
    let rest = Rest::new();
    let meshes = Meshes::new(slices, &mut scratch).unwrap();
    assert_eq!(Scene::from_slices(&rest.slices(meshes)).unwrap().instances().len(), 7);

    let fault =
        |slices: MeshSlices<'_>, scratch: &mut [u32]| Meshes::new(slices, scratch).unwrap_err().to_string();
    let need = scratch.len();
    let short = format!("`scratch` of the scene has {} elements, and the others call for {need}", need - 1);
    assert_eq!(fault(slices, &mut scratch[1..]), short);
    let mut nodes = slices.nodes.to_vec();
    nodes[0].child[0] = 77;
    let said = fault(MeshSlices { nodes: &nodes, ..slices }, &mut scratch);
    assert!(said.contains("element 0 of `meshes`") && said.contains("child 0 of node 0"), "{said}");
    let mut facets = slices.facets.to_vec();
    facets[5].normal[2] += 1.0;
    let said = fault(MeshSlices { facets: &facets, ..slices }, &mut scratch);
    assert!(said.starts_with("element 5 of `facets` of the scene: normal cannot be"), "{said}");
    let uvs = &slices.uvs[1..];
    let said = fault(MeshSlices { uvs, ..slices }, &mut scratch);
    assert_eq!(said, "element 1 of `meshes` of the scene: vertices cannot be 100");
    let mut normals = slices.normals.to_vec();
    normals[7] = [0.0, 0.5, 0.0];
    let said = fault(MeshSlices { normals: &normals, ..slices }, &mut scratch);
    let expected = "element 0 of `normals` of the scene: squared length of the normal cannot be 0";
    assert_eq!(said, expected, "a mesh has normals for all of its vertices, or for none");
    let said = fault(MeshSlices { normals: &normals[1..], ..slices }, &mut scratch);
    assert_eq!(said, "`normals` of the scene has 124 elements, and the others call for 125");
}

#[test]
fn normals_need_their_memory() {
    let mut arrays = Arrays::new();
    let Arrays { meshes, uvs, triangles, nodes, blocks, facets, scratch, .. } = &mut *arrays;
    let normals: &mut [[f32; 3]] = &mut [];
    let mut store =
        MeshStore::new(MeshMemory { meshes, uvs, normals, triangles, nodes, blocks, facets, scratch });
    let [_, (positions, uvs, triangles)] = soups();
    let mesh = store.add(&positions, &uvs, &triangles, Execution::default()).unwrap();
    assert!(store.meshes().slices().normals.is_empty());
    assert_eq!(store.set_normals(mesh, &[]), Ok(()));
    assert_eq!(store.set_normals(MeshId(1), &[]), Err(SceneError::NoSuchMesh(1)));
    assert_eq!(store.set_normals(mesh, &self::normals()[1..]), Err(SceneError::NormalCount));
    let said = store.set_normals(mesh, &self::normals()).unwrap_err().to_string();
    assert_eq!(said, "the buffer `normals` holds 0 elements, and 25 are needed");
}
