//! The C interface. Pointers come from the benchmark, which keeps the contract stated at each function.

use crate::caster::Caster;
use std::ffi::{c_char, c_int, c_void};
use std::slice;

/// A triangle mesh.
#[repr(C)]
pub(crate) struct Mesh {
    verts: *const [f32; 3],
    vertex_count: u64,
    tris: *const [u32; 3],
    triangle_count: u64,
}

/// Rays in rows; all have one origin if `common_origin` is not 0.
#[repr(C)]
pub(crate) struct Rays {
    org: *const [f32; 3],
    dir: *const [f32; 3],
    count: u64,
    width: u32,
    height: u32,
    common_origin: u32,
    pad: u32,
}

/// The memory for results.
#[repr(C)]
pub(crate) struct Hits {
    t: *mut f32,
    normal: *mut [f32; 3],
    prim: *mut u32,
}

/// Returns a slice, also for a null pointer if it is empty.
///
/// # Safety
/// `data` must be valid for reads of `length` elements, which are not written while the slice lives.
unsafe fn elements<'a, T>(data: *const T, length: u64) -> &'a [T] {
    if length == 0 || data.is_null() {
        return &[];
    }
    // SAFETY: as the caller promises; not null, and no more elements than memory can hold.
    unsafe { slice::from_raw_parts(data, length as usize) }
}

/// Like [`elements`], but mutable.
///
/// # Safety
/// `data` must be valid for reads and writes of `length` elements that nothing else touches meanwhile.
unsafe fn elements_mut<'a, T>(data: *mut T, length: u64) -> &'a mut [T] {
    if length == 0 || data.is_null() {
        return &mut [];
    }
    // SAFETY: as the caller promises; not null, and no more elements than memory can hold.
    unsafe { slice::from_raw_parts_mut(data, length as usize) }
}

/// Returns the number of casters.
// SAFETY: nothing else in the process has this name; the benchmark loads each plugin by itself.
#[unsafe(no_mangle)]
extern "C" fn rc_count() -> c_int {
    1
}

/// Returns the name of the caster.
// SAFETY: as for `rc_count`.
#[unsafe(no_mangle)]
extern "C" fn rc_name(_caster: c_int) -> *const c_char {
    c"belvedere".as_ptr()
}

/// Creates a caster for a mesh, or returns null.
///
/// # Safety
/// `mesh` points to a [`Mesh`] whose pointers are valid for its counts during the call.
// SAFETY: as for `rc_count`.
#[unsafe(no_mangle)]
unsafe extern "C" fn rc_build(_caster: c_int, mesh: *const Mesh, threads: c_int) -> *mut c_void {
    // SAFETY: the caller guarantees that `mesh` is valid.
    let Some(mesh) = (unsafe { mesh.as_ref() }) else { return std::ptr::null_mut() };
    // SAFETY: the caller guarantees that the pointers are valid for the counts.
    let positions = unsafe { elements(mesh.verts, mesh.vertex_count) };
    // SAFETY: as above.
    let triangles = unsafe { elements(mesh.tris, mesh.triangle_count) };
    Caster::new(positions, triangles, threads.max(1) as usize)
        .map_or(std::ptr::null_mut(), |caster| Box::into_raw(Box::new(caster)).cast())
}

/// Refits to moved vertices. Returns 1 on success.
///
/// # Safety
/// `handle` came from [`rc_build`] and is not in use elsewhere; `verts` is valid for as many vertices as then.
// SAFETY: as for `rc_count`.
#[unsafe(no_mangle)]
unsafe extern "C" fn rc_refit(handle: *mut c_void, verts: *const [f32; 3]) -> c_int {
    // SAFETY: the caller guarantees that `handle` is a `Caster` that is not in use elsewhere.
    let Some(caster) = (unsafe { handle.cast::<Caster>().as_mut() }) else { return 0 };
    // SAFETY: the caller guarantees that there are as many vertices as at the build.
    let positions = unsafe { elements(verts, caster.vertices as u64) };
    c_int::from(caster.refit(positions))
}

/// Casts rays.
///
/// # Safety
/// `handle` came from [`rc_build`] and is not in use elsewhere; `rays` and `hits` point to structs whose pointers are valid for `count`
/// elements, and the results overlap nothing.
// SAFETY: as for `rc_count`.
#[unsafe(no_mangle)]
unsafe extern "C" fn rc_cast(handle: *mut c_void, rays: *const Rays, hits: *mut Hits, threads: c_int) {
    // SAFETY: the caller guarantees that the three pointers are valid.
    let (caster, rays, hits) = unsafe { (handle.cast::<Caster>().as_mut(), rays.as_ref(), hits.as_ref()) };
    let (Some(caster), Some(rays), Some(hits)) = (caster, rays, hits) else { return };
    // SAFETY: the caller guarantees that they are valid for `count` elements.
    let (origins, directions) = unsafe { (elements(rays.org, rays.count), elements(rays.dir, rays.count)) };
    let origins = if rays.common_origin != 0 { &origins[..origins.len().min(1)] } else { origins };
    // SAFETY: the caller guarantees that they are valid for `count` elements and disjoint.
    let t = unsafe { elements_mut(hits.t, rays.count) };
    // SAFETY: as above.
    let normal = unsafe { elements_mut(hits.normal, rays.count) };
    // SAFETY: as above.
    let primitive = unsafe { elements_mut(hits.prim, rays.count) };
    if rays.count > 0 {
        let rows = [rays.width as usize, rays.height as usize];
        caster.cast(rows, origins, directions, t, normal, primitive, threads.max(1) as usize);
    }
}

/// Frees a caster.
///
/// # Safety
/// `handle` came from [`rc_build`] and is not used again.
// SAFETY: as for `rc_count`.
#[unsafe(no_mangle)]
unsafe extern "C" fn rc_free(handle: *mut c_void) {
    if !handle.is_null() {
        // SAFETY: the caller guarantees that it came from `Box::into_raw` in `rc_build` and is not used again.
        drop(unsafe { Box::from_raw(handle.cast::<Caster>()) });
    }
}
