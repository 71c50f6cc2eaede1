//! A scene as one sensor sees it at one moment: instances relative to the sensor, under a tree of their own.

use crate::execution::Execution;
use crate::pose::Pose;
use crate::scene::bvh;
use crate::scene::{Aabb, Instance, Node, Scene, max_nodes};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3};

/// An instance moved into the frame of a sensor: axes along the world's, origin at the sensor. The difference
/// is taken in f64, so a robot 100 km from the world's origin sees what it sees at it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Placed {
    /// Rows: take what is relative to `translation` into the instance's unscaled frame.
    pub(crate) inverse: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    pub(crate) instance: u32,
    reserved: u32,
}

/// The memory that tracing one frame needs, in the caller's slices. `instances` of each at least, as many as
/// the scene has; of `nodes` [`max_nodes`] of that.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// One per instance.
    pub placed: &'a mut [Placed],
    /// One per instance.
    pub bounds: &'a mut [Aabb],
    /// One per instance.
    pub order: &'a mut [u32],
    /// [`max_nodes`] of the number of instances.
    pub nodes: &'a mut [Node],
    /// SIMD level and threads.
    pub execution: Execution,
}

impl Workspace<'_> {
    /// True when the slices are long enough for the scene.
    pub fn fits(&self, scene: &Scene<'_>) -> bool {
        let instances = scene.instances.len();
        self.placed.len() >= instances
            && self.bounds.len() >= instances
            && self.order.len() >= instances
            && self.nodes.len() >= max_nodes(instances)
    }
}

/// An owned [`Workspace`]: allocates when made, or when a scene has outgrown it, and never else.
#[cfg(feature = "alloc")]
#[derive(Debug, Default, Clone)]
pub struct WorkspaceBuf {
    placed: alloc::vec::Vec<Placed>,
    bounds: alloc::vec::Vec<Aabb>,
    order: alloc::vec::Vec<u32>,
    nodes: alloc::vec::Vec<Node>,
    /// SIMD level and threads.
    pub execution: Execution,
}

#[cfg(feature = "alloc")]
impl WorkspaceBuf {
    /// Enough for the scene.
    pub fn for_scene(scene: &Scene<'_>) -> Self {
        let mut workspace = Self::default();
        workspace.fit(scene);
        workspace
    }

    /// Grows to hold the scene, if it is too small.
    pub fn fit(&mut self, scene: &Scene<'_>) {
        let instances = scene.instances.len();
        if self.placed.len() < instances || self.nodes.is_empty() {
            self.placed.resize(instances, Placed::zeroed());
            self.bounds.resize(instances, Aabb::EMPTY);
            self.order.resize(instances, 0);
            self.nodes.resize(max_nodes(instances), Node::zeroed());
        }
    }

    /// Lends it to a sensor.
    pub fn lend(&mut self) -> Workspace<'_> {
        Workspace {
            placed: &mut self.placed,
            bounds: &mut self.bounds,
            order: &mut self.order,
            nodes: &mut self.nodes,
            execution: self.execution,
        }
    }
}

/// A scene placed around a sensor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) placed: &'a [Placed],
    /// Indices into `placed`, in the order of the leaves.
    pub(crate) order: &'a [u32],
    pub(crate) nodes: &'a [Node],
    /// Position of the frame's origin in the world.
    pub(crate) origin_in_world: DVec3,
}

impl<'a> Frame<'a> {
    /// Places what `visibility` lets the sensor see around `origin_in_world`.
    ///
    /// # Panics
    /// When the workspace does not fit the scene: see [`Workspace::fits`].
    pub(crate) fn new(
        scene: &Scene<'a>,
        origin_in_world: DVec3,
        visibility: u32,
        workspace: &'a mut Workspace<'_>,
    ) -> Self {
        assert!(workspace.fits(scene), "the workspace is smaller than the scene needs");
        let mut count = 0;
        for (index, instance) in scene.instances.iter().enumerate() {
            if instance.visibility & visibility == 0 {
                continue;
            }
            let translation = instance.world_from_instance.translation() - origin_in_world;
            let axes = instance.scaled_axes();
            workspace.placed[count] = Placed {
                inverse: instance.inverse_scaled_axes().transpose().to_cols_array_2d(),
                translation: translation.to_array(),
                instance: index as u32,
                reserved: 0,
            };
            workspace.bounds[count] = bounds_in_frame(scene, instance, &axes, translation);
            count += 1;
        }
        let nodes = bvh::build(&workspace.bounds[..count], &mut workspace.order[..count], workspace.nodes, 1);
        Frame {
            scene: *scene,
            placed: &workspace.placed[..count],
            order: &workspace.order[..count],
            nodes: &workspace.nodes[..nodes],
            origin_in_world,
        }
    }

    pub(crate) fn instance(&self, placed: u32) -> &'a Instance {
        &self.scene.instances[self.placed[placed as usize].instance as usize]
    }

    /// A point of the world in the frame.
    pub(crate) fn point_in_frame(&self, point_in_world: [f64; 3]) -> DVec3 {
        DVec3::from_array(point_in_world) - self.origin_in_world
    }
}

fn bounds_in_frame(scene: &Scene<'_>, instance: &Instance, axes: &DMat3, translation: DVec3) -> Aabb {
    let [low, high] = scene.local_bounds(instance);
    let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let centre = *axes * centre + translation;
    let reach = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
    Aabb::from_f64((centre - reach).to_array(), (centre + reach).to_array())
}

/// Where a frame is taken from, and what makes its noise its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capture {
    /// Pose of the sensor at the moment of capture.
    pub world_from_sensor: Pose,
    /// Number of the frame; noise is a function of seed, sensor, frame and sample.
    pub frame: u64,
}
