//! Numbers of a glTF: accessors over views of buffers.

use super::container::{Container, unsupported};
use serde_json::Value;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// The greatest number of zeros that an accessor without bytes may represent, so that a short file cannot use all
/// memory.
const MOST_ZEROS: usize = 1 << 25;

/// The type of a number.
#[derive(Clone, Copy)]
struct Component {
    /// OpenGL's code.
    code: u64,
    /// Bytes.
    size: usize,
}

impl Component {
    fn new(code: &Value) -> Result<Self, String> {
        let code = code.as_u64().unwrap_or_default();
        let size = match code {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            code => return Err(format!("{code} is not a componentType")),
        };
        Ok(Self { code, size })
    }

    /// Reads a number from its bytes. If it is `normalized`, the result is a fraction of the largest value.
    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        let mut all = [0; 4];
        all[..bytes.len()].copy_from_slice(bytes);
        let [a, b, ..] = all;
        let (value, largest) = match self.code {
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

/// The bytes of a buffer.
type Buffer<'a> = Rc<Cow<'a, [u8]>>;

/// The numbers of a file. Buffers are read once, and so are the entries that sparse accessors replace.
pub(super) struct Accessors<'a> {
    container: &'a Container<'a>,
    buffers: RefCell<HashMap<u64, Buffer<'a>>>,
    replaced: RefCell<HashMap<u64, Rc<Replaced>>>,
}

/// The entries of an accessor, with N numbers each. An entry is read when it is asked for: many primitives may each use
/// a few entries of one long accessor.
pub(super) struct Table<'a, const N: usize> {
    count: usize,
    /// The bytes of its entries; without them, all numbers are 0.
    rows: Option<Rows<'a>>,
    replaced: Rc<Replaced>,
}

/// Numbers of a buffer, in rows.
struct Rows<'a> {
    buffer: Buffer<'a>,
    range: Range<usize>,
    stride: usize,
    component: Component,
    normalized: bool,
}

/// The entries that a sparse accessor replaces.
#[derive(Default)]
struct Replaced {
    /// The number of the replacement of each entry that has one.
    places: HashMap<usize, usize>,
    /// The numbers of all replacements.
    numbers: Vec<f64>,
}

impl<const N: usize> Table<'_, N> {
    /// Returns the number of entries.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Returns an entry, which must exist.
    pub(super) fn get(&self, entry: usize) -> [f64; N] {
        match self.replaced.places.get(&entry) {
            Some(place) => std::array::from_fn(|at| self.replaced.numbers[place * N + at]),
            None => self.rows.as_ref().map_or([0.0; N], |rows| rows.get(entry)),
        }
    }
}

impl Rows<'_> {
    fn get<const N: usize>(&self, row: usize) -> [f64; N] {
        let size = self.component.size;
        let there = &self.buffer[self.range.clone()];
        std::array::from_fn(|at| {
            let first = row * self.stride + at * size;
            self.component.read(&there[first..first + size], self.normalized)
        })
    }
}

/// A range of bytes of a buffer.
struct View {
    /// The number of bytes from one row to the next; without it, rows are contiguous.
    stride: Option<usize>,
    buffer: u64,
    begin: usize,
    end: usize,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(container: &'a Container<'a>) -> Self {
        Self { container, buffers: RefCell::default(), replaced: RefCell::default() }
    }

    /// Returns the numbers of an accessor, N for each entry.
    ///
    /// # Errors
    /// A message about what is wrong with the accessor.
    pub(super) fn read<const N: usize>(&self, index: &Value) -> Result<Vec<[f64; N]>, String> {
        let table = self.open(index)?;
        Ok((0..table.len()).map(|entry| table.get(entry)).collect())
    }

