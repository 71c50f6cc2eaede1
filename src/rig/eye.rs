//! [`Eye`]: the optics of a camera or depth camera, and the settings that may change while it runs.

pub(super) mod report;

use super::pictures::noise;
use super::sight::visuals_of;
use super::{Opening, Settings};
use crate::description::model::{
    AngleFunction, AngleMap, CameraDevice, CameraPlugin, CameraSensor, Lens, LensIntrinsics, LensModel,
};
use belvedere_sensors::ParameterError;
use belvedere_sensors::camera::{Camera, CameraConfig, Edges, PixelFormat};
use belvedere_sensors::device::{AutoExposure, FrameStatistics};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::{
    self, AngleFunction as Function, BrownConrady, DoubleSphere, Equirectangular, Eucm, Intrinsics,
    KannalaBrandt, Mapping, Mei, Optics, Pinhole, PinholeGrid, RayTableBuf, WideAngle,
};
use std::error::Error;

/// A camera's optics and settings.
pub(super) struct Eye {
    optics: EyeOptics,
    format: PixelFormat,
    near_m: f64,
    far_m: f64,
    visibility: u32,
    exposure: f32,
    edges: Edges,
    noise: GaussianNoise,
    /// The device, with the exposure of the next frame.
    device: Option<CameraDevice>,
    automatic: Option<AutoExposure>,
    /// The state of `automatic` before the first frame.
    first: Option<AutoExposure>,
    seed: u64,
    sensor: u32,
}

/// The rays of the pixels.
enum EyeOptics {
    Pinhole(PinholeGrid),
    Table(Box<RayTableBuf>),
}

impl Eye {
    /// Creates an eye from a description.
    ///
    /// # Errors
    /// If a parameter of the lens or the noise is out of range, or the lens maps no pixel.
    pub(super) fn new(
        camera: &CameraSensor,
        lens: &Lens,
        opening: &Opening<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        let automatic = match &camera.device {
            Some(CameraDevice { auto_exposure: Some(automatic), config, .. }) => {
                Some(AutoExposure::new(automatic.config, config.exposure)?)
            }
            _ => None,
        };
        let eye = Self {
            optics: EyeOptics::new([camera.width, camera.height], lens)?,
            format: camera.format,
            near_m: camera.near_m,
            far_m: camera.far_m,
            visibility: visuals_of(camera.visibility_mask),
            exposure: 1.0,
            // Gazebo classic draws every image with sharp edges, whatever the file says.
            edges: if camera.anti_aliasing > 1 && !opening.gazebo_compat {
                Edges::Smooth
            } else {
                Edges::Sharp
            },
            noise: noise(&camera.noise)?,
            device: camera.device,
            automatic,
            first: automatic,
            seed: opening.seed,
            sensor: opening.sensor,
        };
        Camera::new(eye.config())?;
        Ok(eye)
    }

    /// Returns the camera with its current settings.
    pub(super) fn camera(&self) -> Camera<'_> {
        Camera::new(self.config()).expect("checked when it was made and when it is changed")
    }

    /// Returns the current configuration of the camera.
    pub(super) fn config(&self) -> CameraConfig<'_> {
        CameraConfig::new(self.optics.lend())
            .format(self.format)
            .near_m(self.near_m)
            .far_m(self.far_m)
            .visibility(self.visibility)
            .exposure(self.exposure)
            .edges(self.edges)
            .noise(self.noise)
            .device(self.device.map(|device| device.config))
            .seed(self.seed)
            .sensor(self.sensor)
    }

    /// Returns the device, if its frames are composed of several moments.
    pub(super) fn shutter(&self) -> Option<&CameraDevice> {
        self.device.as_ref().filter(|device| !device.is_of_one_moment())
    }

    /// Returns the longest time in ns by which a frame begins before its timestamp.
    pub(super) fn window_ns(&self) -> u64 {
        self.shutter().map_or(0, |device| (device.window_s() * 1e9).ceil() as u64)
    }

    /// Returns true if the exposure depends on earlier frames, so that every frame has to be rendered even without
    /// subscribers.
    pub(super) fn is_automatic(&self) -> bool {
        self.automatic.is_some()
    }

    /// Measures the brightness of an image, if the exposure is automatic.
    pub(super) fn meter(&self, picture: &[u8]) -> Option<FrameStatistics> {
        let metering = self.device?.auto_exposure?.metering;
        self.camera().meter(picture, metering).ok()
    }

    /// Chooses the exposure of the next frame from the brightness of the last one.
    pub(super) fn expose_next(&mut self, seen: Option<FrameStatistics>) {
        if let (Some(automatic), Some(device), Some(seen)) = (&mut self.automatic, &mut self.device, seen) {
            device.config.exposure = automatic.next(&seen);
        }
    }

    /// Restarts with the exposure of the first frame.
    pub(super) fn restart(&mut self) {
        if let (Some(device), Some(first)) = (&mut self.device, self.first) {
            self.automatic = Some(first);
            device.config.exposure = first.exposure();
        }
    }

    /// Applies other settings from the next frame on, if they are within their limits.
    pub(super) fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn Error>> {
        let (noise, exposure) = (settings.noise(&self.noise)?, settings.exposure());
        Camera::new(self.config().noise(noise).exposure(exposure))?;
        (self.noise, self.exposure) = (noise, exposure);
        Ok(())
    }
}

