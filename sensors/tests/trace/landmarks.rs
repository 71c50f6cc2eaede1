//! Sightings of landmarks at the corners of tags: against projections and occlusions in double precision and in closed
//! form, through lenses and rolling shutters, from random positions.
#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common;

use crate::common::add_grey;
use belvedere_sensors::optics::{
    Intrinsics, KannalaBrandt, Lens, Mapping, Optics, Pinhole, PinholeGrid, RayTableBuf, SphericalGrid,
    WideAngle,
};
use belvedere_sensors::scene::{InstanceConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::{Landmark, Sighting, WorkspaceBuf, landmarks_workspace_len, see_landmarks};
use belvedere_sensors::{Moment, Pose, SenseError, Shutter, Slice};
use glam::{DMat3, DVec2, DVec3};

const RANGE: [f64; 2] = [0.05, 50.0];
/// The number of plates with tags, and of balls that occlude them.
const PLATES: usize = 6;
const BALLS: usize = 5;
const PLATE: DVec3 = DVec3::new(1.2, 0.9, 0.02);

/// A xorshift generator of numbers in [−1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    fn pose(&mut self, reach: f64) -> Pose {
        Pose::from_xyz_rpy(self.vector() * reach, self.vector() * 3.2)
    }
}

/// Plates with four landmarks each on their upper face, and balls, all at random, far from the world's origin.
struct Story {
    builder: SceneBuilder,
    landmarks: Vec<Landmark>,
    balls: Vec<(DVec3, f64)>,
    sensor: Pose,
}

const FAR: DVec3 = DVec3::new(30_000.0, -20_000.0, 50.0);

impl Story {
    fn new(random: &mut Random) -> Self {
        let mut builder = SceneBuilder::new();
        let mut landmarks = Vec::new();
        for _ in 0..PLATES {
            let pose = Pose::from_translation(FAR) * random.pose(4.0);
            let plate = add_grey(&mut builder, Shape::Box { size: PLATE.to_array() }, pose);
            let half = PLATE / 2.0;
            landmarks.extend([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, y)| Landmark {
                instance: plate.0,
                point: DVec3::new(x * 0.8 * half.x, y * 0.8 * half.y, half.z),
                normal: DVec3::Z,
            }));
        }
        let mut ball = || {
            let (centre, radius) = (FAR + random.vector() * 3.0, 0.5 + 0.3 * random.next());
            add_grey(&mut builder, Shape::Sphere { radius }, Pose::from_translation(centre));
            (centre, radius)
        };
        let balls = (0..BALLS).map(|_| ball()).collect();
        // Visible to lidars but not to cameras.
        let config = InstanceConfig {
            shape: Shape::Sphere { radius: 0.3 },
            visibility: visibility::COLLISION,
            ..builder_config(&mut builder)
        };
        // From outside of all objects, because an object that contains the camera hides nothing.
        let (eye, target) = (random.vector().normalize() * 8.5, random.vector() * 7.0);
        let sensor = common::look_at(FAR + eye, FAR + target, 3.2 * random.next());
        let around = InstanceConfig { world_from_instance: sensor, ..config };
        builder.add_instance(&around).unwrap();
        Self { builder, landmarks, balls, sensor }
    }

    fn moment(&self, world_from_sensor: Pose) -> Moment<'_> {
        self.builder.moment(world_from_sensor)
    }

    fn see(&self, optics: &Optics<'_>, shutter: &Shutter<'_>, level: Level) -> Vec<Sighting> {
        let (scene, mut memory) = (self.builder.scene(), WorkspaceBuf::default());
        memory.execution.level = level;
        let workspace = &mut memory.lend(landmarks_workspace_len(&scene, optics));
        let mut seen = vec![Sighting::NONE; self.landmarks.len()];
        see_landmarks(&scene, shutter, optics, RANGE.into(), workspace, &self.landmarks, &mut seen).unwrap();
        seen
    }

    /// A landmark in the optical frame of a sensor.
    fn in_optical(&self, landmark: &Landmark, world_from_sensor: &Pose) -> DVec3 {
        let in_world = self.world(landmark);
        let p =
            world_from_sensor.rotation_matrix().transpose() * (in_world - world_from_sensor.translation());
        DVec3::new(-p.y, -p.z, p.x)
    }

    fn world(&self, landmark: &Landmark) -> DVec3 {
        self.builder.poses()[landmark.instance as usize].transform_point(landmark.point)
    }

    /// The distance in metres by which objects clear the line of sight to a landmark; negative if it is occluded. For
    /// balls, from the distance of their centres to the line; for plates, from its intersection with the planes of
    /// their faces.
    fn free(&self, landmark: &Landmark, from: DVec3) -> f64 {
        let to = self.world(landmark);
        let along = (to - from).normalize();
        let distance = to.distance(from);
        let balls = self.balls.iter().map(|&(centre, radius)| {
            let at = (centre - from).dot(along).clamp(0.0, distance);
            (from + along * at).distance(centre) - radius
        });
        let plates = (0..PLATES).filter(|&plate| plate != landmark.instance as usize).map(|plate| {
            let pose = self.builder.poses()[plate].inverse();
            let (start, end) = (pose.transform_point(from), pose.transform_point(to));
            // The distance outside of a box, at the best of many points between: enough to distinguish clear cases.
            let outside = |t: f64| (start.lerp(end, t).abs() - PLATE / 2.0).max_element();
            pierced(start, end)
                .unwrap_or_else(|| (0..=400).map(|i| outside(f64::from(i) / 400.0)).fold(9.0, f64::min))
        });
        balls.chain(plates).fold(9.0, f64::min)
    }
}

