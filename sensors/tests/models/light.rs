//! Light on surfaces beyond their diffuse colour, against formulas in f64.

use crate::common::oracle::{Ray, first_hit, pixel_ray};
use crate::common::{add, camera_of, glowing, look_at, picture, scenery, spot};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::{CameraConfig, Edges};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
use belvedere_sensors::scene::{
    ColourSpace, Environment, InstanceConfig, LightConfig, LightKind, MaterialConfig, Pbr, SceneBuilder,
    Shape, TextureAlpha, TextureMode,
};
use belvedere_sensors::trace::Faces;
use core::f64::consts::PI;
use glam::DVec3;

const FLOOR: Shape = Shape::Rectangle { size: [20.0, 20.0] };
const BALL: Shape = Shape::Sphere { radius: 0.4 };
const BALL_AT: DVec3 = DVec3::new(0.3, 0.2, 0.6);
const LAMP_AT: DVec3 = DVec3::new(0.5, -0.3, 2.0);
const SIZE: [u32; 2] = [320, 240];

fn camera() -> CameraConfig<'static> {
    camera_of(SIZE, 1.2)
}

fn view() -> Pose {
    look_at(DVec3::new(-2.0, -0.5, 2.5), DVec3::new(0.3, 0.0, 0.2), 0.1)
}

fn ball_pose() -> Pose {
    Pose::from_translation(BALL_AT)
}

/// The point at which a ray hits the floor or the ball, and the normal there.
fn meet(ray: &Ray) -> Option<(DVec3, DVec3)> {
    let at = |t: f64| ray.origin + ray.direction * t;
    let ball = first_hit(&BALL, &ball_pose(), ray, 0.0, false);
    let floor = first_hit(&FLOOR, &Pose::IDENTITY, ray, 0.0, false);
    ball.map(|t| (at(t), (at(t) - BALL_AT).normalize())).or(floor.map(|t| (at(t), DVec3::Z)))
}

/// A floor and a ball of some material, in the light of one lamp, with a black background.
fn floor_and_ball(material: &MaterialConfig, light: &LightConfig) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.4; 3], background: [0.0; 3] });
    let material = builder.add_material(material).unwrap();
    add(&mut builder, FLOOR, Pose::IDENTITY, material);
    add(&mut builder, BALL, ball_pose(), material);
    builder.add_light(light).unwrap();
    builder
}

/// Compares every pixel with the expected light along its ray, as a fraction of full scale; `None` where either result
/// is correct. Returns the number of compared pixels.
fn check(builder: &SceneBuilder, light: impl Fn(&Ray) -> Option<[f64; 3]>) -> usize {
    let (pixels, view) = (picture(builder, camera(), view()), view());
    let mut compared = 0;
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let ray = pixel_ray(&camera(), &view, index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let Some(expected) = light(&ray) else { continue };
        for (value, expected) in pixel.iter().zip(expected) {
            let error = (f64::from(*value) - 255.0 * expected.clamp(0.0, 1.0)).abs();
            assert!(error < 0.51, "pixel {index} is {pixel:?}, should be {:?}", expected * 255.0);
        }
        compared += 1;
    }
    compared
}

/// Whether the ball shades a point that is not on it from a lamp; `None` near the edge of the shadow.
fn in_shadow(point: DVec3, to_lamp: DVec3) -> Option<bool> {
    let ray = Ray { origin: point, direction: to_lamp };
    let blocked = |radius| first_hit(&Shape::Sphere { radius }, &ball_pose(), &ray, 1e-9, true).is_some();
    (blocked(0.399) == blocked(0.401)).then(|| blocked(0.4))
}

