//! The way of what turns, in steps that are short enough.

use belvedere_sensors::Pose;

/// The cosine of half of 0.05 rad: [`Pose::interpolate`] is even motion where turns are smaller than that.
const LEAST_COSINE: f64 = 0.999_687_516_275_7;

/// Places at even times from the first to the last, between which nothing turns by 0.05 rad: all turn evenly, by the
/// shorter way, and go straight. Each is as many poses as the two have.
pub(crate) fn steps(first: Vec<Pose>, last: Vec<Pose>) -> Vec<Vec<Pose>> {
    let mut steps = vec![first, last];
    // What turns evenly turns as far in each step, and is halfway at a place that is known without sines.
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
