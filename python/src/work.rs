//! Long work: on threads of its own, without Python's lock, and ended by Ctrl-C.
//!
//! Every call has its own threads. A process that forks keeps none of its threads, and pools that outlive a call would be dead in
//! the child.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::available_parallelism;
use std::time::Duration;

/// How often Python is asked whether somebody wants to stop.
const TICK: Duration = Duration::from_millis(50);

/// Whether work is to be ended. What it gives then is thrown away.
#[pyclass(frozen, module = "piaffe._piaffe")]
#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

#[pymethods]
impl Stop {
    #[new]
    fn new() -> Stop {
        Stop::default()
    }

    /// From now on it is.
    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Stop {
    pub fn is_wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Threads for one call, one for each core at most: more would only wait for each other.
fn pool(threads: Option<usize>) -> PyResult<ThreadPool> {
    let cores = available_parallelism().map_or(1, usize::from);
    let threads = threads.map_or(cores, |threads| threads.clamp(1, cores));
    // A panic drops the channel, which is told below; the default is to end the process.
    let pool = ThreadPoolBuilder::new().num_threads(threads).panic_handler(|_| {}).build();
    pool.map_err(|why| PyRuntimeError::new_err(format!("cannot start {threads} threads: {why}")))
}

/// Does what is soon done, likewise apart from Python's lock and the threads of others.
pub fn apart<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool(None)?;
    Ok(py.detach(|| pool.install(work)))
}

/// Does some work, and asks Python in between whether to go on. Where it is interrupted, the work is told and left to end by itself.
pub fn work<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    stop: Stop,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let ((done, mut answers), told) = (channel(), stop.clone());
    pool(threads)?.spawn(move || {
        // Whoever is gone needs no answer.
        let _ = done.send(work(&told));
    });
    loop {
        let (answer, back) = py.detach(move || (answers.recv_timeout(TICK), answers));
        answers = back;
        match answer {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| stop.set())?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a fault of piaffe's own; please report it with the question"));
            }
        }
    }
}