#[test]
fn highlights_of_blinn_and_phong() {
    let (specular, lamp_specular) = ([0.5, 0.3, 0.2], [0.9, 0.8, 1.0]);
    let sun = DVec3::new(0.3, -0.2, -1.0);
    for shininess in [1.0, 12.5, 200.0_f32] {
        for kind in [
            LightKind::Point { position: LAMP_AT.to_array() },
            LightKind::Directional { direction: sun.to_array() },
            spot(LAMP_AT.to_array(), -DVec3::Z, [0.9, 0.5, 1.0]),
        ] {
            let parallel = matches!(kind, LightKind::Directional { .. });
            let material = MaterialConfig { diffuse: [0.3; 3], specular, shininess, ..Default::default() };
            let attenuation = [1.0, 0.1, 0.2];
            let light = LightConfig {
                kind,
                diffuse: [0.5; 3],
                specular: lamp_specular,
                attenuation,
                cast_shadows: true,
                ..Default::default()
            };
            let compared = check(&floor_and_ball(&material, &light), |ray| {
                let Some((point, normal)) = meet(ray) else { return Some([0.0; 3]) };
                let way = if parallel { -sun } else { LAMP_AT - point };
                let (to_lamp, distance) = (way.normalize(), way.length());
                let on_ball = (point - BALL_AT).length() < 0.41;
                if !on_ball && in_shadow(point, way)? || normal.dot(to_lamp) <= 0.0 {
                    return Some([0.7 * 0.4; 3]);
                }
                let mut gain =
                    if parallel { 1.0 } else { 1.0 / (1.0 + 0.1 * distance + 0.2 * distance * distance) };
                if matches!(kind, LightKind::Spot { .. }) {
                    gain *= ((to_lamp.z - 0.5) / (f64::from(0.9_f32) - 0.5)).clamp(0.0, 1.0);
                }
                let middle = (to_lamp - ray.direction.normalize()).normalize();
                let highlight = normal.dot(middle).max(0.0).powf(f64::from(shininess)) * gain;
                Some(core::array::from_fn(|channel| {
                    let shine = f64::from(specular[channel]) * f64::from(lamp_specular[channel]) * highlight;
                    0.7 * 0.4 + 0.3 * 0.5 * normal.dot(to_lamp) * gain + shine
                }))
            });
            assert!(compared > 76_000, "{compared}");
        }
    }
    // Without a shininess there is no highlight, as in Gazebo.
    let dull = MaterialConfig { specular, ..Default::default() };
    let light = LightConfig { specular: lamp_specular, ..Default::default() };
    let plain = floor_and_ball(&MaterialConfig::default(), &light);
    assert!(picture(&floor_and_ball(&dull, &light), camera(), view()) == picture(&plain, camera(), view()));
}

/// The formula of Ogre's physically based shader for reflection of unit light, in f64: the light that is scattered by a
/// surface of this base colour, and its highlight.
fn facets(base: f64, pbr: &Pbr, [normal, to_lamp, to_sensor]: [DVec3; 3]) -> [f64; 2] {
    let (roughness, metalness) = (f64::from(pbr.roughness), f64::from(pbr.metalness));
    let middle = (to_lamp + to_sensor).normalize();
    let cos = |one: DVec3, other: DVec3| one.dot(other).clamp(0.0, 1.0);
    let [nl, nv, nh, vh] =
        [cos(normal, to_lamp), cos(normal, to_sensor), cos(normal, middle), cos(to_sensor, middle)];
    let alpha = (roughness * roughness).max(1e-3);
    let distribution = alpha.powi(2) / (PI * (nh * nh * (alpha * alpha - 1.0) + 1.0).powi(2));
    let smith = |from: f64, to: f64| from * (to * to * (1.0 - alpha * alpha) + alpha * alpha).sqrt();
    let visible = 0.5 / (smith(nl, nv) + smith(nv, nl));
    let head_on = 0.04 * (1.0 - metalness) + base * metalness;
    let mirrored = head_on + (1.0 - head_on) * (1.0 - vh).powi(5);
    let bent = roughness * 0.5 + 2.0 * roughness * vh * vh;
    let bend = |cos: f64| 1.0 + (bent - 1.0) * (1.0 - cos).powi(5);
    let lost = 1.0 - roughness + roughness / 1.51;
    let scattered = base * (1.0 - metalness) * (1.0 - mirrored) * lost * bend(nl) * bend(nv);
    [nl * scattered, nl * PI * distribution * visible * mirrored]
}

