//! Shapes at their limits: all sizes, far from the origin, scaled and mirrored, grazed, seen along an axis; and height
//! fields.

use crate::common;

use crate::common::exactness::Dice;
use crate::common::oracle::{first_hit_scaled, pixel_ray, scaled};
use crate::common::{camera_of, depth_camera, depth_image, look_at};
use belvedere_sensors::Pose;
use belvedere_sensors::depth::TooNear;
use belvedere_sensors::scene::tree::{LEAF, NONE};
use belvedere_sensors::scene::{
    HeightField, HeightGrid, InstanceConfig, MaterialConfig, SceneBuilder, SceneError, Shape,
};
use belvedere_sensors::simd::WIDTH;
use belvedere_sensors::trace::Faces;
use glam::DVec3;

/// A pixel may differ in hit or miss if changing the size of the shape by this fraction changes the result.
const EDGE: f64 = 1e-6;
/// The largest error of a depth, relative to it.
const RELATIVE_ERROR: f64 = 1e-5;

const SHAPES: [Shape; 7] = [
    Shape::Rectangle { size: [1.5, 1.0] },
    Shape::Box { size: [1.0, 0.75, 0.5] },
    Shape::Sphere { radius: 0.5 },
    Shape::Ellipsoid { radii: [0.5, 0.4, 0.2] },
    Shape::Cylinder { radius: 0.25, length: 1.0 },
    Shape::Capsule { radius: 0.25, length: 0.5 },
    Shape::Cone { radius: 0.4, length: 0.8 },
];

/// Compares each pixel of a picture of one scaled shape with the formula, and returns the number of pixels that it
/// covers.
fn check(shape: Shape, scale: DVec3, pose: Pose, view: Pose, far: f64) -> usize {
    check_within(shape, scale, pose, view, [far * 1e-6, far], [160, 120])
}

/// The same in a picture of another size, with other clip distances.
fn check_within(
    shape: Shape,
    scale: DVec3,
    pose: Pose,
    view: Pose,
    [near, far]: [f64; 2],
    size: [u32; 2],
) -> usize {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let config = InstanceConfig {
        shape,
        scale: scale.to_array(),
        world_from_instance: pose,
        material,
        ..Default::default()
    };
    builder.add_instance(&config).unwrap();
    let camera =
        depth_camera().camera(camera_of(size, 1.2).near_m(near).far_m(far)).too_near(TooNear::SeenThrough);
    let camera = camera.faces(Faces::Front);
    let depths = depth_image(&builder, camera, view);
    let mut covered = 0;
    for (index, &depth) in depths.iter().enumerate() {
        let (column, row) = (index as u32 % size[0], index as u32 / size[0]);
        let ray = pixel_ray(&camera.camera, &view, column, row);
        let hit = |shape: &Shape| {
            first_hit_scaled(shape, &pose, scale, &ray, camera.camera.near_m, false).filter(|t| *t < far)
        };
        let at_edge =
            || hit(&scaled(&shape, 1.0 + EDGE)).is_some() != hit(&scaled(&shape, 1.0 - EDGE)).is_some();
        let agrees = match hit(&shape) {
            Some(truth) => (f64::from(depth) - truth).abs() < RELATIVE_ERROR * truth,
            None => depth == f32::INFINITY,
        };
        assert!(
            agrees || at_edge(),
            "{shape:?} × {scale} at ({column}, {row}): {depth}, should be {:?}",
            hit(&shape)
        );
        covered += usize::from(depth.is_finite());
    }
    covered
}

