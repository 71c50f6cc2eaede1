//! Meshes with a normal per vertex: they are lit as the round body that they stand for, and remain triangles otherwise.

use crate::common::oracle::pixel_ray;
use crate::common::{add, camera_of, depth_camera, look_at, picture};
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthFrame};
use belvedere_sensors::scene::{
    Environment, InstanceConfig, InstanceId, LightConfig, LightId, LightKind, MaterialConfig, MeshId, Pbr,
    SceneBuilder, SceneError, Shape, TextureId,
};
use belvedere_sensors::trace::{Faces, Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;
use std::collections::HashMap;

const TOWARDS_LAMP: DVec3 = DVec3::new(-0.5, 0.4, 0.6);
const EYE: DVec3 = DVec3::new(-4.0, 0.5, 1.0);

/// A ball of radius 1 around the origin: an icosahedron, each of whose faces is divided into 4 to the power of
/// `times` triangles. Its corners are also its normals.
fn ball(times: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let golden = f64::midpoint(1.0, 5_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let mut faces = Vec::new();
    for a in 0..12_u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|corner| corners[corner as usize]);
                let near = |p: DVec3, q: DVec3| p.distance(q) < 2.1;
                if near(p, q) && near(q, r) && near(r, p) {
                    faces.push(if (q - p).cross(r - p).dot(p) > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    for _ in 0..times {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push(corners[a as usize].normalize() + corners[b as usize].normalize());
                corners.len() as u32 - 1
            })
        };
        let divide = |[a, b, c]: [u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(divide).collect();
    }
    (corners.iter().map(|corner| corner.normalize().as_vec3().to_array()).collect(), faces)
}

/// A white ball in the light of a distant lamp.
fn stage(normals: impl Fn(&[f32; 3]) -> [f32; 3], smooth: bool, look: &MaterialConfig) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
    let (corners, faces) = ball(3);
    let uvs: Vec<[f32; 2]> = corners.iter().map(|[x, y, _]| [*x, *y]).collect();
    let mesh = builder.add_mesh(&corners, &uvs, &faces).unwrap();
    if smooth {
        let normals: Vec<_> = corners.iter().map(normals).collect();
        builder.set_mesh_normals(mesh, &normals).unwrap();
    }
    let outwards = [[128, 128, 255, 255]];
    if look.normal_map.is_some() {
        builder.add_normal_map(1, 1, &outwards).unwrap();
    } else if look.texture.is_some() {
        builder.add_texture(1, 1, &outwards).unwrap();
    }
    let material = builder.add_material(look).unwrap();
    add(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY, material);
    let kind = LightKind::Directional { direction: (-TOWARDS_LAMP).to_array() };
    builder.add_light(&LightConfig { kind, diffuse: [1.0; 3], ..LightConfig::default() }).unwrap();
    builder
}

fn white() -> MaterialConfig {
    MaterialConfig { diffuse: [1.0; 3], ..MaterialConfig::default() }
}

fn camera() -> CameraConfig<'static> {
    camera_of([320, 240], 0.7)
}

fn view() -> Pose {
    look_at(EYE, DVec3::ZERO, 0.0)
}

/// For each pixel well inside the silhouette of the ball, the point of the ball that it sees.
fn points() -> Vec<(usize, DVec3)> {
    let mut points = Vec::new();
    for index in 0..320 * 240 {
        let ray = pixel_ray(&camera(), &view(), index as u32 % 320, index as u32 / 320);
        let direction = ray.direction.normalize();
        let along = -EYE.dot(direction);
        let under = 1.0 - (EYE.length_squared() - along * along);
        // The cosine between the ray and the normal.
        if under > 0.3 * 0.3 {
            points.push((index, EYE + direction * (along - under.sqrt())));
        }
    }
    assert!(points.len() > 20_000, "{}", points.len());
    points
}

/// The greatest difference between a picture's brightness and Lambert's law on the ball, of 255.
fn worst(pixels: &[u8], sign: f64) -> f64 {
    let to_lamp = TOWARDS_LAMP.normalize() * sign;
    let error = |(index, point): (usize, DVec3)| {
        let expected = 255.0 * point.normalize().dot(to_lamp).max(0.0);
        (f64::from(pixels[3 * index]) - expected).abs()
    };
    points().into_iter().map(error).fold(0.0, f64::max)
}

#[test]
fn a_coarse_ball_is_lit_as_a_round_one() {
    let smooth = stage(|corner| *corner, true, &white());
    let flat = stage(|corner| *corner, false, &white());
    let (smooth, flat) = (picture(&smooth, camera(), view()), picture(&flat, camera(), view()));
    // Triangles lie up to 0.004 below the ball: seen at a low angle, at another place of it.
    assert!(worst(&smooth, 1.0) < 4.0, "{}", worst(&smooth, 1.0));
    assert!(worst(&flat, 1.0) > 15.0, "{}", worst(&flat, 1.0));
    // What is seen of the ball stays the same.
    let lit = |pixels: &[u8]| pixels.iter().filter(|value| **value > 60).count();
    assert!(lit(&smooth).abs_diff(lit(&flat)) < lit(&flat) / 50);
}

