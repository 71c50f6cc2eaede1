//! Pictures through lenses of every model, ray by ray against an oracle in f64.

use crate::common::brute::{Found, Pair, Tally};
use crate::common::exactness::{Dice, SOLIDS, geosphere};
use crate::common::{Stage, depth_image, look_at, picture, scenery};
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, POINT_STEP};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::optics::{
    BrownConrady, DoubleSphere, Equirectangular, Eucm, Intrinsics, KannalaBrandt, Lens, Mapping, Mei, Optics,
    Pinhole, PinholeGrid, RayTableBuf, WideAngle,
};
use belvedere_sensors::scene::{
    Environment, InstanceConfig, MaterialConfig, SceneBuilder, Shape, visibility,
};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Capture, Execution, Pose, Sensor};
use core::f64::consts::PI;
use glam::{DVec2, DVec3};

/// Odd, and not a multiple of the four pixels of a block.
const SIZE: [u32; 2] = [161, 117];

/// The optical axis is not in the middle, and pixels are not square.
fn intrinsics(focal: f64) -> Intrinsics {
    Intrinsics { fx: focal, fy: focal * 1.01, cx: 81.3, cy: 57.2, skew: 0.0 }
}

/// A lens with a name, and whether pixels at the edge of the picture should see nothing.
type Named = (&'static str, Box<dyn Lens>, bool);

/// All models.
fn lenses() -> Vec<Named> {
    let [narrow, wide] = [130.0, 62.0].map(intrinsics);
    let brown = |intrinsics: Intrinsics, coefficients: &[f64]| {
        Box::new(BrownConrady::new(intrinsics, coefficients).unwrap())
    };
    let [width, height] = SIZE;
    let mapped = |degrees: f64, mapping: Mapping, cutoff: f64| {
        let (field, cutoff) = (degrees.to_radians(), cutoff.to_radians());
        Box::new(WideAngle::from_fov(width, height, field, mapping, true, cutoff).unwrap())
    };
    let custom = Mapping { c1: 1.05, c2: 4.0, ..Mapping::STEREOGRAPHIC };
    vec![
        ("plumb bob", brown(narrow, &[-0.28, 0.09, 8e-4, -3e-4, 0.02]), false),
        ("plumb bob with a rim", brown(wide, &[-0.4, 0.1, 0.0, 0.0, -0.05]), true),
        ("rational", brown(wide, &[5.2, 2.4, 3e-5, -1e-4, 0.1, 5.6, 4.1, 0.7]), false),
        (
            "thin prism",
            brown(narrow, &[0.1, 0.02, 5e-4, -1e-3, 0.0, 0.3, 0.04, 0.0, 4e-3, -1e-3, -3e-3, 8e-4]),
            false,
        ),
        (
            "tilted",
            brown(narrow, &[-0.2, 0.1, 1e-3, 2e-3, 0.0, 0.02, 0.0, 0.0, 1e-3, 0.0, -1e-3, 0.0, 0.12, -0.08]),
            false,
        ),
        (
            "fisheye",
            Box::new(KannalaBrandt::new(intrinsics(35.0), [0.02, -0.01, 3e-3, -1e-3]).unwrap()),
            true,
        ),
        ("fisheye of 220°", mapped(220.0 * 161.0 / 110.0, Mapping::EQUIDISTANT, 110.0), true),
        // 111° in the corners.
        ("fisheye without a rim", Box::new(KannalaBrandt::new(intrinsics(52.0), [0.0; 4]).unwrap()), false),
        ("EUCM", Box::new(Eucm::new(intrinsics(45.0), 0.63, 1.1).unwrap()), true),
        ("double sphere", Box::new(DoubleSphere::new(intrinsics(35.0), -0.2, 0.6).unwrap()), true),
        ("Mei", Box::new(Mei::new(intrinsics(80.0), 1.3, [-0.1, 0.01, 4e-4, -3e-4]).unwrap()), true),
        ("panorama", Box::new(Equirectangular::new(width, height).unwrap()), false),
        ("gnomonical", mapped(110.0, Mapping::GNOMONICAL, 90.0), false),
        ("stereographic", mapped(190.0, Mapping::STEREOGRAPHIC, 100.0), true),
        ("equisolid angle", mapped(180.0, Mapping::EQUISOLID_ANGLE, 95.0), true),
        ("orthographic", mapped(170.0, Mapping::ORTHOGRAPHIC, 90.0), true),
        ("custom", mapped(150.0, custom, 80.0), true),
    ]
}

/// All shapes, some of them twice, on all sides of the origin.
fn shapes_all_round() -> Pair {
    let mut pair = Pair::new();
    let mut dice = Dice(21);
    let (vertices, triangles) = geosphere(1);
    let dented: Vec<_> =
        vertices.iter().map(|[x, y, z]| [x * 0.6, y * (0.4 + 0.2 * x), z * (0.5 - 0.2 * y)]).collect();
    let mesh = pair.mesh(&dented, &triangles);
    let heights: Vec<_> = (0..9 * 7).map(|_| (dice.roll() * 0.4) as f32).collect();
    let field = pair.height_field(9, 7, [3.0, 2.5], &heights);
    let shapes: Vec<_> = SOLIDS[..7].iter().copied().chain([mesh, field]).collect();
    let count = shapes.len() + 5;
    for index in 0..count {
        // A spiral around the sphere with the golden angle.
        let up = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sin, cos) = (index as f64 * 2.399_963).sin_cos();
        let across = (1.0 - up * up).sqrt();
        let away = DVec3::new(cos * across, sin * across, up) * (1.3 + dice.roll());
        let shape = shapes[index % shapes.len()];
        let flat = shape == field || matches!(shape, Shape::Rectangle { .. });
        // Shapes with only one side show it.
        let turn = if flat {
            let faced = look_at(away, DVec3::ZERO, dice.roll()).rotation();
            Pose::new(away, faced * glam::DQuat::from_rotation_y(PI / 2.0 + 0.3))
        } else {
            Pose::from_xyz_rpy(away, dice.turn())
        };
        let scale = if index % 3 == 1 { [1.2, 0.7, 0.9] } else { [1.0; 3] };
        pair.add(shape, turn, scale);
    }
    pair.add(Shape::Plane, Pose::from_xyz_rpy(DVec3::Z * -3.0, DVec3::new(0.1, 0.05, 0.0)), [1.0; 3]);
    pair
}

