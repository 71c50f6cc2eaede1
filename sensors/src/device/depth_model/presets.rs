//! Depth cameras with published figures. Figures that no data sheet gives are marked as assumed or derived where they
//! are set.

use super::{AxialNoise, DepthModel, DisparityNoise, SecondEye, published};

/// A commercially available depth camera.
///
/// ```
/// use belvedere_sensors::device::depth_model::presets;
/// let d435 = presets::named("d435").expect("there is one");
/// assert_eq!((d435.size, d435.focal_px().round()), ([848, 480], 424.0));
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct DepthPreset {
    /// The name by which configuration files refer to the preset.
    pub name: &'static str,
    /// The product name, and the sources of the figures.
    pub source: &'static str,
    /// Width and height of the image in pixels.
    pub size: [u32; 2],
    /// Horizontal field of view, in degrees.
    pub horizontal_fov_deg: f64,
    /// Least and greatest depth in metres.
    pub range_m: [f64; 2],
    model: fn(f64) -> DepthModel,
}

/// Two presets with the same name are equal.
impl PartialEq for DepthPreset {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl DepthPreset {
    /// Returns the measurement model for images with the given focal length in pixels: a stereo camera computes
    /// disparities in the pixels of its image. A Kinect uses its own pixels, whatever the size of the image.
    #[must_use]
    pub fn model(&self, focal_px: f64) -> DepthModel {
        (self.model)(focal_px)
    }

    /// Returns the focal length in pixels of an image of the preset's own size.
    #[must_use]
    pub fn focal_px(&self) -> f64 {
        let half = 0.5 * self.horizontal_fov_deg.to_radians();
        0.5 * f64::from(self.size[0]) / libm::tan(half)
    }
}

/// Structured light: the noise and steps of a Kinect, and the shadow of a projector 75 mm to the right.
fn structured_light(_focal_px: f64) -> DepthModel {
    published::nguyen().steps(published::KINECT_STEPS).second_eye(SecondEye::at(0.075))
}

/// Stereo with a subpixel accuracy of 0.08 px, out of Intel's range of 0.05 to 0.1. This holds for walls that face the
/// camera; subpixel locking is visible on others.
fn stereo(focal_px: f64, baseline_m: f64, horizontal_fov_deg: f64) -> DepthModel {
    let (stddev_px, locking_px) = (0.08, published::D4XX_LOCKING_PX);
    published::active_stereo(focal_px, baseline_m, stddev_px, 0.5 * horizontal_fov_deg.to_radians())
        .noise(DisparityNoise { focal_px, baseline_m, stddev_px, locking_px })
        .matching(published::D4XX_MATCHING)
}

/// All presets.
pub const ALL: &[DepthPreset] = &[
    DepthPreset {
        name: "kinect_v1",
        source: "Microsoft Kinect (2010): 57° × 43°, 0.8 … 4 m, Kinect for Windows Sensor Components and Specifications; \
                 noise by Nguyen et al. 2012, steps by Khoshelham and Oude Elberink 2012, baseline 75 mm",
        size: [640, 480],
        horizontal_fov_deg: 57.0,
        range_m: [0.8, 4.0],
        model: structured_light,
    },
    DepthPreset {
        name: "xtion",
        source: "ASUS Xtion PRO LIVE: 58° × 45°, 0.8 … 3.5 m, its specifications; the Kinect's processor (PrimeSense PS1080), \
                 so its noise and steps, and its baseline is assumed",
        size: [640, 480],
        horizontal_fov_deg: 58.0,
        range_m: [0.8, 3.5],
        model: structured_light,
    },
    DepthPreset {
        name: "redwood",
        source: "A PrimeSense camera of 640 × 480 pixels by the noise of Redwood: Choi, Zhou, Koltun 2015, as simulators have it, \
                 with depths below 10 m; least depth and 57° are a Kinect v1's",
        size: [640, 480],
        horizontal_fov_deg: 57.0,
        range_m: [0.4, 10.0],
        model: |_| published::redwood(),
    },
    DepthPreset {
        name: "d415",
        source: "Intel RealSense D415 at 1280 × 720: 65° × 40°, baseline 55 mm; RMS z²·s/(f·B), Best-Known-Methods for Tuning \
                 D400; least depth derived: 126 pixels of disparity; greatest 10 m; how it finds what has no texture, and subpixel \
                 locking, are assumed",
        size: [1280, 720],
        horizontal_fov_deg: 65.0,
        range_m: [0.44, 10.0],
        model: |focal_px| stereo(focal_px, 0.055, 65.0),
    },
    DepthPreset {
        name: "d435",
        source: "Intel RealSense D435 at 848 × 480: 90° of its imagers, baseline 50 mm; as d415",
        size: [848, 480],
        horizontal_fov_deg: 90.0,
        range_m: [0.17, 10.0],
        model: |focal_px| stereo(focal_px, 0.05, 90.0),
    },
    DepthPreset {
        name: "d455",
        source: "Intel RealSense D455 at 848 × 480: 87° × 58°, baseline 95 mm; as d415",
        size: [848, 480],
        horizontal_fov_deg: 87.0,
        range_m: [0.34, 10.0],
        model: |focal_px| stereo(focal_px, 0.095, 87.0),
    },
    DepthPreset {
        name: "kinect_v2",
        source: "Microsoft Kinect for Xbox One: 70.6° × 60°, 0.5 … 4.5 m; noise by Fankhauser et al. 2015; 120, 80 and 16 MHz; \
                 the footprint is assumed",
        size: [512, 424],
        horizontal_fov_deg: 70.6,
        range_m: [0.5, 4.5],
        model: |_| published::fankhauser().window(published::KINECT_V2_LIGHT),
    },
    DepthPreset {
        name: "azure_kinect",
        source: "Microsoft Azure Kinect DK, NFOV unbinned: 75° × 65°, 0.5 … 3.86 m, random error of 17 mm at most, hardware \
                 specification; derived: σ = 17 mm · (z/3.5 m)², as amplitudes fall; some 200 MHz, Bamji et al. 2018; \
                 frequencies and footprint are assumed",
        size: [640, 576],
        horizontal_fov_deg: 75.0,
        range_m: [0.5, 3.86],
        model: |_| {
            let noise = AxialNoise { polynomial: [0.0, 0.0, 0.017 / (3.5 * 3.5)], ..AxialNoise::NONE };
            DepthModel::new().noise(noise).window(published::AZURE_LIGHT)
        },
    },
];

preset_names!(ALL: DepthPreset);