/// The distance from the edges of a plate to the point at which a line crosses its middle plane, negative inside;
/// `None` if the line does not cross that plane within the segment.
fn pierced(start: DVec3, end: DVec3) -> Option<f64> {
    let t = start.z / (start.z - end.z);
    let inside = (start.lerp(end, t).abs() - PLATE / 2.0).truncate().max_element();
    ((0.0..=1.0).contains(&t) && inside < 0.0).then_some(inside)
}

fn builder_config(builder: &mut SceneBuilder) -> InstanceConfig {
    InstanceConfig { material: common::glowing(builder, [0.5; 3]), ..Default::default() }
}

/// The expected sighting of a landmark by a camera with these optics at one moment; `None` in doubtful cases, at edges.
fn expected(
    story: &Story,
    landmark: &Landmark,
    sensor: &Pose,
    lens: &dyn Lens,
    size: [u32; 2],
) -> Option<bool> {
    let optical = story.in_optical(landmark, sensor);
    let Some(at) = lens.project(optical) else { return Some(false) };
    let size = DVec2::new(size[0].into(), size[1].into());
    let around = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y].map(|way| at + way * 2.0);
    if around.iter().any(|&pixel| lens.unproject(pixel).is_none()) {
        return None;
    }
    let margin = (at + 0.5).min(size - 0.5 - at).min_element();
    let pose = &story.builder.poses()[landmark.instance as usize];
    let facing = -(pose.rotation_matrix() * landmark.normal)
        .dot((story.world(landmark) - sensor.translation()).normalize());
    let free = story.free(landmark, sensor.translation());
    let measures = [margin, facing, free];
    if measures.iter().any(|&measure| measure < -0.03) {
        return Some(false);
    }
    measures.iter().all(|&measure| measure > 0.03).then_some(true)
}

fn pinhole(size: [u32; 2]) -> Pinhole {
    let [cx, cy] = size.map(|size| f64::from(size - 1) / 2.0 + 0.3);
    Pinhole::new(Intrinsics { fx: 240.0, fy: 250.0, cx, cy, skew: 0.0 }).unwrap()
}

fn fisheye() -> KannalaBrandt {
    let lens = Intrinsics { fx: 105.0, fy: 104.0, cx: 160.5, cy: 121.0, skew: 0.0 };
    KannalaBrandt::new(lens, [0.02, -0.004, 0.001, 0.0]).unwrap()
}

/// A circular picture: the corners see nothing.
fn circle() -> WideAngle {
    let mapping = Mapping {
        c1: 1.0,
        c2: 1.0,
        c3: 0.0,
        f: 1.0,
        fun: belvedere_sensors::optics::AngleFunction::Identity,
    };
    let lens = Intrinsics { fx: 70.0, fy: 70.0, cx: 160.0, cy: 120.0, skew: 0.0 };
    WideAngle::new(lens, mapping, 1.65).unwrap()
}

const SIZE: [u32; 2] = [321, 241];

