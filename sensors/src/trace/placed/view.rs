//! A scene as one sensor sees it at one moment: its instances placed around the sensor, under a tree.

use crate::moment::Moment;
use crate::pose::Pose;
use crate::scene::tree::WideNode;
use crate::scene::{Aabb, HeightGrid, Instance, Kind, Scene, Triangles, limits};
use crate::simd::WIDTH;
use crate::trace::error::SenseError;
use crate::trace::placed::top::{build_top, top_nodes};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};

/// The largest number of levels of the tree over the instances: 16⁸ = 2³².
pub(crate) const MAX_DEPTH: usize = 8;

/// Transforms points of an instance, in single precision, to the axes of the sensor.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ToSensor {
    /// Rows of the matrix.
    pub(crate) rows: [[f32; 3]; 3],
    /// The sensor's origin in the instance, rounded …
    pub(crate) origin_high: [f32; 3],
    /// … and the remainder after rounding.
    pub(crate) origin_low: [f32; 3],
}

impl ToSensor {
    fn new(sensor_from_instance: &DMat3, origin: DVec3) -> Self {
        let high = origin.as_vec3();
        Self {
            rows: sensor_from_instance.transpose().as_mat3().to_cols_array_2d(),
            origin_high: high.to_array(),
            origin_low: (origin - high.as_dvec3()).as_vec3().to_array(),
        }
    }
}

/// An instance in the frame of a sensor: axes along the world's, origin at the sensor. The difference of positions is
/// computed in f64, so that a robot 100 km from the world's origin sees the same as at the origin.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Placed {
    /// Columns: the instance's axes in the frame, including the scale.
    pub(crate) axes: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    /// Rows of the inverse: from the frame to the instance.
    pub(crate) inverse: [[f64; 3]; 3],
    /// The frame's origin in the instance.
    pub(crate) origin_in_instance: [f64; 3],
    pub(crate) to_sensor: ToSensor,
    /// Transforms normals of the instance to the frame: rows of the inverse transpose.
    normal_rows: [[f32; 3]; 3],
    pub(crate) instance: u32,
    /// The number of its [`Kind`].
    kind: u32,
    /// The slot of its first primitive.
    pub(crate) first_slot: u32,
    pub(crate) first_node: u32,
    pub(crate) first_block: u32,
    /// The index of its mesh or height field.
    pub(crate) mesh: u32,
    /// 1 if it does not block light.
    clear: u32,
    /// 1 if its scale mirrors it.
    pub(crate) mirrored: u32,
    /// 1 if its scale is not 1, so that normals must be normalised in the frame.
    scaled: u32,
    /// 0 if its axes are those of the world, unscaled.
    turned: u32,
}

impl Placed {
    /// The kind of shape of the instance.
    #[inline(always)]
    pub(crate) fn kind(&self) -> Kind {
        Kind::of_checked(self.kind)
    }

    /// Returns true if the axes of the instance differ from those of the frame.
    #[inline(always)]
    pub(crate) fn is_turned(&self) -> bool {
        self.turned != 0
    }

    /// Returns true if it blocks light.
    #[inline(always)]
    pub(crate) fn casts_shadows(&self) -> bool {
        self.clear == 0
    }

    /// Transforms a unit normal of the instance to the frame.
    #[inline(always)]
    pub(crate) fn normal_in_frame(&self, normal: [f32; 3]) -> [f32; 3] {
        if self.turned == 0 {
            return normal;
        }
        let [x, y, z] = normal;
        let mut turned = self.normal_rows.map(|row| (row[0] * x + row[1] * y) + row[2] * z);
        if self.scaled != 0 {
            let [x, y, z] = turned;
            let length = crate::simd::sqrt_f32((x * x + y * y) + z * z);
            turned = [x / length, y / length, z / length];
        }
        turned
    }

    /// Transforms a direction of the frame to the instance.
    pub(crate) fn vector_in_instance(&self, vector: DVec3) -> DVec3 {
        let [x, y, z] = self.inverse.map(|row| DVec3::from_array(row).dot(vector));
        DVec3::new(x, y, z)
    }
}

/// A scene placed around a sensor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) world_from_sensor: Pose,
    /// Poses, by the index of the instance in the scene.
    pub(crate) world_from_instance: &'a [Pose],
    /// The next moment, if rays have times between the two.
    pub(crate) next: Option<Moment<'a>>,
    pub(crate) placed: &'a [Placed],
    /// The tree over the placed instances, in the frame; a leaf is an index into `placed`.
    pub(crate) nodes: &'a [WideNode],
    /// The transformation from the frame to the axes of the sensor.
    pub(crate) sensor_from_frame: ToSensor,
    pub(crate) sensor_from_world: DMat3,
    /// The position of the frame's origin in the world.
    pub(crate) origin_in_world: DVec3,
    /// True if any instance may shadow itself.
    pub(crate) has_concave: bool,
}

