//! Renders flat fields and dark frames through a camera device, to be measured by EMVA 1288.
//!
//! The first line of the standard input is the device: `width=640 height=480`, and parameters by the names of
//! [`DeviceConfig`]'s fields, such as `read_noise_e=5`; those that are not given are ideal. Each further line is a
//! picture of an evenly lit wall: exposure time in seconds, the colour of the wall (0 for a dark frame), and the number
//! of the frame. Pictures are written to a directory, as 0.u16, 1.u16 …: rows of 16-bit DN, low byte first. The program
//! prints the number of photons per second that a colour of 1 sends to a pixel.
//!
//! ```text
//! $ printf '%s\n' 'width=64 height=48 read_noise_e=5' '0.01 0.5 0' '0.01 0 1' |
//!       cargo run -q -p belvedere-sensors --example emva /tmp
//! ```

use belvedere_sensors::camera::{Camera, CameraConfig, Picture, PixelFormat};
use belvedere_sensors::device::{DeviceConfig, Exposure};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{Environment, InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::DVec3;
use std::error::Error;
use std::io::BufRead;
use std::path::Path;

/// Parses width, height and device from words like `read_noise_e=5`.
fn parse(line: &str) -> Result<([u32; 2], DeviceConfig), Box<dyn Error>> {
    let (mut size, mut device) = ([640, 480], DeviceConfig::default());
    for word in line.split_whitespace() {
        let (name, value) = word.split_once('=').ok_or_else(|| format!("`{word}` must be name=value"))?;
        let number: f64 = value.parse().map_err(|error| format!("`{word}`: {error}"))?;
        match name {
            "width" => size[0] = number as u32,
            "height" => size[1] = number as u32,
            "gain" => device.exposure.gain = number,
            "f_number" => device.f_number = number,
            "pixel_pitch_um" => device.pixel_pitch_um = number,
            "quantum_efficiency" => device.quantum_efficiency = [number; 3],
            "full_well_e" => device.full_well_e = number,
            "dark_current_e_per_s" => device.dark_current_e_per_s = number,
            "read_noise_e" => device.read_noise_e = number,
            "converter_noise_dn" => device.converter_noise_dn = number,
            "dsnu_e" => device.dsnu_e = number,
            "prnu" => device.prnu = number,
            "dn_per_electron" => device.dn_per_electron = number,
            "black_level_dn" => device.black_level_dn = number,
            "bits" => device.bits = number as u32,
            _ => return Err(format!("`{name}` is not a parameter of a device").into()),
        }
    }
    Ok((size, device))
}

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args().nth(1).ok_or("the argument must be a directory for the pictures")?;
    let mut lines = std::io::stdin().lock().lines();
    let first = lines.next().transpose()?.ok_or("the first line must be the device")?;
    let ([width, height], device) = parse(&first)?;
    println!("{}", device.photons_per_second());

    // The scene is a wall that emits the colour of each picture.
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
    let shining = |colour| MaterialConfig {
        emissive: [colour; 3],
        diffuse: [0.0; 3],
        ambient: [0.0; 3],
        ..MaterialConfig::default()
    };
    let material = builder.add_material(&shining(0.0))?;
    builder.add_instance(&InstanceConfig {
        shape: Shape::Box { size: [1.0, 100.0, 100.0] },
        world_from_instance: Pose::from_translation(DVec3::X * 2.5),
        material,
        ..InstanceConfig::default()
    })?;

    let config = CameraConfig::new(PinholeGrid::from_fov(width, height, 0.5)?)
        .format(PixelFormat::Mono16)
        .device(Some(device))
        .seed(1288);
    let mut camera = Camera::new(config)?;
    let mut workspace = WorkspaceBuf::default();
    let mut pixels = vec![0; camera.frame_len()];
    for (number, line) in lines.enumerate() {
        let line = line?;
        let words: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [time_s, colour, frame] = words[..] else {
            return Err(format!("`{line}` must be time, colour and frame").into());
        };
        builder.set_material(material, &shining(colour as f32))?;
        camera.set_device_exposure(Exposure { time_s, gain: device.exposure.gain })?;
        let capture = Capture::new(frame as u64, builder.moment(Pose::IDENTITY));
        let scene = builder.scene();
        camera.sense_in(&mut workspace, &scene, &capture, Picture::new().colour(&mut pixels))?;
        std::fs::write(Path::new(&directory).join(format!("{number}.u16")), &pixels)?;
    }
    Ok(())
}