#[test]
fn landmarks_are_projected_and_occluded_like_the_oracle() {
    let (pinhole, fisheye, circle) = (pinhole(SIZE), fisheye(), circle());
    let tables =
        [&fisheye as &dyn Lens, &circle].map(|lens| RayTableBuf::from_lens(SIZE[0], SIZE[1], lens).unwrap());
    let grid = PinholeGrid::new(SIZE[0], SIZE[1], pinhole).unwrap();
    let cameras: [(&str, Optics<'_>, &dyn Lens, f64); 3] = [
        ("pinhole", grid.into(), &pinhole, 1e-8),
        // Between rays, directions are interpolated linearly.
        ("fisheye", (&tables[0]).into(), &fisheye, 2e-3),
        ("circle", (&tables[1]).into(), &circle, 4e-3),
    ];
    let mut random = Random(7);
    let stories: Vec<_> = (0..400).map(|_| Story::new(&mut random)).collect();
    for (name, optics, lens, tolerance) in cameras {
        let (mut worst, mut shown, mut hidden, mut doubtful) = (0.0_f64, 0, 0, 0);
        for story in &stories {
            let shutter = Shutter::Global(story.moment(story.sensor));
            let seen = story.see(&optics, &shutter, best_level());
            let plain = story.see(&optics, &shutter, Level::baseline());
            assert_eq!(format!("{seen:?}"), format!("{plain:?}"), "the same bits at every level");
            for (landmark, seen) in story.landmarks.iter().zip(&seen) {
                let optical = story.in_optical(landmark, &story.sensor);
                let expected = expected(story, landmark, &story.sensor, lens, SIZE);
                match expected {
                    Some(expected) => assert_eq!(seen.visible, expected, "{name}: {seen:?}"),
                    None => doubtful += 1,
                }
                (shown, hidden) =
                    (shown + u32::from(expected == Some(true)), hidden + u32::from(expected == Some(false)));
                if seen.visible {
                    let at = lens.project(optical).unwrap();
                    worst = worst.max((DVec2::from_array(seen.pixel) - at).abs().max_element());
                    assert!((seen.depth - optical.z).abs() < 1e-9);
                }
            }
        }
        println!("{name}: {shown} shown, {hidden} hidden, {doubtful} at an edge; {worst:.1e} px at worst");
        assert!(shown > 1500 && hidden > 1500 && doubtful * 10 < shown + hidden && worst < tolerance);
    }
}

#[test]
fn a_rolling_shutter_sees_landmarks_when_their_row_is_captured() {
    let (pinhole, fisheye) = (pinhole(SIZE), fisheye());
    let table = RayTableBuf::from_lens(SIZE[0], SIZE[1], &fisheye).unwrap();
    let grid = PinholeGrid::new(SIZE[0], SIZE[1], pinhole).unwrap();
    let mut random = Random(11);
    for (optics, lens, lines, tolerance) in
        [(Optics::from(grid), &pinhole as &dyn Lens, 1, 1e-8), ((&table).into(), &fisheye, 4, 2e-3)]
    {
        let (mut worst, mut shown, mut moved) = (0.0_f64, 0, 0.0_f64);
        for _ in 0..150 {
            let story = Story::new(&mut random);
            // Up to a third of a radian, and half a metre, per frame.
            let (turn, way) = (random.vector() * 0.3, random.vector() * 0.5);
            let at = |row: u32| {
                let share = f64::from(row) / f64::from(SIZE[1]);
                let there = Pose::from_xyz_rpy(way * share, turn * share);
                story.sensor * there
            };
            let slices: Vec<_> = (0..SIZE[1])
                .step_by(lines)
                .map(|row| Slice { lines: row..(row + lines as u32).min(SIZE[1]), at: story.moment(at(row)) })
                .collect();
            let seen = story.see(&optics, &Shutter::Slices(&slices), best_level());
            for (landmark, seen) in story.landmarks.iter().zip(&seen) {
                let project = |sensor: &Pose| lens.project(story.in_optical(landmark, sensor));
                // Every moment at which the row of the point is being captured; usually one.
                let taken = slices.iter().enumerate().filter_map(|(index, Slice { lines, at })| {
                    let pixel = project(&at.world_from_sensor)?;
                    let row = (pixel.y + 0.5).floor();
                    (row >= 0.0 && lines.contains(&(row as u32))).then_some((index, pixel))
                });
                let taken: Vec<_> = taken.collect();
                if let [(slice, pixel)] = *taken {
                    let sensor = &slices[slice].at.world_from_sensor;
                    let expected = expected(&story, landmark, sensor, lens, SIZE);
                    assert!(expected.is_none_or(|expected| expected == seen.visible), "{seen:?} {pixel}");
                    if seen.visible {
                        assert_eq!(seen.slice, slice);
                        worst = worst.max((DVec2::from_array(seen.pixel) - pixel).abs().max_element());
                        moved = moved.max(project(&story.sensor).map_or(0.0, |first| first.distance(pixel)));
                        shown += 1;
                    }
                }
            }
        }
        println!("{shown} shown, {worst:.1e} px at worst, up to {moved:.0} px from where they were at first");
        assert!(shown > 500 && worst < tolerance && moved > 30.0);
    }
}

/// A camera that turns by ω per row about its vertical axis while a point straight ahead is in its middle row.
#[test]
fn a_turning_camera_in_closed_form() {
    let size = [641, 481];
    let pinhole = Pinhole::new(Intrinsics { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0, skew: 0.0 }).unwrap();
    let mut builder = SceneBuilder::new();
    let ahead = Pose::from_translation(DVec3::X * 5.0);
    let plate = add_grey(
        &mut builder,
        Shape::Rectangle { size: [1.0, 1.0] },
        Pose::new(
            ahead.translation(),
            glam::DQuat::from_mat3(&DMat3::from_cols(DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X)),
        ),
    );
    let landmark = Landmark { instance: plate.0, point: DVec3::ZERO, normal: DVec3::Z };
    let turned = |row: u32| Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Z * (5e-4 * f64::from(row)));
    let slices: Vec<_> =
        (0..size[1]).map(|row| Slice { lines: row..row + 1, at: builder.moment(turned(row)) }).collect();
    let (scene, mut memory) = (builder.scene(), WorkspaceBuf::default());
    let optics = Optics::from(PinholeGrid::new(size[0], size[1], pinhole).unwrap());
    let workspace = &mut memory.lend(landmarks_workspace_len(&scene, &optics));
    let mut seen = [Sighting::NONE];
    see_landmarks(
        &scene,
        &Shutter::Slices(&slices),
        &optics,
        RANGE.into(),
        workspace,
        &[landmark],
        &mut seen,
    )
    .unwrap();
    // Turned to the left by 0.12 rad in row 240.
    assert!((seen[0].pixel[0] - (320.0 + 400.0 * 0.12_f64.tan())).abs() < 1e-9);
    assert!((seen[0].pixel[1] - 240.0).abs() < 1e-9 && seen[0].visible && seen[0].slice == 240);

    // In a grid of angles, the same point is found by its azimuth, 10 columns of 0.01 rad to the right of the first.
    let grid = SphericalGrid {
        columns: 100,
        rows: 11,
        first_azimuth_rad: 0.1,
        azimuth_step_rad: -0.01,
        first_elevation_rad: 0.05,
        elevation_step_rad: -0.01,
    };
    let optics = Optics::from(grid);
    let workspace = &mut memory.lend(landmarks_workspace_len(&scene, &optics));
    let still = Shutter::Global(builder.moment(Pose::IDENTITY));
    see_landmarks(&scene, &still, &optics, RANGE.into(), workspace, &[landmark], &mut seen).unwrap();
    assert!(
        (seen[0].pixel[0] - 10.0).abs() < 1e-3 && (seen[0].pixel[1] - 5.0).abs() < 1e-3 && seen[0].visible
    );
}

