//! Edge cases of the kernels, one ray at a time.

use super::outside::{Outside, match_outside};
use super::{Inside, match_solid};
use crate::scene::{Instance, InstanceConfig, Kind, Shape};

const SHAPES: [Shape; 8] = [
    Shape::Box { size: [1.0, 1.5, 2.0] },
    Shape::Rectangle { size: [1.0, 1.5] },
    Shape::Plane,
    Shape::Sphere { radius: 1.0 },
    Shape::Ellipsoid { radii: [0.5, 0.75, 1.0] },
    Shape::Cylinder { radius: 0.5, length: 2.0 },
    Shape::Capsule { radius: 0.5, length: 1.0 },
    Shape::Cone { radius: 0.5, length: 2.0 },
];

fn inside(shape: Shape, origin: [f64; 3], direction: [f64; 3]) -> Inside {
    let instance = Instance::new(&InstanceConfig { shape, ..Default::default() }).unwrap();
    let Kind::Solid(solid) = instance.kind() else { unreachable!("a mesh") };
    match_solid!(solid, instance.size, inside => inside(origin, direction))
}

fn first(shape: Shape, origin: [f64; 3], direction: [f64; 3], both: bool) -> f64 {
    inside(shape, origin, direction).first(0.0, both)
}

#[test]
fn rays_along_the_axis() {
    // All of them reach up to z = 1, or are flat.
    for shape in SHAPES {
        let flat = matches!(shape, Shape::Rectangle { .. } | Shape::Plane);
        let (top, bottom) = if flat { (0.0, f64::INFINITY) } else { (1.0, -1.0) };
        let t = first(shape, [0.0, 0.0, 5.0], [0.0, 0.0, -1.0], false);
        assert!((t - (5.0 - top)).abs() < 1e-15, "{shape:?}: {t}");
        let t = first(shape, [0.0, 0.0, 0.5], [0.0, 0.0, -2.0], true);
        let expected = if flat { 0.25 } else { (0.5 - bottom) / 2.0 };
        assert!((t - expected).abs() < 1e-15, "{shape:?} from within: {t}");
        let t = first(shape, [0.0, 0.0, 0.5], [0.0, 0.0, -2.0], false);
        assert_eq!(t, if flat { 0.25 } else { f64::INFINITY }, "{shape:?}: only from outside");
    }
}

#[test]
fn rays_that_point_away_miss() {
    for shape in SHAPES {
        for direction in [[0.0, 0.0, 1.0], [0.1, -0.2, 3.0], [1e-300, 0.0, 1.0]] {
            assert_eq!(first(shape, [0.0, 0.0, 5.0], direction, true), f64::INFINITY, "{shape:?}");
        }
        // Beside it, along each axis and in between, so that some components are exactly zero.
        for direction in
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-0.0, -0.0, 1.0]]
        {
            let origin = [2.0, 3.0, 4.0];
            assert_eq!(first(shape, origin, direction, true), f64::INFINITY, "{shape:?} {direction:?}");
        }
    }
}

#[test]
fn rays_from_the_surface() {
    // From the top, looking down: t = 0, from outside.
    for shape in SHAPES {
        let flat = matches!(shape, Shape::Rectangle { .. } | Shape::Plane);
        let top = if flat { 0.0 } else { 1.0 };
        let t = first(shape, [0.0, 0.0, top], [0.0, 0.0, -1.0], false);
        assert_eq!(t, 0.0, "{shape:?}");
        // … and along it. Rays along a surface may hit or miss it; the result only has to be a number.
        for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]] {
            let t = first(shape, [0.0, 0.0, top], direction, true);
            assert!(!t.is_nan(), "{shape:?} {direction:?}");
        }
    }
    // Along the side of a cone, which is a straight line on the surface: a = 0 in its equation.
    let t = first(SHAPES[7], [0.5, 0.0, -1.0], [-0.5, 0.0, 2.0], true);
    assert!(!t.is_nan());
    // In the plane of a rectangle or an endless plane: a miss.
    for shape in [SHAPES[1], SHAPES[2]] {
        assert_eq!(first(shape, [0.0; 3], [1.0, 0.0, 0.0], true), f64::INFINITY);
        assert_eq!(first(shape, [0.0, 0.0, -1.0], [1.0, 0.5, 0.0], true), f64::INFINITY);
    }
}

