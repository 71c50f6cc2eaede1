//! Renders pictures of a checkerboard through any lens, for calibration.
//!
//! The first line of the standard input is a lens, as in `project_points`. The second has the width and height of the
//! pictures, the number of rays across and down that are averaged per pixel, and the board: columns and rows of
//! squares, and the length of their sides in metres. Each further line is a pose of the board in the camera's optical
//! frame: x y z of its first inner corner, and its rotation as a rotation vector, both as `OpenCV`'s calibration
//! returns them (x to the right over the board, y down, z away from the viewer). Pictures are written to a directory,
//! as 0.pgm, 1.pgm …
//!
//! This program does the averaging itself: a picture k times as large is rendered through a lens whose pixels are k
//! times finer ([`Finer`]), with exact edges of the squares.
//!
//! ```text
//! $ printf '%s\n' 'pinhole 500 500 319.5 239.5 0' '640 480 4 10 7 0.03' '-0.12 -0.075 0.5 0.3 0 0' |
//!       cargo run -q -p belvedere-sensors --example render_board /tmp
//! ```

mod lens_line;

use belvedere_sensors::camera::{Camera, CameraConfig, Picture, PixelFormat};
use belvedere_sensors::optics::{Lens, RayTableBuf};
use belvedere_sensors::scene::{Environment, InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::{DMat3, DQuat, DVec2, DVec3};
use lens_line::{numbers, parse_lens};
use std::error::Error;
use std::io::BufRead;
use std::path::Path;

/// A lens with `factor` times as many pixels across and down as another.
struct Finer<'a> {
    lens: &'a dyn Lens,
    factor: f64,
}

impl Lens for Finer<'_> {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        self.lens.project(point_in_optical).map(|pixel| (pixel + 0.5) * self.factor - 0.5)
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        self.lens.unproject((pixel + 0.5) / self.factor - 0.5)
    }
}

/// Black and white squares, and a white border as wide as one square. They are side by side in one plane, with the
/// first inner corner at (0, 0).
fn board(columns: usize, rows: usize, side: f64) -> Result<SceneBuilder, Box<dyn Error>> {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.4; 3] });
    let shades = [0.05, 0.95].map(|shade| MaterialConfig {
        emissive: [shade; 3],
        diffuse: [0.0; 3],
        ambient: [0.0; 3],
        ..MaterialConfig::default()
    });
    let [black, white] = shades.map(|shade| builder.add_material(&shade));
    let (black, white) = (black?, white?);
    // Front faces look along their +z, and the board's z points away from the viewer.
    let turn = DQuat::from_rotation_x(core::f64::consts::PI);
    for row in 0..rows + 2 {
        for column in 0..columns + 2 {
            let inside = (1..=columns).contains(&column) && (1..=rows).contains(&row);
            let material = if inside && (row + column) % 2 == 0 { black } else { white };
            let centre = DVec3::new(column as f64 - 1.5, row as f64 - 1.5, 0.0) * side;
            builder.add_instance(&InstanceConfig {
                shape: Shape::Rectangle { size: [side; 2] },
                world_from_instance: Pose::new(centre, turn),
                material,
                ..InstanceConfig::default()
            })?;
        }
    }
    Ok(builder)
}

/// Averages each square of `factor` × `factor` pixels.
fn shrink(pixels: &[u8], width: usize, factor: usize) -> Vec<u8> {
    let wide = width * factor;
    let count = (factor * factor) as u32;
    let mut means = Vec::with_capacity(pixels.len() / (factor * factor));
    for rows in pixels.chunks(wide * factor) {
        for column in 0..width {
            let squares = rows.chunks(wide).flat_map(|row| &row[column * factor..(column + 1) * factor]);
            let sum: u32 = squares.map(|pixel| u32::from(*pixel)).sum();
            means.push(((sum + count / 2) / count) as u8);
        }
    }
    means
}

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args().nth(1).ok_or("the argument must be a directory for the pictures")?;
    let mut lines = std::io::stdin().lock().lines();
    let mut line = || lines.next().transpose();
    let lens = parse_lens(&line()?.ok_or("the first line must be a lens: a model and its parameters")?)?;
    let setup = line()?.ok_or("the second line must be the picture and the board")?;
    let [width, height, factor, columns, rows, side] = numbers(setup.split_whitespace())?[..] else {
        return Err(format!("`{setup}` must be width height factor columns rows side").into());
    };
    let [width, height, factor] = [width, height, factor].map(|count| count as usize);

    let finer = Finer { lens: &*lens, factor: factor as f64 };
    let table = RayTableBuf::from_lens((width * factor) as u32, (height * factor) as u32, &finer)?;
    let camera = Camera::new(CameraConfig::new(&table).format(PixelFormat::Mono8).near_m(1e-3))?;
    let builder = board(columns as usize, rows as usize, side)?;
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    let mut pixels = vec![0; camera.frame_len()];
    // x, y and z of the optical frame in the camera's frame, which looks along +x with z up.
    let optical =
        Pose::new(DVec3::ZERO, DQuat::from_mat3(&DMat3::from_cols(DVec3::NEG_Y, DVec3::NEG_Z, DVec3::X)));
    let mut number = 0;
    while let Some(line) = line()? {
        let [x, y, z, rx, ry, rz] = numbers(line.split_whitespace())?[..] else {
            return Err(format!("`{line}` must be x y z and a rotation vector").into());
        };
        let turn = DQuat::from_scaled_axis(DVec3::new(rx, ry, rz));
        let camera_from_board = optical * Pose::new(DVec3::new(x, y, z), turn);
        let capture = Capture::new(0, builder.moment(camera_from_board.inverse()));
        camera
            .sense(
                &scene,
                &capture,
                &mut workspace.lend(camera.workspace_len(&scene, &capture)),
                Picture::new().colour(&mut pixels),
            )
            .expect("outputs of the right size");
        let mut file = format!("P5 {width} {height} 255\n").into_bytes();
        file.extend(shrink(&pixels, width, factor));
        std::fs::write(Path::new(&directory).join(format!("{number}.pgm")), file)?;
        number += 1;
    }
    Ok(())
}