#[test]
fn facets_of_metal_and_plastic() {
    let lights = (0.5_f32, [0.9, 0.8, 1.0_f32]);
    let sun = DVec3::new(0.3, -0.2, -1.0);
    for (roughness, metalness) in [(0.1, 1.0), (0.1, 0.0), (0.4, 0.5), (1.0, 0.0), (0.0, 0.7)] {
        for kind in [
            LightKind::Point { position: LAMP_AT.to_array() },
            LightKind::Directional { direction: sun.to_array() },
        ] {
            let parallel = matches!(kind, LightKind::Directional { .. });
            // A grey base colour, whose reflectance is the same for each channel.
            let pbr = Pbr { roughness, metalness, highlights: [1.0, 0.5, 0.25] };
            let material = MaterialConfig { diffuse: [0.6; 3], pbr: Some(pbr), ..Default::default() };
            let light =
                LightConfig { kind, diffuse: [lights.0; 3], specular: lights.1, ..Default::default() };
            let compared = check(&floor_and_ball(&material, &light), |ray| {
                let Some((point, normal)) = meet(ray) else { return Some([0.0; 3]) };
                let to_lamp = if parallel { -sun } else { LAMP_AT - point }.normalize();
                let [scattered, highlight] =
                    facets(f64::from(0.6_f32), &pbr, [normal, to_lamp, -ray.direction.normalize()]);
                Some(core::array::from_fn(|channel| {
                    let factor = f64::from(pbr.highlights[channel] * lights.1[channel]);
                    0.7 * 0.4 + f64::from(lights.0) * scattered + factor * highlight
                }))
            });
            assert!(compared > 76_000, "{compared}");
        }
    }
}

#[test]
fn a_smooth_metal_has_a_narrow_highlight_and_nothing_else() {
    let shown = |roughness: f32, metalness: f32| {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
        let pbr = Some(Pbr { roughness, metalness, ..Default::default() });
        let look = MaterialConfig { diffuse: [1.0, 0.5, 0.0], pbr, ..Default::default() };
        let material = builder.add_material(&look).unwrap();
        add(&mut builder, BALL, Pose::IDENTITY, material);
        let kind = LightKind::Directional { direction: [1.0, 0.0, -0.3] };
        let light = LightConfig { kind, specular: [0.1; 3], ..Default::default() };
        builder.add_light(&light).unwrap();
        let pixels = picture(&builder, camera(), Pose::from_translation(DVec3::new(-1.2, 0.0, 0.0)));
        let lit = pixels.as_chunks::<3>().0.iter().filter(|pixel| pixel[0] > 1).count();
        (lit, pixels.as_chunks::<3>().0.iter().map(|&[red, green, blue]| [red, green, blue]).max().unwrap())
    };
    let (metal, brightest) = shown(0.1, 1.0);
    assert_eq!(brightest, [255, 255, 0], "the peak is saturated");
    let (rough, [red, green, blue]) = shown(0.6, 1.0);
    // A highlight has the colour of the metal, but for the gleam at grazing angles.
    assert!(red.abs_diff(2 * green) < 6 && blue < 6, "{red} {green} {blue}");
    let (plastic, _) = shown(0.1, 0.0);
    assert!(metal > 50 && metal * 10 < rough && rough <= plastic, "{metal}, {rough}, {plastic}");
}

/// Under the same light from everywhere, no surface is brighter than the light, up to the 5 % that Lagarde and de
/// Rousiers leave at grazing angles of smooth plastic.
#[test]
fn facets_reflect_no_more_light_than_they_receive() {
    for (roughness, metalness, most) in [
        (0.5, 1.0, 1.0),
        (0.8, 1.0, 1.0),
        (1.0, 1.0, 1.0),
        (0.5, 0.0, 1.05),
        (0.7, 0.5, 1.05),
        (1.0, 0.0, 1.05),
    ] {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
        let pbr = Some(Pbr { roughness, metalness, ..Default::default() });
        let look = MaterialConfig { diffuse: [1.0; 3], pbr, ..Default::default() };
        let material = builder.add_material(&look).unwrap();
        add(&mut builder, FLOOR, Pose::IDENTITY, material);
        // Equal parts of the hemisphere as seen by the floor: equal parts of the disc below it.
        let (rings, sectors) = (24, 48);
        let part = [0.5 / (rings * sectors) as f32; 3];
        for (ring, sector) in (0..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector))) {
            let sin = ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
            let cos = (1.0 - sin * sin).sqrt();
            let (y, x) = (2.0 * PI * (f64::from(sector) + 0.5) / f64::from(sectors)).sin_cos();
            let kind = LightKind::Directional { direction: [-x * sin, -y * sin, -cos] };
            // The light of a part, which the floor receives at an angle.
            let [diffuse, specular] = [part.map(|part| part / cos as f32); 2];
            builder.add_light(&LightConfig { kind, diffuse, specular, ..Default::default() }).unwrap();
        }
        let eye = look_at(DVec3::new(-1.0, 0.0, 1.0), DVec3::ZERO, 0.0);
        let pixels = picture(&builder, camera_of([8, 64], 0.2), eye);
        let brightest = f64::from(*pixels.iter().max().unwrap()) / 127.5;
        assert!(0.5 < brightest && brightest <= most + 0.005, "{roughness} {metalness}: {brightest}");
    }
}

