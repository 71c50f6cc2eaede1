//! The flags of visuals and the masks of lidars as visibility bits of the scene.

/// The first two bits are those of [`visibility`](belvedere_sensors::scene::visibility), and the last is that of shapes
/// that are hidden, so that a visual that has all flags is not one of them.
const FIRST: u32 = 2;
/// Gazebo reserves the four highest flags; they share one bit.
const OWN: u32 = 0xF000_0000;

/// Returns the visibility bits of `<visibility_flags>` or of a `<visibility_mask>`: two have a bit in common where the
/// numbers in the file have.
pub fn flag_bits(flags: u32) -> u32 {
    let own = if flags & OWN == 0 { 0 } else { 1 << 28 };
    (flags & !OWN | own) << FIRST
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_sensors::scene::visibility;

    #[test]
    fn flags_have_bits_of_their_own() {
        let others = visibility::VISUAL | visibility::COLLISION | super::super::HIDDEN;
        for flag in 0..32 {
            let bits = flag_bits(1 << flag);
            assert!(bits != 0 && bits & others == 0, "{flag}");
            assert_eq!(bits & flag_bits(!(1 << flag)) != 0, flag >= 28, "{flag}");
        }
        assert_eq!(flag_bits(0), 0);
    }
}