/// Returns the lens that is drawn, which matches `camera_info`. Gazebo's plugin reports its own coefficients, focal
/// length and principal point but draws without them, and `gazebo_compat` does the same.
pub(super) fn drawn_lens(camera: &CameraSensor, plugin: &CameraPlugin, gazebo_compat: bool) -> Lens {
    let mut lens = camera.lens.clone();
    if gazebo_compat {
        return lens;
    }
    let is_pinhole = matches!(lens.model, LensModel::Pinhole | LensModel::BrownConrady { .. });
    if is_pinhole && plugin.distortion != [0.0; 5] && !plugin.auto_distortion {
        let [k1, k2, k3, p1, p2] = plugin.distortion;
        lens.model = LensModel::BrownConrady { coefficients: vec![k1, k2, p1, p2, k3] };
    }
    let intrinsics = &mut lens.intrinsics;
    intrinsics.cx = plugin.principal_point[0].unwrap_or(intrinsics.cx);
    intrinsics.cy = plugin.principal_point[1].unwrap_or(intrinsics.cy);
    if let Some(focal) = plugin.focal_length {
        (intrinsics.fx, intrinsics.fy) = (focal, focal);
    }
    lens
}

/// Returns the model of a lens, or `None` for a pinhole without distortion and skew, which needs no table.
fn lens_model(lens: &Lens) -> Result<Option<Box<dyn optics::Lens>>, ParameterError> {
    let LensIntrinsics { fx, fy, cx, cy, skew } = lens.intrinsics;
    let intrinsics = Intrinsics { fx, fy, cx, cy, skew };
    Ok(Some(match &lens.model {
        LensModel::Pinhole if skew == 0.0 => return Ok(None),
        LensModel::Pinhole => Box::new(Pinhole::new(intrinsics)?),
        LensModel::BrownConrady { coefficients } if coefficients.iter().all(|k| *k == 0.0) && skew == 0.0 => {
            return Ok(None);
        }
        LensModel::BrownConrady { coefficients } => Box::new(BrownConrady::new(intrinsics, coefficients)?),
        LensModel::KannalaBrandt { k } => Box::new(KannalaBrandt::new(intrinsics, *k)?),
        LensModel::Eucm { alpha, beta } => Box::new(Eucm::new(intrinsics, *alpha, *beta)?),
        LensModel::DoubleSphere { xi, alpha } => Box::new(DoubleSphere::new(intrinsics, *xi, *alpha)?),
        LensModel::Mei { xi, k1, k2, p1, p2 } => Box::new(Mei::new(intrinsics, *xi, [*k1, *k2, *p1, *p2])?),
        LensModel::Equirectangular => Box::new(Equirectangular::with_intrinsics(intrinsics)?),
        LensModel::WideAngle { map, cutoff_angle_rad, .. } => {
            let AngleMap { c1, c2, c3, focal_px: f, function } = *map;
            let fun = match function {
                AngleFunction::Sine => Function::Sin,
                AngleFunction::Tangent => Function::Tan,
                AngleFunction::Identity => Function::Identity,
            };
            // The map's focal length is already in pixels.
            let in_pixels = Intrinsics { fx: 1.0, fy: 1.0, cx, cy, skew: 0.0 };
            Box::new(WideAngle::new(in_pixels, Mapping { c1, c2, c3, f, fun }, *cutoff_angle_rad)?)
        }
    }))
}

/// Returns true if a lens needs no table.
pub(super) fn is_pinhole(lens: &Lens) -> bool {
    matches!(lens_model(lens), Ok(None))
}

/// Returns the share of an image's pixels that its lens maps; the others are black.
///
/// # Errors
/// If a parameter of the lens is out of range.
pub(super) fn mapped_share(camera: &CameraSensor, lens: &Lens) -> Result<f64, ParameterError> {
    let Some(model) = lens_model(lens)? else { return Ok(1.0) };
    let pixels = (0..camera.height).flat_map(|row| (0..camera.width).map(move |column| [column, row]));
    let mapped =
        pixels.filter(|pixel| model.unproject(glam::DVec2::from_array(pixel.map(f64::from))).is_some());
    Ok(mapped.count() as f64 / (f64::from(camera.width) * f64::from(camera.height)))
}

impl EyeOptics {
    fn new([width, height]: [u32; 2], lens: &Lens) -> Result<Self, Box<dyn Error>> {
        if let Some(model) = lens_model(lens)? {
            return Ok(Self::Table(RayTableBuf::from_lens(width, height, &*model)?.into()));
        }
        let LensIntrinsics { fx, fy, cx, cy, skew } = lens.intrinsics;
        let pinhole = Pinhole::new(Intrinsics { fx, fy, cx, cy, skew })?;
        Ok(Self::Pinhole(PinholeGrid::new(width, height, pinhole)?))
    }

    fn lend(&self) -> Optics<'_> {
        match self {
            Self::Pinhole(grid) => Optics::Pinhole(*grid),
            Self::Table(table) => Optics::Table(table.table()),
        }
    }
}
