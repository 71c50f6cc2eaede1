//! Lit surfaces against the formula, and the positions of shadows.

use crate::common;

use crate::common::oracle::{Ray, first_hit, pixel_ray, scaled};
use crate::common::{SIZE, add, camera, look_at, picture, spot};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{Environment, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape};
use glam::DVec3;

const DIFFUSE: [f32; 3] = [0.9, 0.6, 0.3];
const AMBIENT: [f32; 3] = [0.1, 0.2, 0.3];
const EMISSIVE: [f32; 3] = [0.02, 0.0, 0.05];
const LAMP: [f32; 3] = [0.8, 0.7, 0.6];
const LAMP_AT: DVec3 = DVec3::new(0.5, -0.3, 2.0);

const FLOOR: Shape = Shape::Rectangle { size: [20.0, 20.0] };
const OBSTACLE: Shape = Shape::Box { size: [0.5, 0.3, 0.2] };

fn obstacle_pose() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(0.2, 0.4, 0.8), DVec3::new(0.2, 0.1, 0.5))
}

fn view() -> Pose {
    look_at(DVec3::new(-2.0, -0.5, 2.5), DVec3::new(0.3, 0.0, 0.0), 0.1)
}

/// The floor, optionally with the obstacle above it, in the light of one lamp.
fn scene(light: &LightConfig, obstacle: bool) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.4; 3], background: [0.0; 3] });
    let config = MaterialConfig {
        diffuse: DIFFUSE,
        ambient: AMBIENT,
        emissive: EMISSIVE,
        ..MaterialConfig::default()
    };
    let material = builder.add_material(&config).unwrap();
    add(&mut builder, FLOOR, Pose::IDENTITY, material);
    if obstacle {
        add(&mut builder, OBSTACLE, obstacle_pose(), material);
    }
    builder.add_light(light).unwrap();
    builder
}

fn lamp(kind: LightKind) -> LightConfig {
    let attenuation = [0.8, 0.1, 0.2];
    LightConfig {
        kind,
        diffuse: LAMP,
        range_m: 3.5,
        attenuation,
        cast_shadows: true,
        ..LightConfig::default()
    }
}

fn point() -> LightConfig {
    lamp(LightKind::Point { position: LAMP_AT.to_array() })
}

/// The pixel's colour for this brightness of its lamp.
fn colour(brightness: f64) -> [f64; 3] {
    core::array::from_fn(|channel| {
        let lit = f64::from(DIFFUSE[channel]) * f64::from(LAMP[channel]) * brightness;
        255.0 * (f64::from(EMISSIVE[channel]) + f64::from(AMBIENT[channel]) * 0.4 + lit).min(1.0)
    })
}

/// 1/(0.8 + 0.1 d + 0.2 d²), at most 1.
fn attenuation(distance: f64) -> f64 {
    (1.0 / (0.8 + 0.1 * distance + 0.2 * distance * distance)).min(1.0)
}

/// Compares every pixel of the floor with the formula; `None` where either result is correct.
fn check(builder: &SceneBuilder, brightness: impl Fn(DVec3) -> Option<f64>) {
    let pixels = picture(builder, camera(), view());
    let (mut compared, mut skipped) = (0, 0);
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let ray = pixel_ray(&camera(), &view(), index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let blocked = first_hit(&scaled(&OBSTACLE, 1.001), &obstacle_pose(), &ray, 0.0, false).is_some();
        let floor = first_hit(&FLOOR, &Pose::IDENTITY, &ray, 0.0, false);
        let (false, Some(t)) = (blocked && builder.scene().instances().len() > 1, floor) else { continue };
        let point = ray.origin + ray.direction * t;
        let Some(brightness) = brightness(point) else {
            skipped += 1;
            continue;
        };
        for (channel, expected) in pixel.iter().zip(colour(brightness)) {
            let error = (f64::from(*channel) - expected).abs();
            assert!(error < 0.51, "{pixel:?} at {point}, should be {:?}", colour(brightness));
        }
        compared += 1;
    }
    assert!(compared > 200_000 && skipped < 500, "{compared} pixels compared, {skipped} on edges");
}

#[test]
fn a_point_light() {
    check(&scene(&point(), false), |at| {
        let to_lamp = LAMP_AT - at;
        let distance = to_lamp.length();
        ((distance - 3.5).abs() > 1e-5)
            .then(|| if distance < 3.5 { to_lamp.z / distance * attenuation(distance) } else { 0.0 })
    });
}

#[test]
fn a_directional_light() {
    let direction = DVec3::new(1.0, -2.0, -3.0);
    let light = lamp(LightKind::Directional { direction: direction.to_array() });
    check(&scene(&light, false), |_| Some(3.0 / direction.length()));
}

