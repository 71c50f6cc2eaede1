//! The points of a lidar with a regular grid of beams.

use crate::common::scenery;
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::SceneBuilder;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Pose, SenseError, Sensor};
use glam::DVec3;

#[test]
fn points_are_measured_ranges_along_the_beams() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let (scene, capture) = (builder.scene(), Capture::new(3, builder.moment(pose)));
    let mut workspace = WorkspaceBuf::default();
    // More and fewer columns than are computed at a time, one row and several, and rows beyond the pole.
    for (columns, rows) in
        [(360, Beams::between_degrees(16, -40.0, 110.0)), (200, Beams::ONE), (5, Beams::turn(9))]
    {
        let noise = GaussianNoise::of_stddev(0.05).unwrap();
        let config = LidarConfig::new(Beams::turn(columns)).vertical(rows).range_min_m(1.0).range_max_m(6.0);
        let lidar = Lidar::new(config.noise(noise)).unwrap();
        let mut ranges = vec![7.0; lidar.beams()];
        let mut points = vec![[7.0; 3]; lidar.beams()];
        let output = Scan::new().ranges(&mut ranges).points(&mut points);
        lidar.sense_in(&mut workspace, &scene, &capture, output).unwrap();
        for (beam, (range, point)) in ranges.iter().zip(&points).enumerate() {
            let (row, column) = (beam as u32 / columns, beam as u32 % columns);
            let (azimuth, elevation) = (config.horizontal.angle(column), config.vertical.angle(row));
            let [across, up] = [elevation.cos(), elevation.sin()];
            let direction = DVec3::new(across * azimuth.cos(), across * azimuth.sin(), up);
            if range.is_finite() {
                let expected = direction * f64::from(*range);
                assert!((DVec3::from(point.map(f64::from)) - expected).length() < 1e-6, "beam {beam}");
            } else {
                assert!(point.iter().all(|part| part.is_nan()), "beam {beam}");
            }
        }
        let measured = ranges.iter().filter(|range| range.is_finite()).count();
        assert!(measured > 0 && measured < ranges.len());
        // Points do not depend on whether ranges are requested too.
        let mut alone = vec![[7.0; 3]; lidar.beams()];
        lidar.sense_in(&mut workspace, &scene, &capture, Scan::new().points(&mut alone)).unwrap();
        let bits =
            |points: &[[f32; 3]]| points.as_flattened().iter().map(|part| part.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&alone), bits(&points));
        let short = lidar.sense_in(&mut workspace, &scene, &capture, Scan::new().points(&mut alone[1..]));
        let (value, need) = (lidar.beams() - 1, lidar.beams());
        assert_eq!(short, Err(SenseError::Output { parameter: "points", value, need }));
    }
}
