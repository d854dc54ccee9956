//! Calls of a plugin that may take long, on a thread of their own.
//!
//! The thread that asks for the call waits and does what the plugin asks of the host: it takes output,
//! and runs loops on the pool that it belongs to. So neither has to be shared between threads, and no
//! second pool begins. A plugin that goes on when it was told to stop is left behind: its thread sleeps
//! for good in the host's function, and the caller goes on without it.

use carvegraph_abi::{self as abi, Status, status};
use carvegraph_sdk::node::Services;
use std::ffi::c_void;
use std::io;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, ThreadId};

/// A plugin that was told so many times to stop does not listen.
const WARNINGS: u32 = 10_000;

/// As deep as a program's main thread may go.
const STACK_BYTES: usize = 8 << 20;

/// Why a call came to nothing.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Trouble {
    /// The plugin did not stop when it was told to.
    #[error("it goes on though it was told to stop, and was left behind")]
    Runaway,
    /// The system gives no thread.
    #[error("the system gives no thread to run it on: {0}")]
    NoThread(io::Error),
}

/// What the plugin's thread asks of the waiting one.
enum Request<T> {
    Write(Vec<u8>),
    Loop { count: usize, body: Body },
    Runaway,
    Done(T),
}

/// A loop's body, to be called on any thread, as the ABI allows.
#[derive(Clone, Copy)]
struct Body {
    call: abi::LoopBody,
    data: *mut c_void,
}

// SAFETY: the ABI says that a body is called on several threads at once.
unsafe impl Send for Body {}
// SAFETY: likewise.
unsafe impl Sync for Body {}

impl Body {
    fn call(&self, index: usize) {
        // SAFETY: the plugin's own function with the plugin's own data.
        unsafe { (self.call)(self.data, index) }
    }
}

/// The plugin's end of the line.
pub(crate) struct Line<'a> {
    ask: &'a dyn Ask,
    services: &'a dyn Services,
    warnings: AtomicU32,
    /// The plugin's own thread.
    thread: ThreadId,
}

/// Asks for something and waits until it is done; whether to go on.
trait Ask: Sync {
    fn write(&self, bytes: Vec<u8>) -> bool;
    fn run_loop(&self, count: usize, body: Body) -> bool;
    fn runaway(&self);
}

struct Asking<T> {
    requests: SyncSender<Request<T>>,
    answers: std::sync::Mutex<Receiver<bool>>,
}

impl<T> Asking<T> {
    /// What the waiting thread answers; `None` if it is busy with a loop, which this is called from.
    fn ask(&self, request: Request<T>) -> Option<bool> {
        let answers = self.answers.try_lock().ok()?;
        Some(self.requests.send(request).is_ok() && answers.recv().unwrap_or(false))
    }
}

impl<T: Send> Ask for Asking<T> {
    fn write(&self, bytes: Vec<u8>) -> bool {
        self.ask(Request::Write(bytes)).unwrap_or(false)
    }

    fn run_loop(&self, count: usize, body: Body) -> bool {
        self.ask(Request::Loop { count, body }).unwrap_or_else(|| {
            // A loop within a loop, on one of the threads that run the outer one.
            (0..count).for_each(|index| body.call(index));
            true
        })
    }

    fn runaway(&self) {
        // Nobody listens any more once the caller has gone on: all the same.
        let _ = self.requests.send(Request::Runaway);
    }
}

impl Line<'_> {
    /// Hands bytes to the caller's output; whether more are wanted.
    pub(crate) fn write(&self, bytes: Vec<u8>) -> bool {
        self.ask.write(bytes)
    }

    /// To be called each time the plugin is told to stop. Does not return to one that won't listen,
    /// unless it is on a thread of the pool, which others need.
    pub(crate) fn warned(&self) -> Status {
        let warnings = self.warnings.fetch_add(1, Ordering::Relaxed);
        if warnings < WARNINGS || thread::current().id() != self.thread {
            return status::STOPPED;
        }
        self.ask.runaway();
        loop {
            thread::park();
        }
    }

    pub(crate) fn handle(&self) -> *const abi::Run {
        std::ptr::from_ref(self).cast()
    }

    /// # Safety
    /// `run` is what [`handle`](Self::handle) gave, within the same call.
    unsafe fn of<'a>(run: *const abi::Run) -> Option<&'a Line<'a>> {
        // SAFETY: the caller's promise; a plugin may hand over null.
        unsafe { run.cast::<Line<'a>>().as_ref() }
    }
}

