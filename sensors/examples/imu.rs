//! Prints the readings of an inertial unit at rest, from which its Allan deviation can be computed. The arguments are
//! the name of a preset, a rate in Hz and a time in seconds. Each reading is six numbers on the standard output, f64
//! with the low byte first: angular rates in rad/s and specific forces in m/s², without gravity.
//!
//! ```text
//! $ cargo run -q -p belvedere-sensors --example imu adis16448 100 3600 > rest.f64
//! ```

use belvedere_sensors::imu::{Imu, InertialReading, presets};
use std::error::Error;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [name, rate, seconds] = &words[..] else {
        return Err("the arguments must be the name of a preset, a rate in Hz and a time in s".into());
    };
    let preset = presets::named(name)
        .ok_or_else(|| format!("`{name}` is not a preset: it must be one of {:?}", presets::NAMES))?;
    let (rate, seconds): (f64, f64) = (rate.parse()?, seconds.parse()?);
    let unit = Imu::new(preset.config(), 1, 0)?;
    let mut state = unit.start();
    let mut out = BufWriter::new(std::io::stdout().lock());
    for frame in 0..(rate * seconds) as u64 {
        let read = unit.measure(&InertialReading::default(), frame, 1.0 / rate, &mut state);
        for value in read.angular_velocity.to_array().into_iter().chain(read.specific_force.to_array()) {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(out.flush()?)
}
