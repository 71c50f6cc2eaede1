//! Scanners with lasers behind prisms and mirrors that rotate about a common axis, such as Livox's HAP and Mid-360.

use super::clock::{Clock, MINUTE_NS, Ticks, turns};
use super::firing::FiringLanes;
use crate::ParameterError;
use crate::simd::{LANES, Lanes, sin_cos, sqrt};
use core::f64::consts::{FRAC_PI_2, TAU};
use glam::DVec3;

/// The largest number of wheels of a scanner.
pub const MAX_WHEELS: usize = 4;
/// The number of moments at which [`Prisms::check`] and [`Prisms::half_angle_rad`] trace the beams.
const MOMENTS: usize = 16 * LANES;
/// The largest number of faces of a wheel.
const MAX_FACES: usize = 8;

/// The axis about which all wheels rotate, and from which the angles of the lasers are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// +x. Angles about it are counted from +y towards +z.
    Ahead,
    /// +z. Angles about it are counted from +x towards +y.
    Up,
}

/// A face of a wheel, which refracts or reflects light. Its normal is tilted from the axis in the direction in which
/// the wheel points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Face {
    /// A refracting face: light passes it by Snell's law.
    Refracting {
        /// The angle from the axis to the normal, in radians, −π/2 to π/2.
        tilt_rad: f64,
        /// The refractive index of the material behind the face, 1 (air) to 4.
        index: f64,
    },
    /// A mirror.
    Mirror {
        /// The angle from the axis to the normal, in radians, −π/2 to π/2.
        tilt_rad: f64,
    },
}

/// The deviation of a wheel from uniform rotation: `rad`·sin(2π·`rpm`·t + `phase_rad`), with the time t in minutes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// The amplitude in radians.
    pub rad: f64,
    /// The frequency in cycles per minute.
    pub rpm: i32,
    /// The phase at time 0, in radians.
    pub phase_rad: f64,
}

impl Swing {
    /// Uniform rotation.
    pub const NONE: Self = Self { rad: 0.0, rpm: 0, phase_rad: 0.0 };
}

/// A rotating prism or mirror: faces through which light passes one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel<'a> {
    /// The speed in turns per minute; negative values turn the other way.
    pub speed_rpm: i32,
    /// The direction in which the wheel points at time 0, in radians about the axis.
    pub phase_rad: f64,
    /// The deviation from uniform rotation.
    pub swing: Swing,
    /// The faces in the order in which light meets them. Behind the last is air.
    pub faces: &'a [Face],
}

/// Lasers behind wheels that rotate about one axis.
///
/// Each beam is refracted or reflected at every face of every wheel, so its direction follows from the positions of the
/// wheels at its time. The wheels return to the same positions after a minute or sooner.
///
/// Firings are in the order of time: volley by volley, and in each volley all lasers in their order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prisms<'a> {
    /// The time from one volley to the next, in nanoseconds.
    pub volley_time_ns: u32,
    /// The time from one laser of a volley to the next, in nanoseconds; 0 if all fire at once.
    pub laser_time_ns: u16,
    /// The axis about which the wheels rotate.
    pub axis: Axis,
    /// The angles of the lasers from the axis in radians, 1 to 64 of them: upwards if the axis is [`Axis::Ahead`],
    /// towards +y if it is [`Axis::Up`].
    pub lasers_rad: &'a [f64],
    /// The wheels in the order in which light meets them.
    pub wheels: Wheels<'a>,
}

/// The wheels of a scanner, 1 to [`MAX_WHEELS`] of them, in the order in which light meets them.
#[derive(Debug, Clone, Copy)]
pub struct Wheels<'a>(WheelList<'a>);

/// Where wheels are stored.
#[derive(Debug, Clone, Copy)]
enum WheelList<'a> {
    Borrowed(&'a [Wheel<'a>]),
    /// A thin reference, so that the list is no larger than a slice.
    #[cfg(feature = "alloc")]
    Owned(&'a WheelsBuf),
}

/// Wheels that own their faces.
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
pub(in crate::sensor) struct WheelsBuf(alloc::vec::Vec<WheelBuf>);

