//! Cube textures, as the sky and on shapes, against an oracle in f64 that finds neighbours by their distance.

use crate::common::oracle::{Ray, first_surface, pixel_ray};
use crate::common::{SIZE, add, camera, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::{CameraConfig, Edges};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
use belvedere_sensors::scene::{
    Air, CubeTexture, Environment, InstanceConfig, MaterialConfig, Scene, SceneBuilder, SceneError, Shape,
    Sky, TextureId, TextureMode,
};
use core::f64::consts::TAU;
use glam::DVec3;

/// Outwards, right and up in the image of each face.
const FACES: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::NEG_Z, DVec3::Y],
    [DVec3::NEG_X, DVec3::Z, DVec3::Y],
    [DVec3::Y, DVec3::X, DVec3::NEG_Z],
    [DVec3::NEG_Y, DVec3::X, DVec3::Z],
    [DVec3::Z, DVec3::X, DVec3::Y],
    [DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y],
];

/// The faces of a cube, whose texels all differ.
struct Cube {
    size: i64,
    texels: Vec<[u8; 4]>,
}

impl Cube {
    fn new(size: u32) -> Self {
        let texel =
            |i: u32| [(i * 37 + 11) % 251, (i * 101 + 5) % 241, (i * 59) % 239, 0].map(|value| value as u8);
        Self { size: size.into(), texels: (0..6 * size * size).map(texel).collect() }
    }

    fn add(&self, builder: &mut SceneBuilder) -> TextureId {
        builder.add_cube_texture(self.size as u32, &self.texels).unwrap()
    }

    /// A place on a face, whose rows and columns may be beyond it.
    fn place(&self, face: usize, row: f64, column: f64) -> DVec3 {
        let [outwards, right, up] = FACES[face];
        let on = |number: f64| (2.0 * number + 1.0) / self.size as f64 - 1.0;
        outwards + right * on(column) - up * on(row)
    }

    /// A texel of a face, or the nearest one beyond its edge.
    fn texel(&self, face: usize, row: i64, column: i64) -> [f64; 3] {
        let [near_row, near_column] = [row, column].map(|number| number.clamp(0, self.size - 1));
        if (row, column) == (near_row, near_column) {
            let texel = self.texels[((face as i64 * self.size + row) * self.size + column) as usize];
            return [0, 1, 2].map(|channel| f64::from(texel[channel]));
        }
        if row != near_row && column != near_column {
            let three = [(near_row, near_column), (row, near_column), (near_row, column)];
            let three = three.map(|(row, column)| self.texel(face, row, column));
            return [0, 1, 2].map(|channel| three.iter().map(|texel| texel[channel]).sum::<f64>() / 3.0);
        }
        // Halfway between the two is the edge.
        let middle = |one: i64, other: i64| (one + other) as f64 / 2.0;
        let edge = self.place(face, middle(row, near_row), middle(column, near_column));
        let size = self.size;
        let all = (0..6).flat_map(|face| (0..size * size).map(move |i| (face, i / size, i % size)));
        let (face, row, column) = all
            .filter(|(other, ..)| *other != face)
            .min_by(|one, other| {
                let far = |(face, row, column)| self.place(face, row as f64, column as f64).distance(edge);
                far(*one).total_cmp(&far(*other))
            })
            .unwrap();
        self.texel(face, row, column)
    }

    /// The colour in a direction, linear between the nearest four texels.
    fn colour(&self, direction: DVec3) -> [f64; 3] {
        let far = |face: &usize| FACES[*face][0].dot(direction);
        let face = (0..6).max_by(|one, other| far(one).total_cmp(&far(other))).unwrap();
        let [outwards, right, up] = FACES[face].map(|axis| axis.dot(direction));
        let at = |part: f64| f64::midpoint(part / outwards, 1.0) * self.size as f64 - 0.5;
        let (column, row) = (at(right), at(-up));
        let mut sum = [0.0; 3];
        for (y, x) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let weight = |place: f64, side: i64| 1.0 - (place - (place.floor() + side as f64)).abs();
            let texel = self.texel(face, row.floor() as i64 + y, column.floor() as i64 + x);
            for channel in 0..3 {
                sum[channel] += texel[channel] * weight(row, y) * weight(column, x);
            }
        }
        sum
    }
}

