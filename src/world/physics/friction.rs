//! Makes the friction of slipping contacts act against the slip, as Coulomb's law requires.
//!
//! rapier solves the friction of a point by two tangents. It computes the impulse that would stop the point, −K⁻¹·v, where K
//! says how the point yields to an impulse, and shortens it to μ times the normal impulse. A point beside the centre of mass
//! yields more in some directions than in others, because a push turns the body too. So the shortened impulse is at an angle
//! to the slip v, and only its cosine brakes: 0.936 at the corners of a cube, 0.857 at those of a thin plate.
//!
//! Here each point that slips is given the velocity (K/κ − 1)·v in its surface, with κ the mean of the two yields. rapier then
//! computes the impulse −K⁻¹·(K/κ)·v = −v/κ, which is against the slip. A point that sticks is hardly affected: what is
//! left of its slip after a step is (K/κ − 1) of the slip before, which is always shorter.

use glam::DVec3;
use rapier3d_f64::dynamics::RigidBody;
use rapier3d_f64::geometry::SolverContact;

/// The velocity between two touching points per unit of impulse between them, in a plane with two axes.
#[derive(Default)]
struct Yield {
    /// Along each axis, for an impulse along the same axis.
    along: [f64; 2],
    /// Along one axis, for an impulse along the other.
    across: f64,
}

impl Yield {
    /// Adds the share of a body at a point of the world. Bodies that forces do not move have none.
    fn add(&mut self, body: &RigidBody, point: DVec3, axes: [DVec3; 2]) {
        if !body.is_dynamic() {
            return;
        }
        let properties = body.mass_properties();
        let arm = point - body.center_of_mass();
        let torques = axes.map(|axis| arm.cross(axis));
        let turns = torques.map(|torque| properties.effective_world_inv_inertia * torque);
        for side in 0..2 {
            let inverse_mass = properties.effective_inv_mass.dot(axes[side] * axes[side]);
            self.along[side] += inverse_mass + turns[side].dot(torques[side]);
        }
        self.across += turns[0].dot(torques[1]);
    }
}

/// Turns the friction of contacts with this normal against their slip. A side without a body never moves.
pub(super) fn turn_against_slip(
    bodies: [Option<&RigidBody>; 2],
    normal: DVec3,
    contacts: &mut [SolverContact],
) {
    for contact in contacts {
        let points = [contact.anchor1, contact.anchor2];
        let velocity =
            |side: usize| bodies[side].map_or(DVec3::ZERO, |body| body.velocity_at_point(points[side]));
        let slip = (velocity(0) - velocity(1)).reject_from_normalized(normal);
        let Some(along) = slip.try_normalize() else { continue };
        let axes = [along, normal.cross(along)];
        let mut yields = Yield::default();
        for (body, point) in bodies.into_iter().zip(points) {
            if let Some(body) = body {
                yields.add(body, point, axes);
            }
        }
        let mean = 0.5 * (yields.along[0] + yields.along[1]);
        if mean > 0.0 {
            let own = axes[0] * (yields.along[0] - mean) + axes[1] * yields.across;
            contact.tangent_velocity = own * (slip.length() / mean);
        }
    }
}