/// A [`Wheel`] that owns its faces.
#[cfg(feature = "alloc")]
#[derive(Debug, Clone)]
struct WheelBuf {
    /// The wheel without its faces.
    wheel: Wheel<'static>,
    faces: alloc::vec::Vec<Face>,
}

#[cfg(feature = "alloc")]
impl WheelsBuf {
    pub(in crate::sensor) fn copy_of(wheels: &Wheels<'_>) -> Self {
        let own = |Wheel { speed_rpm, phase_rad, swing, faces }: Wheel<'_>| WheelBuf {
            wheel: Wheel { speed_rpm, phase_rad, swing, faces: &[] },
            faces: faces.to_vec(),
        };
        Self(wheels.iter().map(own).collect())
    }
}

impl<'a> Wheels<'a> {
    /// Creates a list of wheels. [`Scanner::new`](super::Scanner::new) refuses a scanner with none of them, or with
    /// more than [`MAX_WHEELS`].
    #[must_use]
    pub const fn new(wheels: &'a [Wheel<'a>]) -> Self {
        Self(WheelList::Borrowed(wheels))
    }

    #[cfg(feature = "alloc")]
    pub(in crate::sensor) const fn owned(wheels: &'a WheelsBuf) -> Self {
        Self(WheelList::Owned(wheels))
    }

    /// Returns the number of wheels.
    #[must_use]
    pub const fn count(&self) -> usize {
        match self.0 {
            WheelList::Borrowed(wheels) => wheels.len(),
            #[cfg(feature = "alloc")]
            WheelList::Owned(wheels) => wheels.0.len(),
        }
    }

    /// Returns the wheels, one after the other.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = Wheel<'a>> + use<'a> {
        let list = self.0;
        (0..self.count()).map(move |index| match list {
            WheelList::Borrowed(wheels) => wheels[index],
            #[cfg(feature = "alloc")]
            WheelList::Owned(wheels) => Wheel { faces: &wheels.0[index].faces, ..wheels.0[index].wheel },
        })
    }
}

/// Lists with the same wheels are equal.
impl PartialEq for Wheels<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

/// Directions of up to 64 rays: components along the axis and along the two axes across it.
type Rays = [Lanes<f64>; 3];