fn near(pixel: [u8; 3], expected: [f64; 3]) -> bool {
    pixel.iter().zip(expected).all(|(value, expected)| (f64::from(*value) - expected).abs() < 0.75)
}

/// A scene with this sky alone.
fn under(cube: &Cube) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
    let texture = cube.add(&mut builder);
    builder.set_air(Air { sky: Some(Sky::Cube(texture)), fog: None }).unwrap();
    builder
}

/// Compares pixels of the sky with the oracle, and returns the seen faces as one bit each.
fn compare_sky(cube: &Cube, pixels: &[u8], direction: impl Fn(usize) -> DVec3) -> u32 {
    let mut seen = 0;
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let DVec3 { x, y, z } = direction(index);
        let in_cube = DVec3::new(x, z, -y);
        let expected = cube.colour(in_cube);
        assert!(near(*pixel, expected), "pixel {index} at {in_cube} is {pixel:?}, should be {expected:?}");
        let face =
            FACES.iter().position(|[outwards, ..]| outwards.dot(in_cube) >= in_cube.abs().max_element());
        seen |= 1 << face.unwrap_or(0);
    }
    seen
}

#[test]
fn the_sky_shows_the_faces_of_a_cube_without_seams() {
    for size in [1, 2, 3, 8] {
        let cube = Cube::new(size);
        let builder = under(&cube);
        let mut seen = 0;
        for ahead in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            let config = camera_of([160, 120], 1.8);
            let eye = look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 3.0) + ahead, 0.2);
            let pixels = picture(&builder, config, eye);
            seen |= compare_sky(&cube, &pixels, |index| {
                pixel_ray(&config, &eye, index as u32 % 160, index as u32 / 160).direction
            });
            // No edge is found in it, or sampling it changes little.
            let smooth = picture(&builder, config.edges(Edges::Smooth), eye);
            assert!(smooth.iter().zip(&pixels).all(|(one, other)| one.abs_diff(*other) < 16));
        }
        assert_eq!(seen, 0b11_1111);
    }
}

#[test]
fn a_fisheye_sees_the_sky() {
    let lens = Intrinsics { fx: 50.0, fy: 50.0, cx: 79.5, cy: 79.5, skew: 0.0 };
    let rays = RayTableBuf::from_lens(160, 160, &KannalaBrandt::new(lens, [0.0; 4]).unwrap()).unwrap();
    let cube = Cube::new(4);
    let builder = under(&cube);
    let eye = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.3, -0.4, 1.0));
    let pixels = picture(&builder, CameraConfig::new(&rays), eye);
    // The angle from the axis grows with the distance from the centre.
    let ahead = |index: usize| {
        let [right, down] = [index % 160, index / 160].map(|pixel| (pixel as f64 - 79.5) / 50.0);
        let angle = right.hypot(down);
        let aside = angle.sin() / angle;
        eye.rotation() * DVec3::new(angle.cos(), -right * aside, -down * aside)
    };
    assert_eq!(compare_sky(&cube, &pixels, ahead), 0b11_1111);
}

#[test]
fn fine_texels_of_the_sky_become_their_mean() {
    let checks = |i: u32| if (i + i / 512).is_multiple_of(2) { [0, 0, 255, 0] } else { [255, 0, 255, 0] };
    let cube = Cube { size: 512, texels: (0..6 * 512 * 512).map(checks).collect() };
    let pixels = picture(&under(&cube), camera_of([64, 48], 1.8), Pose::IDENTITY);
    for pixel in pixels.as_chunks::<3>().0 {
        assert!(pixel[0].abs_diff(128) < 3 && pixel[1..] == [0, 255], "{pixel:?}");
    }
}

/// The direction that a point of a shape has in its cube.
fn in_cube(shape: &Shape, point: DVec3) -> DVec3 {
    match *shape {
        Shape::Box { size } => point / (DVec3::from_array(size) / 2.0),
        Shape::Rectangle { size } => point / DVec3::new(size[0] / 2.0, size[1] / 2.0, 1.0),
        Shape::Sphere { radius } => point / radius,
        Shape::Ellipsoid { radii } => point / DVec3::from_array(radii),
        Shape::Cylinder { radius, length } | Shape::Cone { radius, length } => {
            point / DVec3::new(radius, radius, length / 2.0)
        }
        Shape::Capsule { radius, length } => {
            let along = point.z.clamp(-length / 2.0, length / 2.0);
            DVec3::new(
                point.x / radius,
                point.y / radius,
                along / (length / 2.0) + (point.z - along) / radius,
            )
        }
        _ => point,
    }
}

