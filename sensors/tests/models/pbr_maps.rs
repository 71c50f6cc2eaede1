//! Maps of roughness, metalness and emitted light: each pixel looks as on a surface that has the values of its place on
//! the maps everywhere.

use crate::common::{add, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{
    ColourSpace, Environment, LightConfig, LightKind, MaterialConfig, Pbr, SceneBuilder, SceneError, Shape,
    TextureId,
};
use glam::DVec3;

/// Edge of the maps in texels.
const SIDE: u32 = 64;

/// The values of roughness (green) and metalness (blue) on the quarters of the map. Red is not used.
const FACETS: [[u8; 4]; 4] = [[9, 255, 0, 255], [200, 51, 0, 0], [0, 102, 255, 255], [255, 204, 153, 9]];
/// The factors of the quarters of the emissive map.
const GLOWS: [[u8; 4]; 4] = [[0, 0, 0, 255], [255, 51, 0, 0], [0, 102, 255, 255], [51, 51, 51, 9]];
/// Colours by which a picture tells the quarters apart.
const MARKS: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];

/// What the maps are multiplied by.
const FACTORS: Pbr = Pbr { roughness: 0.75, metalness: 0.5, highlights: [1.0, 0.5, 0.25] };
const EMISSIVE: [f32; 3] = [0.5, 0.25, 1.0];

/// An image of four quarters.
fn quarters(values: [[u8; 4]; 4]) -> Vec<[u8; 4]> {
    let half = |at: u32| usize::from(at >= SIDE / 2);
    (0..SIDE * SIDE).map(|at| values[half(at / SIDE) * 2 + half(at % SIDE)]).collect()
}

type AddMap = fn(&mut SceneBuilder, u32, u32, &[[u8; 4]]) -> Result<TextureId, SceneError>;

fn add_map(builder: &mut SceneBuilder, add: AddMap, values: [[u8; 4]; 4]) -> TextureId {
    add(builder, SIDE, SIDE, &quarters(values)).unwrap()
}

