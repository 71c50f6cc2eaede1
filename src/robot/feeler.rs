//! [`Feeler`]: what touched the collisions of a contact sensor, step by step.
//!
//! A contact may be shorter than the time between two frames of its sensor. Therefore a feeler keeps the last contacts of
//! each pair of shapes, and the sum of the impulses between them. The sensor compares sums, so a frame has the mean force
//! since the last one.

use crate::description::model::{LinkIndex, Model, Sensor, SensorKind};
use crate::world::physics::{ModelIndex, Physics, ShapeHandle, Touch};
use glam::DVec3;
use std::collections::HashMap;

/// Number of pairs up to which those of removed shapes are not looked for.
const FEW_PAIRS: usize = 64;

/// The collisions that a contact sensor watches.
#[derive(Debug, Clone)]
pub struct Feeler {
    /// The shapes of the collisions, each with its link and its index in the link.
    own: Vec<(ShapeHandle, LinkIndex, usize)>,
    /// The places of the shapes in `own`.
    places: HashMap<ShapeHandle, usize>,
    pairs: Vec<Pair>,
    /// The indices of the pairs.
    known: HashMap<(ShapeHandle, ShapeHandle), usize>,
    /// Number of pairs from which those of removed shapes are looked for again.
    room: usize,
}

/// Two shapes that touched each other.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    /// The link of the watched collision, and the index of the collision in it.
    pub(crate) own: (LinkIndex, usize),
    /// The shape of that collision, and the other shape.
    pub(crate) shapes: (ShapeHandle, ShapeHandle),
    /// The last step in which they touched ended at this time.
    pub(crate) touched_ns: u64,
    /// The points at which they touched in that step, with the impulses of that step.
    pub(crate) touches: Vec<Touch>,
    /// The sum of all impulses on the watched shape so far, in N·s.
    pub(crate) passed: DVec3,
}

impl Feeler {
    /// Returns the feelers of a model, in the order of its contact sensors.
    pub(crate) fn all(model: &Model, index: ModelIndex, physics: &Physics) -> Vec<Self> {
        let contact = |sensor: &Sensor| {
            let SensorKind::Contact(contact) = &sensor.kind else { return None };
            let shapes = contact.collisions.iter().filter_map(|(link, collision)| {
                Some((physics.shape_of(index, *link, *collision)?, *link, *collision))
            });
            let own: Vec<_> = shapes.collect();
            let places = own.iter().enumerate().map(|(place, (shape, ..))| (*shape, place)).collect();
            Some(Self { own, places, pairs: Vec::new(), known: HashMap::new(), room: FEW_PAIRS })
        };
        model.sensors.iter().filter_map(contact).collect()
    }

    /// Records the contacts of a step.
    pub(crate) fn observe(&mut self, physics: &Physics) {
        let now_ns = physics.time_ns();
        for (number, &(shape, link, collision)) in self.own.iter().enumerate() {
            for touch in physics.touches_of(shape) {
                // Shapes that only come near each other transmit nothing.
                let is_contact = touch.gap_m <= 0.0 || touch.impulse != DVec3::ZERO;
                // Two watched collisions are one pair.
                let is_told = self.places.get(&touch.other).is_some_and(|place| *place < number);
                if !is_contact || is_told {
                    continue;
                }
                let (own, shapes, pairs) = ((link, collision), (shape, touch.other), &mut self.pairs);
                let known = *self.known.entry(shapes).or_insert_with(|| {
                    let (touches, passed) = (Vec::new(), DVec3::ZERO);
                    pairs.push(Pair { own, shapes, touched_ns: 0, touches, passed });
                    pairs.len() - 1
                });
                let pair = &mut self.pairs[known];
                if pair.touched_ns != now_ns {
                    pair.touched_ns = now_ns;
                    pair.touches.clear();
                }
                pair.touches.push(touch);
                pair.passed += touch.impulse;
            }
        }
        if self.pairs.len() >= self.room {
            self.pairs.retain(|pair| physics.has_shape(pair.shapes.1));
            self.known = self.pairs.iter().enumerate().map(|(index, pair)| (pair.shapes, index)).collect();
            self.room = (2 * self.pairs.len()).max(FEW_PAIRS);
        }
    }

    /// Returns the pairs that have touched so far. Their order is that in which they first touched.
    pub(crate) fn pairs(&self) -> &[Pair] {
        &self.pairs
    }
}