/// From inside, from almost on the surface, and from so near that the near plane cuts the shape; different code handles
/// each.
#[test]
fn shapes_seen_from_anywhere() {
    let mut dice = Dice(41);
    let mut covered = [0; SHAPES.len()];
    for number in 0..1400 {
        let shape = SHAPES[number % SHAPES.len()];
        let scale = DVec3::new(0.5 + dice.roll(), 0.5 + dice.roll(), 0.5 + dice.roll());
        let pose = Pose::from_xyz_rpy(dice.cube() * 3.0, dice.turn());
        // In the box around the shape, exactly on its centre line, and slightly outside.
        let mut from = dice.cube() * [0.3, 0.8, 1.5][number % 3];
        if number % 5 == 0 {
            (from.x, from.y) = (0.0, 0.0);
        }
        let view = Pose::from_xyz_rpy(pose.transform_point(from), dice.turn());
        let near = [1e-6, 0.1, 0.4][number / 3 % 3];
        let size = [1 + (dice.roll() * 70.0) as u32, 1 + (dice.roll() * 50.0) as u32];
        covered[number % SHAPES.len()] += check_within(shape, scale, pose, view, [near, 20.0], size);
    }
    assert!(covered.iter().all(|&pixels| pixels > 3000), "{covered:?}");
}

#[test]
fn any_size_and_100_km_away() {
    for shape in SHAPES {
        for size in [1e-6, 1e-3, 1.0, 1e4] {
            for offset in [DVec3::ZERO, DVec3::new(1e5, -7e4, 300.0)] {
                // At 100 km the position itself is only accurate to 1e-11 m.
                if size < 1e-3 && offset != DVec3::ZERO {
                    continue;
                }
                let pose = Pose::from_xyz_rpy(offset, DVec3::new(0.5, -0.3, 1.1));
                let eye = offset + DVec3::new(1.2, 0.9, 0.7) * size;
                let covered =
                    check(scaled(&shape, size), DVec3::ONE, pose, look_at(eye, offset, 0.2), 10.0 * size);
                assert!(covered > 500, "{shape:?} × {size} at {offset}: {covered} pixels");
            }
        }
    }
}

#[test]
fn scaled_and_mirrored() {
    let pose = Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.5, -0.3, 1.1));
    for shape in SHAPES.into_iter().chain([Shape::Plane]) {
        for scale in [[1.0, 2.0, 0.5], [-1.0, 1.0, 1.0], [0.5, -0.7, -1.4], [-3.0, -0.1, -0.4]] {
            let covered: usize = [[1.2, 0.9, 0.7], [-1.0, 1.4, -0.6], [-0.5, -1.0, 1.1], [0.4, -1.4, -0.9]]
                .into_iter()
                .map(|eye| {
                    let (eye, target) = (DVec3::from_array(eye) * 2.0, pose.translation());
                    check(shape, DVec3::from_array(scale), pose, look_at(target + eye, target, 0.4), 100.0)
                })
                .sum();
            assert!(covered > 100, "{shape:?} × {scale:?}: {covered} pixels");
        }
    }
}

#[test]
fn along_the_axes() {
    // In the middle column and row of the picture, components of directions are exactly 0.
    for shape in SHAPES {
        for (eye, roll) in [(DVec3::Z, 0.0), (DVec3::X, 0.0), (DVec3::Y, 0.0), (DVec3::NEG_Z, 0.0)] {
            let view = look_at(eye * 2.0, DVec3::ZERO, roll);
            let flat = matches!(shape, Shape::Rectangle { .. });
            let covered = check(shape, DVec3::ONE, Pose::IDENTITY, view, 10.0);
            assert!(flat || covered > 200, "{shape:?} from {eye}: {covered} pixels");
        }
    }
}

/// Heights that are neither flat nor regular, without the platform's sine.
fn terrain(rows: u32, columns: u32) -> Vec<f32> {
    (0..rows * columns).map(|i| ((i as f32 * 0.618).fract() - 0.5) * ((i % 7) as f32 + 0.5)).collect()
}

const GRIDS: [[u32; 2]; 9] = [[2, 2], [2, 3], [3, 2], [3, 5], [4, 6], [9, 17], [70, 40], [2, 1000], [300, 2]];

