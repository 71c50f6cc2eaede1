//! Mass and inertia of solid shapes of uniform density.

use super::model::{Geometry, Inertial, Mesh};
use belvedere_sensors::Pose;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A body: its mass, its centre of mass, and its inertia about that centre along the axes of the frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solid {
    pub(super) mass_kg: f64,
    centre: DVec3,
    inertia: DMat3,
}

impl Solid {
    /// Returns the mass properties of a shape with a density in kg/m³; none without a finite volume.
    pub(super) fn of(geometry: &Geometry, density: f64) -> Option<Self> {
        let about = |volume: f64, height: f64, moments: DVec3| Self {
            mass_kg: volume * density,
            centre: DVec3::Z * height,
            inertia: DMat3::from_diagonal(moments * volume * density),
        };
        let solid = match geometry {
            Geometry::Box { size } => {
                let squares = *size * *size;
                let moments = (DVec3::splat(squares.element_sum()) - squares) / 12.0;
                about(size.element_product(), 0.0, moments)
            }
            Geometry::Ellipsoid { radii } => {
                about(4.0 / 3.0 * PI * radii.element_product(), 0.0, ball(*radii))
            }
            Geometry::Sphere { radius } => {
                about(4.0 / 3.0 * PI * radius * radius * radius, 0.0, ball(DVec3::splat(*radius)))
            }
            Geometry::Cylinder { radius, length } => {
                about(PI * radius * radius * length, 0.0, cylinder(*radius, *length))
            }
            Geometry::Capsule { radius: r, length: l } => {
                let (middle, ends) = (PI * r * r * l, 4.0 / 3.0 * PI * r * r * r);
                let across = 0.4 * r * r + 0.25 * l * l + 0.375 * l * r;
                let of_ends = DVec3::new(across, across, 0.4 * r * r);
                let volume = middle + ends;
                about(volume, 0.0, (cylinder(*r, *l) * middle + of_ends * ends) / volume)
            }
            Geometry::Cone { radius: r, length: l } => {
                let across = 0.15 * r * r + 0.0375 * l * l;
                about(PI * r * r * l / 3.0, -0.25 * l, DVec3::new(across, across, 0.3 * r * r))
            }
            Geometry::Mesh(mesh) => inside(mesh, density),
            Geometry::Plane { .. } | Geometry::HeightMap(_) => return None,
        };
        (solid.mass_kg > 0.0 && solid.mass_kg.is_finite()).then_some(solid)
    }

    /// Returns the solid in an outer frame.
    pub(super) fn placed(self, outer_from_inner: &Pose) -> Self {
        let turn = outer_from_inner.rotation_matrix();
        Self {
            mass_kg: self.mass_kg,
            centre: outer_from_inner.transform_point(self.centre),
            inertia: turn * self.inertia * turn.transpose(),
        }
    }

    /// Joins several solids into one body; none if there are none.
    pub(super) fn together(solids: &[Self]) -> Option<Self> {
        let mass_kg: f64 = solids.iter().map(|solid| solid.mass_kg).sum();
        if mass_kg <= 0.0 {
            return None;
        }
        let centre = solids.iter().map(|solid| solid.centre * solid.mass_kg).sum::<DVec3>() / mass_kg;
        let inertia = solids.iter().fold(DMat3::ZERO, |sum, solid| {
            sum + solid.inertia + of_a_point(solid.centre - centre) * solid.mass_kg
        });
        Some(Self { mass_kg, centre, inertia })
    }

    /// Returns the mass properties of a link whose frame the solid is in. A given mass in kg replaces that of the solid.
    pub(super) fn inertial(&self, mass_kg: Option<f64>) -> Inertial {
        let factor = mass_kg.map_or(1.0, |mass_kg| mass_kg / self.mass_kg);
        let [x, y, z] =
            [self.inertia.x_axis, self.inertia.y_axis, self.inertia.z_axis].map(|axis| axis * factor);
        Inertial {
            link_from_inertial: Pose::from_translation(self.centre),
            mass_kg: self.mass_kg * factor,
            inertia: [x.x, y.y, z.z, x.y, x.z, y.z],
        }
    }
}

/// Returns the moments of inertia of an ellipsoid of 1 kg.
fn ball(radii: DVec3) -> DVec3 {
    let squares = radii * radii;
    (DVec3::splat(squares.element_sum()) - squares) / 5.0
}

/// Returns the moments of inertia of a cylinder of 1 kg along z.
fn cylinder(radius: f64, length: f64) -> DVec3 {
    let across = (3.0 * radius * radius + length * length) / 12.0;
    DVec3::new(across, across, 0.5 * radius * radius)
}

