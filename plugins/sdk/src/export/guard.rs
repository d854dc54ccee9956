//! No panic leaves a plugin.

use super::borrow::lent;
use carvegraph_abi::{self as abi, Status, status};
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where the message of a fault goes.
#[derive(Clone, Copy)]
pub(super) struct Fault(pub(super) *const abi::Sink);

impl Fault {
    /// Tells the host why a call fails.
    pub(super) fn tell(self, message: &str) -> Status {
        let text = lent(message);
        // SAFETY: the host lends the sink for the call; it may lend none.
        if let Some(sink) = unsafe { self.0.as_ref() } {
            // SAFETY: the host's own function with the host's own data.
            unsafe { (sink.write)(sink.data, text.data, text.size) };
        }
        status::FAILED
    }
}

thread_local! {
    /// How many guarded calls this thread is in.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
    /// What the last panic within them said, and where.
    static SAID: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps panics of guarded calls off the terminal: the host tells of them in its own words.
pub(super) fn hush() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if DEPTH.get() == 0 {
                return usual(info);
            }
            let place = info.location().map(|at| format!(" ({}:{})", at.file(), at.line()));
            let said = format!("{}{}", words(info.payload()), place.unwrap_or_default());
            SAID.with(|last| *last.borrow_mut() = Some(said));
        }));
    });
}

/// What a panic's payload says.
fn words(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or(payload.downcast_ref::<&str>().copied()).unwrap_or("no message")
}

/// Unwinds out of a plugin's own code when the host wants no more of it: code that ignores the error
/// of a sink would otherwise never end.
pub(super) struct Stop;

/// How guarded work ended badly.
pub(super) enum Ended {
    /// By [`Stop`].
    Stopped,
    /// By a panic that said this.
    Panicked(String),
}

/// Runs the plugin's own code.
pub(super) fn run<T>(work: impl FnOnce() -> T) -> Result<T, Ended> {
    DEPTH.set(DEPTH.get() + 1);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    DEPTH.set(DEPTH.get() - 1);
    result.map_err(|payload| {
        let said = SAID.with(|last| last.borrow_mut().take());
        let ended = match payload.is::<Stop>() {
            true => Ended::Stopped,
            false => Ended::Panicked(said.unwrap_or_else(|| words(&*payload).to_owned())),
        };
        // Its destructor may panic too.
        std::mem::forget(payload);
        ended
    })
}

/// A call that is made once.
pub(super) fn once(fault: Fault, work: impl FnOnce() -> Status) -> Status {
    call(&AtomicBool::new(false), fault, work)
}

/// A call of something that is not called again once it has panicked.
pub(super) fn call(poisoned: &AtomicBool, fault: Fault, work: impl FnOnce() -> Status) -> Status {
    if poisoned.load(Ordering::Relaxed) {
        fault.tell("it panicked before and is not called again");
        return status::PANICKED;
    }
    match run(work) {
        Ok(status) => status,
        Err(Ended::Stopped) => status::STOPPED,
        Err(Ended::Panicked(said)) => {
            poisoned.store(true, Ordering::Relaxed);
            fault.tell(&format!("it panicked: {said}"));
            status::PANICKED
        }
    }
}