fn with_grid(rows: u32, columns: u32, test: impl FnOnce(HeightGrid<'_>, &[f32])) {
    let heights = terrain(rows, columns);
    let mut extents = vec![[f32::NAN; 2]; HeightField::extents_len(rows, columns)];
    let field = HeightField::build(rows, columns, [3.0, 2.0], &heights, &mut extents).unwrap();
    assert!(extents.iter().flatten().all(|height| height.is_finite()), "all extents are filled");
    test(HeightGrid::new(&field, &heights, &extents).unwrap(), &heights);
}

/// The position of the corner at a height, as documented.
fn corner(grid: &HeightGrid<'_>, heights: &[f32], row: u32, column: u32) -> [f32; 3] {
    let (field, across) = (grid.field(), f64::from(column) / f64::from(grid.field().columns() - 1));
    let down = f64::from(row) / f64::from(field.rows() - 1);
    let height = heights[(row * field.columns() + column) as usize];
    [((across - 0.5) * field.size()[0]) as f32, ((0.5 - down) * field.size()[1]) as f32, height]
}

#[test]
fn height_fields_have_every_triangle_once() {
    for [rows, columns] in GRIDS {
        with_grid(rows, columns, |grid, heights| {
            let field = grid.field();
            assert_eq!(field.triangles(), 2 * (rows - 1) * (columns - 1));
            let mut seen = vec![0; field.triangles() as usize];
            // The bits of each corner, from the first triangle that has it.
            let mut bits = vec![None; heights.len()];
            for block in 0..field.blocks() {
                let wide = grid.block(block);
                let used = wide.triangle.iter().position(|&triangle| triangle == NONE).unwrap_or(WIDTH);
                assert!(used > 0 && wide.triangle[used..].iter().all(|&triangle| triangle == NONE));
                for lane in 0..WIDTH {
                    let corners =
                        [0, 1, 2].map(|corner| [0, 1, 2].map(|axis| wide.corners[corner][axis][lane]));
                    if lane >= used {
                        assert_eq!(corners, [grid.triangle(wide.triangle[used - 1])[0]; 3]);
                        continue;
                    }
                    let triangle = wide.triangle[lane];
                    assert_eq!(grid.triangle_of(block, lane as u32), triangle, "{rows} × {columns}");
                    seen[triangle as usize] += 1;
                    assert_eq!(corners, grid.triangle(triangle));
                    let (row, column) = (triangle / 2 / (columns - 1), triangle / 2 % (columns - 1));
                    let at = if triangle % 2 == 0 {
                        [[row, column], [row + 1, column], [row, column + 1]]
                    } else {
                        [[row + 1, column], [row + 1, column + 1], [row, column + 1]]
                    };
                    for (found, [row, column]) in corners.into_iter().zip(at) {
                        let shared = bits[(row * columns + column) as usize].get_or_insert(found);
                        assert_eq!(found.map(f32::to_bits), shared.map(f32::to_bits));
                        let expected = corner(&grid, heights, row, column);
                        assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-6));
                    }
                    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
                    assert!((b - a).cross(c - a).z > 0.0, "the outside is above");
                }
            }
            assert!(seen.iter().all(|&times| times == 1), "{rows} × {columns}");
        });
    }
}

/// Calls `leaf` with each block below a node, and checks that boxes contain everything below them.
fn descend(grid: &HeightGrid<'_>, node: u32, outer: [[f32; 3]; 2], leaves: &mut Vec<u32>) {
    let inside = |low: [f32; 3], high: [f32; 3], [outer_low, outer_high]: [[f32; 3]; 2]| {
        (0..3).all(|axis| outer_low[axis] <= low[axis] && high[axis] <= outer_high[axis])
    };
    let wide = grid.node(node);
    let used = wide.child.iter().position(|&child| child == NONE).unwrap_or(WIDTH);
    assert!(used > 0 && wide.child[used..].iter().all(|&child| child == NONE));
    for lane in 0..WIDTH {
        let (low, high) =
            ([0, 1, 2].map(|axis| wide.min[axis][lane]), [0, 1, 2].map(|axis| wide.max[axis][lane]));
        assert!(inside(low, high, outer));
        if lane >= used {
            continue;
        }
        let child = wide.child[lane];
        if child & LEAF == 0 {
            assert!(child > node, "children come after their parents");
            descend(grid, child, [low, high], leaves);
            continue;
        }
        leaves.push(child & !LEAF);
        let block = grid.block(child & !LEAF);
        for corner in block.corners {
            for lane in 0..WIDTH {
                let point = corner.map(|axis| axis[lane]);
                assert!(inside(point, point, [low, high]), "{point:?} outside of {low:?} … {high:?}");
            }
        }
    }
}