impl Prisms<'_> {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, index: Option<usize>, value, rule| {
            let error = ParameterError::new("scanner", parameter, value, rule);
            Err(match index {
                Some(index) => error.at(index),
                None => error,
            })
        };
        self.clock().check("volley_time_ns", frame_time_ns)?;
        let lasers = self.lasers_rad.len();
        if !(1..=LANES).contains(&lasers) {
            return wrong("number of lasers_rad", None, lasers as f64, "1 to 64");
        }
        let last_ns = (lasers as u128 - 1) * u128::from(self.laser_time_ns);
        if last_ns >= u128::from(self.volley_time_ns) {
            let rule = "short enough that all lasers fire before the next volley";
            return wrong("laser_time_ns", None, f64::from(self.laser_time_ns), rule);
        }
        for (index, angle) in self.lasers_rad.iter().enumerate() {
            if !(-1.0..=1.0).contains(angle) {
                return wrong("lasers_rad", Some(index), *angle, "-1 to 1");
            }
        }
        if !(1..=MAX_WHEELS).contains(&self.wheels.count()) {
            return wrong("number of wheels", None, self.wheels.count() as f64, "1 to 4");
        }
        for (index, wheel) in self.wheels.iter().enumerate() {
            if let Err((parameter, value, rule)) = wheel.check() {
                return wrong(parameter, Some(index), value, rule);
            }
        }
        for (index, angle) in self.lasers_rad.iter().enumerate() {
            if moments().any(|at_ns| self.bent(*angle, &at_ns)[0].iter().any(|along| along.is_nan())) {
                return wrong("lasers_rad", Some(index), *angle, "an angle at which light passes all wheels");
            }
        }
        Ok(())
    }

    pub(super) fn clock(&self) -> Clock {
        Clock { tick_ns: self.volley_time_ns.into() }
    }

    pub(super) fn most_firings(&self, frame_time_ns: u64) -> u128 {
        u128::from(self.clock().most(frame_time_ns)) * self.lasers_rad.len() as u128
    }

    pub(super) fn time_s(&self, ticks: &Ticks, index: usize) -> f64 {
        let (volley, laser) = (index / self.lasers_rad.len(), index % self.lasers_rad.len());
        (ticks.at_ns(volley as u64) + laser as u64 * u64::from(self.laser_time_ns)) as f64 * 1e-9
    }

    /// Returns the largest angle between a beam and the axis, in radians.
    ///
    /// It is the maximum over some moments of a minute, accurate to a degree or so. Behind mirrors it is more than a
    /// right angle.
    #[must_use]
    pub fn half_angle_rad(&self) -> f64 {
        let along = |laser: &f64| {
            let all = moments().flat_map(|at_ns| self.bent(*laser, &at_ns)[0]);
            all.fold(1.0, |least: f64, along| if along < least { along } else { least })
        };
        libm::acos(self.lasers_rad.iter().map(along).fold(1.0, f64::min).clamp(-1.0, 1.0))
    }

    /// Returns the directions of a laser's beam at moments of a minute, along the axis and across it; NaN if it does
    /// not leave a wheel.
    fn bent(&self, laser_rad: f64, at_ns: &Lanes<i128>) -> Rays {
        let (sin, cos) = sin_cos(laser_rad);
        let mut rays: Rays = [[cos; LANES], [0.0; LANES], [sin; LANES]];
        self.bend(at_ns, &mut rays);
        rays
    }

    /// Sends rays through all wheels.
    #[inline(always)]
    fn bend(&self, at_ns: &Lanes<i128>, rays: &mut Rays) {
        for wheel in self.wheels.iter() {
            let mut turned = [0.0; LANES];
            for lane in 0..LANES {
                turned[lane] = wheel.turned(at_ns[lane]);
            }
            wheel.bend(&turned, rays);
        }
    }

    #[inline(always)]
    pub(super) fn fill(&self, ticks: &Ticks, (first, count): (usize, usize), lanes: &mut FiringLanes) {
        let mut at_ns = [0_i128; LANES];
        let mut rays: Rays = [[1.0; LANES], [0.0; LANES], [0.0; LANES]];
        for lane in 0..count {
            let (volley, laser) =
                ((first + lane) / self.lasers_rad.len(), (first + lane) % self.lasers_rad.len());
            let after_volley_ns = laser as u64 * u64::from(self.laser_time_ns);
            at_ns[lane] = ticks.in_minute_ns(volley as u64) + i128::from(after_volley_ns);
            lanes.time_s[lane] = (ticks.at_ns(volley as u64) + after_volley_ns) as f64 * 1e-9;
            lanes.laser[lane] = laser as u32;
            (rays[2][lane], rays[0][lane]) = sin_cos(self.lasers_rad[laser]);
        }
        self.bend(&at_ns, &mut rays);
        let [x, y, z] = match self.axis {
            Axis::Ahead => [0, 1, 2],
            Axis::Up => [1, 2, 0],
        };
        lanes.origin = [[0.0; LANES]; 3];
        lanes.direction = [rays[x], rays[y], rays[z]];
        // Light that does not leave a wheel at a moment that was not checked continues along the axis.
        let along = if self.axis == Axis::Ahead { DVec3::X } else { DVec3::Z };
        for lane in 0..count {
            if lanes.direction.iter().any(|part| !part[lane].is_finite()) {
                for axis in 0..3 {
                    lanes.direction[axis][lane] = along[axis];
                }
            }
        }
    }
}

/// Returns moments of a minute that cover the positions of the wheels. They are spaced by the golden section of a
/// minute, so that no angle repeats whatever the speeds are.
fn moments() -> impl Iterator<Item = Lanes<i128>> {
    let moment = |number: usize| number as i128 * 37_082_039_325 % MINUTE_NS;
    (0..MOMENTS).step_by(LANES).map(move |first| core::array::from_fn(|lane| moment(first + lane)))
}