#[test]
fn normals_of_any_length_are_the_same() {
    let expected = picture(&stage(|corner| *corner, true, &white()), camera(), view());
    for length in [1e-37_f32, 1e-3, 3.0, 1e37] {
        let long = stage(|corner| corner.map(|x| x * length), true, &white());
        let pixels = picture(&long, camera(), view());
        let most = pixels.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{length}: {most:?}");
    }
}

#[test]
fn textures_and_maps_follow_the_interpolated_normals() {
    let plain = picture(&stage(|corner| *corner, true, &white()), camera(), view());
    // A map that points straight outwards, in blue of 255: nearly (0, 0, 1).
    let normal_map = Some(TextureId(0));
    let bumpy =
        picture(&stage(|corner| *corner, true, &MaterialConfig { normal_map, ..white() }), camera(), view());
    assert!(worst(&bumpy, 1.0) < 6.0, "{}", worst(&bumpy, 1.0));
    let texture = Some(TextureId(0));
    let textured =
        picture(&stage(|corner| *corner, true, &MaterialConfig { texture, ..white() }), camera(), view());
    for (textured, plain) in textured.chunks_exact(3).zip(plain.chunks_exact(3)) {
        assert!(textured[2].abs_diff(plain[2]) <= 1, "{textured:?} {plain:?}");
    }
    // The highlight of a smooth ball is where it would be on a sphere.
    let pbr = Some(Pbr { roughness: 0.3, metalness: 0.0, highlights: [1.0; 3] });
    let shiny = stage(|corner| *corner, true, &MaterialConfig { pbr, ..white() });
    let mut round = stage(|corner| *corner, true, &MaterialConfig { pbr, ..white() });
    let sphere = InstanceConfig { shape: Shape::Sphere { radius: 1.0 }, ..InstanceConfig::default() };
    round.set_instance(InstanceId(0), &sphere).unwrap();
    let (shiny, round) = (picture(&shiny, camera(), view()), picture(&round, camera(), view()));
    for (index, _) in points() {
        assert!(shiny[3 * index].abs_diff(round[3 * index]) <= 8, "pixel {index}");
    }
}

#[test]
fn the_inside_is_lit_with_its_normals_reversed() {
    let mut builder = stage(|corner| *corner, true, &white());
    // Turned inside out by its winding: the camera sees the back of the near side.
    let (corners, faces) = ball(3);
    let faces: Vec<_> = faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let inwards: Vec<_> = corners.iter().map(|corner| corner.map(|x| -x)).collect();
    builder.set_mesh(MeshId(0), &corners, &[], &faces).unwrap();
    builder.set_mesh_normals(MeshId(0), &inwards).unwrap();
    let pixels = picture(&builder, camera().faces(Faces::Both), view());
    assert!(worst(&pixels, 1.0) < 4.0, "{}", worst(&pixels, 1.0));
}

#[test]
fn a_stretched_and_mirrored_ball_has_the_normals_of_an_ellipsoid() {
    let scale = [-1.0, 0.6, 1.3];
    let light = |shape: Shape, scale: [f64; 3]| {
        let mut builder = stage(|corner| *corner, true, &white());
        let config = InstanceConfig { shape, scale, ..InstanceConfig::default() };
        builder.set_instance(InstanceId(0), &config).unwrap();
        picture(&builder, camera(), view())
    };
    let mesh = light(Shape::Mesh(MeshId(0)), scale);
    let round = light(Shape::Ellipsoid { radii: [1.0, 0.6, 1.3] }, [1.0; 3]);
    let pairs = mesh.iter().zip(&round).filter(|(a, b)| **a > 0 && **b > 0);
    let differing = pairs.clone().filter(|(a, b)| a.abs_diff(**b) > 4).count();
    assert!(pairs.clone().count() > 40_000);
    // At the silhouette, the triangles lie farther beneath the ellipsoid.
    assert!(differing < pairs.count() / 50, "{differing}");
}