#[test]
fn height_fields_lie_in_their_boxes() {
    for [rows, columns] in GRIDS {
        with_grid(rows, columns, |grid, _| {
            let mut leaves = vec![];
            descend(&grid, 0, grid.bounds(), &mut leaves);
            leaves.sort_unstable();
            assert_eq!(leaves, (0..grid.field().blocks()).collect::<Vec<_>>(), "{rows} × {columns}");
        });
    }
}

/// t of the nearest of a leaf's triangles (Cramer's rule, in f64).
fn in_block(grid: &HeightGrid<'_>, block: u32, origin: DVec3, direction: DVec3) -> f64 {
    let block = grid.block(block);
    let hit = |lane: usize| {
        let [a, b, c] =
            block.corners.map(|corner| DVec3::from_array(corner.map(|axis| f64::from(axis[lane]))));
        let (ab, ac, ao) = (b - a, c - a, origin - a);
        let determinant = -direction.dot(ab.cross(ac));
        let t = ao.dot(ab.cross(ac)) / determinant;
        let moment = direction.cross(ao);
        let (beta, gamma) = (-ac.dot(moment) / determinant, ab.dot(moment) / determinant);
        (determinant != 0.0 && beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0 && t >= 0.0).then_some(t)
    };
    (0..WIDTH).filter_map(hit).fold(f64::INFINITY, f64::min)
}

/// The same by traversing the tree.
fn through_tree(grid: &HeightGrid<'_>, node: u32, origin: DVec3, direction: DVec3, visited: &mut u32) -> f64 {
    let wide = grid.node(node);
    let mut nearest = f64::INFINITY;
    for lane in 0..WIDTH {
        let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let ends = [wide.min[axis][lane], wide.max[axis][lane]];
            let [a, b] = ends.map(|end| (f64::from(end) - origin[axis]) / direction[axis]);
            (enter, exit) = (enter.max(a.min(b) - 1e-9), exit.min(a.max(b) + 1e-9));
        }
        let child = wide.child[lane];
        if child == NONE || enter > exit {
            continue;
        }
        nearest = nearest.min(if child & LEAF == 0 {
            through_tree(grid, child, origin, direction, visited)
        } else {
            *visited += 1;
            in_block(grid, child & !LEAF, origin, direction)
        });
    }
    nearest
}

#[test]
fn rays_through_the_tree_of_a_height_field() {
    with_grid(70, 90, |grid, heights| {
        let (mut hits, mut visited) = (0, 0);
        for i in 0..2000 {
            let part = |factor: f64| (f64::from(i) * factor).fract() - 0.5;
            let target = DVec3::new(part(0.618) * 3.2, part(0.414) * 2.2, part(0.271) * 2.0);
            let origin = DVec3::new(part(0.732) * 6.0, part(0.236) * 6.0, 1.0 + 6.0 * part(0.915));
            let direction = target - origin;
            let found = through_tree(&grid, 0, origin, direction, &mut visited);
            let all = (0..grid.field().blocks())
                .map(|block| in_block(&grid, block, origin, direction))
                .fold(f64::INFINITY, f64::min);
            assert_eq!(found, all, "ray {i}");
            hits += u32::from(found.is_finite());
            // The hit is on the surface over that cell: at the height interpolated from the four heights around it.
            if found.is_finite() {
                let p = origin + direction * found;
                let (x, y) = ((p.x / 3.0 + 0.5) * 89.0, (0.5 - p.y / 2.0) * 69.0);
                let (column, row) = ((x as u32).min(88), (y as u32).min(68));
                let (right, down) = (x - f64::from(column), y - f64::from(row));
                let h = |row: u32, column: u32| f64::from(heights[(row * 90 + column) as usize]);
                let [a, b, c, d] =
                    [h(row, column), h(row, column + 1), h(row + 1, column), h(row + 1, column + 1)];
                let height = if right + down < 1.0 {
                    a + right * (b - a) + down * (c - a)
                } else {
                    d + (1.0 - right) * (c - d) + (1.0 - down) * (b - d)
                };
                assert!((p.z - height).abs() < 1e-4, "ray {i}: at {p}, should be at {height}");
            }
        }
        assert!(hits > 1000, "{hits} hits");
        assert!(visited < 2000 * 40, "{visited} leaves were visited of {}", 2000 * grid.field().blocks());
    });
}

