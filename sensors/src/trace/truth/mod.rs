//! Ground truth for each ray, computed from the same rays as a sensor's frame.

pub(in crate::trace) mod boxes;
mod flow;
pub(in crate::trace) mod landmarks;

use crate::execution::split_at;
use crate::memory::{Cutter, lines};
use crate::moment::Capture;
use crate::optics::Optics;
use crate::scene::Scene;
use crate::trace::error::{SenseError, check_output};
use crate::trace::grid::place::{Place, for_each_block};
use crate::trace::grid::{Band, Sight, check_shutter};
use crate::trace::hit::measure::Measure;
use crate::trace::hit::normals::{NormalFinder, Normals};
use crate::trace::hit::resolve::{Resolver, SurfaceHit};
use crate::trace::truth::flow::Flow;
use fearless_simd::{Select, Simd, SimdBase, u32x16};

/// The output buffers of ground truth, one element per ray in row-major order. Channels that are `None` are not
/// computed.
///
/// Ground truth describes what the sensor's rays hit between its smallest and largest distance, before any noise, limit
/// or encoding. If slices of a shutter overlap, it is that of the first slice of a line.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Truth<'a> {
    /// Depths along the optical axis in metres; +∞ where nothing is hit.
    pub depth: Option<&'a mut [f32]>,
    /// Ranges along the ray in metres; +∞ where nothing is hit.
    pub range: Option<&'a mut [f32]>,
    /// Outward unit normals in the axes of the world; 0 where nothing is hit.
    pub normal: Option<&'a mut [[f32; 3]]>,
    /// Indices of instances in the scene; `u32::MAX` where nothing is hit.
    pub instance: Option<&'a mut [u32]>,
    /// [Classes](crate::scene::InstanceConfig::class) of instances; 0 where nothing is hit.
    pub class: Option<&'a mut [u32]>,
    /// Angles of incidence in radians, between the reversed ray and the normal. They are more than π/2 where a surface
    /// is hit from inside, and NaN where nothing is hit.
    pub incidence: Option<&'a mut [f32]>,
    /// Optical flow in pixels, to the right and down: from the pixel to where the same point of the same instance is
    /// seen at [`Capture::after`].
    ///
    /// It is NaN where nothing is hit, and where the optics have no pixel for the new direction. The point may be
    /// occluded at that moment.
    pub flow: Option<&'a mut [[f32; 2]]>,
    /// Optical flow to [`Capture::before`], defined like `flow`.
    pub flow_back: Option<&'a mut [[f32; 2]]>,
}

/// The ground truth of one ray; see [`Truth`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct OfRay {
    pub(crate) depth: f32,
    pub(crate) range: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) instance: u32,
    pub(crate) class: u32,
    pub(crate) incidence: f32,
}

impl OfRay {
    /// The ground truth of a ray that hits nothing.
    pub(crate) const NOTHING: Self = Self {
        depth: f32::INFINITY,
        range: f32::INFINITY,
        normal: [0.0; 3],
        instance: u32::MAX,
        class: 0,
        incidence: f32::NAN,
    };
}

fn put<T>(output: &mut Option<&mut [T]>, index: usize, value: T) {
    if let Some(output) = output {
        output[index] = value;
    }
}

/// Checks that ground truth has an element for each ray, and that the capture has the moments for its flow.
pub(crate) fn check_truth(
    truth: Option<&Truth<'_>>,
    scene: &Scene<'_>,
    optics: &Optics<'_>,
    capture: &Capture<'_>,
) -> Result<(), SenseError> {
    let Some(truth) = truth else { return Ok(()) };
    let [width, height] = optics.size();
    truth.check(width * height, capture)?;
    for shutter in [&capture.before, &capture.after].into_iter().flatten() {
        check_shutter(scene, shutter, height as u32)?;
    }
    Ok(())
}

impl<'a> Truth<'a> {
    outputs! {
        /// Sets the buffer for depths.
        depth: &'a mut [f32],
        /// Sets the buffer for ranges.
        range: &'a mut [f32],
        /// Sets the buffer for normals.
        normal: &'a mut [[f32; 3]],
        /// Sets the buffer for indices of instances.
        instance: &'a mut [u32],
        /// Sets the buffer for classes.
        class: &'a mut [u32],
        /// Sets the buffer for angles of incidence.
        incidence: &'a mut [f32],
        /// Sets the buffer for the flow to [`Capture::after`].
        flow: &'a mut [[f32; 2]],
        /// Sets the buffer for the flow to [`Capture::before`].
        flow_back: &'a mut [[f32; 2]],
    }

