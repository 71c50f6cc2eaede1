//! `<polyline>`: outlines that are extruded from z = 0 to a height. An outline inside another one is a hole in it.

use super::Loader;
use crate::model::Mesh;
use crate::values::{child_number, numbers};
use crate::xml::Element;
use earcut::Earcut;
use std::sync::Arc;

/// An outline in the plane.
type Outline = Vec<[f64; 2]>;

impl Loader<'_> {
    /// Converts all `<polyline>` elements of a `<geometry>` to one mesh.
    pub(super) fn polylines(&mut self, geometry: &Element) -> Option<Arc<Mesh>> {
        let mut outlines: Vec<Outline> = Vec::new();
        let mut height = None;
        for polyline in geometry.elements_named("polyline") {
            let own = child_number(polyline, "height", self.diagnostics).unwrap_or(1.0);
            let height = *height.get_or_insert(own);
            if !(own > 0.0 && own.is_finite()) {
                return self.wrong(polyline, &format!("its <height> is {own}"), "write metres above 0");
            }
            if own != height {
                self.ignored(polyline, &format!("its height is {own}, that of the first is {height}"));
                continue;
            }
            let mut outline = Vec::new();
            for point in polyline.elements_named("point") {
                outline.push(numbers(&point.text(), "<point>", &point.source, self.diagnostics)?);
            }
            // Some outlines repeat the first point at their end.
            if outline.len() > 1 && outline.first() == outline.last() {
                outline.pop();
            }
            if outline.len() < 3 || area(&outline) == 0.0 {
                return self.wrong(polyline, "it encloses nothing", "give it three corners or more");
            }
            outlines.push(outline);
        }
        let mesh = extrude(outlines, height? as f32, geometry.source.file.to_path_buf());
        if mesh.triangles.is_empty() {
            return self.wrong(geometry, "its outlines leave nothing solid", "draw each outline once");
        }
        Some(Arc::new(mesh))
    }

    fn wrong<T>(&mut self, polyline: &Element, what: &str, remedy: &str) -> Option<T> {
        self.diagnostics.error(&polyline.source, format!("a <polyline> cannot be drawn: {what}"), remedy);
        None
    }
}

/// Returns twice the area: positive if counter-clockwise.
fn area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|([x, y], [u, v])| x * v - u * y).sum()
}

/// Returns true if a point is inside: an odd number of edges lie to its right.
fn encloses(outline: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let next = outline.iter().cycle().skip(1);
    let edges = outline.iter().zip(next);
    edges.filter(|([a, b], [c, d])| (b > &y) != (d > &y) && x < a + (y - b) / (d - b) * (c - a)).count() % 2
        == 1
}

/// Returns the outlines that contain another one.
fn around(outlines: &[Outline], inner: usize) -> Vec<usize> {
    let others = (0..outlines.len()).filter(|other| *other != inner);
    others.filter(|other| encloses(&outlines[*other], outlines[inner][0])).collect()
}

fn extrude(mut outlines: Vec<Outline>, height: f32, path: std::path::PathBuf) -> Mesh {
    let around: Vec<Vec<usize>> = (0..outlines.len()).map(|inner| around(&outlines, inner)).collect();
    // Solid inside an even number of others, a hole in the innermost of an odd number.
    let depth: Vec<usize> = around.iter().map(Vec::len).collect();
    let is_solid = |one: usize| depth[one].is_multiple_of(2);
    for (one, outline) in outlines.iter_mut().enumerate() {
        if (area(outline) > 0.0) != is_solid(one) {
            outline.reverse();
        }
    }
    let mut mesh = Mesh {
        path,
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
        material: None,
    };
    let mut cutter = Earcut::new();
    let mut cut: Vec<u32> = Vec::new();
    for solid in (0..outlines.len()).filter(|one| is_solid(*one)) {
        let holes = (0..outlines.len())
            .filter(|hole| depth[*hole] == depth[solid] + 1 && around[*hole].contains(&solid));
        let (mut points, mut starts) = (outlines[solid].clone(), Vec::new());
        for hole in holes {
            starts.push(points.len() as u32);
            points.extend(&outlines[hole]);
        }
        cutter.earcut(points.iter().copied(), &starts, &mut cut);
        let first = mesh.positions.len() as u32;
        let count = points.len() as u32;
        for z in [0.0, height] {
            mesh.positions.extend(points.iter().map(|[x, y]| [*x as f32, *y as f32, z]));
        }
        for corners in cut.chunks_exact(3) {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            // The winding of the triangles does not matter: the top must face up, the bottom down.
            let [p, q, r] = [a, b, c].map(|corner| points[corner as usize]);
            let [a, b, c] = if area(&[p, q, r]) > 0.0 { [a, b, c] } else { [a, c, b] };
            mesh.triangles.push([a, b, c].map(|corner| first + count + corner));
            mesh.triangles.push([a, c, b].map(|corner| first + corner));
        }
        let ends = starts.iter().copied().skip(1).chain([count]);
        let rings = std::iter::once((0, starts.first().copied().unwrap_or(count)))
            .chain(starts.iter().copied().zip(ends));
        for (start, end) in rings {
            for corner in start..end {
                let next = if corner + 1 == end { start } else { corner + 1 };
                let [a, b, c, d] = [corner, next, next + count, corner + count].map(|corner| first + corner);
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh
}
