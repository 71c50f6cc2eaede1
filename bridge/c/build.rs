//! Keeps what the crates below export unmangled (iceoryx2's `__internal_default_logger`) out of the shared library's
//! symbols, where it would meet that of another library with iceoryx2 in the same process.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-cdylib-link-arg=-Wl,--exclude-libs,ALL");
}