/// Compares a picture of a shape with the oracle where it is not seen at a glancing angle. `at` converts a point along
/// the axes of the shape to a direction in the cube.
fn compare_shape(
    cube: &Cube,
    pixels: &[u8],
    eye: &Pose,
    (shape, pose): (&Shape, &Pose),
    at: impl Fn(DVec3) -> DVec3,
) {
    let mut seen = 0;
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let ray = pixel_ray(&camera(), eye, index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let Some((t, normal)) = first_surface(shape, pose, DVec3::ONE, &ray, 0.0, false) else { continue };
        let Ray { origin, direction } = ray;
        if normal.dot(direction.normalize()) > -0.3 {
            continue;
        }
        let place = at(pose.inverse().transform_point(origin + direction * t));
        // Around the origin of a rectangle, a pixel sees many texels.
        if place.length() < 0.3 {
            continue;
        }
        let expected = cube.colour(place);
        assert!(near(*pixel, expected), "pixel {index} of {shape:?} is {pixel:?}, should be {expected:?}");
        seen += 1;
    }
    assert!(seen > 500, "{shape:?} has {seen} pixels");
}

#[test]
fn shapes_show_the_faces_of_a_cube() {
    let cube = Cube::new(3);
    let shapes = [
        Shape::Box { size: [0.8, 1.2, 0.6] },
        Shape::Rectangle { size: [1.4, 1.0] },
        Shape::Sphere { radius: 0.6 },
        Shape::Ellipsoid { radii: [0.6, 0.4, 0.8] },
        Shape::Cylinder { radius: 0.5, length: 0.8 },
        Shape::Capsule { radius: 0.4, length: 0.7 },
        Shape::Cone { radius: 0.6, length: 1.0 },
    ];
    for (number, shape) in shapes.iter().enumerate() {
        for mode in [TextureMode::Reflectance, TextureMode::Light] {
            for (stretch, half_way_up) in [([1.0; 3], 1.6), ([1.3, 0.7, 2.0], 2.2)] {
                let mut builder = under(&Cube::new(1));
                let texture = cube.add(&mut builder);
                let cube_texture = Some(CubeTexture { texture, stretch });
                let look = MaterialConfig {
                    ambient: [1.0; 3],
                    diffuse: [0.0; 3],
                    cube_texture,
                    texture_mode: mode,
                    ..Default::default()
                };
                let material = builder.add_material(&look).unwrap();
                let turn = DVec3::new(0.2, 0.3, number as f64 * TAU / 7.0);
                let pose = Pose::from_xyz_rpy(DVec3::new(0.4, -0.2, 0.1), turn);
                add(&mut builder, *shape, pose, material);
                let eye = look_at(DVec3::new(-1.6, 0.3, half_way_up), pose.translation(), 0.1);
                let pixels = picture(&builder, camera(), eye);
                let factors = DVec3::from_array(stretch.map(f64::from));
                compare_shape(&cube, &pixels, &eye, (shape, &pose), |point| in_cube(shape, point) * factors);
                // Baked, it is the same.
                let baked = builder.bake();
                let (scene, _) = Scene::from_baked(bytemuck::cast_slice(&baked)).unwrap();
                assert_eq!(scene.air(), builder.scene().air());
                assert!(picture((scene, builder.poses()), camera(), eye) == pixels);
            }
        }
    }
}

/// Points of a mesh are not stretched, but by its scale: here a square beside the origin of its own axes.
#[test]
fn meshes_show_the_faces_of_a_cube() {
    let cube = Cube::new(3);
    let mut builder = under(&Cube::new(1));
    let cube_texture = Some(CubeTexture::new(cube.add(&mut builder)));
    let look = MaterialConfig { ambient: [1.0; 3], diffuse: [0.0; 3], cube_texture, ..Default::default() };
    let material = builder.add_material(&look).unwrap();
    let corners = [[-0.5, -0.5, 0.3], [0.5, -0.5, 0.3], [0.5, 0.5, 0.3], [-0.5, 0.5, 0.3]];
    let mesh = builder.add_mesh(&corners, &[], &[[0, 1, 2], [0, 2, 3]]).unwrap();
    builder
        .add_instance(&InstanceConfig {
            shape: Shape::Mesh(mesh),
            scale: [2.0; 3],
            material,
            ..Default::default()
        })
        .unwrap();
    let eye = look_at(DVec3::new(-1.0, 0.3, 2.0), DVec3::Z * 0.6, 0.1);
    let pixels = picture(&builder, camera(), eye);
    let square = (&Shape::Rectangle { size: [2.0; 2] }, &Pose::from_translation(DVec3::Z * 0.6));
    compare_shape(&cube, &pixels, &eye, square, |point| DVec3::new(point.x, point.y, 0.6));
}

