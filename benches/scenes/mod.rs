//! Generates the scenes and rays of the benchmarks. They are the same on every machine.
//!
//! | scene | what | triangles |
//! |---|---|---:|
//! | S1 | room of 10 × 8 × 3 m, 10 boxes, 10 cylinders of 48 sides | 2,112 |
//! | S2 | warehouse of 62 × 42 × 9 m, 200 racks of posts, boards and boxes | 100,392 |
//! | S3 | ball of 3 m with noise at three scales (edges of about 1 cm) over a ground | 997,376 |
//! | S4 | terrain of 100 × 100 m in cells of 0.2 m | 500,000 |
//!
//! | rays | what | count |
//! |---|---|---:|
//! | R1 | pinhole camera, 640 × 480, 60° wide | 307,200 |
//! | R2 | planar lidar, one ring | 720 |
//! | R3 | VLP-16, 16 rings of 2° | 28,800 |
//! | R4 | OS1-128, 128 rings over 45° | 131,072 |
//! | R5 | random origins in the scene, random directions | 1,000,000 |
//!
//! Metres, z up. All numbers are computed with + − × ÷ √, integer arithmetic and `libm`.

#![allow(dead_code, unused_imports, reason = "each target that includes this module uses a part of it")]
#![allow(unreachable_pub, reason = "a module of several targets, none of which exports it")]

mod blob;
pub mod fine;
pub mod level;
pub mod moving;
mod noise;
pub mod ours;
pub mod peer;
mod random;
pub mod rays;
mod room;
mod solids;
mod terrain;
mod warehouse;

use belvedere_sensors::Pose;
use glam::DVec3;
pub use rays::RaySet;

/// Triangles, counter-clockwise seen from outside.
pub struct Mesh {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh, and the poses of the sensors that see it.
pub struct Scene {
    pub name: &'static str,
    pub mesh: Mesh,
    /// The position of the sensors of R1 to R4, in single precision.
    pub position: DVec3,
    pub yaw_rad: f64,
    /// The camera's pitch, positive upwards. Lidars are level.
    pub pitch_rad: f64,
    /// The box in which the rays of R5 start.
    pub inside: [DVec3; 2],
    /// The seed of R5.
    seed: u64,
}

/// The names of the scenes.
pub const SCENES: [&str; 4] = ["S1", "S2", "S3", "S4"];
/// The names of the ray sets.
pub const RAYS: [&str; 5] = ["R1", "R2", "R3", "R4", "R5"];

impl Scene {
    /// Creates the scene with a name.
    ///
    /// # Panics
    /// If it is none of [`SCENES`].
    pub fn new(name: &str) -> Self {
        match name {
            "S1" => room::room(),
            "S2" => warehouse::warehouse(),
            "S3" => blob::blob(),
            "S4" => terrain::terrain(),
            _ => panic!("no scene {name:?}: there are {SCENES:?}"),
        }
    }

    /// Returns the pose of the camera.
    pub fn world_from_camera(&self) -> Pose {
        Pose::from_xyz_rpy(self.position, DVec3::new(0.0, -self.pitch_rad, self.yaw_rad))
    }

    /// Returns the pose of the lidars.
    pub fn world_from_lidar(&self) -> Pose {
        Pose::from_xyz_rpy(self.position, DVec3::new(0.0, 0.0, self.yaw_rad))
    }

    fn finish(
        name: &'static str,
        seed: u64,
        solids: solids::Solids,
        position: [f64; 3],
        [yaw_rad, pitch_rad]: [f64; 2],
    ) -> Self {
        let mesh = solids.finish();
        let position = DVec3::from_array(position.map(|x| f64::from(x as f32)));
        let mut inside = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for vertex in &mesh.vertices {
            let vertex = DVec3::from_array(vertex.map(f64::from));
            inside = [inside[0].min(vertex), inside[1].max(vertex)];
        }
        Self { name, mesh, position, yaw_rad, pitch_rad, inside, seed }
    }
}
