//! Tables of directions: the same hits as the grids from which they were taken, and as each ray cast alone.

use crate::common::{Stage, add_grey, scenery};
use belvedere_sensors::optics::{Optics, PinholeGrid, RayTable, SphericalGrid, TableError};
use belvedere_sensors::scene::{SceneBuilder, Shape, visibility};
use belvedere_sensors::trace::rays::{Rays, cast_rays, workspace_len};
use belvedere_sensors::trace::{CacheLine, Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Execution, Pose};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::{DQuat, DVec3};

/// Directions, row by row.
struct Directions {
    width: u32,
    height: u32,
    all: Vec<[f32; 3]>,
}

impl Directions {
    fn new(width: u32, height: u32, direction: impl Fn(u32, u32) -> DVec3) -> Self {
        let rays = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let all = rays.map(|(column, row)| direction(column, row).normalize().as_vec3().to_array()).collect();
        Self { width, height, all }
    }

    fn turned(&self, by: DQuat) -> Self {
        let turn =
            |direction: &[f32; 3]| (by * DVec3::from_array(direction.map(f64::from))).as_vec3().to_array();
        Self { all: self.all.iter().map(turn).collect(), ..*self }
    }

    /// Calls `work` with the table.
    fn table<T>(&self, work: impl FnOnce(&RayTable<'_>) -> T) -> T {
        let mut buffer = vec![CacheLine::ZERO; RayTable::required_len(self.width, self.height)];
        work(&RayTable::build(self.width, self.height, &self.all, &mut buffer).expect("a valid table"))
    }
}

fn pinhole(grid: &PinholeGrid) -> Directions {
    let ([width, height], lens) = (grid.size(), grid.intrinsics());
    Directions::new(width, height, |column, row| {
        let left = (lens.cx - f64::from(column)) / lens.fx;
        DVec3::new(1.0, left, (lens.cy - f64::from(row)) / lens.fy)
    })
}

fn polar(azimuth: f64, elevation: f64) -> DVec3 {
    DVec3::new(azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos(), elevation.sin())
}

fn spherical(grid: &SphericalGrid) -> Directions {
    Directions::new(grid.columns, grid.rows, |column, row| {
        polar(
            grid.first_azimuth_rad + f64::from(column) * grid.azimuth_step_rad,
            grid.first_elevation_rad + f64::from(row) * grid.elevation_step_rad,
        )
    })
}

/// A fisheye after Kannala and Brandt with a view of 190°: r = f·(θ + k₁θ³ + k₂θ⁵), inverted by bisection.
fn fisheye(size: u32) -> Directions {
    let radius = |angle: f64| angle - 0.03 * angle.powi(3) + 0.002 * angle.powi(5);
    let edge = 95.0_f64.to_radians();
    let focal = f64::from(size) * 0.5 / radius(edge);
    let centre = f64::from(size - 1) * 0.5;
    Directions::new(size, size, |column, row| {
        let (right, down) = ((f64::from(column) - centre) / focal, (f64::from(row) - centre) / focal);
        let wanted = right.hypot(down);
        let [mut low, mut high] = [0.0, 2.4];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if radius(middle) < wanted { low = middle } else { high = middle }
        }
        let sine = low.sin() / wanted.max(1e-12);
        DVec3::new(low.cos(), -right * sine, -down * sine)
    })
}

/// The rings of a Velodyne VLP-32C: elevations from its manual (63-9325), in degrees, and the azimuth offsets of its
/// lasers.
fn vlp_32c(columns: u32, clockwise: bool) -> Directions {
    const ELEVATIONS: [f64; 32] = [
        -25.0, -15.639, -11.31, -8.843, -7.254, -6.148, -5.333, -4.667, -4.0, -3.667, -3.333, -3.0, -2.667,
        -2.333, -2.0, -1.667, -1.333, -1.0, -0.667, -0.333, 0.0, 0.333, 0.667, 1.0, 1.333, 1.667, 2.333,
        3.333, 4.667, 7.0, 10.333, 15.0,
    ];
    const OFFSETS: [f64; 4] = [1.4, -4.2, 4.2, -1.4];
    Directions::new(columns, 32, |column, row| {
        let azimuth = f64::from(column) / f64::from(columns) * TAU + OFFSETS[row as usize % 4].to_radians();
        polar(if clockwise { -azimuth } else { azimuth }, ELEVATIONS[row as usize].to_radians())
    })
}

