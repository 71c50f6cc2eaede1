//! Projects points to pixels, and pixels back to directions, through any lens model.
//!
//! The first line of the standard input is a lens: its model, fx fy cx cy skew, and the model's parameters. Those of
//! `wide_angle` are c1 c2 c3 f, fun (id, sin or tan) and the cutoff angle; an equirectangular lens has only width and
//! height. Each further line is a point (x y z, optical frame), for which its pixel is printed, or a pixel (column
//! row), for which the direction of its ray is printed. If there is none, `none` is printed.
//!
//! ```text
//! $ printf '%s\n' 'brown_conrady 500 500 320 240 0 -0.3 0.1 0.001 -0.0005 0' '0.8 0.6 2' '320 240' |
//!       cargo run -q -p belvedere-sensors --example project_points
//! 506.2275 379.8425
//! 0 0 1
//! ```

mod lens_line;

use glam::{DVec2, DVec3};
use lens_line::{numbers, parse_lens};
use std::error::Error;
use std::io::{BufRead, BufWriter, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let mut lines = std::io::stdin().lock().lines();
    let lens =
        parse_lens(&lines.next().ok_or("the first line must be a lens: a model and its parameters")??)?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    for line in lines {
        let line = line?;
        let found = match numbers(line.split_whitespace())?[..] {
            [x, y, z] => lens.project(DVec3::new(x, y, z)).map(|pixel| format!("{} {}", pixel.x, pixel.y)),
            [column, row] => lens
                .unproject(DVec2::new(column, row))
                .map(|direction| format!("{} {} {}", direction.x, direction.y, direction.z)),
            _ => return Err(format!("`{line}` is neither a point (x y z) nor a pixel (column row)").into()),
        };
        writeln!(out, "{}", found.as_deref().unwrap_or("none"))?;
    }
    Ok(())
}