    /// Checks that each output has `rays` elements, and that there is a moment for each flow.
    fn check(&self, rays: usize, capture: &Capture<'_>) -> Result<(), SenseError> {
        self.check_len(rays)?;
        match (&self.flow, &capture.after, &self.flow_back, &capture.before) {
            (Some(_), None, ..) => Err(SenseError::OtherMoment { parameter: "after" }),
            (.., Some(_), None) => Err(SenseError::OtherMoment { parameter: "before" }),
            _ => Ok(()),
        }
    }

    /// Checks that each output has `rays` elements.
    pub(crate) fn check_len(&self, rays: usize) -> Result<(), SenseError> {
        check_output("depth", self.depth.as_ref().map(|values| values.len()), rays)?;
        check_output("range", self.range.as_ref().map(|values| values.len()), rays)?;
        check_output("normal", self.normal.as_ref().map(|values| values.len()), rays)?;
        check_output("instance", self.instance.as_ref().map(|values| values.len()), rays)?;
        check_output("class", self.class.as_ref().map(|values| values.len()), rays)?;
        check_output("incidence", self.incidence.as_ref().map(|values| values.len()), rays)?;
        check_output("flow", self.flow.as_ref().map(|values| values.len()), rays)?;
        check_output("flow_back", self.flow_back.as_ref().map(|values| values.len()), rays)
    }

    /// Writes the ground truth of a single ray, without flow.
    pub(crate) fn put(&mut self, ray: usize, of: &OfRay) {
        put(&mut self.depth, ray, of.depth);
        put(&mut self.range, ray, of.range);
        put(&mut self.normal, ray, of.normal);
        put(&mut self.instance, ray, of.instance);
        put(&mut self.class, ray, of.class);
        put(&mut self.incidence, ray, of.incidence);
    }