/// Returns the inertia about the origin of a point mass of 1 kg: d²·1 − d·dᵀ.
fn of_a_point(d: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer(d, d)
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Integrates the inside of a closed mesh: tetrahedra from the origin to each triangle, whose volumes have the sign of its side.
fn inside(mesh: &Mesh, density: f64) -> Solid {
    let at = |vertex: u32| {
        mesh.positions.get(vertex as usize).map_or(DVec3::NAN, |point| DVec3::from(point.map(f64::from)))
    };
    let (mut volume, mut moment, mut seconds) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for [a, b, c] in mesh.triangles.iter().map(|triangle| triangle.map(at)) {
        let part = a.dot(b.cross(c)) / 6.0;
        let sum = a + b + c;
        volume += part;
        moment += sum * (part / 4.0);
        // ∫ x·xᵀ over a tetrahedron with a corner in the origin.
        seconds += (outer(a, a) + outer(b, b) + outer(c, c) + outer(sum, sum)) * (part / 20.0);
    }
    // The mesh is inside out.
    let sign = if volume < 0.0 { -1.0 } else { 1.0 };
    let (volume, moment, seconds) = (volume * sign, moment * sign, seconds * sign);
    let centre = moment / volume;
    let about_origin =
        DMat3::from_diagonal(DVec3::splat(seconds.x_axis.x + seconds.y_axis.y + seconds.z_axis.z)) - seconds;
    let inertia = (about_origin - of_a_point(centre) * volume) * density;
    Solid { mass_kg: volume * density, centre, inertia }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A box as a mesh, away from the origin, has the mass properties of a box.
    #[test]
    fn a_mesh_weighs_what_it_encloses() {
        let size = DVec3::new(1.0, 0.4, 0.2);
        let corner = |index: u32| {
            let side = |bit: u32| if index >> bit & 1 == 1 { 0.5 } else { -0.5 };
            DVec3::new(side(0), side(1), side(2)) * size + DVec3::new(3.0, 2.0, -1.0)
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut mesh = Mesh {
            path: "box".into(),
            positions: (0..8).map(|index| corner(index).as_vec3().to_array()).collect(),
            uvs: Vec::new(),
            normals: Vec::new(),
            triangles: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            material: None,
        };
        let expected = Solid::of(&Geometry::Box { size }, 500.0).unwrap();
        for _ in 0..2 {
            let solid = Solid::of(&Geometry::Mesh(Arc::new(mesh.clone())), 500.0).unwrap();
            assert!((solid.mass_kg - 40.0).abs() < 1e-4, "{solid:?}");
            assert!((solid.centre - DVec3::new(3.0, 2.0, -1.0)).length() < 1e-6, "{solid:?}");
            assert!(solid.inertia.abs_diff_eq(expected.inertia, 1e-4), "{solid:?} {expected:?}");
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        }
    }

    /// Compares a capsule and a cone with sums over small cubes.
    #[test]
    fn round_shapes_have_the_moments_of_their_parts() {
        const STEP: f64 = 0.01;
        let capsule = |at: DVec3| at.with_z((at.z.abs() - 0.3).max(0.0)).length() < 0.2;
        let cone = |at: DVec3| at.z.abs() < 0.3 && at.truncate().length() < 0.25 * (0.3 - at.z) / 0.6;
        let shapes: [(Geometry, &dyn Fn(DVec3) -> bool); 2] = [
            (Geometry::Capsule { radius: 0.2, length: 0.6 }, &capsule),
            (Geometry::Cone { radius: 0.25, length: 0.6 }, &cone),
        ];
        for (geometry, is_inside) in shapes {
            let mut cubes = Vec::new();
            for (x, y, z) in
                (-30..30).flat_map(|x| (-30..30).flat_map(move |y| (-55..55).map(move |z| (x, y, z))))
            {
                let centre = (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5) * STEP;
                if is_inside(centre) {
                    let cube = Geometry::Box { size: DVec3::splat(STEP) };
                    cubes.push(Solid::of(&cube, 1000.0).unwrap().placed(&Pose::from_translation(centre)));
                }
            }
            let (solid, sum) = (Solid::of(&geometry, 1000.0).unwrap(), Solid::together(&cubes).unwrap());
            assert!((solid.mass_kg / sum.mass_kg - 1.0).abs() < 0.01, "{solid:?} {sum:?}");
            assert!((solid.centre - sum.centre).length() < 0.002, "{solid:?} {sum:?}");
            let most = 0.02 * sum.inertia.x_axis.x;
            assert!(solid.inertia.abs_diff_eq(sum.inertia, most), "{solid:?} {sum:?}");
        }
    }
}