#[test]
fn faulty_height_fields() {
    let mut builder = SceneBuilder::new();
    let heights = [0.0, 1.0, 2.0, 3.0, f32::NAN, 5.0];
    let size = [1.0, 2.0];
    assert_eq!(builder.add_height_field(1, 6, size, &heights), Err(SceneError::HeightFieldTooSmall));
    assert_eq!(builder.add_height_field(0, 0, size, &[]), Err(SceneError::HeightFieldTooSmall));
    assert_eq!(builder.add_height_field(2, 2, size, &heights), Err(SceneError::HeightCount));
    assert_eq!(builder.add_height_field(u32::MAX, u32::MAX, size, &heights), Err(SceneError::HeightCount));
    assert_eq!(builder.add_height_field(2, 3, size, &heights), Err(SceneError::BadHeight(4)));
    assert_eq!(builder.add_height_field(2, 2, size, &[0.0, 0.0, 1e30, 0.0]), Err(SceneError::BadHeight(2)));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-60, 1e60] {
        assert_eq!(builder.add_height_field(2, 2, [1.0, bad], &heights[..4]), Err(SceneError::BadSize));
    }
    let short = HeightField::build(2, 2, size, &heights[..4], &mut [[0.0; 2]; 1]);
    assert_eq!(short, Err(SceneError::BufferTooSmall { buffer: "extents", have: 1, need: 2 }));
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let field = builder.add_height_field(2, 2, size, &heights[..4]).unwrap();
    let there = InstanceConfig { shape: Shape::HeightField(field), material, ..Default::default() };
    assert!(builder.add_instance(&there).is_ok());
    let missing = Shape::HeightField(belvedere_sensors::scene::HeightFieldId(1));
    let missing = InstanceConfig { shape: missing, ..there };
    assert_eq!(builder.add_instance(&missing), Err(SceneError::NoSuchHeightField(1)));
    let second = builder.add_height_field(3, 2, size, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let scene = builder.scene();
    assert_eq!(scene.height_field(second).unwrap().bounds(), [[-0.5, -1.0, 1.0], [0.5, 1.0, 6.0]]);
}

#[test]
fn stored_height_fields_are_validated() {
    use bytemuck::{bytes_of, pod_read_unaligned};
    for [rows, columns] in GRIDS {
        let heights = terrain(rows, columns);
        let mut extents = vec![[0.0; 2]; HeightField::extents_len(rows, columns)];
        let field = HeightField::build(rows, columns, [3.0, 2.0], &heights, &mut extents).unwrap();
        assert_eq!(field.validate(&heights, &extents), Ok(()));
        assert!(HeightGrid::new(&field, &heights[1..], &extents).is_none());
        assert!(matches!(
            field.validate(&heights[1..], &extents),
            Err(SceneError::BufferTooSmall { buffer: "heights", .. })
        ));
        for node in 0..extents.len() {
            let mut wrong = extents.clone();
            wrong[node][1] += 1.0;
            assert!(matches!(field.validate(&heights, &wrong), Err(SceneError::BadTree(_))), "node {node}");
        }
        // Whichever byte is wrong: an error, or a field whose difference does not matter.
        for byte in 0..size_of::<HeightField>() {
            for flip in [1_u8, 0x80, 0xff] {
                let mut bytes = bytes_of(&field).to_vec();
                bytes[byte] ^= flip;
                let wrong: HeightField = pod_read_unaligned(&bytes);
                assert!(wrong.validate(&heights, &extents).is_err(), "byte {byte} ^ {flip}");
            }
        }
    }
}

