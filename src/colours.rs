//! The colour map for distances: Google's Turbo, in which near is red and far is blue, as on the page and in the Python
//! package.

/// Start of the map: below it, far distances would be nearly as black as missing values.
const FARTHEST: f64 = 0.08;

/// Returns the colour of a nearness from 0 (far) to 1 (near).
pub(crate) fn of_nearness(nearness: f64) -> [u8; 3] {
    let colour = colorous::TURBO.eval_continuous(FARTHEST + (1.0 - FARTHEST) * nearness.clamp(0.0, 1.0));
    [colour.r, colour.g, colour.b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_red_and_far_is_blue() {
        let [red, green, blue] = of_nearness(0.9);
        assert!(red > 150 && green < 60 && blue < 50);
        let [red, _, blue] = of_nearness(0.0);
        assert!(blue > 130 && red < 80);
    }
}