/// The solids, rectangles and small meshes of the scenery, and meshes of many triangles and a height field.
fn scene() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let count = 60_u32;
    let at = |x: u32, y: u32| {
        let (x, y) = (f64::from(x) * 0.2 - 6.0, f64::from(y) * 0.2 - 6.0);
        [x as f32, y as f32, ((x * 1.3).sin() * (y * 0.9).cos() * 0.4) as f32]
    };
    let corners: Vec<_> =
        (0..=count).flat_map(|y| (0..=count).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
    let faces: Vec<_> = (0..count)
        .flat_map(|y| (0..count).map(move |x| y * (count + 1) + x))
        .flat_map(|first| {
            let above = first + count + 1;
            [[first, first + 1, above + 1], [first, above + 1, above]]
        })
        .collect();
    let mesh = builder.add_mesh(&corners, &[], &faces).expect("a valid mesh");
    add_grey(&mut builder, Shape::Mesh(mesh), Pose::from_translation(DVec3::new(0.0, 0.0, -1.0)));
    let overhead = Pose::from_xyz_rpy(DVec3::new(0.5, 0.3, 4.0), DVec3::new(0.2, -0.3, 0.8));
    add_grey(&mut builder, Shape::Mesh(mesh), overhead);
    let wall = Pose::from_xyz_rpy(DVec3::new(-6.0, 0.0, 0.0), DVec3::new(0.0, 1.4, 0.3));
    add_grey(&mut builder, Shape::Mesh(mesh), wall);
    builder
}

/// The viewpoints of the tests.
const EYES: [DVec3; 3] =
    [DVec3::new(-1.37, 0.21, 1.13), DVec3::new(0.5, -2.2, 0.6), DVec3::new(2.9, 2.4, 2.05)];

#[derive(Debug, PartialEq, Default, Clone)]
struct Found {
    distance: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    primitive: Vec<u32>,
}

impl Found {
    fn empty(rays: usize) -> Self {
        Self {
            distance: vec![0.0; rays],
            normal: vec![[0.0; 3]; rays],
            instance: vec![0; rays],
            primitive: vec![0; rays],
        }
    }

    fn hits(&mut self) -> Hits<'_> {
        Hits {
            distance: Some(&mut self.distance),
            normal: Some(&mut self.normal),
            instance: Some(&mut self.instance),
            primitive: Some(&mut self.primitive),
            barycentrics: None,
        }
    }

    fn name(&self, ray: usize) -> [u32; 2] {
        [self.instance[ray], self.primitive[ray]]
    }
}

fn cast(stage: &Stage<'_>, pose: &Pose, grid: &Optics<'_>, execution: Execution) -> Found {
    let [width, height] = grid.size();
    let mut found = Found::empty(width * height);
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    cast_grid(
        &stage.scene,
        &stage.moment(*pose),
        grid,
        [0.0, f64::INFINITY],
        visibility::VISUAL,
        Faces::Both,
        &mut workspace.lend(grid_workspace_len(&stage.scene, grid)),
        found.hits(),
    )
    .unwrap();
    found
}

fn cast_each(stage: &Stage<'_>, origin: DVec3, directions: &[[f32; 3]]) -> Found {
    let mut found = Found::empty(directions.len());
    let rays = Rays { origins: &[[0.0; 3]], directions, ranges: None };
    let mut workspace = WorkspaceBuf::default();
    cast_rays(
        &stage.scene,
        stage.poses,
        origin,
        &rays,
        visibility::VISUAL,
        Faces::Both,
        &mut workspace.lend(workspace_len(&stage.scene)),
        found.hits(),
    )
    .expect("outputs of the right size");
    found
}

/// Returns true if two distances are equal within a tolerance.
fn close(a: f32, b: f32, tolerance: f32) -> bool {
    a == b || (a - b).abs() <= tolerance * a.abs()
}

