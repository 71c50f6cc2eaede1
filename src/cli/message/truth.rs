//! Ground truth about the objects in an image.

use super::parts::{array, pose, text, xyz};
use super::tree::Tree::{self, List, Map, Whole};
use belvedere_bridge::payload::{BoundingBox, TagDetection};

pub(super) fn bounding_box(found: &BoundingBox) -> Tree {
    let whole = |values: &[u32]| List(values.iter().map(|&value| Whole(value.into())).collect(), 0);
    Map(vec![
        ("instance", Whole(found.instance.into())),
        ("label", Whole(found.label.into())),
        ("pixels", Whole(found.pixels.into())),
        ("min", whole(&found.min)),
        ("max", whole(&found.max)),
        ("pose", pose(found.position, found.orientation)),
        ("size", xyz(found.size)),
    ])
}

pub(super) fn tag_detection(tag: &TagDetection) -> Tree {
    Map(vec![
        ("family", text(tag.family.as_str())),
        ("id", Whole(tag.id.into())),
        ("size", Tree::Number(tag.size)),
        ("corners", List(tag.corners.iter().map(|corner| array(corner)).collect(), 0)),
        ("visible", List(tag.visible.iter().map(|&flag| Whole(flag.into())).collect(), 0)),
        ("pose", pose(tag.position, tag.orientation)),
    ])
}