/// A cube of 1 m as a mesh.
fn cube() -> (Vec<[f32; 3]>, [[u32; 3]; 12]) {
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 0.5 } else { -0.5 });
    let faces = [
        [[1, 3, 7], [1, 7, 5], [0, 4, 6], [0, 6, 2]],
        [[2, 6, 7], [2, 7, 3], [0, 1, 5], [0, 5, 4]],
        [[4, 5, 7], [4, 7, 6], [0, 2, 3], [0, 3, 1]],
    ];
    ((0..8).map(corner).collect(), core::array::from_fn(|i| faces[i / 4][i % 4]))
}

/// A lit picture of one instance with a texture.
fn lit_picture(config: &InstanceConfig, repeat: [f32; 2], view: Pose) -> Vec<u8> {
    let mut builder = SceneBuilder::new();
    // Smooth, so that a rounding error remains a small difference.
    let ramp = |i: u32| if i < 32 { i * 8 } else { (63 - i) * 8 };
    let texels: Vec<[u8; 4]> = (0..64 * 64)
        .map(|i| [ramp(i % 64) as u8, ramp(i / 64) as u8, ((i % 64 + i / 64) * 2) as u8, 255])
        .collect();
    let texture = Some(builder.add_texture(64, 64, &texels).unwrap());
    let material =
        MaterialConfig { texture, texture_repeat: repeat, ambient: [0.3; 3], ..MaterialConfig::default() };
    let material = builder.add_material(&material).unwrap();
    let (corners, faces) = cube();
    let uvs: Vec<[f32; 2]> = corners.iter().map(|[x, y, z]| [x + 0.3 * z, y - 0.2 * z]).collect();
    builder.add_mesh(&corners, &uvs, &faces).unwrap();
    builder
        .add_light(&belvedere_sensors::scene::LightConfig {
            kind: belvedere_sensors::scene::LightKind::Directional { direction: [-0.5, -0.7, -0.6] },
            diffuse: [0.8; 3],
            ..Default::default()
        })
        .unwrap();
    builder.add_instance(&InstanceConfig { material, ..*config }).unwrap();
    let camera = camera_of([160, 120], 1.2);
    common::picture(&builder, camera, view)
}

#[test]
fn a_scaled_shape_looks_like_one_of_that_size() {
    let mesh = Shape::Mesh(belvedere_sensors::scene::MeshId(0));
    let unit = [1.0; 3];
    let once = [1.0; 2];
    // A shape with its scale and the repetition of its texture, and another that looks the same.
    let pairs = [
        (Shape::Box { size: unit }, [0.8, 0.5, 1.2], once, Shape::Box { size: [0.8, 0.5, 1.2] }, unit, once),
        (
            Shape::Rectangle { size: [1.0; 2] },
            [1.4, 0.9, 3.0],
            once,
            Shape::Rectangle { size: [1.4, 0.9] },
            unit,
            once,
        ),
        (Shape::Sphere { radius: 0.5 }, [1.2; 3], once, Shape::Sphere { radius: 0.6 }, unit, once),
        (
            Shape::Sphere { radius: 0.5 },
            [1.2, 0.6, 0.8],
            once,
            Shape::Ellipsoid { radii: [0.6, 0.3, 0.4] },
            unit,
            once,
        ),
        (
            Shape::Cylinder { radius: 0.5, length: 1.0 },
            [0.6, 0.6, 1.4],
            once,
            Shape::Cylinder { radius: 0.3, length: 1.4 },
            unit,
            once,
        ),
        (
            Shape::Cone { radius: 0.5, length: 1.0 },
            [0.8, 0.8, 1.3],
            once,
            Shape::Cone { radius: 0.4, length: 1.3 },
            unit,
            once,
        ),
        (
            Shape::Capsule { radius: 0.2, length: 0.5 },
            [1.5; 3],
            once,
            Shape::Capsule { radius: 0.3, length: 0.75 },
            unit,
            once,
        ),
        (Shape::Plane, [0.5, 0.25, 2.0], once, Shape::Plane, unit, [2.0, 4.0]),
        (Shape::Plane, unit, once, Shape::Rectangle { size: [4e3; 2] }, unit, [4e3; 2]),
        // Mirroring twice is a rotation by half a turn; the outside stays outside.
        (mesh, [-1.0, -1.0, 1.0], once, mesh, [-1.0, -1.0, 1.0], once),
    ];
    let pose = Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.5, -0.3, 1.1));
    for (number, (shape, scale, repeat, other, other_scale, other_repeat)) in pairs.into_iter().enumerate() {
        let turn = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Z * core::f64::consts::PI);
        for eye in [DVec3::new(1.2, 0.9, 0.7), DVec3::new(-0.5, -1.0, 1.1)] {
            let view = look_at(pose.translation() + eye * 1.2, pose.translation(), 0.4);
            let config = |shape, scale, world_from_instance| InstanceConfig {
                shape,
                scale,
                world_from_instance,
                ..Default::default()
            };
            let one = lit_picture(&config(shape, scale, pose), repeat, view);
            let two = if number == 9 {
                lit_picture(&config(mesh, unit, pose * turn), once, view)
            } else {
                lit_picture(&config(other, other_scale, pose), other_repeat, view)
            };
            assert!(one.chunks(3).filter(|pixel| *pixel != [0; 3]).count() > 500, "{shape:?} is seen");
            let differ = one.iter().zip(&two).filter(|(a, b)| a.abs_diff(**b) > 3).count();
            assert!(
                differ <= one.len() / 300,
                "{shape:?} × {scale:?}: {differ} of {} bytes differ",
                one.len()
            );
        }
    }
}

