//! Landmarks: where known points of instances, such as corners of tags or keypoints, appear in a picture.

use crate::moment::{Moment, Shutter};
use crate::optics::Optics;
use crate::optics::rays::Rays;
use crate::scene::tree::NONE;
use crate::scene::{Scene, visibility};
use crate::simd::dispatch;
use crate::trace::error::{SenseError, check_output};
use crate::trace::grid::{check_shutter, rays_len, rays_of};
use crate::trace::packet::Faces;
use crate::trace::placed::memory::{Workspace, view_lines};
use crate::trace::placed::view::View;
use crate::trace::rays::ray::FrameRay;
use crate::trace::rays::scene::{Stacks, hit_in_view};
use crate::trace::truth::flow::at_its_line;
use glam::DVec3;

/// The number of rays across and down that are compared with the direction of a point at the beginning of the search
/// for its pixel.
const COARSE: i32 = 24;
/// A surface that is nearer than a point by at most this fraction of its distance does not hide it, because rays are in
/// single precision.
const TOUCHING: f64 = 1e-5;
/// The same for the instance that the point belongs to, whose surface may be slightly above the point.
const BEARING: f64 = 1e-3;

/// A point that is fixed to an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// The index of the instance.
    pub instance: u32,
    /// The point in metres, in the frame of the instance's pose.
    pub point: DVec3,
    /// The outward normal of the surface at the point, in the same frame and of any length. The point is visible from
    /// that side only; with a normal of 0 it is visible from everywhere.
    pub normal: DVec3,
}

/// The place at which a [`Landmark`] is seen, and whether it is visible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Column and row; centres of pixels are integers. NaN where the optics have no pixel for the point: behind a
    /// pinhole, and outside the pixels of other optics.
    pub pixel: [f64; 2],
    /// The depth along the optical axis in metres, at the moment at which the point's line is taken.
    pub depth: f64,
    /// The index of the shutter's slice that has the point's line; 0 if all lines are taken at one moment.
    pub slice: usize,
    /// Whether the point lies in the picture and within the range, faces the sensor, and is not occluded.
    pub visible: bool,
}

impl Sighting {
    /// The sighting of a landmark that the optics have no pixel for.
    pub const NONE: Self = Self { pixel: [f64::NAN; 2], depth: f64::NAN, slice: 0, visible: false };
}

/// What a camera sees of a scene, for [`see_landmarks`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The least and the greatest distance in metres; for a pinhole these are depths.
    pub range: [f64; 2],
    /// The instances that are visible: those whose [visibility](crate::scene::InstanceConfig::visibility) has a bit in
    /// common with this mask. Others hide nothing, and no point of theirs is visible.
    pub visibility: u32,
}

impl From<[f64; 2]> for Sight {
    /// Returns the sight of a camera with this range that sees all visuals.
    fn from(range: [f64; 2]) -> Self {
        Self { range, visibility: visibility::VISUAL }
    }
}

/// Returns the number of cache lines of [`Workspace`] memory that [`see_landmarks`] needs.
pub fn landmarks_workspace_len(scene: &Scene<'_>, optics: &Optics<'_>) -> usize {
    view_lines(scene.instances().len(), 1) + rays_len(optics, &optics.ray_grid(), 0)
}