fn wide(direction: [f32; 3]) -> DVec3 {
    DVec3::from_array(direction.map(f64::from))
}

/// Distances, instances, primitives, normals and barycentrics.
fn cast(stage: &Stage<'_>, pose: Pose, grid: &Optics<'_>) -> Vec<Found> {
    let rays = grid.size().into_iter().product();
    let (mut distance, mut instance, mut primitive) = (vec![0.0; rays], vec![0; rays], vec![0; rays]);
    let (mut normal, mut barycentrics) = (vec![[0.0; 3]; rays], vec![[0.0; 2]; rays]);
    cast_grid(
        &stage.scene,
        &stage.moment(pose),
        grid,
        [0.02, 300.0],
        visibility::VISUAL,
        Faces::Front,
        &mut WorkspaceBuf::default().lend(grid_workspace_len(&stage.scene, grid)),
        Hits {
            distance: Some(&mut distance),
            normal: Some(&mut normal),
            instance: Some(&mut instance),
            primitive: Some(&mut primitive),
            barycentrics: Some(&mut barycentrics),
        },
    )
    .unwrap();
    (0..rays)
        .map(|ray| Found {
            distance: distance[ray],
            instance: instance[ray],
            primitive: primitive[ray],
            barycentrics: barycentrics[ray],
            normal: normal[ray],
        })
        .collect()
}

/// Pixels, row by row.
fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    (0..height).flat_map(move |row| (0..width).map(move |column| (column, row)))
}

#[test]
fn each_ray_agrees_with_the_oracle() {
    let pair = shapes_all_round();
    let stage = Stage::from(&pair.builder);
    let pose = Pose::from_xyz_rpy(DVec3::new(0.05, -0.1, 0.02), DVec3::new(0.3, -0.2, 0.7));
    std::thread::scope(|scope| {
        for half in [0, 1] {
            let (pair, stage) = (&pair, &stage);
            scope.spawn(move || {
                for (name, lens, _) in lenses().iter().skip(half).step_by(2) {
                    one_lens(pair, stage, pose, name, &**lens);
                }
            });
        }
    });
}

