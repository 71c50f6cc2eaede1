//! The values of a message as a tree, named and nested as ROS does.

use super::tree::Tree::{self, Flag, List, Map, Number, Text, Whole};
use belvedere_bridge::{Fields, Value};

/// Collects the values of a message in order.
pub(super) struct Entries {
    pub(super) all: Vec<(&'static str, Tree)>,
    limit: usize,
}

impl Entries {
    /// Creates it without values. Lists of messages are shortened to `limit`.
    pub(super) fn new(limit: usize) -> Self {
        Self { all: Vec::new(), limit }
    }
}

impl Fields for Entries {
    fn ros(&self) -> Option<&'static str> {
        None
    }

    /// Adds only `frame_id`, because the rest of the frame's header is printed before every message.
    fn header(&mut self, frame_id: Option<&str>) {
        if let Some(frame_id) = frame_id {
            self.value("frame_id", Value::Frame(frame_id));
        }
    }

    fn value(&mut self, name: &'static str, value: Value<'_>) {
        let value = match value {
            Value::Bool(value) => Flag(value),
            Value::U8(value) => Whole(value.into()),
            Value::I8(value) => Number(value.into()),
            Value::U16(value) => Whole(value.into()),
            Value::U32(value) => Whole(value.into()),
            Value::U64(value) => Whole(value),
            Value::F32(value) => Number(value.into()),
            Value::F64(value) => Number(value),
            Value::Time(time_ns) => seconds(time_ns),
            Value::Word(_, text) | Value::Text(text) | Value::Frame(text) => Text(text.to_owned()),
            Value::U8s(values) => list(values, |value| Whole(value.into())),
            Value::U16s(values) => list(values, |value| Whole(value.into())),
            Value::U32s(values) => list(values, |value| Whole(value.into())),
            Value::F32s(values) => list(values, |value| Number(value.into())),
            Value::Array(values) | Value::F64s(values) => list(values, Number),
            Value::Pixels(pixels) => list(pixels, |pixel| list(&pixel, Number)),
            Value::Texts(texts) => list(texts, |text| Text(text.to_owned())),
        };
        self.all.push((name, value));
    }

    fn part(&mut self, name: &'static str, _: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) {
        let mut part = Self::new(self.limit);
        describe(&mut part);
        self.all.push((name, Map(part.all)));
    }

    fn list(
        &mut self,
        name: &'static str,
        _: &'static str,
        count: usize,
        describe: &mut dyn FnMut(usize, &mut dyn Fields),
    ) {
        let shown = (0..count.min(self.limit)).map(|index| {
            let mut part = Self::new(self.limit);
            describe(index, &mut part);
            Map(part.all)
        });
        self.all.push((name, List(shown.collect(), count.saturating_sub(self.limit))));
    }
}

fn list<T: Copy>(values: &[T], tree: impl Fn(T) -> Tree) -> Tree {
    List(values.iter().map(|&value| tree(value)).collect(), 0)
}

/// Splits a timestamp into seconds and nanoseconds, as ROS does.
pub(super) fn seconds(ns: u64) -> Tree {
    Map(vec![("secs", Whole(ns / 1_000_000_000)), ("nsecs", Whole(ns % 1_000_000_000))])
}
