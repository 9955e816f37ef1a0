//! Tells the linker that the interpreter is there when the package is loaded, which macOS has to be told.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
