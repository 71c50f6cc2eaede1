//! Shapes of SDF, seen from above and compared with closed forms: by a GPU lidar, by a CPU lidar, and by a ball that
//! falls on them.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use glam::DVec3;
use image::{ImageBuffer, Luma};
use std::time::Duration;

/// A beam straight down from 10 m above a point.
fn lidar(kind: &str, [x, y]: [f64; 2]) -> String {
    format!(
        "<sdf version='1.6'><model name='eye'><static>true</static><pose>{x} {y} 10 0 1.5707963267948966 0</pose>
         <link name='l'><sensor name='s' type='{kind}'><ray><scan><horizontal><samples>1</samples><min_angle>0</min_angle>
         <max_angle>0</max_angle></horizontal></scan><range><min>0.1</min><max>20</max></range></ray><topic>scan</topic>
         </sensor></link></model></sdf>"
    )
}

fn thing(geometry: &str) -> String {
    format!(
        "<sdf version='1.9'><model name='thing'><static>true</static><link name='l'>
         <visual name='v'><geometry>{geometry}</geometry></visual>
         <collision name='c'><geometry>{geometry}</geometry></collision></link></model></sdf>"
    )
}

fn simulation(models: &[&str]) -> Simulation {
    let folder = tempfile::tempdir().unwrap();
    let world = folder.path().join("nothing.world");
    std::fs::write(&world, "<sdf version='1.6'><world name='nothing'/></sdf>").unwrap();
    let mut simulation = Simulation::builder(load::world(world.to_str().unwrap()).unwrap()).build().unwrap();
    for text in models {
        simulation.spawn(&load::model(text).unwrap(), SpawnOptions::default()).unwrap();
    }
    simulation
}

/// The height of the hit over each point; `None` if there is no hit.
#[track_caller]
fn assert_heights(geometry: &str, points: &[([f64; 2], Option<f64>)]) {
    for kind in ["gpu_ray", "ray"] {
        for (at, wanted) in points {
            let mut frame = FrameBuf::default();
            simulation(&[&thing(geometry), &lidar(kind, *at)]).render("scan", &mut frame).unwrap();
            let ranges: &[f32] = bytemuck::cast_slice(frame.view().payload());
            match wanted {
                Some(z) => {
                    let z_m = 10.0 - f64::from(ranges[0]);
                    assert!((z_m - z).abs() < 2e-5, "{kind} over {at:?}: {z_m} instead of {z}");
                }
                None => assert_eq!(ranges[0], f32::INFINITY, "{kind} over {at:?}"),
            }
        }
    }
}

#[test]
fn ellipsoids() {
    let z = |x: f64, y: f64| Some(0.5 * (1.0 - x * x - y * y / 4.0).sqrt());
    assert_heights(
        "<ellipsoid><radii>1 2 0.5</radii></ellipsoid>",
        &[
            ([0.0, 0.0], z(0.0, 0.0)),
            ([0.6, -1.0], z(0.6, -1.0)),
            ([0.2, 1.7], z(0.2, 1.7)),
            ([0.9, 1.0], None),
        ],
    );
}

#[test]
fn cones() {
    assert_heights(
        "<cone><radius>1</radius><length>2</length></cone>",
        &[([0.3, 0.4], Some(0.0)), ([0.0, -0.9], Some(-0.8)), ([0.8, 0.7], None)],
    );
}

