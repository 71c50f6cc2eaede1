//! The inverse of an increasing function.

/// The x in [0, `upper`] at which an increasing function has the value `target`; 0 or `upper` if `target` is outside
/// its range there. `function` returns the value and the derivative.
///
/// This is Newton's method inside a bracket that shrinks with each evaluation, with a bisection wherever a step would
/// leave the bracket or the last step did not halve the error. It therefore converges for any increasing function,
/// where Newton's method alone or a fixed-point iteration might cycle.
pub(super) fn solve(function: impl Fn(f64) -> (f64, f64), target: f64, upper: f64, start: f64) -> f64 {
    if function(upper).0 <= target {
        return upper;
    }
    let (mut low, mut high) = (0.0, upper);
    let mut x = start.clamp(low, high);
    let (mut best, mut best_error) = (x, f64::INFINITY);
    for _ in 0..120 {
        let (value, derivative) = function(x);
        let error = value - target;
        if error < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let halved = error.abs() <= 0.5 * best_error;
        if error.abs() < best_error {
            (best, best_error) = (x, error.abs());
        }
        let newton = x - error / derivative;
        if error == 0.0 || (newton - x).abs() <= f64::EPSILON * x {
            break;
        }
        let middle = low + (high - low) * 0.5;
        let next = if halved && newton > low && newton < high { newton } else { middle };
        if next == x || !(next >= low && next <= high) {
            break;
        }
        x = next;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::solve;

    #[test]
    fn inverts_functions_of_every_shape() {
        // Flat at 1: Newton's method alone leaves [0, 2] from most starting points.
        let inflected = |x: f64| ((x - 1.0).powi(3) + 1.0, 3.0 * (x - 1.0).powi(2));
        for step in 0..=2000 {
            let x = f64::from(step) * 1e-3;
            for start in [0.0, 0.3, 1.0, 2.0] {
                let found = solve(inflected, inflected(x).0, 2.0, start);
                assert!((inflected(found).0 - inflected(x).0).abs() < 1e-15, "{x} {start}: {found}");
            }
        }
        assert_eq!(solve(|x| (x, 1.0), 5.0, 2.0, 1.0), 2.0);
        assert!(solve(|x| (x, 1.0), -5.0, 2.0, 1.0) < 1e-15);
    }
}
