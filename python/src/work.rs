//! Long work without the GIL, which Ctrl-C and exceptions of progress callbacks stop.

use std::{
    panic::resume_unwind,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread::{Builder, scope},
    time::Duration,
};

use benchdog::{
    model::stop::Stop,
    pipeline::sweep::SweepWatch,
    planner::{Event, Part, Watch},
};
use pyo3::prelude::*;

/// How often signals are looked for and callbacks called.
const TICK: Duration = Duration::from_millis(20);

/// How long a call waits before it looks again whether another one has ended.
const WAIT: Duration = Duration::from_millis(2);

/// The stack of the thread that works, bytes: that of a program's main thread.
const STACK_BYTES: usize = 8 << 20;

/// What a call learns of its work, and how it stops it.
#[derive(Default)]
pub struct Work {
    stop: AtomicBool,
    /// The part of the work that was told of last.
    part: Mutex<Option<Part>>,
    runs: AtomicU64,
}

impl Stop for Work {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Watch for Work {
    fn tell(&self, event: &Event<'_>) {
        if let Event::Part(part) = event {
            *lock(&self.part) = Some(*part);
        }
    }
}

impl SweepWatch for Work {
    fn finished_run(&self) {
        self.runs.fetch_add(1, Ordering::Relaxed);
    }
}

impl Work {
    /// The part of the work that was told of last.
    pub fn part(&self) -> Option<Part> {
        *lock(&self.part)
    }

    /// The number of finished runs.
    pub fn runs(&self) -> u64 {
        self.runs.load(Ordering::Relaxed)
    }

    /// Waits for a value that another call may be using; `None` after a stop.
    pub fn wait_for<'m, T>(&self, value: &'m Mutex<T>) -> Option<MutexGuard<'m, T>> {
        loop {
            match value.try_lock() {
                Ok(guard) => return Some(guard),
                // What a panic left is only ever replaced as a whole.
                Err(std::sync::TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
                Err(std::sync::TryLockError::WouldBlock) if self.is_stopped() => return None,
                Err(std::sync::TryLockError::WouldBlock) => std::thread::sleep(WAIT),
            }
        }
    }

    /// Does `job` on a thread without the GIL. Meanwhile signals are looked for, and `meanwhile` is called. An exception of either
    /// stops the job and is raised.
    pub fn run<T: Send>(
        &self,
        py: Python<'_>,
        mut meanwhile: impl FnMut(Python<'_>) -> PyResult<()>,
        job: impl FnOnce() -> T + Send,
    ) -> PyResult<T> {
        let (sender, mut receiver) = channel();
        scope(|scope| {
            let worker = Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || {
                // The receiver is there until the scope ends.
                let _ = sender.send(job());
            })?;
            loop {
                let answer;
                (receiver, answer) = py.detach(move || {
                    let answer = receiver.recv_timeout(TICK);
                    (receiver, answer)
                });
                match answer {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Timeout) => {}
                    // Only a panic ends the job without an answer.
                    Err(RecvTimeoutError::Disconnected) => match worker.join() {
                        Err(panic) => resume_unwind(panic),
                        Ok(()) => unreachable!("a job that ends sends its result"),
                    },
                }
                if let Err(exception) = py.check_signals().and_then(|()| meanwhile(py)) {
                    self.stop.store(true, Ordering::Relaxed);
                    // What the job panics with after a stop is of no interest any more.
                    py.detach(|| worker.join()).ok();
                    return Err(exception);
                }
            }
        })
    }
}

fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
