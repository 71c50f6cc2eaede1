//! Interpolation of rotating motion in sufficiently small steps.

use belvedere_sensors::Pose;

/// The cosine of half of 0.05 rad: for smaller rotations [`Pose::interpolate`] is uniform motion.
const LEAST_COSINE: f64 = 0.999_687_516_275_7;

/// Returns poses at equally spaced times from the first to the last, such that nothing turns by 0.05 rad or more
/// between two of them. Rotations are uniform and take the shorter way; translations are straight. Each element has as
/// many poses as `first` and `last`.
pub(crate) fn steps(first: Vec<Pose>, last: Vec<Pose>) -> Vec<Vec<Pose>> {
    let mut steps = vec![first, last];
    // A uniform rotation turns by the same angle in each step, and its midpoint needs no sines.
    while turns_far(&steps[0], &steps[1]) {
        let mut finer = Vec::with_capacity(2 * steps.len() - 1);
        for pair in steps.windows(2) {
            let halfway = pair[0].iter().zip(&pair[1]).map(|(from, to)| from.interpolate(to, 0.5)).collect();
            finer.extend([pair[0].clone(), halfway]);
        }
        finer.extend(steps.pop());
        steps = finer;
    }
    steps
}

fn turns_far(from: &[Pose], to: &[Pose]) -> bool {
    from.iter().zip(to).any(|(from, to)| from.rotation().dot(to.rotation()).abs() < LEAST_COSINE)
}
