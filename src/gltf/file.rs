//! [`File`]: a binary glTF file that is being built: lists of JSON objects, and the bytes that they refer to.

use serde_json::{Map, Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// A binary glTF file that is being built.
#[derive(Debug, Default)]
pub(super) struct File {
    lists: Map<String, Value>,
    data: Vec<u8>,
}

impl File {
    /// Adds an object to one of the lists and returns its index.
    pub(super) fn add(&mut self, list: &str, object: Value) -> usize {
        let list = self.lists.entry(list).or_insert_with(|| Value::Array(Vec::new()));
        // Always an array: it was made just now, or by an earlier call.
        let Value::Array(list) = list else { return 0 };
        list.push(object);
        list.len() - 1
    }

    /// Returns true if a list has entries.
    pub(super) fn has(&self, list: &str) -> bool {
        self.lists.contains_key(list)
    }

    /// Declares the use of an extension.
    pub(super) fn uses(&mut self, extension: &str) {
        let used = self.lists.get("extensionsUsed").and_then(Value::as_array);
        if used.is_none_or(|used| used.iter().all(|known| known != extension)) {
            self.add("extensionsUsed", extension.into());
        }
    }

    /// Adds bytes and returns the index of their buffer view.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let offset = self.data.len();
        self.data.extend_from_slice(bytes);
        self.add("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    fn numbers(&mut self, bytes: &[u8], count: usize, component: u32, kind: &str) -> Value {
        let view = self.bytes(bytes);
        json!({ "bufferView": view, "componentType": component, "count": count, "type": kind })
    }

    /// Adds points, with their bounding box, which glTF requires.
    pub(super) fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let mut accessor = self.numbers(bytemuck::cast_slice(points), points.len(), FLOAT, "VEC3");
        let extreme = |pick: fn(f32, f32) -> f32| {
            points.iter().copied().reduce(|a, b| std::array::from_fn(|axis| pick(a[axis], b[axis])))
        };
        accessor["min"] = json!(extreme(f32::min).unwrap_or_default());
        accessor["max"] = json!(extreme(f32::max).unwrap_or_default());
        self.add("accessors", accessor)
    }

    pub(super) fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let accessor = self.numbers(bytemuck::cast_slice(vectors), vectors.len(), FLOAT, "VEC3");
        self.add("accessors", accessor)
    }

    pub(super) fn pairs(&mut self, pairs: &[[f32; 2]]) -> usize {
        let accessor = self.numbers(bytemuck::cast_slice(pairs), pairs.len(), FLOAT, "VEC2");
        self.add("accessors", accessor)
    }

    pub(super) fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let accessor =
            self.numbers(bytemuck::cast_slice(triangles), 3 * triangles.len(), UNSIGNED_INT, "SCALAR");
        self.add("accessors", accessor)
    }

    /// Returns the complete file.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let generator = format!("belvedere {}", env!("CARGO_PKG_VERSION"));
        self.lists.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
        self.lists.insert("scene".into(), 0.into());
        if !self.data.is_empty() {
            self.lists.insert("buffers".into(), json!([{ "byteLength": self.data.len() }]));
        }
        let mut json = Value::Object(self.lists).to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunks: &[(&[u8; 4], &[u8])] = &[(b"JSON", &json), (b"BIN\0", &self.data)];
        let chunks = &chunks[..if self.data.is_empty() { 1 } else { 2 }];
        let len = 12 + chunks.iter().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
        let mut out = Vec::with_capacity(len);
        out.extend_from_slice(b"glTF");
        out.extend_from_slice(&2_u32.to_le_bytes());
        out.extend_from_slice(&(len as u32).to_le_bytes());
        for (name, bytes) in chunks {
            out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
            out.extend_from_slice(*name);
            out.extend_from_slice(bytes);
        }
        out
    }
}