/// Casts a table, and each of its rays alone. They hit the same surface at the same distance, unless there is an edge
/// within 1e-6 of the ray. Returns the number of hits.
fn same_as_each(name: &str, stage: &Stage<'_>, eye: DVec3, directions: &Directions) -> usize {
    let (found, traced) = directions.table(|table| {
        let found = cast(stage, &Pose::from_translation(eye), &Optics::Table(*table), Execution::default());
        let rays =
            (0..directions.height).flat_map(|row| (0..directions.width).map(move |column| (column, row)));
        (found, rays.map(|(column, row)| table.direction(column, row)).collect::<Vec<_>>())
    });
    let expected = cast_each(stage, eye, &traced);
    let mut unlike = 0;
    for (ray, direction) in traced.iter().enumerate() {
        if found.name(ray) == expected.name(ray) && close(found.distance[ray], expected.distance[ray], 1e-5) {
            continue;
        }
        unlike += 1;
        let direction = DVec3::from_array(direction.map(f64::from));
        let (right, up) = direction.any_orthonormal_pair();
        let around: Vec<_> = (0..16)
            .map(|i| {
                let angle = f64::from(i) / 16.0 * TAU;
                let off = (right * angle.cos() + up * angle.sin()) * 1e-6;
                (direction + off).as_vec3().to_array()
            })
            .collect();
        let around = cast_each(stage, eye, &around);
        let explained = (0..16).any(|other| {
            around.name(other) == found.name(ray) && close(found.distance[ray], around.distance[other], 1e-5)
        });
        assert!(
            explained,
            "{name}: ray {ray} {direction}: {:?} at {}, not {:?} at {}",
            found.name(ray),
            found.distance[ray],
            expected.name(ray),
            expected.distance[ray]
        );
    }
    assert!(unlike * 1000 <= traced.len(), "{name}: {unlike} of {} rays differ", traced.len());
    found.distance.iter().filter(|distance| distance.is_finite()).count()
}

/// Casts a grid and a table of its directions. Directions are rounded to single precision in the table, so an edge may
/// be between them; otherwise they hit the same surface.
fn same_as_grid(name: &str, grid: &Optics<'_>, directions: &Directions) {
    let builder = scene();
    let stage = &Stage::from(&builder);
    let mut seen = 0;
    for (index, eye) in EYES.into_iter().enumerate() {
        let pose = Pose::from_xyz_rpy(eye, DVec3::new(0.1, 0.2, -2.0) * index as f64);
        let expected = cast(stage, &pose, grid, Execution::default());
        let found =
            directions.table(|table| cast(stage, &pose, &Optics::Table(*table), Execution::default()));
        let rays = found.distance.len();
        let (mut hits, mut other, mut farther) = (0, 0, 0);
        for ray in 0..rays {
            if found.name(ray) != expected.name(ray) {
                other += 1;
            } else if found.distance[ray].is_finite() {
                hits += 1;
                // The rounding of a direction displaces a hit on a slanted surface by more.
                let along = pose.rotation() * DVec3::from_array(directions.all[ray].map(f64::from));
                let normal = DVec3::from_array(found.normal[ray].map(f64::from));
                let slant = 1.0 / normal.dot(along).abs().max(1e-3);
                farther +=
                    usize::from(!close(found.distance[ray], expected.distance[ray], 1e-6 * slant as f32));
            }
        }
        seen += hits;
        assert!(other * 5000 <= rays, "{name}: {other} of {rays} hit something else");
        assert_eq!(farther, 0, "{name}: {farther} of {rays} elsewhere");
    }
    assert!(seen * 10 > directions.all.len(), "{name}: {seen} hits");
}

#[test]
fn tables_agree_with_a_pinhole() {
    for (width, height) in [(320, 240), (333, 17), (1, 1), (61, 90)] {
        let lens = PinholeGrid::from_fov(width, height, 1.2).unwrap();
        same_as_grid("pinhole", &Optics::Pinhole(lens), &pinhole(&lens));
    }
}

#[test]
fn tables_agree_with_a_vlp_16() {
    for (columns, clockwise, first) in [(1800, true, 0.0), (1801, false, -PI), (400, false, 1.0)] {
        let step = if columns == 400 { 0.01 } else { TAU / f64::from(columns) };
        let grid = SphericalGrid {
            columns,
            rows: 16,
            first_azimuth_rad: first,
            azimuth_step_rad: if clockwise { -step } else { step },
            first_elevation_rad: -15.0_f64.to_radians(),
            elevation_step_rad: 2.0_f64.to_radians(),
        };
        same_as_grid("VLP-16", &Optics::Spherical(grid), &spherical(&grid));
    }
}

/// A rotation that is not about an axis.
fn some_turn() -> DQuat {
    DQuat::from_scaled_axis(DVec3::new(0.7, -1.1, 0.4))
}

