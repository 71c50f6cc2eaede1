//! Depth frames through lenses, compared with a pinhole of as many rays.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use crate::tag_room;
use belvedere::world::scene::WorldScene;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::optics::{
    BrownConrady, Intrinsics, KannalaBrandt, Lens, Optics, PinholeGrid, RayTableBuf,
};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Sensor};
use core::f64::consts::{FRAC_PI_2, PI};
use std::hint::black_box;

const GROUP: &str = "frames";

/// Measures the lenses in the tag room.
pub fn run(gate: &mut Gate<'_>, level: Level) {
    let intrinsics = |focal_px| Intrinsics { fx: focal_px, fy: focal_px, cx: 319.5, cy: 239.5, skew: 0.0 };
    // The left and right edges of the image are 90° from the axis.
    let fisheye = KannalaBrandt::new(intrinsics(320.0 / FRAC_PI_2), [0.0; 4]);
    compare(gate, level, "lens_kannala_brandt_180", &fisheye.expect("a fisheye"));
    // 90° before distortion, with the barrel distortion of a webcam.
    let barrel = BrownConrady::new(intrinsics(320.0), &[-0.28, 0.07, 2e-4, 2e-5, 0.0]);
    compare(gate, level, "lens_brown_conrady_90", &barrel.expect("a lens"));
}

fn compare(gate: &mut Gate<'_>, level: Level, name: &str, lens: &impl Lens) {
    if !gate.options.wants(GROUP, name) {
        return;
    }
    let built = tag_room::scene(&tag_room::room());
    let table = RayTableBuf::from_lens(640, 480, lens).expect("a lens that sees");
    let pinhole = PinholeGrid::from_fov(640, 480, PI / 2.0).expect("in range");
    gate.run(
        Entry { group: GROUP, name, unit: Unit::Time, peer: "pinhole of 90°", clock: Clock::Thread },
        (&mut frames(&built, &Optics::from(&table), level), 1.0),
        (&mut frames(&built, &Optics::from(pinhole), level), 1.0),
    );
}

/// Renders a depth frame at each call.
fn frames<'a>(built: &'a WorldScene, optics: &Optics<'a>, level: Level) -> impl FnMut() + use<'a> {
    let camera = DepthCamera::new(DepthCameraConfig::new(CameraConfig::new(*optics)).faces(Faces::Front))
        .expect("in range");
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = Execution::at(level);
    let mut depths = vec![0.0; camera.pixels()];
    move || {
        let scene = built.scene();
        let capture = Capture::new(0, built.moment(tag_room::across()));
        let output = DepthFrame::new().depth_32fc1(black_box(&mut depths));
        camera.sense_in(&mut workspace, &scene, &capture, output).expect("outputs of the right size");
    }
}
