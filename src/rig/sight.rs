//! Selects the shapes that sensors see.

use crate::description::model::RaySensor;
use crate::world::scene::flag_bits;
use belvedere_sensors::scene::visibility;
use belvedere_sensors::trace::Faces;

/// Returns the visibility mask of the rays, and which sides of surfaces they see.
pub(super) fn sight(ray: &RaySensor) -> (u32, Faces) {
    // Gazebo's GPU lidars render visuals, without back faces; its CPU lidars cast rays at collision shapes.
    match ray.visibility_mask {
        _ if !ray.sees_visuals => (visibility::COLLISION, Faces::Both),
        mask => (visuals_of(mask), Faces::Front),
    }
}

/// Returns the visibility mask of a sensor that sees the visuals whose flags have a bit of `mask`.
pub(super) fn visuals_of(mask: u32) -> u32 {
    // A visual without any flag is seen by all sensors that have no mask.
    if mask == u32::MAX { visibility::VISUAL } else { flag_bits(mask) }
}