#[test]
fn falloff_of_a_spot() {
    let axis = DVec3::new(0.2, 0.3, -1.0).normalize();
    let (inner, outer) = (0.95_f32, 0.8_f32);
    for falloff in [0.0, 0.3, 1.0, 4.0_f32] {
        let kind = spot(LAMP_AT.to_array(), axis, [inner, outer, falloff]);
        let material = MaterialConfig { diffuse: [0.9; 3], ambient: [0.0; 3], ..Default::default() };
        let compared =
            check(&floor_and_ball(&material, &LightConfig { kind, ..Default::default() }), |ray| {
                let Some((point, normal)) = meet(ray) else { return Some([0.0; 3]) };
                let to_lamp = (LAMP_AT - point).normalize();
                let share = (-axis.dot(to_lamp) - f64::from(outer)) / f64::from(inner - outer);
                // With a small exponent, the light falls off steeply at the rim of the cone.
                if share.abs() < 1e-4 {
                    return None;
                }
                let cone = if share > 0.0 { share.min(1.0).powf(f64::from(falloff)) } else { 0.0 };
                Some([0.9 * normal.dot(to_lamp).max(0.0) * cone; 3])
            });
        assert!(compared > 76_000, "{compared}");
    }
}

/// IEC 61966-2-1.
fn decoded(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn encoded(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[test]
fn linear_light() {
    let (diffuse, ambient, emissive) = ([0.9, 0.5, 0.1], [0.3, 0.6, 0.9], [0.1, 0.0, 0.3]);
    let (specular, shininess) = ([0.4; 3], 20.0);
    let material = MaterialConfig { diffuse, ambient, emissive, specular, shininess, ..Default::default() };
    let kind = LightKind::Point { position: LAMP_AT.to_array() };
    let light = LightConfig { kind, diffuse: [0.8; 3], specular: [0.5; 3], ..Default::default() };
    let mut builder = floor_and_ball(&material, &light);
    builder.set_environment(Environment { ambient: [0.3; 3], background: [0.2, 0.4, 0.6] });
    builder.set_colour_space(ColourSpace::Srgb);
    let in_light = |channel: usize, colour: [f32; 3]| decoded(f64::from(colour[channel]));
    let compared = check(&builder, |ray| {
        let Some((point, normal)) = meet(ray) else { return Some([0.2, 0.4, 0.6]) };
        let to_lamp = (LAMP_AT - point).normalize();
        let facing = normal.dot(to_lamp).max(0.0);
        let middle = (to_lamp - ray.direction.normalize()).normalize();
        let highlight = if facing > 0.0 { normal.dot(middle).max(0.0).powf(20.0) } else { 0.0 };
        Some(core::array::from_fn(|channel| {
            let lit =
                in_light(channel, diffuse) * 0.8 * facing + in_light(channel, specular) * 0.5 * highlight;
            encoded((in_light(channel, emissive) + in_light(channel, ambient) * 0.3 + lit).min(1.0))
        }))
    });
    assert!(compared > 76_000, "{compared}");

    // From afar, a board of black and white squares is as bright as half the light; between two texels, light is
    // interpolated.
    let board = |space: ColourSpace, before: bool| {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
        if before {
            builder.set_colour_space(space);
        }
        let texels: Vec<_> = (0..64).map(|i| [[0, 0, 0, 255], [255; 4]][(i + i / 8) % 2]).collect();
        let texture = Some(builder.add_texture(8, 8, &texels).unwrap());
        let config =
            MaterialConfig { ambient: [1.0; 3], texture, texture_repeat: [30.0; 2], ..Default::default() };
        let material = builder.add_material(&config).unwrap();
        add(&mut builder, FLOOR, Pose::IDENTITY, material);
        builder.set_colour_space(space);
        picture(&builder, camera_of([32, 24], 0.5), look_at(DVec3::Z * 15.0, DVec3::X * 0.1, 0.0))
    };
    assert!(board(ColourSpace::Srgb, true) == board(ColourSpace::Srgb, false));
    let all_near =
        |pixels: &[u8], value: f64| pixels.iter().all(|&pixel| (f64::from(pixel) - value).abs() <= 2.0);
    assert!(all_near(&board(ColourSpace::Srgb, true), 255.0 * encoded(0.5)));
    assert!(all_near(&board(ColourSpace::AsGiven, false), 127.5));
}

/// A material that emits light, with an alpha.
fn pane(colour: [f32; 3], alpha: f32) -> MaterialConfig {
    MaterialConfig { emissive: colour, diffuse: [0.0; 3], ambient: [0.0; 3], alpha, ..Default::default() }
}

/// Adds a square that faces −x at this distance from the origin, and returns its material.
fn add_square(builder: &mut SceneBuilder, at: f64, side: f64, config: &MaterialConfig) {
    let material = builder.add_material(config).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::X * at, DVec3::new(0.0, -core::f64::consts::FRAC_PI_2, 0.0));
    add(builder, Shape::Rectangle { size: [side; 2] }, pose, material);
}

#[test]
fn panes_are_blended_over_the_background() {
    // Five panes one behind the other: the fifth is opaque, whatever its alpha.
    let layers = [([0.9, 0.1, 0.2], 0.5), ([0.1, 0.8, 0.3], 0.25), ([0.2; 3], 0.0), ([0.7, 0.6, 0.5], 0.4)];
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { background: [0.3, 0.5, 1.0], ..Default::default() });
    for (index, (colour, alpha)) in layers.iter().enumerate() {
        add_square(&mut builder, 2.0 + index as f64 * 0.01, 8.0 - index as f64, &pane(*colour, *alpha));
    }
    let glow = glowing(&mut builder, [0.0, 1.0, 0.5]);
    add(&mut builder, BALL, Pose::from_translation(DVec3::X * 4.0), glow);
    let pixels = picture(&builder, camera_of([64, 48], 0.5), Pose::IDENTITY);
    let through = |behind: [f64; 3]| {
        layers.iter().rev().fold(behind, |behind, (colour, alpha)| {
            let alpha = f64::from(*alpha);
            core::array::from_fn(|channel| {
                alpha * f64::from(colour[channel]) + (1.0 - alpha) * behind[channel]
            })
        })
    };
    let near = |pixel: &[u8], colour: [f64; 3]| {
        pixel.iter().zip(colour).all(|(&value, colour)| (f64::from(value) - 255.0 * colour).abs() < 0.51)
    };
    let (ball, sky) = (through([0.0, 1.0, 0.5]), through([0.3, 0.5, 1.0]));
    let pixels = pixels.as_chunks::<3>().0;
    assert!(near(&pixels[24 * 64 + 32], ball) && near(&pixels[0], sky), "{:?}", pixels[24 * 64 + 32]);
    assert!(pixels.iter().all(|pixel| near(pixel, ball) || near(pixel, sky)));
    add_square(&mut builder, 3.0, 8.0, &pane([0.25; 3], 0.1));
    let pixels = picture(&builder, camera_of([64, 48], 0.5), Pose::IDENTITY);
    assert!(pixels.as_chunks::<3>().0.iter().all(|pixel| near(pixel, through([0.25; 3]))));
}

