//! The native part of the Python package `gravel`: texts in; texts and the bytes of arrays out. What a user calls is in
//! `gravel/__init__.py`.

use harness::library;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How long a user waits for Ctrl-C to be heard.
const LOOK: Duration = Duration::from_millis(50);

/// The text of a problem: of a file, or of a case at a time step.
#[pyfunction]
fn problem(
    py: Python,
    name: String,
    scene: Vec<(String, String)>,
    time_step: Option<String>,
) -> PyResult<String> {
    heeded(py, move |_| library::problem(&name, scene, time_step.as_deref()))
}

/// Solves a problem: what `gravel solve --json` prints, with the curve; then impulses, velocities and relative velocities.
#[pyfunction]
fn solve(py: Python, problem: String, request: String) -> PyResult<(String, [Bound<PyByteArray>; 3])> {
    let solved =
        heeded(py, move |stopped| library::solve(&problem, &request, || stopped.load(Ordering::Relaxed)))?;
    let arrays = [solved.impulses, solved.velocity, solved.relative_velocity];
    let bytes = |numbers: Vec<f64>| numbers.into_iter().flat_map(f64::to_ne_bytes).collect::<Vec<u8>>();
    Ok((solved.told.to_string(), arrays.map(|numbers| PyByteArray::new(py, &bytes(numbers)))))
}

/// Does `work` in a thread of its own, while this one hears Ctrl-C and other threads of Python go on.
fn heeded<T: Send>(py: Python, work: impl FnOnce(&AtomicBool) -> Result<T, String> + Send) -> PyResult<T> {
    py.detach(|| {
        let (stopped, mut heard) = (AtomicBool::new(false), Ok(()));
        let done = std::thread::scope(|scope| {
            let (open, closes) = channel::<()>();
            let worker = scope.spawn(|| {
                // It closes with the work, however that ends.
                let _open = open;
                work(&stopped)
            });
            while closes.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if heard.is_ok() {
                    heard = Python::attach(|py| py.check_signals());
                }
                stopped.store(heard.is_err(), Ordering::Relaxed);
            }
            worker.join()
        });
        heard?;
        done.unwrap_or_else(|panic| resume_unwind(panic)).map_err(PyValueError::new_err)
    })
}

#[pymodule(gil_used = false)]
fn _native(module: &Bound<PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(problem, module)?)?;
    module.add_function(wrap_pyfunction!(solve, module)?)
}