/// A frame with a pillar in its window. The outlines have either winding, and one of them repeats its first point.
#[test]
fn polylines() {
    let outline = |points: &str, height: f64| {
        let points = points.replace(',', "</point><point>");
        format!("<polyline><point>{points}</point><height>{height}</height></polyline>")
    };
    let (frame, window) = ("-1 -1,1 -1,1 1,-1 1", "-.5 -.5,-.5 .5,.5 .5,.5 -.5,-.5 -.5");
    let pillar = "-.1 -.1,.1 -.1,0 .1";
    let geometry = [frame, pillar, window].map(|points| outline(points, 0.7)).concat();
    let (there, no) = (Some(0.7), None);
    assert_heights(
        &geometry,
        &[
            ([0.75, 0.2], there),
            ([-0.2, -0.9], there),
            ([0.0, 0.0], there),
            ([0.3, 0.3], no),
            ([1.2, 0.0], no),
        ],
    );
    // The shape is closed: it has the same height from below as from above. A concave outline keeps its notch.
    let bay = outline("0 0,2 0,2 2,1 0.5,0 2", 1.5);
    assert_heights(&bay, &[([0.1, 1.5], Some(1.5)), ([1.9, 1.5], Some(1.5)), ([1.0, 1.0], no)]);
    for wrong in [
        "<polyline><point>0 0</point><point>1 0</point></polyline>",
        &outline("0 0,1 1,2 2", 1.0),
        &outline("0 0,1 0,1 1", -1.0),
        // Each outline is a hole in the other.
        &outline("0 0,2 0,1 2", 1.0).repeat(2),
    ] {
        let errors = load::model(&thing(wrong)).unwrap_err().to_string();
        assert!(errors.contains("<polyline>"), "{errors}");
    }
}

/// A falling ball.
const BALL: &str = "<sdf version='1.6'><model name='ball'><pose>1 2 1.8 0 0 0</pose><link name='l'><inertial>
        <mass>1</mass><inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial>
        <collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model></sdf>";

/// Brightness increases to the right, and more so downwards: a plane, so the division of the cells does not matter. The
/// top of the picture is +y, and the height of its brightest pixel is that of the size.
#[test]
fn height_maps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slope.png");
    ImageBuffer::from_fn(5, 3, |column, row| Luma([1000 * column as u16 + 3000 * row as u16]))
        .save(&path)
        .unwrap();
    let map = |z: f64| {
        format!(
            "<heightmap><uri>file://{}</uri><size>8 6 {z}</size><pos>1 2 0.5</pos></heightmap>",
            path.display()
        )
    };
    // 4 columns and 2 rows of cells; 10,000 is the brightest value.
    let level = |x: f64, y: f64| ((x + 3.0) / 8.0 * 4000.0 + (5.0 - y) / 6.0 * 6000.0) / 10_000.0;
    let at = [[1.0, 2.0], [-2.5, 4.5], [4.3, -0.7], [3.9, 4.9]];
    let rising = at.map(|[x, y]| ([x, y], Some(0.5 + 2.0 * level(x, y))));
    assert_heights(&map(2.0), &rising);
    assert_heights(&map(2.0), &[([5.1, 2.0], None)]);
    // Upside down: black is the highest.
    let falling = at.map(|[x, y]| ([x, y], Some(0.5 + 0.5 * (6.5535 - level(x, y)))));
    assert_heights(&map(-0.5), &falling);

    // A ball on the slope: its centre is one radius above the plane, and it rolls down, towards −x and +y.
    let mut simulation = simulation(&[&thing(&map(2.0))]);
    let ball = simulation.spawn(&load::model(BALL).unwrap(), SpawnOptions::default()).unwrap();
    simulation.run_for(Duration::from_millis(1500));
    let middle = simulation.pose(ball).unwrap().translation();
    // z = 1.5 + 0.1 (x − 1) − 0.2 (y − 2)
    let normal = DVec3::new(-0.1, 0.2, 1.0).normalize();
    let distance = (middle - DVec3::new(1.0, 2.0, 1.5)).dot(normal);
    assert!((distance - 0.1).abs() < 2e-3, "{distance} m from the slope, at {middle}");
    assert!(middle.x < 0.95 && middle.y > 2.1, "{middle}");

    let flat = load::model(&thing(&map(0.0))).unwrap();
    assert!(flat.links[0].collisions.is_empty(), "without height it is left out: {flat:?}");
    for wrong in [map(2.0).replace("slope.png", "none.png"), "<heightmap/>".into()] {
        assert!(load::model(&thing(&wrong)).is_err(), "{wrong}");
    }
    let text = folder.path().join("dem.tif");
    std::fs::write(&text, b"II*\0").unwrap();
    let errors = load::model(&thing(&map(2.0).replace("slope.png", "dem.tif"))).unwrap_err().to_string();
    assert!(errors.contains("dem.tif") && errors.contains("PNG"), "{errors}");
}
