//! Draws the images of `docs/cameras.md`: one room with different lenses, shutters, devices and channels of ground truth,
//! and scenes that show effects of light.
//!
//! `cargo run --release --example draw_cameras -- docs/cameras`

mod light;

use belvedere::description::load::load_world;
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere::picture;
use belvedere::world::physics::Physics;
use belvedere::world::scene::WorldScene;
use belvedere_bridge::{Encoding, FrameHeader, FrameView, Kind};
use belvedere_sensors::camera::{Camera, CameraConfig, Edges, Picture};
use belvedere_sensors::device::presets;
use belvedere_sensors::optics::{
    BrownConrady, Equirectangular, Intrinsics, KannalaBrandt, Lens, PinholeGrid, RayTableBuf,
};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Moment, Pose, Sensor, Slice};
use glam::DVec3;
use image::RgbImage;
use std::error::Error;
use std::path::{Path, PathBuf};

const SIZE: [u32; 2] = [320, 240];
const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;

/// The room, and the folder for the images.
struct Studio {
    scene: WorldScene,
    folder: PathBuf,
    memory: WorkspaceBuf,
}

impl Studio {
    fn save(&self, name: &str, picture: &RgbImage) -> Result<(), Box<dyn Error>> {
        let path = self.folder.join(name).with_extension("png");
        picture.save(&path)?;
        println!("{}", path.display());
        Ok(())
    }

    /// Renders the image of a camera with a shutter and saves it.
    fn draw(
        &mut self,
        name: &str,
        config: &CameraConfig<'_>,
        slices: &[(u32, Pose)],
    ) -> Result<(), Box<dyn Error>> {
        let camera = Camera::new(*config)?;
        let poses = self.scene.poses();
        let moment = |pose| Moment { world_from_sensor: pose, world_from_instance: poses };
        // A rolling shutter has a slice for each row. Otherwise every slice has all rows.
        let lines = |row: u32| if slices.len() == SIZE[1] as usize { row..row + 1 } else { 0..SIZE[1] };
        let slices: Vec<_> =
            slices.iter().map(|&(row, pose)| Slice { lines: lines(row), at: moment(pose) }).collect();
        let capture = match slices.as_slice() {
            [only] => Capture::new(0, only.at),
            slices => Capture::new(0, slices),
        };
        let mut pixels = vec![0; camera.frame_len()];
        let scene = self.scene.scene();
        camera.sense_in(&mut self.memory, &scene, &capture, Picture::new().colour(&mut pixels))?;
        let picture = RgbImage::from_raw(SIZE[0], SIZE[1], pixels).ok_or("not a picture of rgb8")?;
        self.save(name, &picture)
    }

    /// Renders channels of ground truth and saves them.
    fn draw_truth(
        &mut self,
        config: &CameraConfig<'_>,
        at: Pose,
        before: Pose,
    ) -> Result<(), Box<dyn Error>> {
        let camera = Camera::new(*config)?;
        let (mut depth, mut normal) = (vec![0.0_f32; PIXELS], vec![[0.0_f32; 3]; PIXELS]);
        let (mut instance, mut flow) = (vec![0_u32; PIXELS], vec![[0.0_f32; 2]; PIXELS]);
        let capture = Capture::new(0, self.scene.moment(at)).before(self.scene.moment(before));
        let truth = Truth::new().depth(&mut depth).normal(&mut normal).instance(&mut instance);
        let scene = self.scene.scene();
        camera.sense_in(
            &mut self.memory,
            &scene,
            &capture,
            Picture::new().truth(truth.flow_back(&mut flow)),
        )?;
        let channels: [(&str, Encoding, &[u8]); 4] = [
            ("truth_depth", Encoding::F32C1, bytemuck::cast_slice(&depth)),
            ("truth_normal", Encoding::F32C3, bytemuck::cast_slice(&normal)),
            ("truth_instance", Encoding::I32C1, bytemuck::cast_slice(&instance)),
            ("truth_flow_back", Encoding::F32C2, bytemuck::cast_slice(&flow)),
        ];
        for (name, encoding, payload) in channels {
            let mut header = FrameHeader::new(Kind::Image, encoding);
            header.set_packed(SIZE[0], SIZE[1]);
            header.payload_len = payload.len() as u64;
            self.save(name, &picture::draw(&FrameView::new(&header, payload)?)?)?;
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: draw_cameras FOLDER")?;
    std::fs::create_dir_all(Path::new(&folder))?;
    let mut diagnostics = Diagnostics::default();
    let world = load_world("tag_ceiling", &package_path([], None), Rules::default(), &mut diagnostics)
        .ok_or("the room cannot be loaded")?;
    let physics = Physics::new(&world)?;
    let scene = WorldScene::new(&world, &physics).map_err(|problem| format!("{problem:?}"))?;
    let mut studio = Studio { scene, folder: folder.into(), memory: WorkspaceBuf::default() };

    for (name, picture) in light::pictures()? {
        studio.save(name, &picture)?;
    }
    let at = Pose::from_xyz_rpy(DVec3::new(-1.5, 0.4, 0.6), DVec3::new(0.0, 0.1, 0.3));
    let turned = |angle: f64| at * Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, 0.0, angle));
    let lens = |focal| Intrinsics { fx: focal, fy: focal, cx: 159.5, cy: 119.5, skew: 0.0 };
    let pinhole = CameraConfig::new(PinholeGrid::from_fov(SIZE[0], SIZE[1], 1.396_263_4)?).seed(1);
    let fisheye = KannalaBrandt::new(lens(160.0 / core::f64::consts::FRAC_PI_2), [0.0; 4])?;
    let barrel = BrownConrady::new(lens(170.0), &[-0.28, 0.07, 2e-4, 2e-5, 0.0])?;
    let panorama = Equirectangular::with_intrinsics(lens(160.0 / core::f64::consts::PI))?;
    let lenses: [(&str, &dyn Lens); 3] = [
        ("lens_kannala_brandt", &fisheye),
        ("lens_brown_conrady", &barrel),
        ("lens_equirectangular", &panorama),
    ];
    studio.draw("lens_pinhole", &pinhole, &[(0, at)])?;
    for (name, lens) in lenses {
        let table = RayTableBuf::from_lens(SIZE[0], SIZE[1], lens)?;
        studio.draw(name, &CameraConfig::new(&table), &[(0, at)])?;
    }
    studio.draw("edges_smooth", &pinhole.edges(Edges::Smooth), &[(0, at)])?;
    let rows: Vec<_> = (0..SIZE[1]).map(|row| (row, turned(1.5e-3 * f64::from(row)))).collect();
    studio.draw("shutter_rolling", &pinhole, &rows)?;
    let exposed: Vec<_> = (0..24).map(|moment| (0, turned(2e-3 * f64::from(moment)))).collect();
    studio.draw("shutter_blur", &pinhole, &exposed)?;
    studio.draw("device_webcam", &pinhole.device(Some(presets::webcam())), &[(0, at)])?;
    studio.draw_truth(&pinhole, at, turned(0.02) * Pose::from_translation(DVec3::X * -0.05))
}
