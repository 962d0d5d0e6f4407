//! The extension module `benchdog._native`: plans, simulations, sweeps and the command, for the Python package around it.
//!
//! It converts values and leaves the rest to the library: files and texts (`source.rs`), dicts (`document.rs`), errors (`errors.rs`), long work without the
//! GIL that Ctrl-C stops (`work.rs`), traces as arrays (`trace.rs`, `measures.rs`). The package has the classes that users see.

mod command;
mod document;
mod errors;
mod measures;
mod planning;
mod simulation;
mod source;
mod sweep;
mod table;
mod trace;
mod work;

use pyo3::prelude::*;

/// The functions and classes of `benchdog._native`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{
        command::command,
        planning::{Planner, plan},
        simulation::simulate,
        sweep::Sweep,
    };
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