fn one_lens(pair: &Pair, stage: &Stage<'_>, pose: Pose, name: &str, lens: &dyn Lens) {
    let [width, height] = SIZE;
    let table = RayTableBuf::from_lens(width, height, lens).unwrap();
    let found = cast(stage, pose, &Optics::from(&table));
    let depths = depth_image(*stage, DepthCameraConfig::new(CameraConfig::new(&table)), pose);
    let mut tally = Tally::default();
    let (mut dark, mut behind, mut worst_depth) = (0, 0, 0.0_f64);
    for ((found, depth), (column, row)) in found.iter().zip(depths).zip(pixels(SIZE)) {
        let what = || format!("{name}, column {column}, row {row}");
        let direction = wide(table.table().direction(column, row));
        if direction == DVec3::ZERO {
            dark += 1;
            let nothing = found.distance == f32::INFINITY && found.instance == u32::MAX;
            assert!(nothing && found.primitive == u32::MAX, "{}: {found:?}", what());
            assert_eq!(depth, f32::INFINITY, "{}", what());
            continue;
        }
        let direction = direction.normalize();
        let along = pose.rotation() * direction;
        let ray = (pose.translation(), DVec3::ZERO, along);
        pair.check(&what(), ray, [0.02, 300.0], false, found, 1.0, &mut tally);
        // The depth is measured along the axis, so surfaces beside or behind the camera are too near.
        let expected = f64::from(found.distance) * direction.x;
        if found.distance == f32::INFINITY {
            assert_eq!(depth, f32::INFINITY, "{}", what());
        } else if direction.x <= 0.0 {
            behind += 1;
            assert_eq!(depth, f32::NEG_INFINITY, "{}", what());
        } else {
            let off = (f64::from(depth) / expected - 1.0).abs();
            assert!(off <= 1e-5, "{}: a depth of {depth}, not {expected}", what());
            worst_depth = worst_depth.max(off);
        }
    }
    let Tally { rays, hits, doubtful, worst } = tally;
    println!(
        "{name:26} {rays:5} rays, {dark:5} pixels without; {hits:5} hits, {behind:4} of them behind, {doubtful} at an \
         edge; distance {worst:.1e}, depth {worst_depth:.1e} off"
    );
    assert!(hits * 3 > rays && doubtful * 1000 <= rays, "{name}: {hits} hits, {doubtful} at an edge");
}

#[test]
fn directions_are_those_of_the_lens() {
    let [width, height] = SIZE;
    let mut worst = 0.0_f64;
    for (name, lens, has_rim) in &lenses() {
        let table = RayTableBuf::from_lens(width, height, &**lens).unwrap();
        let mut dark = 0;
        for (column, row) in pixels(SIZE) {
            let direction = table.table().direction(column, row);
            let Some(expected) = lens.unproject(DVec2::new(column.into(), row.into())) else {
                dark += 1;
                assert_eq!(direction, [0.0; 3], "{name}, column {column}, row {row}");
                continue;
            };
            // In the order forward, left, up.
            let expected = DVec3::new(expected.z, -expected.x, -expected.y);
            let angle = expected.cross(wide(direction)).length().atan2(expected.dot(wide(direction)));
            assert!(angle < 1e-7, "{name}, column {column}, row {row}: {angle} rad off");
            worst = worst.max(angle);
        }
        assert_eq!(dark > 0, *has_rim, "{name}: {dark} pixels see nothing");
    }
    println!("directions: {worst:.1e} rad off at most");
}