/// What a camera sees of a floor, a ball, a box and a mesh of one material.
fn seen(space: ColourSpace, is_lit: bool, look: impl Fn(&mut SceneBuilder) -> MaterialConfig) -> Vec<u8> {
    let mut builder = SceneBuilder::new();
    builder.set_colour_space(space);
    let ambient = if is_lit { [0.2; 3] } else { [1.0; 3] };
    builder.set_environment(Environment { ambient, background: [0.5; 3] });
    let config = look(&mut builder);
    let material = builder.add_material(&config).unwrap();
    let corners = [[-0.4, -0.4, 0.0], [0.4, -0.4, 0.0], [0.4, 0.4, 0.0], [-0.4, 0.4, 0.0_f32]];
    let uvs = corners.map(|[x, y, _]| [x + 0.5, y + 0.5]);
    let mesh = builder.add_mesh(&corners, &uvs, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let at = |x, y, z| Pose::from_xyz_rpy(DVec3::new(x, y, z), DVec3::new(0.1, -0.4, 0.3));
    add(&mut builder, Shape::Rectangle { size: [6.0, 6.0] }, Pose::IDENTITY, material);
    add(&mut builder, Shape::Sphere { radius: 0.4 }, at(0.5, 0.5, 0.6), material);
    add(&mut builder, Shape::Box { size: [0.6; 3] }, at(0.4, -0.6, 0.6), material);
    add(&mut builder, Shape::Mesh(mesh), at(-0.7, 0.1, 0.8), material);
    if is_lit {
        for (position, brightness) in [([-1.0, -0.6, 2.0], 0.5), ([0.6, 1.0, 2.5], 0.3)] {
            let kind = LightKind::Point { position };
            let light = LightConfig { kind, ..Default::default() };
            let diffuse = [brightness; 3];
            builder.add_light(&LightConfig { diffuse, specular: [0.4, 0.5, 0.3], ..light }).unwrap();
        }
    }
    let view = look_at(DVec3::new(-2.0, -0.5, 2.5), DVec3::new(0.3, 0.0, 0.2), 0.1);
    picture(&builder, camera_of([320, 240], 1.2), view)
}

#[test]
fn each_pixel_has_the_values_of_its_place() {
    for space in [ColourSpace::AsGiven, ColourSpace::Srgb] {
        let marked = seen(space, false, |builder| {
            let texture = Some(add_map(builder, SceneBuilder::add_texture, MARKS));
            MaterialConfig { ambient: [1.0; 3], texture, ..Default::default() }
        });
        let look = MaterialConfig {
            diffuse: [0.6, 0.5, 0.4],
            emissive: EMISSIVE,
            pbr: Some(FACTORS),
            ..Default::default()
        };
        let mapped = seen(space, true, |builder| {
            let pbr_map = Some(add_map(builder, SceneBuilder::add_pbr_map, FACETS));
            let emissive_map = Some(add_map(builder, SceneBuilder::add_texture, GLOWS));
            MaterialConfig { pbr_map, emissive_map, ..look }
        });
        let share = |value: u8| f32::from(value) / 255.0;
        let plain = [0, 1, 2, 3].map(|quarter| {
            seen(space, true, |_| {
                let (emissive, pbr) = of_quarter(space, quarter, share);
                MaterialConfig { emissive, pbr: Some(pbr), ..look }
            })
        });
        let (pixels, marks) = (mapped.as_chunks::<3>().0, marked.as_chunks::<3>().0);
        let mut compared = [0; 4];
        for (at, (pixel, mark)) in pixels.iter().zip(marks).enumerate() {
            // Between two quarters, a pixel has a mixture.
            let Some(quarter) = MARKS.iter().position(|[r, g, b, _]| mark == &[*r, *g, *b]) else { continue };
            let expected = plain[quarter].as_chunks::<3>().0[at];
            let near = pixel.iter().zip(expected).all(|(value, expected)| value.abs_diff(expected) <= 1);
            assert!(near, "{space:?}, pixel {at}, quarter {quarter}: {pixel:?} is not {expected:?}");
            // The comparison says nothing where all quarters look the same.
            compared[quarter] += usize::from(
                plain.iter().filter(|other| other.as_chunks::<3>().0[at] == expected).count() == 1,
            );
        }
        assert!(compared.iter().all(|count| *count > 3_000), "{space:?}: {compared:?}");
    }
}

/// The light that a quarter emits, and its facets. In sRGB, factors of light are linear.
fn of_quarter(space: ColourSpace, quarter: usize, share: impl Fn(u8) -> f32) -> ([f32; 3], Pbr) {
    let [r, g, b, _] = GLOWS[quarter];
    let glow = [r, g, b].map(&share);
    let linear =
        |value: f32| if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    let displayed =
        |light: f32| if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    let emissive = core::array::from_fn(|channel| match space {
        ColourSpace::AsGiven => EMISSIVE[channel] * glow[channel],
        ColourSpace::Srgb => displayed(linear(EMISSIVE[channel]) * linear(glow[channel])),
    });
    let [_, roughness, metalness, _] = FACETS[quarter];
    let pbr = Pbr {
        roughness: FACTORS.roughness * share(roughness),
        metalness: FACTORS.metalness * share(metalness),
        ..FACTORS
    };
    (emissive, pbr)
}

#[test]
fn maps_belong_to_their_materials() {
    let mut builder = SceneBuilder::new();
    let map = add_map(&mut builder, SceneBuilder::add_pbr_map, FACETS);
    let glow = add_map(&mut builder, SceneBuilder::add_texture, GLOWS);
    let look = MaterialConfig {
        pbr: Some(FACTORS),
        pbr_map: Some(map),
        emissive_map: Some(glow),
        ..Default::default()
    };
    let material = builder.add_material(&look).unwrap();
    for texture in [map, glow] {
        let error = builder.remove_texture(texture).unwrap_err();
        assert_eq!(error, SceneError::InUse { user: "material", index: 0 });
    }
    let none = Some(TextureId(7));
    for config in [MaterialConfig { pbr_map: none, ..look }, MaterialConfig { emissive_map: none, ..look }] {
        assert_eq!(builder.set_material(material, &config).unwrap_err(), SceneError::NoSuchTexture(7));
    }
    // Without facets, their map is not used.
    builder.set_material(material, &MaterialConfig { pbr: None, emissive_map: None, ..look }).unwrap();
    for texture in [map, glow] {
        builder.remove_texture(texture).unwrap();
    }
}
