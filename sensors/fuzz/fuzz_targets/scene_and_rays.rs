//! Arbitrary bytes as scene and rays: `cargo +nightly fuzz run scene_and_rays` in `sensors/`.
#![no_main]

#[path = "../../tests/trace/fuzz_entry.rs"]
mod entry;

libfuzzer_sys::fuzz_target!(|data: &[u8]| entry::sense(data));