#[test]
fn a_mirrored_mesh_is_not_inside_out() {
    let view = look_at(DVec3::new(1.2, 0.9, 0.7) * 1.5, DVec3::ZERO, 0.2);
    let (corners, faces) = cube();
    for scale in [[1.0, 0.5, 0.75], [-1.0, 0.5, 0.75], [1.0, -0.5, -0.75], [-1.0, -0.5, -0.75]] {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).unwrap();
        let mesh = builder.add_mesh(&corners, &[], &faces).unwrap();
        let look = |shape| InstanceConfig { shape, scale, material, ..Default::default() };
        let id = builder.add_instance(&look(Shape::Mesh(mesh))).unwrap();
        let of_mesh = depth_image(&builder, depth_camera(), view);
        builder.set_instance(id, &look(Shape::Box { size: [1.0; 3] })).unwrap();
        let of_box = depth_image(&builder, depth_camera(), view);
        let differ = of_mesh.iter().zip(&of_box).filter(|(a, b)| a != b && (**a - **b).abs() > 1e-5).count();
        assert!(differ < 20 && of_box.iter().filter(|depth| depth.is_finite()).count() > 10_000, "{differ}");
    }
}

#[test]
fn same_bits_at_every_level() {
    use belvedere_sensors::Execution;
    use belvedere_sensors::simd::Level;
    let mut builder = SceneBuilder::new();
    common::scenery(&mut builder);
    let material = belvedere_sensors::scene::MaterialId(1);
    for (number, shape) in SHAPES.into_iter().chain([Shape::Plane]).enumerate() {
        let across = number as f64 * 0.7 - 2.4;
        let pose = Pose::from_xyz_rpy(DVec3::new(0.5, across, 0.5), DVec3::new(0.3 * across, 0.2, across));
        let scale = if number % 2 == 0 { [0.9, -0.6, 1.1] } else { [1.0; 3] };
        let config =
            InstanceConfig { shape, world_from_instance: pose, scale, material, ..Default::default() };
        builder.add_instance(&config).unwrap();
    }
    let view = look_at(DVec3::new(-3.2, 0.3, 1.4), DVec3::ZERO, 0.1);
    let camera = camera_of([333, 245], 1.2);
    let at = |level| common::picture_with(&builder, camera, view, 7, Execution::at(level));
    let expected = at(Level::baseline());
    assert!(expected.iter().filter(|value| **value > 0).count() > expected.len() / 2);
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(best.as_avx2().map(Level::Avx2));
    for level in levels {
        assert!(at(level) == expected, "{level:?} differs");
    }
}
