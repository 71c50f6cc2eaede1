//! Parts that many messages share, named and nested as in ROS.

use super::tree::Tree::{self, List, Map, Number, Text, Whole};

/// The fields of a message in order.
pub(super) type Entries = Vec<(&'static str, Tree)>;

pub(super) fn text(text: &str) -> Tree {
    Text(text.to_owned())
}

pub(super) fn array(values: &[f64]) -> Tree {
    List(values.iter().map(|&value| Number(value)).collect(), 0)
}

pub(super) fn xyz([x, y, z]: [f64; 3]) -> Tree {
    Map(vec![("x", Number(x)), ("y", Number(y)), ("z", Number(z))])
}

pub(super) fn xyzw([x, y, z, w]: [f64; 4]) -> Tree {
    Map(vec![("x", Number(x)), ("y", Number(y)), ("z", Number(z)), ("w", Number(w))])
}

pub(super) fn pose(position: [f64; 3], orientation: [f64; 4]) -> Tree {
    Map(vec![("position", xyz(position)), ("orientation", xyzw(orientation))])
}

pub(super) fn twist(linear: [f64; 3], angular: [f64; 3]) -> Tree {
    Map(vec![("linear", xyz(linear)), ("angular", xyz(angular))])
}

/// Splits a timestamp into seconds and nanoseconds, as ROS does.
pub(super) fn seconds(ns: u64) -> Tree {
    Map(vec![("secs", Whole(ns / 1_000_000_000)), ("nsecs", Whole(ns % 1_000_000_000))])
}