/// Computes where a camera sees landmarks, through any lens and at the moment at which each one's row is taken, as in
/// the picture.
///
/// `sight` holds the camera's range and what is visible to it; a range converts to that of a camera that sees all visuals.
/// Points can be occluded by the front faces of everything that is visible. One ray is cast to each point; the surface
/// that it touches there does not occlude the point.
///
/// If slices of a shutter overlap, the first slice of a line counts. A point that a turning camera shows in several
/// rows is reported in one of them.
///
/// ```
/// use belvedere_sensors::optics::{Intrinsics, Optics, Pinhole, PinholeGrid};
/// use belvedere_sensors::{Pose, Shutter, scene::*, trace::*};
/// use belvedere_sensors::glam::DVec3;
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// let plate = builder.add_instance(&InstanceConfig {
///     shape: Shape::Box { size: [0.01, 1.0, 1.0] },
///     world_from_instance: Pose::from_translation(DVec3::X * 4.0),
///     material,
///     ..Default::default()
/// })?;
/// // A corner of the front face, and the same one of the back face.
/// let corner = |x| Landmark { instance: plate.0, point: DVec3::new(x, 0.5, 0.5), normal: DVec3::X * x };
/// let lens = Pinhole::new(Intrinsics { fx: 399.5, fy: 399.5, cx: 319.5, cy: 239.5, skew: 0.0 })?;
/// let optics = Optics::from(PinholeGrid::new(640, 480, lens)?);
///
/// let (scene, mut memory) = (builder.scene(), WorkspaceBuf::default());
/// let workspace = &mut memory.lend(landmarks_workspace_len(&scene, &optics));
/// let shutter = Shutter::Global(builder.moment(Pose::IDENTITY));
/// let mut seen = [Sighting::NONE; 2];
/// see_landmarks(&scene, &shutter, &optics, [0.1, 10.0].into(), workspace, &[corner(-0.005), corner(0.005)], &mut seen)?;
/// // 0.5 m to the left and up, at a depth of 3.995 m: 50 pixels.
/// assert!((seen[0].pixel[0] - 269.5).abs() < 1e-9 && (seen[0].pixel[1] - 189.5).abs() < 1e-9);
/// assert_eq!((seen[0].depth, seen[0].visible), (3.995, true));
/// assert!(!seen[1].visible);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns a [`SenseError`] if the optics, the range or a moment is invalid, if an instance does not exist, if `seen`
/// is not as long as `landmarks`, or if the workspace has less than [`landmarks_workspace_len`]. Nothing is written in
/// that case.
pub fn see_landmarks(
    scene: &Scene<'_>,
    shutter: &Shutter<'_>,
    optics: &Optics<'_>,
    sight: Sight,
    workspace: &mut Workspace<'_>,
    landmarks: &[Landmark],
    seen: &mut [Sighting],
) -> Result<(), SenseError> {
    optics.check()?;
    let Sight { range: [least, most], visibility } = sight;
    if !(least >= 0.0 && least < most) {
        return Err(SenseError::Range { least, most });
    }
    check_output("seen", Some(seen.len()), landmarks.len())?;
    let (ray_grid, execution, instances) = (optics.ray_grid(), workspace.execution, scene.instances().len());
    check_shutter(scene, shutter, ray_grid.height as u32)?;
    if let Some(&Landmark { instance, .. }) = landmarks.iter().find(|at| at.instance as usize >= instances) {
        return Err(SenseError::Instance { value: instance, instances });
    }
    let mut memory = workspace.cut(landmarks_workspace_len(scene, optics))?;
    let rays = rays_of(optics, (ray_grid, 0), execution, &mut memory);
    for (landmark, seen) in landmarks.iter().zip(seen.iter_mut()) {
        *seen = find(&rays, shutter, landmark);
        // This is only the first condition; rays are cast below.
        let is_shown = scene.instances()[landmark.instance as usize].visibility & visibility != 0;
        seen.visible = is_shown && in_picture(&rays, seen.pixel);
    }
    // Slice by slice, because each has its own view of the scene; most slices have no landmarks.
    let mut views = memory.views(instances, 1);
    let visible_in = |seen: &[Sighting], from: usize| {
        seen.iter().filter(|seen| seen.visible && seen.slice >= from).map(|seen| seen.slice).min()
    };
    let mut next = visible_in(seen, 0);
    while let Some(slice) = next {
        let moment = moment_of(shutter, slice);
        let view = View::new(scene, moment, visibility, views.reborrow());
        let here = |seen: &&mut Sighting| seen.visible && seen.slice == slice;
        for (seen, landmark) in seen.iter_mut().zip(landmarks).filter(|(seen, _)| here(seen)) {
            let point = towards(moment, landmark);
            let per_t = if matches!(optics, Optics::Pinhole(_)) { seen.depth } else { point.length() };
            seen.visible = (least..=most).contains(&per_t)
                && faces(moment, landmark, point)
                && dispatch!(execution.level, simd => {
                    let ray = FrameRay {
                        origin: [0.0; 3],
                        direction: point.as_vec3().to_array(),
                        range: [(least / per_t) as f32, 1.0],
                    };
                    let hit = hit_in_view::<false, _>(simd, &view, &ray, Faces::Front, &mut Stacks::new());
                    let nearer = 1.0 - hit.t;
                    let is_bearer = |placed: u32| view.placed[placed as usize].instance == landmark.instance;
                    hit.placed == NONE || nearer <= if is_bearer(hit.placed) { BEARING } else { TOUCHING }
                });
        }
        next = visible_in(seen, slice + 1);
    }
    Ok(())
}

