//! A consumer that reads everything it is allowed to.

use std::{fmt::Write as _, hint::black_box};

use belvedere_bridge::{
    FrameHeader, FrameView,
    payload::{
        BoundingBox, CameraInfo, Clock, JointState, Message, ModelState, Odometry, SimulationCommand,
        SimulationResult, TagDetection, Transform, VelocityCommand,
    },
};
use bytemuck::Pod;

/// Reads header, rows, numbers and structs in every type. Returns the sum of the bytes.
pub(crate) fn read_all(view: &FrameView<'_>) -> u64 {
    read_header(view.header());
    let payload = view.payload();
    assert!(payload.len() as u64 <= view.header().payload_len);
    let mut sum = sum(payload);
    for row in view.rows().chain(view.intensity_rows()) {
        let within = payload.as_ptr_range();
        assert!(within.start <= row.as_ptr() && row.as_ptr_range().end <= within.end, "a row outside");
        sum += row.iter().map(|&byte| u64::from(byte)).sum::<u64>();
    }
    read_numbers::<u8>(view);
    read_numbers::<u16>(view);
    read_numbers::<f32>(view);
    read_numbers::<[f32; 8]>(view);
    read_structs::<CameraInfo>(view);
    read_structs::<Clock>(view);
    read_structs::<JointState>(view);
    read_structs::<Odometry>(view);
    read_structs::<Transform>(view);
    read_structs::<VelocityCommand>(view);
    read_structs::<SimulationCommand>(view);
    read_structs::<SimulationResult>(view);
    read_structs::<ModelState>(view);
    read_structs::<BoundingBox>(view);
    read_structs::<TagDetection>(view);
    black_box(sum)
}

fn sum(bytes: &[u8]) -> u64 {
    bytes.iter().map(|&byte| u64::from(byte)).sum()
}

fn read_header(header: &FrameHeader) {
    black_box((header.kind(), header.encoding(), header.intrinsics(), header.has_intensities()));
    black_box(header.scan_geometry().map(|geometry| geometry.angle_max(header.width)));
    let name = header.frame_id.as_str();
    assert!(name.len() <= 64);
    let mut text = String::new();
    write!(text, "{name:?}").expect("memory");
    black_box(text);
}

fn read_numbers<T: Pod>(view: &FrameView<'_>) {
    let count = view.numbers::<T>(view.rows()).count() + view.numbers::<T>(view.intensity_rows()).count();
    assert!(count <= 2 * view.payload().len());
    black_box(view.numbers::<T>(view.rows()).last());
}

fn read_structs<T: Message>(view: &FrameView<'_>) {
    if let Ok(structs) = view.structs::<T>() {
        assert!(structs.len() * size_of::<T>() <= view.payload().len());
        black_box(structs.last());
    }
    let _ = black_box(view.message::<T>().is_ok());
}
