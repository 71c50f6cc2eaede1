//! The ray sets R1 to R5 of a scene.

use super::Scene;
use super::random::Random;
use belvedere_sensors::Pose;
use core::f64::consts::PI;
use glam::DVec3;

/// Rays, row by row, with the parameters by which a sensor model creates the same rays.
pub struct RaySet {
    pub name: &'static str,
    pub width: usize,
    pub height: usize,
    /// Origins in the world: one for all rays, or one for each.
    pub origins: Vec<[f32; 3]>,
    /// Directions in the world, of unit length except for rounding.
    pub directions: Vec<[f32; 3]>,
    pub source: Source,
}

/// The source of rays.
pub enum Source {
    /// A camera that looks along its x axis, y to the left; the rays go through pixel centres.
    Pinhole { world_from_sensor: Pose, focal_px: f64 },
    /// A lidar: rings from the first row on, clockwise seen from above.
    Rings { world_from_sensor: Pose, elevations_rad: Vec<f64> },
    /// No common origin.
    Random,
}

/// Random rays: R5.
pub const RANDOM_RAYS: usize = 1_000_000;

impl RaySet {
    /// Creates the rays with a name in a scene.
    ///
    /// # Panics
    /// If it is none of [`super::RAYS`].
    pub fn new(name: &str, scene: &Scene) -> Self {
        let rings = |name, elevations_deg: Vec<f64>, azimuths| {
            let elevations = elevations_deg.into_iter().map(|degrees| degrees * (PI / 180.0)).collect();
            Self::rings(name, scene, elevations, azimuths)
        };
        match name {
            "R1" => Self::pinhole("R1", scene, 640, 480, 60.0 * (PI / 180.0)),
            "R2" => rings("R2", vec![0.0], 720),
            "R3" => rings("R3", (0..16).map(|ring| 15.0 - 2.0 * f64::from(ring)).collect(), 1800),
            "R4" => rings("R4", (0..128).map(|ring| 22.5 - 45.0 / 127.0 * f64::from(ring)).collect(), 1024),
            "R5" => Self::random("R5", scene, RANDOM_RAYS),
            _ => panic!("no rays {name:?}: there are {:?}", super::RAYS),
        }
    }

    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Returns the origin of a ray.
    pub fn origin(&self, ray: usize) -> [f32; 3] {
        self.origins[if self.origins.len() == 1 { 0 } else { ray }]
    }

    /// Returns the first `count` rays if they are random; grids stay complete.
    #[must_use]
    pub fn first(mut self, count: usize) -> Self {
        if matches!(self.source, Source::Random) && count < self.len() {
            self.origins.truncate(count);
            self.directions.truncate(count);
            self.width = count;
        }
        self
    }

    fn pinhole(name: &'static str, scene: &Scene, width: usize, height: usize, fov_rad: f64) -> Self {
        let world_from_sensor = scene.world_from_camera();
        let focal_px = width as f64 / 2.0 / libm::tan(fov_rad / 2.0);
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let directions = pixels
            .map(|(column, row)| {
                let right = (column as f64 + 0.5 - width as f64 / 2.0) / focal_px;
                let down = (row as f64 + 0.5 - height as f64 / 2.0) / focal_px;
                unit(world_from_sensor.transform_vector(DVec3::new(1.0, -right, -down)))
            })
            .collect();
        Self::shared(
            name,
            scene,
            [width, height],
            directions,
            Source::Pinhole { world_from_sensor, focal_px },
        )
    }

    fn rings(name: &'static str, scene: &Scene, elevations_rad: Vec<f64>, azimuths: usize) -> Self {
        let world_from_sensor = scene.world_from_lidar();
        let mut directions = Vec::with_capacity(elevations_rad.len() * azimuths);
        for &elevation in &elevations_rad {
            let (up, level) = libm::sincos(elevation);
            directions.extend((0..azimuths).map(|step| {
                let (sin, cos) = libm::sincos(-(step as f64 + 0.5) * 2.0 * PI / azimuths as f64);
                unit(world_from_sensor.transform_vector(DVec3::new(level * cos, level * sin, up)))
            }));
        }
        let size = [azimuths, elevations_rad.len()];
        Self::shared(name, scene, size, directions, Source::Rings { world_from_sensor, elevations_rad })
    }

    fn shared(
        name: &'static str,
        scene: &Scene,
        [width, height]: [usize; 2],
        directions: Vec<[f32; 3]>,
        source: Source,
    ) -> Self {
        Self { name, width, height, origins: vec![scene.position.as_vec3().to_array()], directions, source }
    }

    fn random(name: &'static str, scene: &Scene, count: usize) -> Self {
        let mut random = Random::new(scene.seed);
        let [low, high] = scene.inside;
        let origins = (0..count)
            .map(|_| {
                let part = DVec3::new(random.unit(), random.unit(), random.unit());
                (low + (high - low) * (0.01 + 0.98 * part)).as_vec3().to_array()
            })
            .collect();
        let heights: Vec<f64> = (0..count).map(|_| random.unit() * 2.0 - 1.0).collect();
        let directions = heights
            .into_iter()
            .map(|z| {
                let (sin, cos) = libm::sincos(random.unit() * 2.0 * PI);
                let level = (1.0 - z * z).sqrt();
                unit(DVec3::new(level * cos, level * sin, z))
            })
            .collect();
        Self { name, width: count, height: 1, origins, directions, source: Source::Random }
    }
}

fn unit(direction: DVec3) -> [f32; 3] {
    (direction / direction.dot(direction).sqrt()).as_vec3().to_array()
}
