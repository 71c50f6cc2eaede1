//! Textures that are multiplied by all light of a surface, against the formula in f64.

use crate::common::oracle::{Ray, first_hit, pixel_ray};
use crate::common::{add, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{
    Environment, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape, TextureAlpha, TextureMode,
};
use glam::DVec3;

const SIZE: [u32; 2] = [160, 120];
const FLOOR: Shape = Shape::Rectangle { size: [20.0, 20.0] };
const BALL_AT: DVec3 = DVec3::new(0.3, 0.2, 0.6);
const LAMP_AT: DVec3 = DVec3::new(0.5, -0.3, 2.0);
/// The directions of the light of two lamps, of which the second casts shadows.
const SUNS: [DVec3; 2] = [DVec3::new(0.4, 0.1, -0.9), DVec3::new(0.2, -0.5, -0.8)];
const TEXEL: [u8; 3] = [250, 120, 30];

const FLOOR_LOOK: MaterialConfig = MaterialConfig {
    diffuse: [0.9, 0.7, 0.5],
    ambient: [0.9, 0.7, 0.5],
    emissive: [0.05, 0.1, 0.15],
    specular: [0.6; 3],
    shininess: 12.0,
    pbr: None,
    alpha: 1.0,
    texture_alpha: TextureAlpha::Ignored,
    specular_reflectance: 0.0,
    transmittance: 0.0,
    normal_map: None,
    pbr_map: None,
    emissive_map: None,
    texture: None,
    cube_texture: None,
    texture_mode: TextureMode::Light,
    texture_repeat: [1.0; 2],
};
const AMBIENT: f32 = 0.3;

fn lamps() -> [LightConfig; 3] {
    let specular = [0.8; 3];
    let [plain, shadowing] = SUNS.map(|sun| LightKind::Directional { direction: sun.to_array() });
    [
        LightConfig {
            kind: shadowing,
            diffuse: [1.2; 3],
            specular,
            cast_shadows: true,
            ..Default::default()
        },
        LightConfig { kind: plain, diffuse: [0.5; 3], specular, ..Default::default() },
        LightConfig {
            kind: LightKind::Point { position: LAMP_AT.to_array() },
            diffuse: [0.6; 3],
            specular,
            ..Default::default()
        },
    ]
}

fn view() -> Pose {
    look_at(DVec3::new(-2.0, -0.5, 2.5), DVec3::new(0.3, 0.0, 0.2), 0.1)
}

/// A floor with a texture of one colour, and a ball without a texture.
fn scene(texture_mode: TextureMode) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [AMBIENT; 3], background: [0.0; 3] });
    let [r, g, b] = TEXEL;
    let texture = Some(builder.add_texture(2, 2, &[[r, g, b, 255]; 4]).unwrap());
    let floor = builder.add_material(&MaterialConfig { texture, texture_mode, ..FLOOR_LOOK }).unwrap();
    add(&mut builder, FLOOR, Pose::IDENTITY, floor);
    let ball = builder.add_material(&FLOOR_LOOK).unwrap();
    add(&mut builder, Shape::Sphere { radius: 0.4 }, Pose::from_translation(BALL_AT), ball);
    for lamp in lamps() {
        builder.add_light(&lamp).unwrap();
    }
    builder
}

fn hits_ball(ray: &Ray, radius: f64) -> bool {
    first_hit(&Shape::Sphere { radius }, &Pose::from_translation(BALL_AT), ray, 1e-9, true).is_some()
}

/// The light of a lamp on the bare floor, in one channel.
fn light(lamp: &LightConfig, to_lamp: DVec3, to_sensor: DVec3, channel: usize) -> f64 {
    let middle = (to_lamp + to_sensor).normalize();
    let diffuse = f64::from(FLOOR_LOOK.diffuse[channel] * lamp.diffuse[channel]) * to_lamp.z;
    let specular = f64::from(FLOOR_LOOK.specular[channel] * lamp.specular[channel]);
    diffuse + specular * middle.z.powf(f64::from(FLOOR_LOOK.shininess))
}

#[test]
fn light_is_limited_before_it_is_multiplied_by_the_texture() {
    let pixels = picture(&scene(TextureMode::Light), camera_of(SIZE, 1.2), view());
    let [shadowing, plain, point] = lamps();
    let (mut compared, mut limited, mut shaded) = (0, [0; 2], 0);
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let ray = pixel_ray(&camera_of(SIZE, 1.2), &view(), index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let Some(t) = first_hit(&FLOOR, &Pose::IDENTITY, &ray, 0.0, false) else { continue };
        let at = ray.origin + ray.direction * t;
        let to_shadowing = -SUNS[1].normalize();
        let sun_ray = Ray { origin: at, direction: to_shadowing };
        // Neither the ball nor the edge of its shadow.
        let is_edge = hits_ball(&sun_ray, 0.39) != hits_ball(&sun_ray, 0.41);
        if hits_ball(&ray, 0.41) || is_edge {
            continue;
        }
        compared += 1;
        let to_sensor = -ray.direction.normalize();
        let is_shaded = hits_ball(&sun_ray, 0.4);
        shaded += usize::from(is_shaded);
        for channel in 0..3 {
            let sun = if is_shaded { 0.0 } else { light(&shadowing, to_shadowing, to_sensor, channel) };
            let rest = f64::from(FLOOR_LOOK.emissive[channel] + AMBIENT * FLOOR_LOOK.ambient[channel])
                + light(&plain, -SUNS[0].normalize(), to_sensor, channel)
                + light(&point, (LAMP_AT - at).normalize(), to_sensor, channel);
            for (count, light) in limited.iter_mut().zip([sun, rest]) {
                *count += usize::from(light > 1.05);
            }
            let expected = ((sun.min(1.0) + rest.min(1.0)) * f64::from(TEXEL[channel])).min(255.0);
            let error = (f64::from(pixel[channel]) - expected).abs();
            assert!(
                error < 0.51,
                "pixel {index} is {pixel:?}; {expected:.2} is expected in channel {channel}"
            );
        }
    }
    assert!(compared > 10_000 && limited.iter().all(|&count| count > 1000) && shaded > 300);
}

#[test]
fn other_surfaces_keep_their_bytes() {
    // Tiles at the outline of the ball have lanes of both surfaces.
    let [usual, light] = [TextureMode::Reflectance, TextureMode::Light]
        .map(|mode| picture(&scene(mode), camera_of(SIZE, 1.2), view()));
    let (mut same, mut floor) = (0, 0);
    let rows = usual.as_chunks::<3>().0.iter().zip(light.as_chunks::<3>().0);
    for (index, (usual, light)) in rows.enumerate() {
        let ray = pixel_ray(&camera_of(SIZE, 1.2), &view(), index as u32 % SIZE[0], index as u32 / SIZE[0]);
        if hits_ball(&ray, 0.399) {
            assert_eq!(usual, light, "pixel {index}");
            same += 1;
        } else {
            floor += usize::from(usual != light);
        }
    }
    assert!(same > 500 && floor > 5000, "{same} {floor}");
}
