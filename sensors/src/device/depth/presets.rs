//! Depth cameras whose figures are published. What no sheet tells is marked as assumed or derived where it is set.

use super::{AxialNoise, DepthModel, DisparityNoise, SecondEye, published};

/// A depth camera that can be bought.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct DepthPreset {
    /// As files ask for it.
    pub name: &'static str,
    /// What it is called, and where its figures are from.
    pub source: &'static str,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Field of view across, in degrees.
    pub horizontal_fov_deg: f64,
    /// Least and greatest depth, in metres.
    pub range_m: [f64; 2],
    model: fn(f64) -> DepthModel,
}

/// Presets of one name are one.
impl PartialEq for DepthPreset {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl DepthPreset {
    /// What it makes of true depths, with pictures of that focal length in pixels: a stereo camera finds disparities in the
    /// pixels of its picture. A Kinect does so in its own, whatever picture it gives.
    #[must_use]
    pub fn model(&self, focal_px: f64) -> DepthModel {
        (self.model)(focal_px)
    }

    /// Focal length in pixels of a picture of its own size.
    #[must_use]
    pub fn focal_px(&self) -> f64 {
        let half = 0.5 * self.horizontal_fov_deg.to_radians();
        0.5 * f64::from(self.size[0]) / libm::tan(half)
    }
}

/// Structured light: noise and steps of a Kinect, and the shadow of a projector 75 mm to the right.
fn structured_light(_focal_px: f64) -> DepthModel {
    published::nguyen().steps(published::KINECT_STEPS).second_eye(SecondEye::at(0.075))
}

/// Stereo with a subpixel accuracy of 0.08 px, of Intel's 0.05 to 0.1, which is that of walls that face the camera: locking
/// shows on others.
fn stereo(focal_px: f64, baseline_m: f64, horizontal_fov_deg: f64) -> DepthModel {
    let (stddev_px, locking_px) = (0.08, published::D4XX_LOCKING_PX);
    published::active_stereo(focal_px, baseline_m, stddev_px, 0.5 * horizontal_fov_deg.to_radians())
        .noise(DisparityNoise { focal_px, baseline_m, stddev_px, locking_px })
        .matching(published::D4XX_MATCHING)
}

/// All of them.
pub const PRESETS: [DepthPreset; 8] = [
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

/// Their names, as files ask for them.
pub const NAMES: [&str; PRESETS.len()] = {
    let mut names = [""; PRESETS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = PRESETS[index].name;
        index += 1;
    }
    names
};

/// The preset of that name.
///
/// ```
/// use belvedere_sensors::device::depth::presets;
/// let d435 = presets::named("d435").expect("there is one");
/// assert_eq!((d435.size, d435.focal_px().round()), ([848, 480], 424.0));
/// assert!(presets::named("d999").is_none());
/// ```
#[must_use]
pub fn named(name: &str) -> Option<&'static DepthPreset> {
    PRESETS.iter().find(|preset| preset.name == name)
}
