//! Small scenes that show effects of light.

use belvedere_sensors::camera::{Camera, CameraConfig, Edges, Picture};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{
    ColourSpace, Environment, InstanceConfig, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape,
    TextureAlpha,
};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;
use image::RgbImage;
use std::error::Error;

const SIZE: [u32; 2] = [320, 180];

/// Renders the images, each with its name.
pub(crate) fn pictures() -> Result<Vec<(&'static str, RgbImage)>, Box<dyn Error>> {
    Ok(vec![
        ("light_gloss", draw(&balls(ColourSpace::AsGiven)?)?),
        ("light_linear", draw(&balls(ColourSpace::Srgb)?)?),
        ("light_falloff", draw(&spots()?)?),
        ("light_alpha", draw(&glass_and_fence()?)?),
        ("light_normals", draw(&wall_with_normals()?)?),
    ])
}

fn draw(builder: &SceneBuilder) -> Result<RgbImage, Box<dyn Error>> {
    let config = CameraConfig::new(PinholeGrid::from_fov(SIZE[0], SIZE[1], 0.9)?).edges(Edges::Smooth);
    let camera = Camera::new(config)?;
    let eye = Pose::from_xyz_rpy(DVec3::new(-4.2, 0.0, 1.7), DVec3::new(0.0, 0.3, 0.0));
    let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(eye)));
    let mut pixels = vec![0; camera.frame_len()];
    let mut memory = WorkspaceBuf::default();
    camera.sense_in(&mut memory, &scene, &capture, Picture::new().colour(&mut pixels))?;
    Ok(RgbImage::from_raw(SIZE[0], SIZE[1], pixels).ok_or("not a picture of rgb8")?)
}

fn add(
    builder: &mut SceneBuilder,
    shape: Shape,
    at: DVec3,
    config: &MaterialConfig,
) -> Result<(), Box<dyn Error>> {
    let material = builder.add_material(config)?;
    let world_from_instance = Pose::from_translation(at);
    builder.add_instance(&InstanceConfig { shape, world_from_instance, material, ..Default::default() })?;
    Ok(())
}

fn lamp(builder: &mut SceneBuilder, kind: LightKind) -> Result<(), Box<dyn Error>> {
    let config = LightConfig {
        kind,
        diffuse: [0.8; 3],
        specular: [0.8; 3],
        cast_shadows: true,
        ..LightConfig::default()
    };
    builder.add_light(&config)?;
    Ok(())
}

/// Builds a scene with a chequered floor.
fn floor() -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.25; 3], background: [0.55, 0.65, 0.75] });
    let checks = [[200, 200, 195, 255], [120, 125, 130, 255], [120, 125, 130, 255], [200, 200, 195, 255]];
    let texels: Vec<_> = (0..64 * 64).map(|i| checks[i / 32 % 2 + 2 * (i / 64 / 32)]).collect();
    let texture = Some(builder.add_texture(64, 64, &texels)?);
    let config = MaterialConfig {
        diffuse: [1.0; 3],
        ambient: [1.0; 3],
        texture,
        texture_repeat: [8.0; 2],
        ..Default::default()
    };
    add(&mut builder, Shape::Rectangle { size: [12.0; 2] }, DVec3::ZERO, &config)?;
    Ok(builder)
}

/// Builds balls of shininess 0, 3, 12, 50 and 200, from left to right.
fn balls(space: ColourSpace) -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = floor()?;
    builder.set_colour_space(space);
    let colours = [[0.8, 0.2, 0.2], [0.8, 0.6, 0.1], [0.2, 0.6, 0.25], [0.2, 0.4, 0.8], [0.5, 0.25, 0.6]];
    for (index, (diffuse, shininess)) in colours.into_iter().zip([0.0, 3.0, 12.0, 50.0, 200.0]).enumerate() {
        let at = DVec3::new(0.0, 1.6 - 0.8 * index as f64, 0.36);
        let config =
            MaterialConfig { diffuse, ambient: diffuse, specular: [0.8; 3], shininess, ..Default::default() };
        add(&mut builder, Shape::Sphere { radius: 0.36 }, at, &config)?;
    }
    lamp(&mut builder, LightKind::Point { position: [-2.0, 1.2, 3.0] })?;
    Ok(builder)
}

