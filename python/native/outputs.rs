//! The caller's arrays, as slices frame by frame.

use crate::errors::of;
use belvedere_sensors::trace::Truth;
use bytemuck::Pod;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::slice::ChunksExactMut;

/// Arrays that are borrowed exclusively for writing.
pub(crate) struct Outputs<'py>(Vec<(String, Array<'py>)>);

enum Array<'py> {
    F32(PyReadwriteArrayDyn<'py, f32>),
    F64(PyReadwriteArrayDyn<'py, f64>),
    U8(PyReadwriteArrayDyn<'py, u8>),
    U16(PyReadwriteArrayDyn<'py, u16>),
    U32(PyReadwriteArrayDyn<'py, u32>),
}

impl<'py> Outputs<'py> {
    /// Borrows all arrays of a dictionary.
    pub(crate) fn borrow(arrays: &Bound<'py, PyDict>) -> PyResult<Self> {
        let borrowed = arrays.iter().map(|(name, array)| {
            let name: String = name.extract()?;
            let argument = format!("out[{name:?}]");
            let array = borrow(&argument, &array)?;
            Ok((name, array))
        });
        borrowed.collect::<PyResult<_>>().map(Self)
    }

    /// Returns the slices for this many frames.
    pub(crate) fn lend(&mut self, frames: usize) -> PyResult<Slices<'_>> {
        let slices = self.0.iter_mut().map(|(name, array)| {
            let argument = format!("out[{name:?}]");
            let slice = match array {
                Array::F32(array) => slice(&argument, array).map(Slice::F32),
                Array::F64(array) => slice(&argument, array).map(Slice::F64),
                Array::U8(array) => slice(&argument, array).map(Slice::U8),
                Array::U16(array) => slice(&argument, array).map(Slice::U16),
                Array::U32(array) => slice(&argument, array).map(Slice::U32),
            };
            Ok((name.as_str(), slice?))
        });
        Ok(Slices { frames, slices: slices.collect::<PyResult<_>>()? })
    }
}

fn borrow<'py>(argument: &str, array: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
    fn typed<'py, T: Element>(
        argument: &str,
        array: &Bound<'py, PyAny>,
    ) -> Option<PyResult<PyReadwriteArrayDyn<'py, T>>> {
        let array = array.cast::<PyArrayDyn<T>>().ok()?;
        // It is read-only, or borrowed by another thread or as another argument of this call.
        Some(array.try_readwrite().map_err(|error| {
            of(argument, format_args!("{error}; give an array that is writeable and that nothing else uses"))
        }))
    }
    let found = typed(argument, array)
        .map(|array| array.map(Array::F32))
        .or_else(|| Some(typed(argument, array)?.map(Array::U8)))
        .or_else(|| Some(typed(argument, array)?.map(Array::U32)))
        .or_else(|| Some(typed(argument, array)?.map(Array::U16)))
        .or_else(|| Some(typed(argument, array)?.map(Array::F64)));
    found.unwrap_or_else(|| Err(of(argument, "an array of numpy of the channel's type is expected")))
}

fn slice<'a, T: Element>(argument: &str, array: &'a mut PyReadwriteArrayDyn<'_, T>) -> PyResult<&'a mut [T]> {
    array.as_slice_mut().map_err(|error| of(argument, error))
}

/// Slices by channel; each is taken once.
pub(crate) struct Slices<'a> {
    frames: usize,
    slices: Vec<(&'a str, Slice<'a>)>,
}

enum Slice<'a> {
    F32(&'a mut [f32]),
    F64(&'a mut [f64]),
    U8(&'a mut [u8]),
    U16(&'a mut [u16]),
    U32(&'a mut [u32]),
}

/// The chunks of a channel, one for each frame; `None` if the channel is not requested.
pub(crate) struct Frames<'a, T>(Option<ChunksExactMut<'a, T>>);

impl<'a, T> Frames<'a, T> {
    /// Returns the chunk of the next frame.
    pub(crate) fn next(&mut self) -> Option<&'a mut [T]> {
        self.0.as_mut()?.next()
    }

    /// Returns true if the channel is requested.
    pub(crate) fn is_wanted(&self) -> bool {
        self.0.is_some()
    }
}

macro_rules! takers {
    ($($name:ident: $kind:ident $type:ty,)*) => {$(
        /// Takes a channel of `len` elements per frame.
        pub(crate) fn $name<T: Pod>(&mut self, name: &str, len: usize) -> PyResult<Frames<'a, T>> {
            let Some(index) = self.slices.iter().position(|(of, _)| *of == name) else { return Ok(Frames(None)) };
            let (name, slice) = self.slices.swap_remove(index);
            let argument = format!("out[{name:?}]");
            let Slice::$kind(slice) = slice else {
                return Err(of(&argument, concat!("elements of the type ", stringify!($type), " are expected")));
            };
            let elements = bytemuck::try_cast_slice_mut::<$type, T>(slice).map_err(|error| of(&argument, error))?;
            if len == 0 || elements.len() != self.frames * len {
                let (have, need) = (elements.len(), self.frames * len);
                return Err(of(&argument, format_args!("{have} elements, and {need} are expected")));
            }
            Ok(Frames(Some(elements.chunks_exact_mut(len))))
        }
    )*};
}

impl<'a> Slices<'a> {
    takers! {
        f32: F32 f32,
        f64: F64 f64,
        u8: U8 u8,
        u16: U16 u16,
        u32: U32 u32,
    }

    /// Takes the channels of ground truth, with these names of distances.
    pub(crate) fn truth(&mut self, depth: &str, range: &str, rays: usize) -> PyResult<TruthFrames<'a>> {
        Ok(TruthFrames {
            depth: self.f32(depth, rays)?,
            range: self.f32(range, rays)?,
            normal: self.f32("normal", rays)?,
            instance: self.u32("instance", rays)?,
            class: self.u32("class", rays)?,
            incidence: self.f32("incidence", rays)?,
            flow: self.f32("flow", rays)?,
            flow_back: self.f32("flow_back", rays)?,
        })
    }

    /// Checks that no channel is left.
    pub(crate) fn finish(self) -> PyResult<()> {
        match self.slices.first() {
            None => Ok(()),
            Some((name, _)) => Err(of("channels", format_args!("this sensor has no channel {name:?}"))),
        }
    }
}

/// Channels of ground truth.
pub(crate) struct TruthFrames<'a> {
    depth: Frames<'a, f32>,
    range: Frames<'a, f32>,
    normal: Frames<'a, [f32; 3]>,
    instance: Frames<'a, u32>,
    class: Frames<'a, u32>,
    incidence: Frames<'a, f32>,
    flow: Frames<'a, [f32; 2]>,
    flow_back: Frames<'a, [f32; 2]>,
}

impl<'a> TruthFrames<'a> {
    /// Returns whether flow to the next and to the previous frame is requested.
    pub(crate) fn flows(&self) -> [bool; 2] {
        [self.flow.is_wanted(), self.flow_back.is_wanted()]
    }

    /// Returns the outputs for the ground truth of the next frame.
    pub(crate) fn next(&mut self) -> Truth<'a> {
        let mut truth = Truth::new();
        truth.depth = self.depth.next();
        truth.range = self.range.next();
        truth.normal = self.normal.next();
        truth.instance = self.instance.next();
        truth.class = self.class.next();
        truth.incidence = self.incidence.next();
        truth.flow = self.flow.next();
        truth.flow_back = self.flow_back.next();
        truth
    }
}