impl Wheel<'_> {
    /// Checks the wheel; an error is the name of a parameter, its value and the rule that it breaks.
    fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        let swing = self.swing;
        if !(-TAU..=TAU).contains(&self.phase_rad) {
            return Err(("phase_rad of wheel", self.phase_rad, "-2π to 2π"));
        }
        if !(-TAU..=TAU).contains(&swing.rad) {
            return Err(("swing's rad of wheel", swing.rad, "-2π to 2π"));
        }
        if !(-TAU..=TAU).contains(&swing.phase_rad) {
            return Err(("swing's phase_rad of wheel", swing.phase_rad, "-2π to 2π"));
        }
        if !(1..=MAX_FACES).contains(&self.faces.len()) {
            return Err(("number of faces of wheel", self.faces.len() as f64, "1 to 8"));
        }
        let mut last = 1.0;
        for face in self.faces {
            if !(-FRAC_PI_2..=FRAC_PI_2).contains(&face.tilt_rad()) {
                return Err(("tilt_rad of a face of wheel", face.tilt_rad(), "-π/2 to π/2"));
            }
            if let Face::Refracting { index, .. } = *face {
                if !(1.0..=4.0).contains(&index) {
                    return Err(("index of a face of wheel", index, "1 to 4"));
                }
                last = index;
            }
        }
        if last != 1.0 {
            return Err(("index of the last face of wheel", last, "1: behind a wheel is air"));
        }
        Ok(())
    }

    /// Returns the direction in which the wheel points at a time since the beginning of some minute, in radians about
    /// the axis.
    #[inline(always)]
    fn turned(&self, at_ns: i128) -> f64 {
        let even = turns(at_ns, self.speed_rpm.into()) * TAU + self.phase_rad;
        if self.swing.rad == 0.0 {
            return even;
        }
        let (swung, _) = sin_cos(turns(at_ns, self.swing.rpm.into()) * TAU + self.swing.phase_rad);
        even + self.swing.rad * swung
    }

    /// Sends rays through all faces of the wheel; those that do not leave it become NaN.
    #[inline(always)]
    fn bend(&self, turned: &Lanes<f64>, rays: &mut Rays) {
        let (mut across, mut along) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            (across[lane], along[lane]) = sin_cos(turned[lane]);
        }
        let mut before = 1.0;
        for face in self.faces {
            let (tilted, straight) = sin_cos(face.tilt_rad());
            let ratio = match *face {
                Face::Refracting { index, .. } => Some(core::mem::replace(&mut before, index) / index),
                Face::Mirror { .. } => None,
            };
            for lane in 0..LANES {
                let normal = DVec3::new(straight, tilted * along[lane], tilted * across[lane]);
                let ray = DVec3::new(rays[0][lane], rays[1][lane], rays[2][lane]);
                let ray = ratio.map_or_else(|| reflected(ray, normal), |ratio| refracted(ray, normal, ratio));
                for axis in 0..3 {
                    rays[axis][lane] = ray[axis];
                }
            }
        }
    }
}

impl Face {
    const fn tilt_rad(&self) -> f64 {
        match *self {
            Self::Refracting { tilt_rad, .. } | Self::Mirror { tilt_rad } => tilt_rad,
        }
    }
}

/// Reflects a unit direction at a mirror with this unit normal.
#[inline(always)]
fn reflected(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// Refracts a unit direction at a face with this unit normal. `ratio` is the refractive index in front of the face
/// divided by that behind it. NaN in case of total reflection.
#[inline(always)]
fn refracted(direction: DVec3, normal: DVec3, ratio: f64) -> DVec3 {
    let along = direction.dot(normal);
    let rest = 1.0 - ratio * ratio * (1.0 - along * along);
    let root = if rest < 0.0 { f64::NAN } else { sqrt(rest) };
    let behind = if along < 0.0 { -root } else { root };
    let bent = direction * ratio + normal * (behind - ratio * along);
    bent * (1.0 / sqrt(bent.length_squared()))
}