#[test]
fn geometry_stays_that_of_the_triangles() {
    let truth = |builder: &SceneBuilder| {
        let sensor = DepthCamera::new(depth_camera().camera(camera())).unwrap();
        let count = sensor.pixels();
        let (mut depth, mut normal) = (vec![0.0_f32; count], vec![[0.0_f32; 3]; count]);
        let (mut incidence, mut metres) = (vec![0.0_f32; count], vec![0.0_f32; count]);
        let truth = Truth::new().depth(&mut depth).normal(&mut normal).incidence(&mut incidence);
        let frame = DepthFrame::new().depth_32fc1(&mut metres).truth(truth);
        let capture = Capture::new(1, builder.moment(view()));
        sensor.sense_in(&mut WorkspaceBuf::default(), &builder.scene(), &capture, frame).unwrap();
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        [bits(&depth), bits(normal.as_flattened()), bits(&incidence), bits(&metres)]
    };
    let [smooth, flat] = [true, false].map(|smooth| truth(&stage(|corner| *corner, smooth, &white())));
    assert!(smooth == flat);
}

#[test]
fn shadows_start_at_the_triangles() {
    let lit = |smooth: bool, brightness: f32| {
        let mut builder = stage(|corner| *corner, smooth, &white());
        let kind = LightKind::Directional { direction: (-TOWARDS_LAMP).to_array() };
        let lamp =
            LightConfig { kind, diffuse: [brightness; 3], cast_shadows: true, ..LightConfig::default() };
        builder.set_light(LightId(0), &lamp).unwrap();
        picture(&builder, camera(), view())
    };
    // Bright enough that triangles on which the light falls at the lowest angle are not black.
    let (smooth, flat) = (lit(true, 1.0), lit(false, 1e5));
    let (mut dark, mut at_edges) = (0, 0);
    for (index, point) in points() {
        let [smooth, flat] = [&smooth, &flat].map(|pixels| pixels[3 * index]);
        // Triangles that face away are in the ball's own shadow. Elsewhere the light is that of the ball.
        if flat == 0 {
            dark += 1;
            at_edges += usize::from(smooth != 0);
        } else {
            let expected = 255.0 * point.normalize().dot(TOWARDS_LAMP.normalize()).max(0.0);
            assert!((f64::from(smooth) - expected).abs() < 4.0, "at {point}: {smooth}");
        }
    }
    // Points are lifted from their triangle by a millionth, so light passes over its very edge.
    assert!(dark > 500 && at_edges < 5, "{dark} {at_edges}");
}

#[test]
fn normals_come_and_go() {
    let mut builder = stage(|corner| *corner, false, &white());
    let flat = picture(&builder, camera(), view());
    let memory = builder.memory_len();
    let (corners, faces) = ball(3);
    let mesh = MeshId(0);
    builder.set_mesh_normals(mesh, &corners).unwrap();
    assert_eq!(builder.memory_len(), memory + size_of_val(&corners[..]));
    let smooth = picture(&builder, camera(), view());
    assert!(smooth != flat);
    // A mesh that is added later is flat, and leaves the others as they are.
    let other = builder.add_mesh(&corners, &[], &faces).unwrap();
    assert!(picture(&builder, camera(), view()) == smooth);
    builder.set_mesh_normals(mesh, &[]).unwrap();
    assert!(picture(&builder, camera(), view()) == flat);
    builder.set_mesh_normals(mesh, &corners).unwrap();
    builder.remove_mesh(other).unwrap();
    assert!(picture(&builder, camera(), view()) == smooth);
    builder.set_mesh(mesh, &corners, &[], &faces).unwrap();
    assert!(picture(&builder, camera(), view()) == flat);
}

#[test]
fn bad_normals_are_refused() {
    let mut builder = stage(|corner| *corner, false, &white());
    let (corners, _) = ball(3);
    let mesh = MeshId(0);
    builder.set_mesh_normals(mesh, &corners).unwrap();
    let smooth = picture(&builder, camera(), view());
    assert_eq!(builder.set_mesh_normals(MeshId(7), &[]), Err(SceneError::NoSuchMesh(7)));
    assert_eq!(builder.set_mesh_normals(mesh, &corners[1..]), Err(SceneError::NormalCount));
    for bad in [[0.0; 3], [f32::NAN, 0.0, 1.0], [1.0, f32::INFINITY, 0.0]] {
        let mut normals = corners.clone();
        normals[3] = bad;
        assert_eq!(builder.set_mesh_normals(mesh, &normals), Err(SceneError::BadNormal(3)));
    }
    assert_eq!(SceneError::NormalCount.to_string(), "normals must be none or one per vertex");
    assert_eq!(SceneError::BadNormal(3).to_string(), "the normal of vertex 3 is not finite, or is 0");
    assert!(picture(&builder, camera(), view()) == smooth, "a refused call changes nothing");
    // Between opposite normals there is no direction: the triangle's own normal counts, and nothing panics.
    let sign = |index: usize| if index.is_multiple_of(2) { 1.0 } else { -1.0 };
    let opposite = corners.iter().enumerate().map(|(index, corner)| corner.map(|x| x * sign(index)));
    let opposite: Vec<_> = opposite.collect();
    builder.set_mesh_normals(mesh, &opposite).unwrap();
    picture(&builder, camera(), view());
}