    /// Creates buffers for the same channels and `rays` rays in other memory, without flow.
    pub(crate) fn elsewhere<'m>(&self, memory: &mut Cutter<'m>, rays: usize) -> Truth<'m> {
        Truth {
            depth: self.depth.is_some().then(|| memory.take(rays)),
            range: self.range.is_some().then(|| memory.take(rays)),
            normal: self.normal.is_some().then(|| memory.take(rays)),
            instance: self.instance.is_some().then(|| memory.take(rays)),
            class: self.class.is_some().then(|| memory.take(rays)),
            incidence: self.incidence.is_some().then(|| memory.take(rays)),
            flow: None,
            flow_back: None,
        }
    }

    /// The number of cache lines for [`Truth::elsewhere`] with all channels.
    pub(crate) const fn elsewhere_len(rays: usize) -> usize {
        5 * lines(rays * size_of::<f32>()) + lines(rays * size_of::<[f32; 3]>())
    }

    /// Reborrows the buffers.
    pub(crate) fn reborrow(&mut self) -> Truth<'_> {
        Truth {
            depth: self.depth.as_deref_mut(),
            range: self.range.as_deref_mut(),
            normal: self.normal.as_deref_mut(),
            instance: self.instance.as_deref_mut(),
            class: self.class.as_deref_mut(),
            incidence: self.incidence.as_deref_mut(),
            flow: self.flow.as_deref_mut(),
            flow_back: self.flow_back.as_deref_mut(),
        }
    }

    /// Splits off the ground truth of the first `rays` rays.
    pub(crate) fn split_at(self, rays: usize) -> (Self, Self) {
        let (depth, depth_rest) = split_at(self.depth, rays);
        let (range, range_rest) = split_at(self.range, rays);
        let (normal, normal_rest) = split_at(self.normal, rays);
        let (instance, instance_rest) = split_at(self.instance, rays);
        let (class, class_rest) = split_at(self.class, rays);
        let (incidence, incidence_rest) = split_at(self.incidence, rays);
        let (flow, flow_rest) = split_at(self.flow, rays);
        let (flow_back, flow_back_rest) = split_at(self.flow_back, rays);
        (
            Self { depth, range, normal, instance, class, incidence, flow, flow_back },
            Self {
                depth: depth_rest,
                range: range_rest,
                normal: normal_rest,
                instance: instance_rest,
                class: class_rest,
                incidence: incidence_rest,
                flow: flow_rest,
                flow_back: flow_back_rest,
            },
        )
    }

    /// Writes the ground truth of the rays of a band. Compiled once per level, for all kinds of sensors.
    #[inline(never)]
    pub(crate) fn write<S: Simd>(&mut self, simd: S, band: &Band<'_>, sight: &Sight, capture: &Capture<'_>) {
        simd.vectorize(
            #[inline(always)]
            || self.write_channels(simd, band, sight, capture),
        );
    }

    /// Works block by block, so that the hits of a block's rays are resolved once for all channels.
    #[inline(always)]
    fn write_channels<S: Simd>(&mut self, simd: S, band: &Band<'_>, sight: &Sight, capture: &Capture<'_>) {
        let mut resolver = Resolver::new(band.view);
        let measure = Measure::new(&band.view.world_from_sensor);
        if let Some(depth) = self.depth.as_deref_mut() {
            for_each_block(
                band,
                #[inline(always)]
                |place, block| {
                    place.write_f32(simd, measure.block::<S, true>(simd, band, &mut resolver, block), depth);
                },
            );
        }
        if let Some(range) = self.range.as_deref_mut() {
            for_each_block(
                band,
                #[inline(always)]
                |place, block| {
                    place.write_f32(simd, measure.block::<S, false>(simd, band, &mut resolver, block), range);
                },
            );
        }
        let mut finder = NormalFinder::new(sight.faces);
        if let Some(incidence) = self.incidence.as_deref_mut() {
            let axes = band.view.world_from_sensor.rotation_matrix();
            for_each_block(
                band,
                #[inline(always)]
                |place, block| {
                    place.write(&finder.incidence(simd, band, &axes, &mut resolver, block), incidence);
                },
            );
        }
        let Self { normal, instance, class, flow, flow_back, .. } = self;
        let (mut after, mut before) =
            (capture.after.as_ref().map(Flow::new), capture.before.as_ref().map(Flow::new));
        if normal.is_none() && instance.is_none() && class.is_none() && flow.is_none() && flow_back.is_none()
        {
            return;
        }
        for_each_block(
            band,
            #[inline(always)]
            |place, block| {
                let slots = &band.target.slot[place.block];
                let met = resolver.met(simd, slots);
                if instance.is_some() || class.is_some() {
                    let outputs = [instance.as_deref_mut(), class.as_deref_mut()];
                    write_identities(simd, band, &mut resolver, place, &met, outputs);
                }
                if let Some(normal) = normal.as_deref_mut() {
                    match finder.of(simd, band, &mut resolver, block, &met) {
                        Normals::Same(same) => place.write_normal(simd, same, normal),
                        Normals::Each(each) => place.write_normals(simd, each, normal),
                    }
                }
                if let (Some(output), Some(flow)) = (flow.as_deref_mut(), &mut after) {
                    place.write_pairs(simd, flow.block(simd, band, &mut resolver, block, &met), output);
                }
                if let (Some(output), Some(flow)) = (flow_back.as_deref_mut(), &mut before) {
                    place.write_pairs(simd, flow.block(simd, band, &mut resolver, block, &met), output);
                }
            },
        );
    }
}

/// Writes the instances that the rays of a block have hit, and their classes.
#[inline(always)]
fn write_identities<S: Simd>(
    simd: S,
    band: &Band<'_>,
    resolver: &mut Resolver<'_>,
    place: &Place,
    met: &SurfaceHit<'_>,
    outputs: [Option<&mut [u32]>; 2],
) {
    let known = band.view.scene.instances();
    let mut rest = match met {
        SurfaceHit::Nothing => 0,
        SurfaceHit::One(hit) => {
            let index = hit.instance.instance;
            for (output, value) in outputs.into_iter().zip([index, known[index as usize].class]) {
                if let Some(output) = output {
                    place.fill(value, output);
                }
            }
            return;
        }
        SurfaceHit::Several(lanes) => *lanes,
    };
    let slots = &band.target.slot[place.block];
    let (mut instances, mut classes) = (u32x16::splat(simd, u32::MAX), u32x16::splat(simd, 0));
    while rest != 0 {
        let (hit, own) = resolver.first_of(simd, slots, rest);
        rest &= !own;
        let own = simd.from_bitmask_mask32x16(u64::from(own));
        let index = hit.instance.instance;
        instances = own.select(u32x16::splat(simd, index), instances);
        classes = own.select(u32x16::splat(simd, known[index as usize].class), classes);
    }
    for (output, values) in outputs.into_iter().zip([instances, classes]) {
        if let Some(output) = output {
            place.write_u32(simd, values, output);
        }
    }
}