#[test]
fn surfaces_behind_a_clear_pane_look_the_same() {
    let eye = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let lens = Intrinsics { fx: 110.0, fy: 110.0, cx: 99.5, cy: 74.5, skew: 0.0 };
    let fisheye =
        RayTableBuf::from_lens(200, 150, &KannalaBrandt::new(lens, [0.01, 0.0, 0.0, 0.0]).unwrap()).unwrap();
    for config in [camera_of([200, 150], 1.2), CameraConfig::new(&fisheye)] {
        for edges in [Edges::Sharp, Edges::Smooth] {
            let config = config.edges(edges);
            let mut builder = SceneBuilder::new();
            scenery(&mut builder);
            let clear = picture(&builder, config, eye);
            let black = builder.add_material(&pane([0.0; 3], 0.0625)).unwrap();
            let close = InstanceConfig {
                shape: Shape::Rectangle { size: [4.0; 2] },
                world_from_instance: eye
                    * Pose::from_xyz_rpy(
                        DVec3::X * 0.05,
                        DVec3::new(0.0, -core::f64::consts::FRAC_PI_2, 0.0),
                    ),
                material: black,
                ..Default::default()
            };
            builder.add_instance(&close).unwrap();
            let dimmed = picture(&builder, config, eye);
            let apart = clear
                .iter()
                .zip(&dimmed)
                .filter(|(clear, dimmed)| (f64::from(**clear) * 0.9375 - f64::from(**dimmed)).abs() > 1.0);
            // At edges, rays in double precision may hit other surfaces than rays in single precision.
            let apart = apart.count();
            assert!(apart * 250 < clear.len(), "{edges:?}: {apart} of {}", clear.len());
        }
    }
}