/// Memory for a [`View`].
pub(crate) struct ViewMemory<'a> {
    pub(crate) placed: &'a mut [Placed],
    pub(crate) bounds: &'a mut [Aabb],
    pub(crate) order: &'a mut [u64],
    pub(crate) nodes: &'a mut [WideNode],
}

impl ViewMemory<'_> {
    /// Reborrows the memory.
    pub(crate) fn reborrow(&mut self) -> ViewMemory<'_> {
        ViewMemory { placed: self.placed, bounds: self.bounds, order: self.order, nodes: self.nodes }
    }

    /// Splits off the memory of the first `views` views, each with `instances` instances.
    pub(crate) fn split(self, views: usize, instances: usize) -> (Self, Self) {
        let (placed, placed_rest) = self.placed.split_at_mut(views * instances);
        let (bounds, bounds_rest) = self.bounds.split_at_mut(views * instances);
        let (order, order_rest) = self.order.split_at_mut(views * instances);
        let (nodes, nodes_rest) = self.nodes.split_at_mut(views * top_nodes(instances));
        (
            Self { placed, bounds, order, nodes },
            Self { placed: placed_rest, bounds: bounds_rest, order: order_rest, nodes: nodes_rest },
        )
    }
}

/// Checks that a moment has a pose for the sensor and for each instance.
pub(crate) fn check_moment(scene: &Scene<'_>, moment: &Moment<'_>) -> Result<(), SenseError> {
    let (value, need) = (moment.world_from_instance.len(), scene.instances().len());
    if value != need {
        return Err(SenseError::Poses { value, need });
    }
    if !moment.world_from_sensor.is_finite() {
        return Err(SenseError::Pose);
    }
    Ok(())
}

impl<'a> View<'a> {
    /// Transforms a direction from the axes of the sensor to the frame.
    #[inline(always)]
    pub(crate) fn frame_from_sensor(&self, direction: DVec3) -> DVec3 {
        self.sensor_from_world.transpose() * direction
    }

    /// Places the instances that `visibility` selects, at a moment that has been [checked](check_moment).
    pub(crate) fn new(
        scene: &Scene<'a>,
        moment: &Moment<'a>,
        visibility: u32,
        memory: ViewMemory<'a>,
    ) -> Self {
        Self::until(scene, (moment, None), visibility, memory)
    }