#[test]
fn pixels_without_a_ray_are_black() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    builder.set_environment(Environment { ambient: [0.8; 3], background: [0.9, 0.8, 0.7] });
    let stage = Stage::from(&builder);
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    // Far above black, so that noise would be visible.
    let noise = GaussianNoise::new(GaussianNoiseConfig::default().mean(0.4).stddev(0.1)).unwrap();
    let [width, height] = SIZE;
    for (name, lens, has_rim) in &lenses() {
        if !has_rim {
            continue;
        }
        let table = RayTableBuf::from_lens(width, height, &**lens).unwrap();
        for noise in [GaussianNoise::NONE, noise] {
            let config = CameraConfig::new(&table).noise(noise);
            let colours = picture(stage, config, pose);
            let depth_camera = DepthCameraConfig::new(config).model(noise).faces(Faces::Front);
            let depth_camera = DepthCamera::new(depth_camera).unwrap();
            let count = depth_camera.pixels();
            let (mut metres, mut millimetres) = (vec![0.0; count], vec![1; count]);
            let (mut same_colours, mut points) = (vec![0; 3 * count], vec![0; POINT_STEP * count]);
            let capture = Capture::new(0, stage.moment(pose));
            depth_camera
                .sense(
                    &stage.scene,
                    &capture,
                    &mut WorkspaceBuf::default().lend(depth_camera.workspace_len(&stage.scene, &capture)),
                    DepthFrame::new()
                        .depth_32fc1(&mut metres)
                        .depth_16uc1(&mut millimetres)
                        .colour(&mut same_colours)
                        .points(&mut points),
                )
                .expect("outputs of the right size");
            assert!(colours == same_colours, "{name}: the depth camera's colours are others");
            for (pixel, (column, row)) in pixels(SIZE).enumerate() {
                let colour = &colours[3 * pixel..][..3];
                let has_ray = table.table().direction(column, row) != [0.0; 3];
                let place = format!("{name}, column {column}, row {row}");
                if has_ray {
                    assert!(colour != [0; 3], "{place} is black");
                } else {
                    assert_eq!(colour, [0; 3], "{place}");
                    assert_eq!((metres[pixel], millimetres[pixel]), (f32::INFINITY, 0), "{place}");
                    let point = &points[POINT_STEP * pixel..][..POINT_STEP];
                    for coordinate in point[..12].as_chunks::<4>().0 {
                        assert!(f32::from_le_bytes(*coordinate).is_nan(), "{place}: a point of the cloud");
                    }
                    assert_eq!(point[16..20], [0; 4], "{place}: the colour of the cloud's point");
                }
            }
        }
    }
}

/// A slanted textured rectangle 2 m wide, 1 m ahead, and nothing else.
fn poster(size: u32, texel: impl Fn(u32, u32) -> u8) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.set_environment(Environment { ambient: [1.0; 3], background: [0.5; 3] });
    let texels: Vec<_> = pixels([size; 2]).map(|(column, row)| [texel(column, row); 4]).collect();
    let texture = Some(builder.add_texture(size, size, &texels).unwrap());
    let material =
        MaterialConfig { ambient: [1.0; 3], diffuse: [0.0; 3], texture, ..MaterialConfig::default() };
    let material = builder.add_material(&material).unwrap();
    let config = InstanceConfig {
        shape: Shape::Rectangle { size: [6.0; 2] },
        world_from_instance: Pose::from_xyz_rpy(DVec3::X, DVec3::new(0.2, -PI / 2.0 + 0.35, 0.25)),
        material,
        ..InstanceConfig::default()
    };
    builder.add_instance(&config).unwrap();
    builder
}

/// The red values of all pixels.
fn reds(builder: &SceneBuilder, [width, height]: [u32; 2], lens: &dyn Lens) -> Vec<f64> {
    let table = RayTableBuf::from_lens(width, height, lens).unwrap();
    let bytes = picture(builder, CameraConfig::new(&table), Pose::IDENTITY);
    bytes.chunks(3).map(|pixel| pixel[0].into()).collect()
}

/// A lens with this many times as many pixels across and down as another.
struct Finer<'a>(&'a dyn Lens, f64);

impl Lens for Finer<'_> {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        self.0.project(point_in_optical).map(|pixel| (pixel + 0.5) * self.1 - 0.5)
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        self.0.unproject((pixel + 0.5) / self.1 - 0.5)
    }
}