#[test]
fn a_spot_light() {
    let axis = DVec3::new(0.2, 0.3, -1.0);
    let (cos_inner, cos_outer) = (0.95, 0.8);
    let kind = spot(LAMP_AT.to_array(), axis, [cos_inner, cos_outer, 1.0]);
    check(&scene(&LightConfig { range_m: f32::INFINITY, ..lamp(kind) }, false), |at| {
        let to_lamp = LAMP_AT - at;
        let distance = to_lamp.length();
        let cos = -axis.normalize().dot(to_lamp) / distance;
        let (inner, outer) = (f64::from(cos_inner), f64::from(cos_outer));
        let cone = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        Some(to_lamp.z / distance * attenuation(distance) * cone)
    });
}

/// Whether the obstacle is on the ray before t = 1; `None` within a thousandth of its edge.
fn in_shadow(ray: &Ray) -> Option<bool> {
    let meets = |factor| {
        first_hit(&scaled(&OBSTACLE, factor), &obstacle_pose(), ray, 0.0, true).is_some_and(|t| t < 1.0)
    };
    (meets(0.999) == meets(1.001)).then(|| meets(1.0))
}

#[test]
fn the_shadow_of_a_box() {
    check(&scene(&LightConfig { range_m: 50.0, ..point() }, true), |at| {
        let to_lamp = LAMP_AT - at;
        let shadow = in_shadow(&Ray { origin: LAMP_AT, direction: -to_lamp })?;
        let distance = to_lamp.length();
        Some(if shadow { 0.0 } else { to_lamp.z / distance * attenuation(distance) })
    });
    let direction = DVec3::new(0.5, -0.4, -1.0);
    let light = lamp(LightKind::Directional { direction: direction.to_array() });
    check(&scene(&light, true), |at| {
        let shadow = in_shadow(&Ray { origin: at, direction: direction * -100.0 })?;
        Some(if shadow { 0.0 } else { 1.0 / direction.length() })
    });
    check(&scene(&LightConfig { cast_shadows: false, ..light }, true), |_| Some(1.0 / direction.length()));
}

#[test]
fn a_lamp_shines_out_of_its_bulb() {
    let with_bulb = |bulb: Option<Shape>| {
        let mut builder = scene(&point(), false);
        if let Some(bulb) = bulb {
            let glass = common::glowing(&mut builder, [1.0; 3]);
            add(&mut builder, bulb, Pose::from_translation(LAMP_AT), glass);
        }
        // From a position at which the bulb is not visible.
        picture(&builder, camera(), look_at(DVec3::new(-2.0, -0.5, 1.0), DVec3::new(-1.0, 0.0, 0.0), 0.0))
    };
    let bare = with_bulb(None);
    for bulb in [
        Shape::Sphere { radius: 0.1 },
        Shape::Box { size: [0.1; 3] },
        Shape::Cylinder { radius: 0.1, length: 0.2 },
        Shape::Capsule { radius: 0.1, length: 0.2 },
    ] {
        assert!(with_bulb(Some(bulb)) == bare, "{bulb:?}");
    }
}

#[test]
fn a_lamp_in_the_floor_gives_no_light() {
    let on_floor = LightKind::Point { position: [0.3, 0.0, 0.0] };
    let pixels = picture(&scene(&lamp(on_floor), false), camera().far_m(3.0), view());
    let dark = colour(0.0).map(|channel| channel.round() as u8);
    assert!(pixels.as_chunks::<3>().0.iter().all(|pixel| *pixel == dark || *pixel == [0; 3]));
}

#[test]
fn a_mesh_shadows_itself() {
    // Two squares in one mesh: the floor, and above its middle a plate that the lamp sees from above.
    let square = |half: f32, z: f32| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let corners = [square(2.0, 0.0), square(0.3, 1.0)].concat();
    let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let mut builder = SceneBuilder::new();
    let white = MaterialConfig { diffuse: [1.0; 3], ambient: [0.0; 3], ..MaterialConfig::default() };
    let white = builder.add_material(&white).unwrap();
    let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
    add(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY, white);
    builder
        .add_light(&LightConfig { range_m: 10.0, ..lamp(LightKind::Point { position: [0.0, 0.0, 2.0] }) })
        .unwrap();
    for (target, lit) in [(DVec3::ZERO, false), (DVec3::Y * 0.5, false), (DVec3::Y * 0.7, true)] {
        let pixels = picture(&builder, camera(), look_at(DVec3::new(-1.5, 0.0, 0.5), target, 0.0));
        let middle = pixels[(240 * 640 + 320) * 3];
        assert_eq!(middle > 50, lit, "{target} is {middle}");
        assert!(lit || middle == 0);
    }
}
