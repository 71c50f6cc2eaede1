//! Published measurement models, each with its original parameters.

use super::{
    AxialNoise, DepthModel, DisparityNoise, DisparitySteps, DotWindow, LateralNoise, Matching, Sampling,
    SecondEye, TimeOfFlight,
};
use core::f64::consts::FRAC_PI_3;

/// Lateral noise of a Kinect v1, from [`nguyen`].
pub const KINECT_LATERAL: LateralNoise =
    LateralNoise { stddev_px: 0.8, slant_px: 0.035, sampling: Sampling::Edges };

/// Axial noise of a Kinect v1, 0.0012 + 0.0019·(z − 0.4)² and more beyond 60°, from [`nguyen`].
pub const KINECT_AXIAL: AxialNoise = AxialNoise {
    polynomial: [0.0012 + 0.0019 * 0.4 * 0.4, -2.0 * 0.0019 * 0.4, 0.0019],
    slant: [0.0001, 0.0],
    slant_from_rad: FRAC_PI_3,
};

/// Disparity steps of a Kinect v1: eighths of a pixel of 1/580 of the distance, which are steps of 2.85e-3·z², from
/// [`khoshelham`].
pub const KINECT_STEPS: DisparitySteps =
    DisparitySteps { focal_px: 580.0, baseline_m: 0.125 / (580.0 * 2.85e-3), step_px: 0.125 };

/// Axial noise of a Kinect v2, from [`fankhauser`].
pub const KINECT_V2_AXIAL: AxialNoise =
    AxialNoise { polynomial: [0.0015, -0.0005, 0.0003], slant: [0.0, 0.0001], slant_from_rad: 0.0 };

/// Kinect v1 by its noise: C. V. Nguyen, S. Izadi, D. Lovell, "Modeling Kinect sensor noise for improved 3D
/// reconstruction and tracking", 3DIMPVT 2012. The lateral σ is 0.8 + 0.035·θ/(π/2 − θ) pixels, the axial σ is 1.2 +
/// 1.9·(z − 0.4)² mm, plus 0.1/√z · θ²/(π/2 − θ)² mm beyond 60°.
#[must_use]
pub fn nguyen() -> DepthModel {
    DepthModel::new().window(KINECT_LATERAL).noise(KINECT_AXIAL)
}

/// Kinect v1 by its disparities: K. Khoshelham, S. Oude Elberink, "Accuracy and resolution of Kinect depth data for
/// indoor mapping applications", Sensors 12 (2012) 1437. Steps are 2.85·z² mm, and the standard deviation is half of
/// that. It includes rounding, so the noise before rounding is √⅔ of it.
#[must_use]
pub fn khoshelham() -> DepthModel {
    let DisparitySteps { focal_px, baseline_m, step_px } = KINECT_STEPS;
    let stddev_px = 0.5 * step_px * libm::sqrt(2.0 / 3.0);
    DepthModel::new()
        .noise(DisparityNoise { focal_px, baseline_m, stddev_px, locking_px: 0.0 })
        .steps(KINECT_STEPS)
}

/// The depth noise of S. Choi, Q.-Y. Zhou, V. Koltun, "Robust reconstruction of indoor scenes", CVPR 2015, as used by
/// robot simulators, without its table of distortions. The lateral σ is 0.25 pixels. Disparities of 35.13/z with a σ of
/// 1/36 are rounded to eighths. The original has no depths beyond 10 m: set
/// [`max_depth_m`](crate::depth::DepthCameraConfig::max_depth_m).
#[must_use]
pub fn redwood() -> DepthModel {
    let (focal_px, baseline_m) = (468.4, 0.075);
    DepthModel::new()
        .window(LateralNoise { stddev_px: 0.25, ..LateralNoise::NONE })
        .noise(DisparityNoise { focal_px, baseline_m, stddev_px: 0.027_778, locking_px: 0.0 })
        .steps(DisparitySteps { focal_px, baseline_m, step_px: 0.125 })
}

