//! Division of polygons into triangles.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Divides polygons into triangles. It reuses its memory from one polygon to the next.
#[derive(Default)]
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    cut: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// What a face is that has no triangles.
pub(super) const SHORT_FACE: &str = "a face of fewer than three corners";

impl Cutter {
    /// Returns the triangles of a polygon as indices of its corners, with the winding of the polygon. `holes` has the
    /// first corner of each hole, whose corners follow those of the outline.
    ///
    /// A convex outline becomes a fan around its first corner. Any other is divided by ear clipping in the plane of its
    /// mean normal. An outline without area, or one that intersects itself so that no ear is left, also becomes a fan.
    pub(super) fn cut(&mut self, corners: &[DVec3], holes: &[u32]) -> &[[u32; 3]] {
        self.triangles.clear();
        let outline = &corners[..holes.first().map_or(corners.len(), |first| *first as usize)];
        if outline.len() < 3 {
            return &self.triangles;
        }
        let normal = mean_normal(outline).try_normalize();
        let normal = normal.filter(|_| corners.iter().all(|corner| corner.is_finite()));
        match normal {
            Some(normal) if !holes.is_empty() || !is_convex(outline, normal) => {
                self.ears(corners, holes, normal);
                if self.triangles.is_empty() {
                    self.fan(outline.len());
                }
            }
            _ => self.fan(outline.len()),
        }
        &self.triangles
    }

    fn fan(&mut self, corners: usize) {
        self.triangles.extend((2..corners as u32).map(|third| [0, third - 1, third]));
    }

    fn ears(&mut self, corners: &[DVec3], holes: &[u32], normal: DVec3) {
        let (right, up) = normal.any_orthonormal_pair();
        // Far from the origin, products of coordinates would lose the digits that distinguish corners.
        let origin = corners[0];
        let flat = |corner: &DVec3| [(corner - origin).dot(right), (corner - origin).dot(up)];
        self.flat.clear();
        self.flat.extend(corners.iter().map(flat));
        self.earcut.earcut_slice(&self.flat, holes, &mut self.cut);
        for triangle in self.cut.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            let [p, q, r] = [a, b, c].map(|corner| DVec2::from(self.flat[corner as usize]));
            let is_left = (q - p).perp_dot(r - p) >= 0.0;
            self.triangles.push(if is_left { [a, b, c] } else { [a, c, b] });
        }
    }
}

/// Returns Newell's normal of an outline; its length is twice the area.
fn mean_normal(outline: &[DVec3]) -> DVec3 {
    let origin = outline[0];
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(one, other)| (one - origin).cross(other - origin)).sum()
}

/// Returns true if all corners of an outline turn the same way and the outline goes around once.
fn is_convex(outline: &[DVec3], normal: DVec3) -> bool {
    if outline.len() == 3 {
        return true;
    }
    let count = outline.len();
    let edge = |at: usize| outline[(at + 1) % count] - outline[at % count];
    // A fan of an outline that goes around twice, such as a pentagram, turns back somewhere.
    let spoke = |at: usize| outline[at] - outline[0];
    (0..count).all(|at| edge(at).cross(edge(at + 1)).dot(normal) >= 0.0)
        && (1..count - 1).all(|at| spoke(at).cross(spoke(at + 1)).dot(normal) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the area that the triangles cover, each counted once, with its sign about +z.
    fn area(corners: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let at = |corner: u32| corners[corner as usize];
        triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0).sum()
    }

    fn points(flat: &[[f64; 2]]) -> Vec<DVec3> {
        flat.iter().map(|[x, y]| DVec3::new(*x, *y, 1.0)).collect()
    }

    #[test]
    fn an_l_is_divided_in_any_plane_and_winding() {
        let l = points(&[[2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0]]);
        let inside = |[a, b, c]: [u32; 3]| {
            let middle = (l[a as usize] + l[b as usize] + l[c as usize]) / 3.0;
            middle.x < 1.0 || middle.y < 1.0
        };
        let mut cutter = Cutter::default();
        let triangles = cutter.cut(&l, &[]).to_vec();
        assert_eq!(triangles.len(), 4);
        assert!(triangles.iter().copied().all(inside), "{triangles:?}");
        assert!((area(&l, &triangles) - 3.0).abs() < 1e-12);
        let reversed: Vec<DVec3> = l.iter().rev().copied().collect();
        assert!((area(&reversed, cutter.cut(&reversed, &[])) + 3.0).abs() < 1e-12);
        // On a slope, far from the origin, the area seen from above is the same.
        let slope: Vec<DVec3> =
            l.iter().map(|p| DVec3::new(p.x + 4e5, p.y - 5e6, 0.75 * p.x + 0.5 * p.y)).collect();
        assert!((area(&slope, cutter.cut(&slope, &[])) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn holes_stay_open() {
        let mut corners = points(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        corners.extend(points(&[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]));
        corners.extend(points(&[[3.0, 3.0], [3.0, 3.5], [3.5, 3.5], [3.5, 3.0]]));
        let triangles = Cutter::default().cut(&corners, &[4, 8]).to_vec();
        assert!((area(&corners, &triangles) - 14.75).abs() < 1e-12);
    }

    #[test]
    fn outlines_without_area_are_fans() {
        let line = points(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]);
        assert_eq!(Cutter::default().cut(&line, &[]), [[0, 1, 2], [0, 2, 3]]);
        let nan = points(&[[0.0, 0.0], [f64::NAN, 0.0], [2.0, 0.0], [3.0, 1.0]]);
        assert_eq!(Cutter::default().cut(&nan, &[]).len(), 2);
        assert!(Cutter::default().cut(&line[..2], &[]).is_empty());
    }
}
