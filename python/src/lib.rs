//! The extension module `belvedere._native`: a thin layer of PyO3 over the facade. Arrays come and go as bytes, options and reports as JSON; what
//! users call is Python, `../belvedere`.

mod arrays;
mod builtin;
mod errors;
mod film;
mod generalise;
mod numbers;
mod pack;
mod picture;
mod presets;
mod request;
mod reveal;
mod scene;
mod solve;
mod work;

use pyo3::prelude::*;

/// Functions and classes that the Python layer calls.
#[pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use super::arrays::NativeArrays;
    #[pymodule_export]
    use super::builtin::{builtin_names, builtin_scene};
    #[pymodule_export]
    use super::film::animate;
    #[pymodule_export]
    use super::generalise::generalise;
    #[pymodule_export]
    use super::numbers::{displace, ground, pick, project, rays};
    #[pymodule_export]
    use super::pack::pack;
    #[pymodule_export]
    use super::picture::NativePicture;
    #[pymodule_export]
    use super::presets::{preset_check, preset_list, preset_plot, preset_set, preset_text};
    #[pymodule_export]
    use super::reveal::{NativeReveal, drafts, request_schema, reveal};
    #[pymodule_export]
    use super::scene::{NativeScene, schema, sheet};
    #[pymodule_export]
    use super::solve::{NativeGround, disocclude};
    #[pymodule_export]
    use super::{command_line, panics, set_memory_limit, version};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn start(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        // A panic becomes an exception, which says what there is to say.
        std::panic::set_hook(Box::new(|_| {}));
        Ok(())
    }
}

/// Version of the engine.
#[pyfunction]
fn version() -> &'static str {
    belvedere::VERSION
}

/// Budget of memory of this process, bytes; 0 = that of the machine.
#[pyfunction]
fn set_memory_limit(bytes: u64) {
    belvedere::io::budget::set(bytes);
}

/// Runs the program `belvedere`; the first word is its own name. It may end the process.
#[pyfunction]
fn command_line(py: Python<'_>, words: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| belvedere_cli::command_line(words))
}

/// Panics inside the engine, for the test that a panic becomes an exception.
#[pyfunction]
fn panics(py: Python<'_>) -> PyResult<()> {
    work::run(py, &work::Ask::default(), |_| panic!("asked for"))
}