/// The texture of coordinates and that of the cube are multiplied; emitted light has neither of them, unless all light
/// has.
#[test]
fn a_cube_is_multiplied_by_the_other_texture() {
    for (mode, emitted) in [(TextureMode::Reflectance, [20, 20, 20]), (TextureMode::Light, [10, 5, 2])] {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
        let cube = builder.add_cube_texture(1, &[[255, 128, 64, 255]; 6]).unwrap();
        let look = MaterialConfig {
            ambient: [0.5; 3],
            emissive: [20.0 / 255.0; 3],
            texture: Some(builder.add_texture(1, 1, &[[128, 128, 128, 255]]).unwrap()),
            cube_texture: Some(CubeTexture::new(cube)),
            texture_mode: mode,
            ..Default::default()
        };
        let material = builder.add_material(&look).unwrap();
        add(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::from_translation(DVec3::X * 2.0), material);
        let pixels = picture(&builder, camera(), Pose::IDENTITY);
        let pixel = pixels.as_chunks::<3>().0[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize];
        for ((value, own), emitted) in pixel.iter().zip([64, 32, 16]).zip(emitted) {
            assert!(value.abs_diff(own + emitted) <= 1, "{pixel:?} {mode:?}");
        }
    }
}

#[test]
fn what_is_no_cube_is_refused() {
    let mut builder = SceneBuilder::new();
    for (size, texels) in [(0, 0), (2, 23), (2, 25), (2, 4), (3, 6 * 4), (u32::MAX, 6)] {
        assert_eq!(builder.add_cube_texture(size, &vec![[0; 4]; texels]), Err(SceneError::BadCube), "{size}");
    }
    let image = builder.add_texture(1, 1, &[[9; 4]]).unwrap();
    let cube = builder.add_cube_texture(2, &[[9; 4]; 24]).unwrap();
    let sky = |texture| Air { sky: Some(Sky::Cube(texture)), fog: None };
    assert_eq!(builder.set_air(sky(image)), Err(SceneError::WrongTexture(0)));
    assert_eq!(builder.set_air(sky(TextureId(7))), Err(SceneError::NoSuchTexture(7)));
    assert_eq!(builder.set_texture(cube, 1, 1, &[[0; 4]]), Err(SceneError::WrongTexture(1)));
    let wrong = [
        MaterialConfig { texture: Some(cube), ..Default::default() },
        MaterialConfig { normal_map: Some(cube), ..Default::default() },
        MaterialConfig { emissive_map: Some(cube), ..Default::default() },
    ];
    for config in wrong {
        assert_eq!(builder.add_material(&config), Err(SceneError::WrongTexture(1)));
    }
    let of = |texture, stretch| MaterialConfig {
        cube_texture: Some(CubeTexture { texture, stretch }),
        ..Default::default()
    };
    assert_eq!(builder.add_material(&of(image, [1.0; 3])), Err(SceneError::WrongTexture(0)));
    assert_eq!(builder.add_material(&of(cube, [1.0, f32::NAN, 1.0])), Err(SceneError::BadTextureRepeat));

    // It is in use until the sky is another.
    builder.set_air(sky(cube)).unwrap();
    let used = Err(SceneError::InUse { user: "sky", index: 0 });
    assert_eq!(builder.remove_texture(cube), used);
    builder.set_air(sky(cube)).unwrap();
    assert_eq!(builder.remove_texture(cube), used);
    builder.set_air(Air::default()).unwrap();
    let material = builder.add_material(&of(cube, [1.0; 3])).unwrap();
    assert_eq!(builder.remove_texture(cube), Err(SceneError::InUse { user: "material", index: 0 }));
    builder.remove_material(material).unwrap();
    builder.remove_texture(cube).unwrap();
}