#[test]
fn a_textured_wall_through_a_lens_is_the_distorted_pinhole_picture() {
    // Waves of 48 texels: smooth, so that interpolation between pixels has a small error.
    let wave = |at: u32| (f64::from(at) * PI / 24.0).sin();
    let builder = poster(512, |column, row| (127.5 + 60.0 * wave(column) + 60.0 * wave(row)) as u8);
    let [width, height] = SIZE;
    let straight = Pinhole::new(intrinsics(130.0)).unwrap();
    let lens = BrownConrady::new(intrinsics(130.0), &[-0.12, 0.03, 4e-4, -3e-4, 0.0]).unwrap();
    let seen = reds(&builder, SIZE, &lens);
    // The picture of the pinhole, with a margin for the wider view of the lens.
    let margin = 20;
    let wide_size = [width + 2 * margin, height + 2 * margin];
    let Intrinsics { cx, cy, .. } = straight.intrinsics();
    let shifted =
        Intrinsics { cx: cx + f64::from(margin), cy: cy + f64::from(margin), ..straight.intrinsics() };
    let wide_lens = Pinhole::new(shifted).unwrap();
    let flat = reds(&builder, wide_size, &wide_lens);
    let (mut sum, mut most, mut moved) = (0.0, 0.0_f64, 0.0_f64);
    for (value, (column, row)) in seen.iter().zip(pixels(SIZE)) {
        let pixel = DVec2::new(column.into(), row.into());
        let at = wide_lens.project(lens.unproject(pixel).unwrap()).unwrap();
        moved = moved.max((at - f64::from(margin)).distance(pixel));
        let (whole, part) = (at.floor(), at - at.floor());
        let value_at =
            |x: usize, y: usize| flat[(whole.y as usize + y) * wide_size[0] as usize + whole.x as usize + x];
        let line = |y| value_at(0, y) * (1.0 - part.x) + value_at(1, y) * part.x;
        let off = (line(0) * (1.0 - part.y) + line(1) * part.y - value).abs();
        sum += off;
        most = most.max(off);
    }
    let mean = sum / seen.len() as f64;
    println!("wall: {mean:.3} levels off in the mean, {most:.1} at most; moved by {moved:.1} px at most");
    assert!(moved > 4.0, "moved by {moved} px: that is no distortion");
    assert!(mean < 0.6 && most < 5.0, "{mean} levels off in the mean, {most} at most");
}

/// The root mean square difference from a picture with 25 rays per pixel, in levels, up to 53° from the axis.
fn noise_of_sampling(builder: &SceneBuilder, lens: &dyn Lens) -> f64 {
    let [width, height] = SIZE;
    let factor = 5;
    let once = reds(builder, SIZE, lens);
    let many = reds(builder, [width * factor, height * factor], &Finer(lens, factor.into()));
    let (mut sum, mut count) = (0.0, 0);
    for (value, (column, row)) in once.iter().zip(pixels(SIZE)) {
        if lens.unproject(DVec2::new(column.into(), row.into())).is_none_or(|ray| ray.z < 0.6) {
            continue;
        }
        let squares = pixels([factor; 2])
            .map(|(x, y)| many[((row * factor + y) * width * factor + column * factor + x) as usize]);
        let mean = squares.sum::<f64>() / f64::from(factor * factor);
        sum += (value - mean) * (value - mean);
        count += 1;
    }
    (sum / f64::from(count)).sqrt()
}

#[test]
fn textures_are_filtered_as_through_a_pinhole() {
    // Each lens after the pinhole with its focal length.
    let lenses: [(&str, Box<dyn Lens>); 5] = [
        ("pinhole", Box::new(Pinhole::new(intrinsics(130.0)).unwrap())),
        (
            "plumb bob",
            Box::new(BrownConrady::new(intrinsics(130.0), &[-0.12, 0.03, 4e-4, -3e-4, 0.0]).unwrap()),
        ),
        ("pinhole", Box::new(Pinhole::new(intrinsics(75.0)).unwrap())),
        ("fisheye", Box::new(KannalaBrandt::new(intrinsics(75.0), [0.02, -0.01, 3e-3, -1e-3]).unwrap())),
        ("EUCM", Box::new(Eucm::new(intrinsics(75.0), 0.6, 1.1).unwrap())),
    ];
    // Squares of a dozen pixels or more, of about one pixel, and smaller ones, which become grey.
    for (squares, most) in [(64, 10.0), (4, 12.0), (1, 3.0)] {
        let chequers = |column: u32, row: u32| {
            if (column / squares + row / squares).is_multiple_of(2) { 255 } else { 0 }
        };
        let builder = poster(2048, chequers);
        let off = lenses.each_ref().map(|(name, lens)| (*name, noise_of_sampling(&builder, &**lens)));
        println!("squares of {squares} texels: {off:.2?} levels off");
        let mut pinhole = 0.0;
        for (name, off_by) in off {
            pinhole = if name == "pinhole" { off_by } else { pinhole };
            assert!(off_by < most && off_by < 1.5 * pinhole + 1.0, "{name}: {off_by}, the pinhole {pinhole}");
        }
    }
}

