//! Bounding boxes of the visible parts of instances, from a picture of instance indices.

/// The bounding box of the visible pixels of one instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeenBox {
    /// The first column and row.
    pub min: [u32; 2],
    /// The last column and row, inclusive; less than the first if nothing is visible.
    pub max: [u32; 2],
    /// The number of visible pixels.
    pub pixels: u32,
}

impl SeenBox {
    /// The box of an instance that is not visible.
    pub const EMPTY: Self = Self { min: [u32::MAX; 2], max: [0; 2], pixels: 0 };

    /// Returns true if no pixel is visible.
    pub const fn is_empty(&self) -> bool {
        self.pixels == 0
    }
}

/// Computes the bounding box of the visible part of each instance of a scene, and writes it into `boxes` by the index
/// of the instance.
///
/// `instance` is [`Truth::instance`](crate::trace::Truth::instance), in rows of `width` pixels. Instances for which
/// `boxes` has no element are ignored.
///
/// Together with [`Scene::bounds`](crate::scene::Scene::bounds), the box of the whole object in its own frame, this is
/// the data that detectors are trained with: how much of an object is visible, and where all of it is.
///
/// ```
/// use belvedere_sensors::trace::{SeenBox, seen_boxes};
/// let nothing = u32::MAX;
/// let picture = [nothing, 1, 1, nothing, 1, 0];
/// let mut boxes = [SeenBox::EMPTY; 3];
/// seen_boxes(&picture, 3, &mut boxes);
/// assert_eq!(boxes[1], SeenBox { min: [1, 0], max: [2, 1], pixels: 3 });
/// assert_eq!(boxes[0], SeenBox { min: [2, 1], max: [2, 1], pixels: 1 });
/// assert!(boxes[2].is_empty());
/// ```
pub fn seen_boxes(instance: &[u32], width: usize, boxes: &mut [SeenBox]) {
    boxes.fill(SeenBox::EMPTY);
    for (row, line) in instance.chunks(width.max(1)).enumerate() {
        // Neighbours mostly show the same: a run of them is one look at its box.
        let mut start = 0;
        while start < line.len() {
            let run = line[start..].iter().take_while(|&&other| other == line[start]).count();
            if let Some(seen) = boxes.get_mut(line[start] as usize) {
                let (first, last, row) = (start as u32, (start + run - 1) as u32, row as u32);
                seen.min = [seen.min[0].min(first), seen.min[1].min(row)];
                seen.max = [seen.max[0].max(last), seen.max[1].max(row)];
                seen.pixels += run as u32;
            }
            start += run;
        }
    }
}