/// The noise of ICL-NUIM: A. Handa, T. Whelan, J. `McDonald`, A. J. Davison, "A benchmark for RGB-D visual odometry, 3D
/// reconstruction and SLAM", ICRA 2014. The lateral σ is 0.5 pixels. A [`DotWindow`] with a focal length of 480 pixels
/// and a baseline of 75 mm leaves holes at edges. The resulting disparity, 35130/z with z in cm, gets a σ of 1/6 and is
/// rounded. The projector casts shadows. The original programs round z to centimetres first and add half a step, which
/// is omitted here.
#[must_use]
pub fn icl_nuim() -> DepthModel {
    let (focal_px, baseline_m) = (480.0, 0.075);
    let lateral = LateralNoise { stddev_px: 0.5, slant_px: 0.0, sampling: Sampling::Bilinear };
    // 35130 cm correspond to one step: eighths of a pixel with a focal length of 585.5 pixels at a baseline of 75 mm.
    let (fine_px, step_px) = (585.5, 0.125);
    DepthModel::new()
        .second_eye(SecondEye::at(baseline_m))
        .window(DotWindow { focal_px, baseline_m, lateral })
        .noise(DisparityNoise { focal_px: fine_px, baseline_m, stddev_px: step_px / 6.0, locking_px: 0.0 })
        .steps(DisparitySteps { focal_px: fine_px, baseline_m, step_px })
}

/// Active stereo as in Intel's white paper on the D4xx (A. Grunnet-Jepsen, J. N. Sweetser, J. Woodfill, "Tuning depth
/// cameras for best performance"): an RMS error of z²·s/(f·B) with a subpixel accuracy of s, and no depth where the
/// other imager, `baseline_m` to the right with the same field of view, does not see the point.
#[must_use]
pub fn active_stereo(focal_px: f64, baseline_m: f64, subpixel_px: f64, half_view_rad: f64) -> DepthModel {
    DepthModel::new().second_eye(SecondEye { right_m: baseline_m, half_view_rad }).noise(DisparityNoise {
        focal_px,
        baseline_m,
        stddev_px: subpixel_px,
        locking_px: 0.0,
    })
}

/// Kinect v2 by its noise: P. Fankhauser et al., "Kinect v2 for mobile robot navigation: evaluation and modeling", ICAR
/// 2015. The axial σ is 1.5 − 0.5·z + 0.3·z² + 0.1·z^1.5·θ²/(π/2 − θ)² mm.
#[must_use]
pub fn fankhauser() -> DepthModel {
    DepthModel::new().noise(KINECT_V2_AXIAL)
}

/// Modulated light of a Kinect v2: 120, 80 and 16 MHz, so that ranges repeat after 18.7 m (F. Järemo Lawin, P.-E.
/// Forssén, H. Ovrén, "Efficient multi-frequency phase unwrapping using kernel density estimation", ECCV 2016). The
/// footprint and the tolerance for phases are assumed.
pub const KINECT_V2_LIGHT: TimeOfFlight =
    TimeOfFlight { modulation_hz: [120e6, 80e6, 16e6], footprint_px: 0.5, most_off_rad: 0.45 };

/// Modulated light of an Azure Kinect: about 200 MHz on average, within 10 to 320 MHz (C. S. Bamji et al., "1Mpixel
/// 65nm BSI 320MHz demodulated TOF image sensor", ISSCC 2018). The frequencies are not published: 270, 180 and 120 MHz
/// are assumed, with which ranges repeat after 5 m and phase unwrapping works well. The footprint and the tolerance for
/// phases are assumed too.
pub const AZURE_LIGHT: TimeOfFlight =
    TimeOfFlight { modulation_hz: [270e6, 180e6, 120e6], footprint_px: 0.5, most_off_rad: 0.4 };

/// Stereo matching of a D4xx. Assumed: on a surface without texture that faces the camera, half of the pixels are
/// matched at 6 m, and disparities have their full accuracy up to 4.5 m. Intel only promises 99 % at 2 m.
pub const D4XX_MATCHING: Matching =
    Matching { projector: 0.5, half: 0.5 / 36.0, full: 0.5 / 20.25, spread: 0.2 };

/// Greatest displacement of disparities towards whole pixels in a D4xx. Assumed: Intel describes the effect, and a
/// parameter that reduces it by a factor of three to five, but not its size (A. Grunnet-Jepsen et al., "Subpixel
/// linearity improvement for Intel `RealSense` depth camera D400 series").
pub const D4XX_LOCKING_PX: f64 = 0.04;