    /// The same for rays with times between two moments, as fractions of the interval, up to the given fraction. Poses
    /// are those at the first moment, but the boxes of the tree contain moving instances during the whole interval.
    pub(crate) fn until(
        scene: &Scene<'a>,
        (moment, next): (&Moment<'a>, Option<(Moment<'a>, f64)>),
        visibility: u32,
        memory: ViewMemory<'a>,
    ) -> Self {
        let origin_in_world = moment.world_from_sensor.translation();
        let sensor_from_world = moment.world_from_sensor.rotation_matrix().transpose();
        let ViewMemory { placed, bounds, order, nodes } = memory;
        let (mut count, mut slots, mut has_concave) = (0, 0, false);
        for (index, (instance, pose)) in scene.instances.iter().zip(moment.world_from_instance).enumerate() {
            if instance.visibility & visibility == 0 || limits::pose(pose).is_err() {
                continue;
            }
            let turn = pose.rotation_matrix();
            let axes = instance.scaled_axes(&turn);
            let translation = pose.translation() - origin_in_world;
            let inverse = instance.inverse_scaled_axes(&turn);
            let origin = inverse * -translation;
            let mesh = (instance.kind().is_mesh()).then(|| &scene.meshes[instance.mesh as usize]);
            let turned = axes != DMat3::IDENTITY;
            placed[count] = Placed {
                axes: axes.to_cols_array_2d(),
                translation: translation.to_array(),
                inverse: inverse.transpose().to_cols_array_2d(),
                origin_in_instance: origin.to_array(),
                to_sensor: ToSensor::new(&(sensor_from_world * axes), origin),
                instance: index as u32,
                kind: instance.kind().number(),
                first_slot: slots,
                first_node: mesh.map_or(0, |mesh| mesh.first_node),
                mesh: instance.mesh,
                clear: u32::from(!scene.materials[instance.material as usize].casts_shadows()),
                first_block: mesh.map_or(0, |mesh| mesh.first_block),
                mirrored: u32::from(axes.determinant() < 0.0),
                normal_rows: inverse.as_mat3().to_cols_array_2d(),
                scaled: u32::from(instance.scale != [1.0; 3]),
                turned: u32::from(turned),
            };
            bounds[count] = bounds_in_frame(scene, instance, &axes, translation);
            if let Some((next, share)) = &next {
                let end = &next.world_from_instance[index];
                if limits::pose(end).is_err() {
                    continue;
                }
                if pose != end {
                    let end = pose.interpolate(end, *share);
                    let axes = instance.scaled_axes(&end.rotation_matrix());
                    let there = bounds_in_frame(scene, instance, &axes, end.translation() - origin_in_world);
                    bounds[count] = swept(&bounds[count], &there, bow(scene, instance, pose, &end));
                }
            }
            slots += scene.slots(instance);
            has_concave |= !instance.kind().is_solid();
            count += 1;
        }
        let used = build_top(&bounds[..count], &mut order[..count], nodes);
        View {
            scene: *scene,
            world_from_sensor: moment.world_from_sensor,
            world_from_instance: moment.world_from_instance,
            next: next.map(|(next, _)| next),
            placed: &placed[..count],
            nodes: &nodes[..used],
            sensor_from_frame: ToSensor::new(&sensor_from_world, DVec3::ZERO),
            sensor_from_world,
            origin_in_world,
            has_concave,
        }
    }

    pub(crate) fn instance(&self, placed: u32) -> &'a Instance {
        &self.scene.instances[self.placed[placed as usize].instance as usize]
    }

    /// Rows of the matrix from the sensor's axes to those of an instance.
    pub(crate) fn rows_from_sensor(&self, placed: &Placed) -> [[f64; 3]; 3] {
        let [x, y, z] = placed.inverse;
        let row = |row: [f64; 3]| (self.sensor_from_world * DVec3::from_array(row)).to_array();
        [row(x), row(y), row(z)]
    }

    /// The tree of a height field.
    #[inline(always)]
    pub(crate) fn height_grid(&self, placed: &Placed) -> HeightGrid<'a> {
        let field = &self.scene.height_fields[placed.mesh as usize];
        HeightGrid::of(field, self.scene.heights, self.scene.extents)
    }

    /// The upward normal of a height field's triangle in its frame, of any positive length. `local` is the slot of the
    /// triangle, counted from the instance's first.
    #[inline(always)]
    pub(crate) fn height_field_normal(&self, placed: &Placed, local: u32) -> [f32; 3] {
        let width = WIDTH as u32;
        let [along_x, along_y] = self.height_grid(placed).slopes(local / width, local % width);
        // Scaled so that no square overflows, however steep the triangle is.
        let most = along_x.abs().max(along_y.abs()).max(1.0);
        [-along_x / most, -along_y / most, 1.0 / most]
    }

    /// The corners of a triangle of an instance, in its frame. `local` is the slot, counted from the instance's first.
    #[inline(always)]
    pub(crate) fn corners(&self, placed: &Placed, local: u32) -> [DVec3; 3] {
        let (block, lane) = (local / WIDTH as u32, local as usize % WIDTH);
        if placed.kind() == Kind::Triangles(Triangles::HeightField) {
            let grid = self.height_grid(placed);
            let [a, b, c] = grid.triangle(grid.triangle_of(block, lane as u32));
            return [wide(a), wide(b), wide(c)];
        }
        let corners = &self.scene.blocks[(placed.first_block + block) as usize].corners;
        let corner =
            |[x, y, z]: &[[f32; WIDTH]; 3]| DVec3::new(x[lane].into(), y[lane].into(), z[lane].into());
        [corner(&corners[0]), corner(&corners[1]), corner(&corners[2])]
    }

    /// Transforms a point of the world to the frame.
    pub(crate) fn point_in_frame(&self, point_in_world: [f64; 3]) -> DVec3 {
        DVec3::from_array(point_in_world) - self.origin_in_world
    }
}

#[inline(always)]
fn wide(point: [f32; 3]) -> DVec3 {
    Vec3::from_array(point).as_dvec3()
}

/// An upper bound on the deviation of an instance's points from the straight line as it moves from one pose to another.
fn bow(scene: &Scene<'_>, instance: &Instance, from: &Pose, to: &Pose) -> f64 {
    // The cosine of half the angle of the rotation.
    let cos = from.rotation().dot(to.rotation()).abs().min(1.0);
    if cos == 1.0 {
        return 0.0;
    }
    let [low, high] = scene.local_bounds(instance);
    let reach = (low.abs().max(high.abs()) * DVec3::from_array(instance.scale)).length();
    // An arc deviates from its chord by 1 − cos. In addition, the rotation is not uniform: the deviation is less than
    // the cube of the tangent of a quarter of the angle.
    let quarter = crate::simd::sqrt((1.0 - cos) / (1.0 + cos));
    reach * ((1.0 - cos) + quarter * quarter * quarter)
}

/// A box that contains the movement from one box to another, if the points deviate from straight lines by at most
/// `bow`.
fn swept(from: &Aabb, to: &Aabb, bow: f64) -> Aabb {
    let least = |axis: usize| f64::from(from.min[axis].min(to.min[axis])) - bow;
    let most = |axis: usize| f64::from(from.max[axis].max(to.max[axis])) + bow;
    Aabb::from_f64([0, 1, 2].map(least), [0, 1, 2].map(most))
}

fn bounds_in_frame(scene: &Scene<'_>, instance: &Instance, axes: &DMat3, translation: DVec3) -> Aabb {
    let [low, high] = scene.local_bounds(instance);
    let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let centre = *axes * centre + translation;
    let reach = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
    Aabb::from_f64((centre - reach).to_array(), (centre + reach).to_array())
}
