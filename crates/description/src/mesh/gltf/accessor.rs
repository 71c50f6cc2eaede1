//! Numbers of a glTF: accessors over views of buffers.

use super::container::{Container, unsupported};
use serde_json::Value;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// The greatest number of zeros that an accessor without bytes may represent, so that a short file cannot use all
/// memory.
const MOST_ZEROS: usize = 1 << 25;

/// The type of a number, by OpenGL's code.
#[derive(Clone, Copy)]
struct Component(u64);

impl Component {
    fn size(self) -> Result<usize, String> {
        match self.0 {
            5120 | 5121 => Ok(1),
            5122 | 5123 => Ok(2),
            5125 | 5126 => Ok(4),
            code => Err(format!("{code} is not a componentType")),
        }
    }

    /// Reads a number from its bytes. If it is `normalized`, the result is a fraction of the largest value.
    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        let mut all = [0; 4];
        all[..bytes.len()].copy_from_slice(bytes);
        let [a, b, ..] = all;
        let (value, largest) = match self.0 {
            5120 => (f64::from(a.cast_signed()), 127.0),
            5121 => (f64::from(a), 255.0),
            5122 => (f64::from(i16::from_le_bytes([a, b])), 32767.0),
            5123 => (f64::from(u16::from_le_bytes([a, b])), 65535.0),
            5125 => (f64::from(u32::from_le_bytes(all)), 1.0),
            _ => (f64::from(f32::from_le_bytes(all)), 1.0),
        };
        if normalized { (value / largest).max(-1.0) } else { value }
    }
}

/// The numbers of a file. Buffers are read once.
pub(super) struct Accessors<'a> {
    container: &'a Container<'a>,
    buffers: RefCell<HashMap<u64, Rc<Cow<'a, [u8]>>>>,
}

/// A range of bytes that contains rows of numbers.
struct Rows {
    /// The number of bytes from one row to the next; without it, rows are contiguous.
    stride: Option<usize>,
    buffer: u64,
    begin: usize,
    end: usize,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(container: &'a Container<'a>) -> Self {
        Self { container, buffers: RefCell::default() }
    }