fn moment_of<'a>(shutter: &'a Shutter<'_>, slice: usize) -> &'a Moment<'a> {
    match shutter {
        Shutter::Global(moment) => moment,
        Shutter::Slices(slices) => &slices[slice].at,
        // Moving shutters were refused before.
        Shutter::Moving(keyframes) => &keyframes[slice].at,
    }
}

/// The vector from the sensor to a landmark, along the axes of the world. Positions are subtracted first, so that no
/// digits are lost far from the world's origin.
fn towards(moment: &Moment<'_>, landmark: &Landmark) -> DVec3 {
    let pose = &moment.world_from_instance[landmark.instance as usize];
    let between = pose.translation() - moment.world_from_sensor.translation();
    pose.rotation_matrix() * landmark.point + between
}

/// Returns true if the landmark's side of the surface faces the sensor.
fn faces(moment: &Moment<'_>, landmark: &Landmark, towards: DVec3) -> bool {
    let pose = &moment.world_from_instance[landmark.instance as usize];
    landmark.normal == DVec3::ZERO || (pose.rotation_matrix() * landmark.normal).dot(towards) < 0.0
}

/// The pixel of a landmark at the moment at which its line is captured, even if it is hidden.
fn find(rays: &Rays<'_>, shutter: &Shutter<'_>, landmark: &Landmark) -> Sighting {
    let height = rays.ray_grid().height as u32;
    let in_sensor = |moment: &Moment<'_>| {
        moment.world_from_sensor.rotation_matrix().transpose() * towards(moment, landmark)
    };
    // A point that is not seen from one row may be seen from another.
    let rows = [0.5 * f64::from(height - 1), 0.0, f64::from(height - 1)];
    let found = rows
        .into_iter()
        .find_map(|row| at_its_line(shutter, height, row, |moment| project(rays, in_sensor(moment))));
    let Some((pixel, slice)) = found else { return Sighting::NONE };
    Sighting { pixel, depth: in_sensor(moment_of(shutter, slice)).x, slice, visible: false }
}

/// Returns true if there is a ray at a pixel.
fn in_picture(rays: &Rays<'_>, pixel: [f64; 2]) -> bool {
    let ray_grid = rays.ray_grid();
    let [column, row] = pixel.map(|at| libm::floor(at + 0.5));
    let inside = (0.0..f64::from(ray_grid.width)).contains(&column)
        && (0.0..f64::from(ray_grid.height)).contains(&row);
    inside && rays.has(column as i32, row as i32)
}

/// The column and row whose ray passes a point, or `None` if there is no such ray.
fn project(rays: &Rays<'_>, point: DVec3) -> Option<[f64; 2]> {
    if let Rays::Pinhole(_) = rays {
        return rays.project(point, [0.0; 2]); // which takes no guess
    }
    // Search within the cells around the nearest ray. At the borders, there may be none.
    let [column, row] = nearest(rays, point).map(f64::from);
    let middles = [[0.5, 0.5], [-0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]];
    middles.into_iter().find_map(|[x, y]| rays.project(point, [column + x, row + y]))
}

/// The pixel whose ray passes nearest to a point: the best of a coarse grid over the picture, and then repeatedly the
/// best of its neighbours at decreasing distances.
fn nearest(rays: &Rays<'_>, point: DVec3) -> [i32; 2] {
    let ray_grid = rays.ray_grid();
    let mut best = (f64::NEG_INFINITY, [0; 2]);
    let mut consider = |[column, row]: [i32; 2]| {
        let [column, row] = [column.clamp(0, ray_grid.width - 1), row.clamp(0, ray_grid.height - 1)];
        // All directions are unit vectors.
        let along = rays.direction(column, row).dot(point);
        if along > best.0 && rays.has(column, row) {
            best = (along, [column, row]);
        }
        best.1
    };
    let mut at = [0; 2];
    let of = |index: i32, size: i32| (index * (size - 1) + COARSE / 2) / COARSE;
    for row in 0..=COARSE {
        for column in 0..=COARSE {
            at = consider([of(column, ray_grid.width), of(row, ray_grid.height)]);
        }
    }
    let mut step = (ray_grid.width.max(ray_grid.height) / COARSE).max(1);
    loop {
        let [column, row] = at;
        for (x, y) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            at = consider([column + x * step, row + y * step]);
        }
        if at == [column, row] {
            if step == 1 {
                return at;
            }
            step /= 2;
        }
    }
}
