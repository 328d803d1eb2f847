//! The native part of the Python package `gravel`: texts in; texts and the bytes of arrays out. What a user calls is in
//! `gravel/__init__.py`.

use harness::library;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Interval between two checks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// The text of a problem: of a file, or of a case at a time step.
#[pyfunction]
fn problem(
    py: Python,
    name: String,
    scene: Vec<(String, String)>,
    time_step: Option<String>,
) -> PyResult<String> {
    heeded(py, move |stopped| {
        library::problem(&name, scene, time_step.as_deref(), || stopped.load(Ordering::Relaxed))
    })
}

/// Answer to Python: the text that `gravel solve --json` prints, with the curve; impulses, velocities and relative
/// velocities; the numbers per contact or grain in each.
type Told<'py> = (String, [Bound<'py, PyByteArray>; 3], [usize; 3]);

/// Solves a problem.
#[pyfunction]
fn solve(py: Python<'_>, problem: String, request: String) -> PyResult<Told<'_>> {
    let solved =
        heeded(py, move |stopped| library::solve(&problem, &request, || stopped.load(Ordering::Relaxed)))?;
    let arrays = [solved.impulses, solved.velocity, solved.relative_velocity];
    let bytes = |numbers: Vec<f64>| numbers.into_iter().flat_map(f64::to_ne_bytes).collect::<Vec<u8>>();
    let each = [solved.of_contact, solved.of_grain, solved.of_contact];
    Ok((solved.told.to_string(), arrays.map(|numbers| PyByteArray::new(py, &bytes(numbers))), each))
}

/// Does `work` in a thread of its own, while this one hears Ctrl-C and other threads of Python go on. What is interrupted is left
/// alone, and ends where it next asks whether it is stopped.
fn heeded<T: Send + 'static>(
    py: Python,
    work: impl FnOnce(&AtomicBool) -> Result<T, String> + Send + 'static,
) -> PyResult<T> {
    py.detach(|| {
        let stopped = Arc::new(AtomicBool::new(false));
        let (give, given) = channel();
        let stops = Arc::clone(&stopped);
        let worker = thread::spawn(move || give.send(work(&stops)).is_ok());
        loop {
            match given.recv_timeout(LOOK) {
                Ok(done) => return done.map_err(PyValueError::new_err),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(heard) = Python::attach(|py| py.check_signals()) {
                        stopped.store(true, Ordering::Relaxed);
                        return Err(heard);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let ended = worker.join().map(|_| PyValueError::new_err("the work ended without an answer"));
        Err(ended.unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

#[pymodule(gil_used = false)]
fn _native(module: &Bound<PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(problem, module)?)?;
    module.add_function(wrap_pyfunction!(solve, module)?)
}