/// Numbers from −0.5 to 0.5.
fn random_numbers() -> impl FnMut() -> f64 {
    let mut state = 5_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// 1/t by the kernel for rays from outside, if there is one.
fn inverse_from_outside(shape: Shape, origin: [f64; 3], direction: [f64; 3], both: bool) -> Option<f64> {
    let instance = Instance::new(&InstanceConfig { shape, ..Default::default() }).unwrap();
    let Kind::Solid(solid) = instance.kind() else { unreachable!("a mesh") };
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let (outside, rows) = Outside::new(solid, instance.size, origin, both, axes)?;
    let [x, y, z] = direction;
    let direction = rows.map(|[a, b, c]| a * x + b * y + c * z);
    Some(match_outside!(&outside, kernel => kernel.inverse(direction)))
}

#[test]
fn kernels_for_outside_origins_give_the_same() {
    let mut next = random_numbers();
    for shape in SHAPES {
        let (mut hits, mut misses, mut without) = (0, 0, 0);
        for number in 0..100_000 {
            let far = [2.0, 5.0, 100.0, 1e5][number % 4];
            let mut origin = [next() * far, next() * far, next() * far];
            let target = [next() * 2.0, next() * 2.0, next() * 2.5];
            let mut direction: [f64; 3] = core::array::from_fn(|axis| target[axis] - origin[axis]);
            // Some rays are along an axis or in a plane of symmetry, and some look away.
            if number % 7 == 0 {
                direction[number / 7 % 3] = 0.0;
            }
            if number % 11 == 0 {
                origin[number / 11 % 3] = 0.0;
            }
            if number % 13 == 0 {
                direction = direction.map(|component| -component);
            }
            let both = number % 2 == 0;
            let inside = inside(shape, origin, direction);
            let expected = inside.first(0.0, both);
            let Some(inverse) = inverse_from_outside(shape, origin, direction, both) else {
                without += 1;
                continue;
            };
            // A ray near a rim may hit or miss it because of rounding.
            let t = 1.0 / inverse;
            let tolerance = 1e-11 * (1.0 + far / expected.abs().min(far));
            if inverse > 0.0 && expected.is_finite() {
                hits += 1;
                // If a ray almost touches a round side, 1/t contains the root of a difference near 0.
                let touch = 1e-8 * f64::from(inside.exit - inside.enter < 1e-3 * expected);
                let off = (t / expected - 1.0).abs();
                assert!(
                    off < tolerance + touch,
                    "{shape:?} from {origin:?} along {direction:?}: {t}, {expected}"
                );
            } else if (inverse > 0.0) != expected.is_finite() {
                let through = inside.exit - inside.enter;
                let flat = matches!(shape, Shape::Rectangle { .. });
                assert!(
                    through.abs() < 1e-6 || flat && on_rim(shape, origin, direction),
                    "{shape:?} from {origin:?} along {direction:?}: {t}, {expected}"
                );
            } else {
                misses += 1;
            }
        }
        if !matches!(shape, Shape::Cone { .. }) {
            assert!(
                hits > 10_000 && misses > 5_000,
                "{shape:?}: {hits} hits, {misses} misses, {without} without"
            );
            assert!(without < 80_000, "{shape:?}: {without} without");
        }
    }
}

/// Returns true if a ray hits the plane of a rectangle within rounding of its edges.
fn on_rim(shape: Shape, origin: [f64; 3], direction: [f64; 3]) -> bool {
    let Shape::Rectangle { size } = shape else { return false };
    let t = -origin[2] / direction[2];
    (0..2).any(|axis| ((origin[axis] + t * direction[axis]).abs() - size[axis] / 2.0).abs() < 1e-9)
}

#[test]
fn both_ends_lie_on_the_surface() {
    let mut next = random_numbers();
    // The signed distance from the surface, or a similar value: below 0 inside.
    let level = |shape: Shape, [x, y, z]: [f64; 3]| match shape {
        Shape::Box { size: [a, b, c] } => (x.abs() - a / 2.0).max(y.abs() - b / 2.0).max(z.abs() - c / 2.0),
        Shape::Plane => z,
        Shape::Sphere { radius } => x.hypot(y).hypot(z) - radius,
        Shape::Ellipsoid { radii: [a, b, c] } => (x / a).hypot(y / b).hypot(z / c) - 1.0,
        Shape::Cylinder { radius, length } => (x.hypot(y) - radius).max(z.abs() - length / 2.0),
        Shape::Capsule { radius, length } => x.hypot(y).hypot((z.abs() - length / 2.0).max(0.0)) - radius,
        Shape::Cone { radius, length } => {
            (x.hypot(y) - radius * (0.5 - z / length)).max(z.abs() - length / 2.0)
        }
        _ => unreachable!(),
    };
    for shape in SHAPES.into_iter().filter(|shape| !matches!(shape, Shape::Rectangle { .. })) {
        let (mut hits, mut worst) = (0, 0.0_f64);
        for number in 0..50_000 {
            // From near and from very far away.
            let far = [1.0, 10.0, 1e4, 1e6][number % 4];
            let origin = [next() * far, next() * far, next() * far];
            let target = [next() * 2.0, next() * 2.0, next() * 2.5];
            let direction: [f64; 3] = core::array::from_fn(|axis| target[axis] - origin[axis]);
            let at = |t: f64| core::array::from_fn(|axis| origin[axis] + t * direction[axis]);
            let Inside { enter, exit } = inside(shape, origin, direction);
            let rounding = 1e-14 * (1.0 + far);
            if enter <= exit {
                hits += 1;
                for end in [enter, exit].into_iter().filter(|end| end.is_finite()) {
                    let off = level(shape, at(end)).abs();
                    worst = worst.max(off / rounding);
                    assert!(off < rounding * 10.0, "{shape:?} from {origin:?}: {off:e} off the surface");
                }
                let middle =
                    if enter.is_finite() && exit.is_finite() { 0.5 * (enter + exit) } else { continue };
                assert!(level(shape, at(middle)) < rounding, "{shape:?} from {origin:?}: not inside");
            } else {
                // The ray is never inside: neither at the target nor at its point nearest to the centre.
                let dd: f64 = direction.iter().map(|x| x * x).sum();
                let od: f64 = origin.iter().zip(direction).map(|(a, b)| a * b).sum();
                for t in [1.0, -od / dd] {
                    assert!(level(shape, at(t)) > -rounding, "{shape:?} from {origin:?}: missed");
                }
            }
        }
        assert!(hits > 5_000, "{shape:?}: {hits} hits, {worst} roundings off at most");
    }
}