#[test]
fn textures_are_cut_out_or_blended() {
    // Alphas of 0, 85, 170 and 255 from left to right.
    let texels: Vec<_> = (0..16).map(|i| [255, 255, 255, (i % 4 * 85) as u8]).collect();
    let seen = |texture_alpha, texture_mode| {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [1.0; 3], background: [0.0; 3] });
        let texture = Some(builder.add_texture(4, 4, &texels).unwrap());
        let ambient = [1.0; 3];
        let config = MaterialConfig { ambient, texture, texture_alpha, texture_mode, ..Default::default() };
        add_square(&mut builder, 4.0, 4.0, &config);
        let material = MaterialConfig { ambient: [0.0; 3], diffuse: [1.0; 3], ..Default::default() };
        add_square(&mut builder, 5.0, 40.0, &material);
        let kind = LightKind::Directional { direction: [1.0, 0.0, 0.0] };
        builder.add_light(&LightConfig { kind, cast_shadows: true, ..Default::default() }).unwrap();
        let pixels = picture(&builder, camera_of([80, 60], 1.0), Pose::IDENTITY);
        // The positions of texel centres: the x axis of the square, along which u grows, is vertical.
        let row = |metres: f64| (29.5 - metres / 4.0 * 40.0 / 0.5_f64.tan()).round() as usize;
        [1.5, 0.5, -0.5, -1.5].map(|up| pixels[(row(up) * 80 + 40) * 3])
    };
    let sorted = |mut values: [u8; 4]| {
        values.sort_unstable();
        values
    };
    for mode in [TextureMode::Reflectance, TextureMode::Light] {
        assert_eq!(sorted(seen(TextureAlpha::Ignored, mode)), [255; 4]);
        // Where the texture is cut out, the wall is visible, which is black because the whole square casts its shadow
        // on it. A blended texture casts no shadow.
        assert_eq!(sorted(seen(TextureAlpha::CutOut { least: 0.5 }, mode)), [0, 0, 255, 255]);
        assert_eq!(sorted(seen(TextureAlpha::Blended, mode)), [255; 4]);
    }
}