    /// Returns the numbers of an accessor, N for each entry.
    ///
    /// # Errors
    /// A message about what is wrong with the accessor.
    pub(super) fn read<const N: usize>(&self, index: &Value) -> Result<Vec<[f64; N]>, String> {
        let accessor = self.container.entry("accessors", index)?;
        let wrong = |what: String| format!("accessor {index}: {what}");
        let kind = accessor["type"].as_str().unwrap_or_default();
        let numbers = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => 0,
        };
        if numbers != N {
            return Err(wrong(format!("its type is '{kind}', but {N} numbers are needed")));
        }
        let count = number(&accessor["count"]).map_err(wrong)?;
        let component = Component(accessor["componentType"].as_u64().unwrap_or_default());
        let normalized = accessor["normalized"].as_bool().unwrap_or(false);
        let mut entries = match &accessor["bufferView"] {
            Value::Null if count.saturating_mul(N) > MOST_ZEROS => {
                return Err(wrong(format!("it has {count} entries and no bytes")));
            }
            Value::Null => vec![[0.0; N]; count],
            view => self.rows(view, &accessor["byteOffset"], component, normalized, count).map_err(wrong)?,
        };
        let sparse = &accessor["sparse"];
        if !sparse.is_null() {
            self.replace(sparse, component, normalized, &mut entries).map_err(wrong)?;
        }
        Ok(entries)
    }

    /// Returns the numbers of an accessor with an entry for each of `count` vertices. If it has another number of entries,
    /// the result is empty and nothing is read: many primitives may name the same accessor, which may be long.
    ///
    /// # Errors
    /// A message about what is wrong with the accessor.
    pub(super) fn of_vertices<const N: usize>(
        &self,
        index: &Value,
        count: usize,
    ) -> Result<Vec<[f64; N]>, String> {
        let accessor = self.container.entry("accessors", index)?;
        if number(&accessor["count"]) == Ok(count) { self.read(index) } else { Ok(Vec::new()) }
    }

    /// Replaces the entries that a sparse accessor names.
    fn replace<const N: usize>(
        &self,
        sparse: &Value,
        component: Component,
        normalized: bool,
        entries: &mut [[f64; N]],
    ) -> Result<(), String> {
        let count = number(&sparse["count"])?;
        let (indices, values) = (&sparse["indices"], &sparse["values"]);
        let kind = Component(indices["componentType"].as_u64().unwrap_or_default());
        let indices: Vec<[f64; 1]> =
            self.rows(&indices["bufferView"], &indices["byteOffset"], kind, false, count)?;
        let values = self.rows(&values["bufferView"], &values["byteOffset"], component, normalized, count)?;
        for ([index], value) in indices.into_iter().zip(values) {
            let length = entries.len();
            let place = entries.get_mut(index as usize);
            *place.ok_or_else(|| format!("a sparse entry replaces {index}, but there are {length}"))? = value;
        }
        Ok(())
    }

    fn rows<const N: usize>(
        &self,
        view: &Value,
        offset: &Value,
        component: Component,
        normalized: bool,
        count: usize,
    ) -> Result<Vec<[f64; N]>, String> {
        let Rows { stride, buffer, begin, end } = self.view(view)?;
        let size = component.size()?;
        let stride = stride.unwrap_or(size * N);
        let begin = begin.saturating_add(number_or_0(offset)?);
        let needed = if count == 0 { 0 } else { (count - 1).saturating_mul(stride).saturating_add(size * N) };
        let bytes = self.buffer(buffer)?;
        let there = bytes.get(begin..end.max(begin)).unwrap_or_default();
        if needed > there.len() {
            return Err(format!("it needs {needed} bytes, and its view has {}", there.len()));
        }
        let row = |row: usize| {
            std::array::from_fn(|at| {
                let first = row * stride + at * size;
                component.read(&there[first..first + size], normalized)
            })
        };
        Ok((0..count).map(row).collect())
    }

    /// Returns the bytes of a view.
    ///
    /// # Errors
    /// A message about what is wrong with the view.
    pub(super) fn view_bytes(&self, view: &Value) -> Result<Vec<u8>, String> {
        let Rows { buffer, begin, end, .. } = self.view(view)?;
        let bytes = self.buffer(buffer)?;
        bytes.get(begin..end).map(<[u8]>::to_vec).ok_or_else(|| format!("view {view} is beyond its buffer"))
    }

    fn view(&self, index: &Value) -> Result<Rows, String> {
        let view = self.container.entry("bufferViews", index)?;
        let begin = number_or_0(&view["byteOffset"])?;
        let stride = match number_or_0(&view["byteStride"])? {
            0 => None,
            stride => Some(stride),
        };
        let buffer = view["buffer"].as_u64().ok_or("a view has no buffer")?;
        let end = begin.saturating_add(number(&view["byteLength"])?);
        // A buffer without bytes is a placeholder for the output of an extension.
        if let Some(extension) =
            view["extensions"].as_object().and_then(|extensions| extensions.keys().next())
            && self.buffer(buffer).is_err()
        {
            return Err(unsupported(extension));
        }
        Ok(Rows { stride, buffer, begin, end })
    }

    fn buffer(&self, index: u64) -> Result<Rc<Cow<'a, [u8]>>, String> {
        if let Some(known) = self.buffers.borrow().get(&index) {
            return Ok(known.clone());
        }
        let bytes = Rc::new(self.container.buffer(&index.into())?);
        self.buffers.borrow_mut().insert(index, bytes.clone());
        Ok(bytes)
    }
}

fn number(value: &Value) -> Result<usize, String> {
    let number = value.as_u64().and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| format!("{value} is not a whole number of 0 or more"))
}

fn number_or_0(value: &Value) -> Result<usize, String> {
    if value.is_null() { Ok(0) } else { number(value) }
}