#[test]
fn tables_agree_with_single_rays() {
    let ring = SphericalGrid {
        columns: 720,
        rows: 1,
        first_azimuth_rad: -PI,
        azimuth_step_rad: TAU / 720.0,
        first_elevation_rad: 0.0,
        elevation_step_rad: 0.0,
    };
    let sphere = SphericalGrid {
        columns: 256,
        rows: 129,
        first_azimuth_rad: PI,
        azimuth_step_rad: -TAU / 256.0,
        first_elevation_rad: FRAC_PI_2,
        elevation_step_rad: -PI / 128.0,
    };
    let column = SphericalGrid { columns: 1, rows: 90, elevation_step_rad: -0.03, ..sphere };
    let tables = [
        ("fisheye", fisheye(240), 0.5),
        ("VLP-32C", vlp_32c(1024, false), 0.5),
        ("VLP-32C, clockwise", vlp_32c(1001, true), 0.5),
        ("ring", spherical(&ring), 0.5),
        ("sphere", spherical(&sphere), 0.5),
        ("column", spherical(&column), 0.2),
        ("pinhole", pinhole(&PinholeGrid::from_fov(160, 120, 1.9).unwrap()), 0.2),
    ];
    let builder = scene();
    let stage = &Stage::from(&builder);
    for (name, directions, least) in &tables {
        for eye in EYES {
            for directions in [directions, &directions.turned(some_turn())] {
                let hits = same_as_each(name, stage, eye, directions);
                assert!(hits as f64 > least * directions.all.len() as f64, "{name}: {hits} hits");
            }
        }
    }
}

/// Numbers from 0 to 1.
fn uniform(count: usize) -> impl Iterator<Item = f64> {
    let mut state = 7_u64;
    core::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    })
    .take(count)
}

#[test]
fn any_directions() {
    let numbers: Vec<_> = uniform(2 * 64 * 64).collect();
    let random = |width: u32, height: u32| {
        Directions::new(width, height, |column, row| {
            let ray = 2 * (row * width + column) as usize;
            polar(numbers[ray] * TAU, (2.0 * numbers[ray + 1] - 1.0).asin())
        })
    };
    // Along axes, with zeros of either sign, and in the middle between them.
    let straight = Directions::new(9, 12, |column, row| {
        let zero = if row % 2 == 0 { 0.0 } else { -0.0 };
        let at = |number: u32| [zero, 1.0, -1.0][number as usize];
        let direction = DVec3::new(at(column % 3), at(column / 3), at(row / 4));
        if direction == DVec3::ZERO { DVec3::NEG_X } else { direction }
    });
    let same = Directions::new(70, 40, |_, _| DVec3::new(-0.3, 0.4, -0.2));
    let builder = scene();
    let stage = &Stage::from(&builder);
    for (name, directions) in [
        ("random", &random(64, 64)),
        ("random in a row", &random(500, 1)),
        ("random in a column", &random(1, 300)),
        ("one", &random(1, 1)),
        ("two", &random(2, 1)),
        ("along axes", &straight),
        ("all the same", &same),
    ] {
        for eye in EYES {
            same_as_each(name, stage, eye, directions);
        }
    }
    assert!(same_as_each("all the same", stage, EYES[0], &same) == 70 * 40);
}

/// From inside boxes, near walls, and where triangles surround the sensor.
#[test]
fn scenes_all_around_the_sensor() {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Box { size: [4.0, 3.0, 2.0] }, Pose::IDENTITY);
    let huge = [[-50.0, -30.0, -2.0], [70.0, -30.0, -2.0], [0.0, 90.0, -2.0], [0.0, 0.0, 20.0]];
    let mesh = builder.add_mesh(&huge, &[], &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
    add_grey(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY);
    let stage = &Stage::from(&builder);
    let tables = [
        ("fisheye", fisheye(200)),
        ("VLP-32C", vlp_32c(512, false)),
        ("pinhole", pinhole(&PinholeGrid::from_fov(99, 77, 2.0).unwrap())),
    ];
    for (name, directions) in &tables {
        for eye in [
            DVec3::ZERO,
            DVec3::new(1.99, 0.3, -0.2),
            DVec3::new(3.0, 0.1, -1.99),
            DVec3::new(-8.0, 0.9, 2.0),
        ] {
            let hits = same_as_each(name, stage, eye, directions);
            assert_eq!(hits, directions.all.len(), "{name} at {eye}: the mesh is closed");
        }
    }
}