#[test]
fn normal_maps() {
    // A single normal for all texels, so that neither filters nor mip levels matter: to the right, down and outwards.
    let texel = [200, 90, 220, 255_u8];
    let [x, y, z] = [0, 1, 2].map(|i| f64::from(texel[i]) / 127.5 - 1.0);
    let sun = DVec3::new(0.3, -0.5, -0.6);
    let specular = [0.5; 3];
    let corners = [[-0.4, -0.4, 0.0], [0.4, -0.4, 0.0], [0.4, 0.4, 0.0], [-0.4, 0.4, 0.0_f32]];
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let upright = Pose::from_xyz_rpy(DVec3::new(0.2, 0.1, 0.9), DVec3::new(0.5, -0.3, 0.8));
    // Texture coordinates of the mesh: those of the plane, rotated by a quarter turn, and mirrored.
    for (turned, mirror) in [(false, 1.0), (true, 1.0), (false, -1.0)] {
        let mut builder = SceneBuilder::new();
        builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
        let normal_map = Some(builder.add_normal_map(1, 1, &[texel]).unwrap());
        let config =
            MaterialConfig { diffuse: [0.5; 3], normal_map, specular, shininess: 9.0, ..Default::default() };
        let material = builder.add_material(&config).unwrap();
        let uv = |[px, py, _]: [f32; 3]| if turned { [py, -px] } else { [px * mirror, py] };
        let mesh = builder.add_mesh(&corners, &corners.map(uv), &triangles).unwrap();
        add(&mut builder, Shape::Mesh(mesh), upright, material);
        add(
            &mut builder,
            Shape::Box { size: [6.0, 6.0, 0.2] },
            Pose::from_translation(DVec3::Z * -0.1),
            material,
        );
        let kind = LightKind::Directional { direction: sun.to_array() };
        builder.add_light(&LightConfig { kind, specular: [1.0; 3], ..Default::default() }).unwrap();
        let rotation = upright.rotation();
        let square = Shape::Rectangle { size: [0.8; 2] };
        let slab = Shape::Box { size: [6.0, 6.0, 0.2] };
        let compared = check(&builder, |ray| {
            let on_mesh = first_hit(&square, &upright, ray, 0.0, false);
            let on_slab = first_hit(&slab, &Pose::from_translation(DVec3::Z * -0.1), ray, 0.0, false);
            let along = |t: f64| ray.origin + ray.direction * t;
            let local = match (on_mesh, on_slab) {
                (Some(_), _) if turned => rotation * DVec3::new(-y, x, z),
                (Some(_), _) => rotation * DVec3::new(x * f64::from(mirror), y, z),
                // The sides of the slab are not compared.
                (None, Some(t)) if along(t).z > -1e-9 => DVec3::new(x, y, z),
                (None, Some(_)) => return None,
                (None, None) => return Some([0.0; 3]),
            };
            let surface = if on_mesh.is_some() { rotation * DVec3::Z } else { DVec3::Z };
            let (normal, to_lamp) = (local.normalize(), -sun.normalize());
            if surface.dot(to_lamp) <= 0.0 || normal.dot(to_lamp) <= 0.0 {
                return Some([0.0; 3]);
            }
            let middle = (to_lamp - ray.direction.normalize()).normalize();
            let highlight = normal.dot(middle).max(0.0).powf(9.0);
            Some([0.5 * normal.dot(to_lamp) + 0.5 * highlight; 3])
        });
        assert!(compared > 60_000, "{compared}");
    }
}

/// A cube of 0.8 m of triangles, wound outwards or inwards, above a floor in the light of one lamp.
fn floor_and_cube(light: &LightConfig, inside_out: bool) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.2; 3], background: [0.0; 3] });
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let side = |bit: u32, index: u32| if index >> bit & 1 == 0 { -0.4 } else { 0.4 };
    let corners: Vec<[f32; 3]> =
        (0..8).map(|index| [side(0, index), side(1, index), side(2, index)]).collect();
    let squares = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = squares
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|[a, b, c]| if inside_out { [a, c, b] } else { [a, b, c] })
        .collect();
    let cube = builder.add_mesh(&corners, &[], &triangles).unwrap();
    add(&mut builder, FLOOR, Pose::IDENTITY, material);
    add(&mut builder, Shape::Mesh(cube), Pose::from_translation(BALL_AT), material);
    builder.add_light(light).unwrap();
    builder
}

