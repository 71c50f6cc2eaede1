//! Link arguments of the shared library.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=BELVEDERE_SONAME");
    // Keeps symbols that the dependencies export unmangled (iceoryx2's `__internal_default_logger`) out of the
    // library's symbols, where they would clash with those of another library with iceoryx2 in the same process.
    println!("cargo::rustc-cdylib-link-arg=-Wl,--exclude-libs,ALL");
    // bridge/CMakeLists.txt installs the library under a versioned soname. Cargo's own file has none, so that a program
    // can link it in the build directory.
    if let Ok(name) = std::env::var("BELVEDERE_SONAME") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,{name}");
    }
}