#[test]
fn a_table_of_a_pinhole_measures_like_the_pinhole() {
    let pair = shapes_all_round();
    let stage = Stage::from(&pair.builder);
    let [width, height] = SIZE;
    let lens = Pinhole::new(intrinsics(95.0)).unwrap();
    let rule = PinholeGrid::new(width, height, lens).unwrap();
    let table = RayTableBuf::from_lens(width, height, &lens).unwrap();
    for yaw in [0.0, 1.6, 3.1, -1.5] {
        let pose = Pose::from_xyz_rpy(DVec3::new(0.05, -0.1, 0.02), DVec3::new(0.3, -0.2, yaw));
        let depths = |config| depth_image(stage, DepthCameraConfig::new(config), pose);
        let (by_rule, by_table) = (depths(CameraConfig::new(rule)), depths(CameraConfig::new(&table)));
        let (hits, other) = (cast(&stage, pose, &rule.into()), cast(&stage, pose, &(&table).into()));
        let (mut worst, mut unlike, mut seen) = (0.0_f32, 0, 0);
        for pixel in 0..by_rule.len() {
            let names = |found: &Found| (found.instance, found.primitive);
            // The clip distances of a pinhole are depths.
            if hits[pixel].distance.min(other[pixel].distance) > 200.0 {
                continue;
            }
            if names(&hits[pixel]) != names(&other[pixel]) {
                // An edge is between the two rays, whose directions differ by a rounding error.
                unlike += 1;
            } else if by_rule[pixel] != by_table[pixel] {
                worst = worst.max((by_table[pixel] / by_rule[pixel] - 1.0).abs());
            }
            seen += usize::from(by_rule[pixel].is_finite());
        }
        println!("pinhole, yaw {yaw}: {seen} hits, {unlike} of others, depth {worst:.1e} off");
        assert!(seen * 3 > by_rule.len() && unlike <= 2, "{unlike} of {seen} pixels see something else");
        assert!(worst <= 1e-5, "depths {worst} off");
    }
}

/// Colours and depths of the scenery through a fisheye, with noise.
fn fisheye_frame(execution: Execution) -> (Vec<u8>, Vec<u32>) {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let lens = KannalaBrandt::new(
        Intrinsics { fx: 75.0, fy: 75.5, cx: 166.2, cy: 121.4, skew: 0.3 },
        [0.02, -0.01, 3e-3, -1e-3],
    )
    .unwrap();
    let table = RayTableBuf::from_lens(333, 245, &lens).unwrap();
    let noise = GaussianNoise::new(
        GaussianNoiseConfig::default().mean(0.001).stddev(0.007).bias_mean(0.002).bias_stddev(0.001),
    )
    .unwrap();
    let camera =
        DepthCamera::new(DepthCameraConfig::new(CameraConfig::new(&table).noise(noise)).model(noise))
            .unwrap();
    let (mut colours, mut depths) = (vec![0; camera.camera().frame_len()], vec![0.0; camera.pixels()]);
    let scene = builder.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let capture = Capture::new(7, builder.moment(pose));
    camera
        .sense(
            &scene,
            &capture,
            &mut workspace.lend(camera.workspace_len(&scene, &capture)),
            DepthFrame::new().depth_32fc1(&mut depths).colour(&mut colours),
        )
        .expect("outputs of the right size");
    (colours, depths.into_iter().map(f32::to_bits).collect())
}

#[test]
fn the_same_bytes_for_all_levels_and_threads() {
    let best = Level::new();
    let mut executions = vec![("the best", Execution::at(best))];
    #[cfg(target_arch = "x86_64")]
    for (name, level) in [
        ("SSE2", best.as_sse2().map(Level::Sse2)),
        ("AVX2", best.as_avx2().map(Level::Avx2)),
        ("AVX-512", best.as_avx512().map(Level::Avx512)),
    ] {
        match level {
            Some(level) => executions.push((name, Execution::at(level))),
            None => println!("this machine has no {name}: not tested"),
        }
    }
    let expected = fisheye_frame(Execution::at(Level::baseline()));
    assert!(expected.0.iter().filter(|byte| **byte != 0).count() > expected.0.len() / 3);
    for (name, execution) in executions {
        assert!(fisheye_frame(execution) == expected, "{name} differs");
    }
    #[cfg(feature = "rayon")]
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| fisheye_frame(Execution::parallel()));
        assert!(found == expected, "{threads} threads differ");
    }
}