#[test]
fn a_mesh_inside_out_looks_like_its_front_side() {
    let sun = LightKind::Directional { direction: [0.3, -0.2, -1.0] };
    for (kind, cast_shadows) in
        [(sun, false), (sun, true), (LightKind::Point { position: LAMP_AT.to_array() }, false)]
    {
        let light = LightConfig { kind, cast_shadows, ..LightConfig::default() };
        for edges in [Edges::Sharp, Edges::Smooth] {
            let right = picture(&floor_and_cube(&light, false), camera().edges(edges), view());
            let both = camera().edges(edges).faces(Faces::Both);
            let same = picture(&floor_and_cube(&light, false), both, view());
            assert!(right == same, "of a closed mesh both sides are the outside: {kind:?}");
            let turned = picture(&floor_and_cube(&light, true), both, view());
            let off = right.iter().zip(&turned).filter(|(a, b)| a.abs_diff(**b) > 1).count();
            assert!(off < 40, "{off} values differ by more than a step: {kind:?}, {edges:?}");
            let seen_through = picture(&floor_and_cube(&light, true), camera().edges(edges), view());
            let off = right.iter().zip(&seen_through).filter(|(a, b)| a.abs_diff(**b) > 1).count();
            assert!(off > 1000, "front faces alone show its far inside");
        }
    }
}

#[test]
fn insides_are_lit_by_lamps_inside() {
    let pose = Pose::from_xyz_rpy(DVec3::new(0.2, -0.1, 0.3), DVec3::new(0.1, 0.2, 0.3));
    let lamp = pose.transform_point(DVec3::new(0.4, 0.5, -0.3));
    let half = DVec3::new(2.0, 1.5, 1.2);
    let shapes = [Shape::Box { size: (half * 2.0).to_array() }, Shape::Sphere { radius: 1.5 }];
    let sun = LightKind::Directional { direction: [0.3, -0.2, -1.0] };
    let outside = LightKind::Point { position: [0.5, 9.0, 7.0] };
    for shape in shapes {
        for (kind, is_inside) in
            [(LightKind::Point { position: lamp.to_array() }, true), (outside, false), (sun, false)]
        {
            let mut builder = SceneBuilder::new();
            builder.set_environment(Environment { ambient: [0.2; 3], background: [0.0; 3] });
            let material = builder.add_material(&MaterialConfig::default()).unwrap();
            let MaterialConfig { ambient, diffuse, .. } = MaterialConfig::default();
            add(&mut builder, shape, pose, material);
            let light = LightConfig {
                kind,
                diffuse: [0.7; 3],
                attenuation: [1.0, 0.0, 0.0],
                range_m: f32::INFINITY,
                cast_shadows: true,
                ..LightConfig::default()
            };
            builder.add_light(&light).unwrap();
            let view = pose * Pose::from_xyz_rpy(DVec3::new(-0.5, 0.1, 0.2), DVec3::new(0.3, 0.5, 1.0));
            let pixels = picture(&builder, camera().faces(Faces::Both), view);
            let mut compared = 0;
            for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
                let ray = pixel_ray(&camera(), &view, index as u32 % SIZE[0], index as u32 / SIZE[0]);
                let t = first_hit(&shape, &pose, &ray, 0.0, true).expect("all around");
                let point = ray.origin + ray.direction * t;
                let local = pose.inverse().transform_point(point);
                let normal = if matches!(shape, Shape::Sphere { .. }) {
                    -local.normalize()
                } else {
                    let share = (local / half).abs();
                    let axis = share.max_position();
                    let mut others = share.to_array();
                    others[axis] = 0.0;
                    if others.into_iter().fold(0.0, f64::max) > 0.999 {
                        continue;
                    }
                    DVec3::AXES[axis] * -local[axis].signum()
                };
                let normal = pose.rotation() * normal;
                let gain = if is_inside { normal.dot((lamp - point).normalize()).max(0.0) } else { 0.0 };
                for channel in 0..3 {
                    let expected =
                        f64::from(ambient[channel]) * 0.2 + f64::from(diffuse[channel]) * 0.7 * gain;
                    let error = (f64::from(pixel[channel]) - 255.0 * expected.min(1.0)).abs();
                    assert!(
                        error < 0.52,
                        "pixel {index} is {pixel:?}, should be {}: {shape:?}, {kind:?}",
                        expected * 255.0
                    );
                }
                compared += 1;
            }
            assert!(compared > 70_000, "{compared}");
        }
    }
}