#[test]
fn errors_name_the_invalid_input() {
    let story = Story::new(&mut Random(3));
    let scene = story.builder.scene();
    let optics = Optics::from(PinholeGrid::from_fov(64, 48, 1.0).unwrap());
    let shutter = Shutter::Global(story.moment(story.sensor));
    let see = |range: [f64; 2], lines: usize, landmarks: &[Landmark], places| {
        let (mut memory, mut seen) = (WorkspaceBuf::default(), vec![Sighting::NONE; places]);
        let mut workspace = memory.lend(lines);
        workspace.buffer = &mut workspace.buffer[..lines];
        see_landmarks(&scene, &shutter, &optics, range.into(), &mut workspace, landmarks, &mut seen)
    };
    let need = landmarks_workspace_len(&scene, &optics);
    let [first, ..] = story.landmarks[..] else { panic!("there are landmarks") };
    assert_eq!(see(RANGE, need, &[first], 1), Ok(()));
    assert_eq!(see([2.0, 1.0], need, &[first], 1), Err(SenseError::Range { least: 2.0, most: 1.0 }));
    assert_eq!(see(RANGE, need - 1, &[first], 1), Err(SenseError::Workspace { value: need - 1, need }));
    let places = see(RANGE, need, &[first], 2);
    assert_eq!(places, Err(SenseError::Output { parameter: "seen", value: 2, need: 1 }));
    let nobody = Landmark { instance: 99, ..first };
    let error = see(RANGE, need, &[nobody], 1).unwrap_err();
    assert_eq!(error.to_string(), "a landmark is on instance 99; the scene has 12, counted from 0");
}