#[test]
fn the_same_bytes() {
    let mut executions = vec![Execution::default()];
    #[cfg(target_arch = "x86_64")]
    {
        use belvedere_sensors::simd::Level;
        let best = Level::new();
        let levels = [
            best.as_sse2().map(Level::Sse2),
            best.as_avx2().map(Level::Avx2),
            best.as_avx512().map(Level::Avx512),
        ];
        executions.extend(levels.into_iter().flatten().map(Execution::at));
    }
    #[cfg(feature = "rayon")]
    executions.push(Execution::parallel());
    let builder = scene();
    let pose = Pose::from_xyz_rpy(EYES[0], DVec3::new(0.1, 0.2, -0.4));
    let tables = [
        fisheye(300),
        vlp_32c(2000, true),
        pinhole(&PinholeGrid::from_fov(321, 243, 1.1).unwrap()).turned(some_turn()),
    ];
    for (index, directions) in tables.iter().enumerate() {
        directions.table(|table| {
            let cast = |execution| cast(&Stage::from(&builder), &pose, &Optics::Table(*table), execution);
            let expected = cast(executions[0]);
            for execution in &executions {
                assert!(cast(*execution) == expected, "table {index} differs with {execution:?}");
            }
        });
    }
}

#[test]
fn bad_tables() {
    let mut buffer = vec![CacheLine::ZERO; RayTable::required_len(3, 2)];
    let good = [[1.0, 0.0, 0.0]; 6];
    let mut build = |width, height, directions: &[[f32; 3]]| {
        RayTable::build(width, height, directions, &mut buffer).map(|table| table.direction(0, 0))
    };
    assert_eq!(build(3, 2, &good), Ok([1.0, 0.0, 0.0]));
    for (width, height) in [(0, 2), (3, 0), (16_385, 1), (1, u32::MAX), (u32::MAX, u32::MAX)] {
        assert_eq!(build(width, height, &good), Err(TableError::Size { width, height }));
    }
    assert_eq!(build(2, 2, &good), Err(TableError::Count { expected: 4, found: 6 }));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut directions = good;
        directions[5][2] = bad;
        assert_eq!(build(3, 2, &directions), Err(TableError::NotFinite { column: 2, row: 1 }));
    }
    for (bad, length) in [([0.0, 2.0, 0.0], 2.0), ([f32::MAX, 0.0, 0.0], f64::from(f32::MAX))] {
        let mut directions = good;
        directions[3] = bad;
        let error = build(3, 2, &directions);
        assert_eq!(error, Err(TableError::NotUnit { column: 0, row: 1, length }));
        assert!(error.unwrap_err().to_string().contains("column 0, row 1"));
    }
    assert_eq!(build(3, 2, &[[0.0; 3]; 6]), Err(TableError::Empty));
    let mut directions = good;
    directions[0] = [0.0; 3];
    assert_eq!(build(3, 2, &directions), Ok([0.0; 3]), "a pixel without a ray");
    directions[0] = [1.000_05, 0.0, 0.0];
    assert_eq!(build(3, 2, &directions), Ok([1.0, 0.0, 0.0]));
    let required = RayTable::required_len(3, 2);
    let error = RayTable::build(3, 2, &good, &mut buffer[1..]).unwrap_err();
    assert_eq!(error, TableError::BufferTooSmall { required, found: required - 1 });
}

/// The memory budget of a sensor: 64 bytes per ray.
#[test]
fn memory() {
    let nothing = SceneBuilder::new();
    for (width, height) in [(640, 480), (1800, 16), (2048, 128), (1280, 1280)] {
        let rays = width as usize * height as usize;
        // A frame of a table needs the memory of a grid's, without the grid's own tables.
        let grid = Optics::Spherical(SphericalGrid {
            columns: width,
            rows: height,
            first_azimuth_rad: 0.0,
            azimuth_step_rad: 1e-3,
            first_elevation_rad: 0.0,
            elevation_step_rad: 1e-3,
        });
        let lines = RayTable::required_len(width, height) + grid_workspace_len(&nothing.scene(), &grid);
        assert!(lines * 64 <= 64 * rays, "{width} × {height}: {} bytes a ray", lines * 64 / rays);
    }
}