    /// Opens an accessor with N numbers for each entry.
    ///
    /// # Errors
    /// A message about what is wrong with the accessor.
    pub(super) fn open<const N: usize>(&self, index: &Value) -> Result<Table<'a, N>, String> {
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
        let rows = match &accessor["bufferView"] {
            Value::Null if count.saturating_mul(N) > MOST_ZEROS => {
                return Err(wrong(format!("it has {count} entries and no bytes")));
            }
            Value::Null => None,
            _ => Some(self.rows(accessor, accessor, N, count).map_err(wrong)?),
        };
        let replaced = self.replaced::<N>(index, accessor, count).map_err(wrong)?;
        Ok(Table { count, rows, replaced })
    }

    /// Opens an accessor with an entry for each of `count` vertices; `None` if it has another number of entries.
    ///
    /// # Errors
    /// A message about what is wrong with the accessor.
    pub(super) fn of_vertices<const N: usize>(
        &self,
        index: &Value,
        count: usize,
    ) -> Result<Option<Table<'a, N>>, String> {
        let accessor = self.container.entry("accessors", index)?;
        if number(&accessor["count"]) == Ok(count) { self.open(index).map(Some) } else { Ok(None) }
    }

    /// Returns the entries that a sparse accessor of `count` entries replaces; none if it is not sparse.
    fn replaced<const N: usize>(
        &self,
        index: &Value,
        accessor: &Value,
        count: usize,
    ) -> Result<Rc<Replaced>, String> {
        let sparse = &accessor["sparse"];
        let Some(index) = index.as_u64().filter(|_| !sparse.is_null()) else { return Ok(Rc::default()) };
        if let Some(known) = self.replaced.borrow().get(&index) {
            return Ok(known.clone());
        }
        let more = number(&sparse["count"])?;
        let indices = self.rows(&sparse["indices"], &sparse["indices"], 1, more)?;
        let values = self.rows(&sparse["values"], accessor, N, more)?;
        let mut replaced = Replaced::default();
        for row in 0..more {
            let [entry] = indices.get(row);
            if entry as usize >= count {
                return Err(format!("a sparse entry replaces {entry}, but there are {count}"));
            }
            replaced.places.insert(entry as usize, row);
            replaced.numbers.extend(values.get::<N>(row));
        }
        let replaced = Rc::new(replaced);
        self.replaced.borrow_mut().insert(index, replaced.clone());
        Ok(replaced)
    }

    /// Opens the `count` rows of `columns` numbers that `place` refers to, with the type of numbers of `accessor`.
    fn rows(
        &self,
        place: &Value,
        accessor: &Value,
        columns: usize,
        count: usize,
    ) -> Result<Rows<'a>, String> {
        let View { stride, buffer, begin, end } = self.view(&place["bufferView"])?;
        let component = Component::new(&accessor["componentType"])?;
        let normalized = accessor["normalized"].as_bool().unwrap_or(false);
        let size = component.size * columns;
        let stride = stride.unwrap_or(size);
        let begin = begin.saturating_add(number_or_0(&place["byteOffset"])?);
        let needed = if count == 0 { 0 } else { (count - 1).saturating_mul(stride).saturating_add(size) };
        let buffer = self.buffer(buffer)?;
        let range = if buffer.get(begin..end.max(begin)).is_some() { begin..end.max(begin) } else { 0..0 };
        if needed > range.len() {
            return Err(format!("it needs {needed} bytes, and its view has {}", range.len()));
        }
        Ok(Rows { buffer, range, stride, component, normalized })
    }

    /// Returns the bytes of a view.
    ///
    /// # Errors
    /// A message about what is wrong with the view.
    pub(super) fn view_bytes(&self, view: &Value) -> Result<Vec<u8>, String> {
        let View { buffer, begin, end, .. } = self.view(view)?;
        let bytes = self.buffer(buffer)?;
        bytes.get(begin..end).map(<[u8]>::to_vec).ok_or_else(|| format!("view {view} is beyond its buffer"))
    }

    fn view(&self, index: &Value) -> Result<View, String> {
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
        Ok(View { stride, buffer, begin, end })
    }

    fn buffer(&self, index: u64) -> Result<Buffer<'a>, String> {
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
