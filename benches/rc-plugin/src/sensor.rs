//! Finds the sensor to which a table of directions belongs. The benchmark gives the direction of every ray. The rule of
//! the sensor (a lens, steps of angles) is fitted to the corners of the table and then checked against each ray.

use belvedere_sensors::Pose;
use belvedere_sensors::optics::{Intrinsics, Pinhole};
use belvedere_sensors::optics::{Optics, PinholeGrid, SphericalGrid};
use core::f64::consts::TAU;
use glam::{DMat3, DQuat, DVec3};

/// The largest distance between a direction, a unit vector in single precision, and that of the rule.
const TOLERANCE: f64 = 3e-7;

/// A grid of rays, and its rotation in the world.
#[derive(Clone, Copy)]
pub(crate) struct Sensor {
    pub(crate) grid: Optics<'static>,
    world_from_sensor: DMat3,
}

impl Sensor {
    /// Returns the pose of the sensor if its rays start at an origin.
    pub(crate) fn pose(&self, origin: [f32; 3]) -> Pose {
        Pose::new(vector(origin), DQuat::from_mat3(&self.world_from_sensor))
    }

    /// Finds the sensor with these rays, row after row: a camera with its principal point in the middle, or an upright
    /// lidar that scans the full circle in equal steps. Returns `None` for other rays.
    fn fit([width, height]: [usize; 2], directions: &[[f32; 3]]) -> Option<Self> {
        if width < 2 || height < 1 || width > 16384 || height > 16384 || width * height != directions.len() {
            return None;
        }
        let table = Table { width, height, directions };
        [table.fit_pinhole(), table.fit_spherical()].into_iter().flatten().find(|sensor| table.is_of(sensor))
    }

    /// Returns the unit direction of a ray in the world.
    fn direction(&self, column: usize, row: usize) -> DVec3 {
        let (column, row) = (column as f64, row as f64);
        let in_sensor = match self.grid {
            Optics::Pinhole(grid) => {
                let Intrinsics { fx, fy, cx, cy, .. } = grid.intrinsics();
                DVec3::new(1.0, (cx - column) / fx, (cy - row) / fy).normalize()
            }
            Optics::Spherical(grid) => {
                let (sin, cos) = (grid.first_azimuth_rad + grid.azimuth_step_rad * column).sin_cos();
                let (up, level) = (grid.first_elevation_rad + grid.elevation_step_rad * row).sin_cos();
                DVec3::new(cos * level, sin * level, up)
            }
            // No other kind of grid is fitted.
            _ => return DVec3::ZERO,
        };
        self.world_from_sensor * in_sensor
    }
}

/// A table of directions, row after row.
struct Table<'a> {
    width: usize,
    height: usize,
    directions: &'a [[f32; 3]],
}

impl Table<'_> {
    fn at(&self, column: usize, row: usize) -> DVec3 {
        vector(self.directions[row * self.width + column])
    }

    fn fit_pinhole(&self) -> Option<Sensor> {
        if self.height < 2 {
            return None;
        }
        let (last_column, last_row) = (self.width - 1, self.height - 1);
        let top = [self.at(0, 0), self.at(last_column, 0)];
        let bottom = [self.at(0, last_row), self.at(last_column, last_row)];
        let forward = (top[0] + top[1] + bottom[0] + bottom[1]).try_normalize()?;
        let left = (top[0] - top[1] + bottom[0] - bottom[1]).try_normalize()?;
        let up = forward.cross(left).try_normalize()?;
        let left = up.cross(forward);
        let corner = top[0] / top[0].dot(forward);
        let (cx, cy) = (0.5 * last_column as f64, 0.5 * last_row as f64);
        let (fx, fy) = (cx / corner.dot(left), cy / corner.dot(up));
        let lens = Pinhole::new(Intrinsics { fx, fy, cx, cy, skew: 0.0 }).ok()?;
        let grid = PinholeGrid::new(self.width as u32, self.height as u32, lens).ok()?;
        let world_from_sensor = DMat3::from_cols(forward, left, up);
        Some(Sensor { grid: Optics::Pinhole(grid), world_from_sensor })
    }

    fn fit_spherical(&self) -> Option<Sensor> {
        let (first, next) = (self.at(0, 0), self.at(1, 0));
        let clockwise = first.x * next.y - first.y * next.x < 0.0;
        let step = TAU / self.width as f64;
        let elevations = [first.z, self.at(0, self.height - 1).z].map(|z| z.clamp(-1.0, 1.0).asin());
        let grid = SphericalGrid {
            columns: self.width as u32,
            rows: self.height as u32,
            first_azimuth_rad: 0.0,
            azimuth_step_rad: if clockwise { -step } else { step },
            first_elevation_rad: elevations[0],
            elevation_step_rad: (elevations[1] - elevations[0]) / (self.height - 1).max(1) as f64,
        };
        let forward = DVec3::new(first.x, first.y, 0.0).try_normalize()?;
        let left = DVec3::Z.cross(forward);
        Some(Sensor {
            grid: Optics::Spherical(grid),
            world_from_sensor: DMat3::from_cols(forward, left, DVec3::Z),
        })
    }

    /// Returns true if every ray is one of the sensor's.
    fn is_of(&self, sensor: &Sensor) -> bool {
        (0..self.height).all(|row| {
            (0..self.width).all(|column| {
                (self.at(column, row) - sensor.direction(column, row)).abs().max_element() <= TOLERANCE
            })
        })
    }
}

fn vector(single: [f32; 3]) -> DVec3 {
    DVec3::from_array(single.map(f64::from))
}

/// Caches the sensor of the last table, because a sensor is created once and used often.
#[derive(Default)]
pub(crate) struct Sensors {
    last: Option<(Key, Option<Sensor>)>,
}

/// The identity of a table: its address, its size, and a few of its directions.
#[derive(PartialEq)]
struct Key {
    address: usize,
    rows: [usize; 2],
    samples: [[f32; 3]; 3],
}

impl Sensors {
    /// Returns the sensor with these rays, if there is one.
    pub(crate) fn find(&mut self, rows: [usize; 2], directions: &[[f32; 3]]) -> Option<Sensor> {
        let (first, last) = (directions.first()?, directions.last()?);
        let key = Key {
            address: directions.as_ptr().addr(),
            rows,
            samples: [*first, directions[directions.len() / 2], *last],
        };
        match &self.last {
            Some((known, sensor)) if *known == key => *sensor,
            _ => {
                let sensor = Sensor::fit(rows, directions);
                self.last = Some((key, sensor));
                sensor
            }
        }
    }
}