/// Builds spot lights of falloff 0, 0.3, 1 and 4, from left to right.
fn spots() -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = floor()?;
    for (index, falloff) in [0.0, 0.3, 1.0, 4.0].into_iter().enumerate() {
        let position = [0.0, 1.5 - index as f64, 1.6];
        let direction = [0.0, 0.0, -1.0];
        lamp(
            &mut builder,
            LightKind::Spot { position, direction, cos_inner: 0.99, cos_outer: 0.956, falloff },
        )?;
    }
    Ok(builder)
}

/// Builds a transparent ball, a fence with a cut-out texture, and a pane in front of balls.
fn glass_and_fence() -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = balls(ColourSpace::AsGiven)?;
    let glass = MaterialConfig {
        diffuse: [0.3, 0.6, 0.7],
        ambient: [0.3, 0.6, 0.7],
        specular: [0.9; 3],
        shininess: 80.0,
        alpha: 0.4,
        ..Default::default()
    };
    add(&mut builder, Shape::Sphere { radius: 0.5 }, DVec3::new(-1.2, 0.1, 0.5), &glass)?;
    add(&mut builder, Shape::Box { size: [0.02, 1.1, 0.8] }, DVec3::new(-0.9, -1.2, 0.4), &glass)?;
    let slats = |i: usize| i % 16 < 5 || i / 16 % 16 < 3;
    let texels: Vec<_> = (0..256).map(|i| [200, 170, 120, if slats(i) { 255 } else { 0 }]).collect();
    let texture = Some(builder.add_texture(16, 16, &texels)?);
    let fence = MaterialConfig {
        diffuse: [1.0; 3],
        ambient: [1.0; 3],
        texture,
        texture_repeat: [6.0, 3.0],
        texture_alpha: TextureAlpha::CutOut { least: 0.5 },
        ..Default::default()
    };
    add(&mut builder, Shape::Box { size: [0.02, 1.2, 0.6] }, DVec3::new(-0.8, 1.3, 0.3), &fence)?;
    Ok(builder)
}

/// Builds two flat walls, the left one with a normal map of studs.
fn wall_with_normals() -> Result<SceneBuilder, Box<dyn Error>> {
    const SIDE: usize = 64;
    let mut builder = floor()?;
    let texels: Vec<_> = (0..SIDE * SIDE)
        .map(|i| {
            let [x, y] = [i % SIDE, i / SIDE].map(|at| (at as f64 + 0.5) / 32.0 - 1.0);
            let height = (1.0 - (x * x + y * y) / 0.64).max(0.0).sqrt();
            // The rows of an image go downwards, but v goes upwards.
            let normal = if height > 0.0 { DVec3::new(x, -y, 0.8 * height).normalize() } else { DVec3::Z };
            let [x, y, z] = normal.to_array().map(|part| (127.5 * (part + 1.0)).round() as u8);
            [x, y, z, 255]
        })
        .collect();
    let normal_map = Some(builder.add_normal_map(SIDE as u32, SIDE as u32, &texels)?);
    for (normal_map, y) in [(normal_map, 0.95), (None, -0.95)] {
        let wall = MaterialConfig {
            diffuse: [0.7, 0.5, 0.35],
            ambient: [0.7, 0.5, 0.35],
            specular: [0.4; 3],
            shininess: 20.0,
            normal_map,
            texture_repeat: [6.0, 5.0],
            ..Default::default()
        };
        add(&mut builder, Shape::Box { size: [0.1, 1.8, 1.5] }, DVec3::new(0.0, y, 0.75), &wall)?;
    }
    lamp(&mut builder, LightKind::Point { position: [-2.0, 1.2, 3.0] })?;
    Ok(builder)
}
