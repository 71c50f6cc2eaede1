//! Selects the shapes that the rays of a lidar or a rangefinder see.

use crate::description::model::RaySensor;
use crate::world::scene::flag_bits;
use belvedere_sensors::scene::visibility;
use belvedere_sensors::trace::Faces;

/// Returns the visibility mask of the rays, and which sides of surfaces they see.
pub(super) fn sight(ray: &RaySensor) -> (u32, Faces) {
    // Gazebo's GPU lidars render visuals, without back faces; its CPU lidars cast rays at collision shapes.
    match ray.visibility_mask {
        _ if !ray.sees_visuals => (visibility::COLLISION, Faces::Both),
        u32::MAX => (visibility::VISUAL, Faces::Front),
        mask => (flag_bits(mask), Faces::Front),
    }
}
