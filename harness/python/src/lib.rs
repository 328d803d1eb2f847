//! The native part of the Python package `gravel`: texts in; texts and the bytes of arrays out. What a user calls is in
//! `gravel/__init__.py`.

use harness::library::{self, Simulation, Table, Values};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
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
    let each = [solved.of_contact, solved.of_grain, solved.of_contact];
    Ok((solved.told.to_string(), arrays.map(|numbers| array(py, &numbers)), each))
}

/// A column for Python: an array's bytes with its type, or texts.
#[derive(IntoPyObject)]
enum Column<'py> {
    Array((Bound<'py, PyByteArray>, &'static str)),
    Texts(Vec<String>),
}

fn columns<'py>(py: Python<'py>, table: Table) -> Vec<(String, Column<'py>)> {
    let column = |(name, values)| {
        let values = match values {
            Values::Counts(counts) => {
                let bytes: Vec<u8> = counts.into_iter().flat_map(i64::to_ne_bytes).collect();
                Column::Array((PyByteArray::new(py, &bytes), "i8"))
            }
            Values::Numbers(numbers) => Column::Array((array(py, &numbers), "f8")),
            Values::Texts(texts) => Column::Texts(texts),
        };
        (name, values)
    };
    table.into_iter().map(column).collect()
}

fn array<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyByteArray> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
    PyByteArray::new(py, &bytes)
}

/// Radius, mass, position, velocity and spin of each body, and the numbers in a position and in a spin.
type OfBodies<'py> = ([Bound<'py, PyByteArray>; 5], [usize; 3]);

/// A simulation under way. A call waits for the one before, as after Ctrl-C.
#[pyclass(frozen)]
struct March(Arc<Mutex<Simulation>>);

impl March {
    fn with<T>(&self, work: impl FnOnce(&mut Simulation) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl March {
    #[new]
    fn new(
        name: String,
        scene: Vec<(String, String)>,
        request: String,
        restart: Option<PathBuf>,
        state: Option<PathBuf>,
    ) -> PyResult<Self> {
        let simulation = Simulation::new(&name, &scene, &request, restart.as_deref(), state);
        Ok(Self(Arc::new(Mutex::new(simulation.map_err(PyValueError::new_err)?))))
    }

    /// Makes time steps: the text of what it tells, the series, the contacts of the last.
    #[expect(clippy::type_complexity, reason = "two tables")]
    fn advance<'py>(
        &self,
        py: Python<'py>,
        time_steps: u64,
        contacts: bool,
    ) -> PyResult<(String, Vec<(String, Column<'py>)>, Vec<(String, Column<'py>)>)> {
        let simulation = Arc::clone(&self.0);
        let advanced = heeded(py, move |stopped| {
            let stops = || stopped.load(Ordering::Relaxed);
            let mut simulation = simulation.lock().unwrap_or_else(PoisonError::into_inner);
            simulation.advance(time_steps, contacts, &stops)
        })?;
        Ok((advanced.told.to_string(), columns(py, advanced.series), columns(py, advanced.contacts)))
    }

    fn bodies<'py>(&self, py: Python<'py>) -> OfBodies<'py> {
        let bodies = self.with(|simulation| simulation.bodies());
        let lists = [bodies.radius, bodies.mass, bodies.position, bodies.velocity, bodies.spin];
        (lists.map(|numbers| array(py, &numbers)), bodies.sizes)
    }

    fn walls(&self) -> Vec<Vec<[f64; 3]>> {
        self.with(|simulation| simulation.walls())
    }

    fn time(&self) -> (u64, f64) {
        self.with(|simulation| simulation.time())
    }

    fn warnings(&self) -> Vec<String> {
        self.with(|simulation| simulation.warnings())
    }

    fn save(&self) -> PyResult<()> {
        self.with(|simulation| simulation.save()).map_err(PyValueError::new_err)
    }
}

/// Writes the problem of a case at a time step as a file.
#[pyfunction]
fn freeze(
    py: Python,
    name: String,
    scene: Vec<(String, String)>,
    time_step: Option<String>,
    output: PathBuf,
) -> PyResult<()> {
    heeded(py, move |stopped| {
        let stops = || stopped.load(Ordering::Relaxed);
        library::freeze(&name, scene, time_step.as_deref(), &output, stops)
    })
}

/// Runs a plan, as `gravel bench` with these arguments: the folder of its tables.
#[pyfunction]
#[pyo3(name = "bench")]
fn study(py: Python, arguments: Vec<String>) -> PyResult<PathBuf> {
    heeded(py, move |stopped| library::bench(arguments, || stopped.load(Ordering::Relaxed)))
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
    module.add_class::<March>()?;
    for function in [
        wrap_pyfunction!(problem, module)?,
        wrap_pyfunction!(freeze, module)?,
        wrap_pyfunction!(study, module)?,
    ] {
        module.add_function(function)?;
    }
    module.add_function(wrap_pyfunction!(solve, module)?)
}