/// Runs `call` on a thread of its own; `out` takes what it writes. Answers what `call` does, and what
/// the output failed with.
pub(crate) fn watched<T: Send>(
    services: &dyn Services,
    mut out: impl FnMut(&[u8]) -> io::Result<()>,
    call: impl FnOnce(&Line<'_>) -> T + Send,
) -> Result<(T, io::Result<()>), Trouble> {
    let (requests, inbox) = sync_channel::<Request<T>>(1);
    let (answer, answers) = sync_channel::<bool>(1);
    let asking = Asking { requests, answers: answers.into() };
    let work = move || {
        let (warnings, thread) = (AtomicU32::new(0), thread::current().id());
        let line = Line { ask: &asking, services, warnings, thread };
        let result = call(&line);
        // The caller waits for this, unless it has gone on.
        let _ = asking.requests.send(Request::Done(result));
    };
    let builder = thread::Builder::new().name("carve-plugin".into()).stack_size(STACK_BYTES);
    // SAFETY: what the thread borrows outlives what it runs: this function returns when the thread is
    // done, or when it has announced that it will sleep for good, after which it touches nothing.
    let thread = unsafe { builder.spawn_unchecked(work) }.map_err(Trouble::NoThread)?;
    let mut written = Ok(());
    loop {
        let go_on = match inbox.recv() {
            Ok(Request::Write(bytes)) => {
                written = written.and_then(|()| out(&bytes));
                written.is_ok()
            }
            Ok(Request::Loop { count, body }) => {
                services.parallel_for(count, &|index| body.call(index))
            }
            Ok(Request::Done(result)) => {
                // It has nothing left to do but to end.
                let _ = thread.join();
                return Ok((result, written));
            }
            Ok(Request::Runaway) | Err(_) => return Err(Trouble::Runaway),
        };
        if answer.send(go_on).is_err() {
            return Err(Trouble::Runaway);
        }
    }
}

/// What the host does for plugins.
pub(crate) static HOST: abi::Host = abi::Host {
    struct_size: size_of::<abi::Host>() as u32,
    abi_major: abi::MAJOR,
    abi_minor: abi::MINOR,
    reserved: 0,
    log,
    progress,
    parallel_for,
};

unsafe extern "C" fn log(run: *const abi::Run, level: u32, message: abi::Text) {
    // SAFETY: the plugin hands back what it was given, and a text of its own.
    let (line, text) = unsafe { (Line::of(run), crate::borrow::text("message", message)) };
    if let (Some(line), Ok(text)) = (line, text) {
        match level {
            0 => line.services.note(&text),
            _ => line.services.warn(&text),
        }
    }
}

unsafe extern "C" fn progress(run: *const abi::Run, share: f64) -> Status {
    // SAFETY: the plugin hands back what it was given.
    match unsafe { Line::of(run) } {
        Some(line) if !line.services.progress(share) => line.warned(),
        _ => status::OK,
    }
}

unsafe extern "C" fn parallel_for(
    run: *const abi::Run,
    count: usize,
    body: abi::LoopBody,
    data: *mut c_void,
) -> Status {
    let body = Body { call: body, data };
    // SAFETY: the plugin hands back what it was given.
    match unsafe { Line::of(run) } {
        Some(line) if line.ask.run_loop(count, body) => status::OK,
        Some(line) => line.warned(),
        None => status::FAILED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_sdk::node::Alone;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn output_goes_to_the_caller_in_order() {
        let mut taken = Vec::new();
        let take = |bytes: &[u8]| {
            taken.extend_from_slice(bytes);
            Ok(())
        };
        let ended = watched(&Alone, take, |line| line.write(vec![1, 2]) && line.write(vec![3]));
        assert!(ended.unwrap().0);
        assert_eq!(taken, [1, 2, 3]);
    }

    #[test]
    fn one_that_will_not_stop_is_left_behind() {
        let refuse = |_: &[u8]| Err(io::Error::other("full"));
        let deaf = |line: &Line<'_>| {
            while line.write(vec![1]) || line.warned() == status::STOPPED {}
        };
        let ended = watched(&Alone, refuse, deaf);
        assert!(matches!(ended, Err(Trouble::Runaway)));
    }

    unsafe extern "C" fn count(data: *mut c_void, _: usize) {
        // SAFETY: the counter of the test, which waits.
        unsafe { &*data.cast::<AtomicUsize>() }.fetch_add(1, Ordering::Relaxed);
    }

    struct Nested<'a> {
        line: &'a Line<'a>,
        counter: &'a AtomicUsize,
    }

    unsafe extern "C" fn count_within(data: *mut c_void, _: usize) {
        // SAFETY: the test's, which waits.
        let nested = unsafe { &*data.cast::<Nested<'_>>() };
        let counter = std::ptr::from_ref(nested.counter).cast_mut().cast();
        // SAFETY: likewise.
        let answer = unsafe { parallel_for(nested.line.handle(), 10, count, counter) };
        assert_eq!(answer, status::OK);
    }

    #[test]
    fn loops_and_loops_within_them_run_on_the_callers_side() {
        let counter = AtomicUsize::new(0);
        let ended = watched(
            &Alone,
            |_| Ok(()),
            |line| {
                let mut nested = Nested { line, counter: &counter };
                let data = std::ptr::from_mut(&mut nested).cast();
                // SAFETY: `nested` lives until the loop is done.
                unsafe { parallel_for(line.handle(), 7, count_within, data) }
            },
        );
        assert_eq!(ended.unwrap().0, status::OK);
        assert_eq!(counter.into_inner(), 70);
    }
}
