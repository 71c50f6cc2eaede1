//! Loaning without initialisation: the only place that treats memory as initialised without Rust code having written
//! it.
#![allow(unsafe_code)]

use iceoryx2::{
    port::{LoanError, publisher::Publisher},
    sample_mut::SampleMut,
};

use crate::{FrameHeader, domain::Ipc};

/// Loans `len` bytes of shared memory without filling them: they hold zeros or the data of an earlier frame.
///
/// Filling would add a pass over the memory (17 µs for 640 × 480 RGB) before the pass that writes it.
pub(crate) fn loan_bytes(
    port: &Publisher<Ipc, [u8], FrameHeader>,
    len: usize,
) -> Result<SampleMut<Ipc, [u8], FrameHeader>, LoanError> {
    let sample = port.loan_slice_uninit(len)?;
    // SAFETY: `assume_init` asks that all `len` bytes be initialised.
    // 1. They lie in a file of `/dev/shm` that iceoryx2 has created, sized with `ftruncate` and mapped shared. The
    //    kernel gives such pages out filled with zeros; memory from a mapping is never uninitialised as fresh
    //    stack or heap memory is.
    // 2. A recycled chunk holds what an earlier `LoanedFrame` of this publisher wrote through `&mut [u8]`. Nothing
    //    of another type is written to a payload: iceoryx2's own headers lie before it, its allocator keeps its
    //    lists outside of the chunks, and subscribers map the file read-only.
    // 3. `u8` has no invalid values and no padding.
    Ok(unsafe { sample.assume_init() })
}
