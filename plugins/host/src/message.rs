//! What a plugin says when a call fails.

use crate::borrow::handle;
use carvegraph_abi::{self as abi, Status, status};
use std::ffi::c_void;
use std::slice;

/// Longer messages are cut.
const MAX_BYTES: usize = 4096;

/// Calls something that may tell why it failed: its status and the message.
pub(crate) fn heard(call: impl FnOnce(*const abi::Sink) -> Status) -> (Status, String) {
    let mut said: Vec<u8> = Vec::new();
    let sink = abi::Sink { data: handle(&mut said), write: hear };
    let status = call(&raw const sink);
    (status, String::from_utf8_lossy(&said).trim().to_owned())
}

unsafe extern "C" fn hear(data: *mut c_void, bytes: *const u8, size: usize) -> Status {
    if bytes.is_null() {
        return status::FAILED;
    }
    // SAFETY: `data` is the list of `heard`, which waits for the call to return; the plugin promises
    // the bytes, of which no more are looked at than a message has.
    unsafe {
        let said = &mut *data.cast::<Vec<u8>>();
        let room = MAX_BYTES.saturating_sub(said.len());
        said.extend_from_slice(slice::from_raw_parts(bytes, size.min(room)));
    }
    status::OK
}

/// What is to be told of a call that did not end well.
pub(crate) fn reason(status: Status, said: String) -> String {
    match (said.is_empty(), status) {
        (false, _) => said,
        (true, status::FAILED) => "it failed without saying why".to_owned(),
        (true, status::STOPPED) => "it stopped, though nobody asked it to".to_owned(),
        (true, status::PANICKED) => "it panicked".to_owned(),
        (true, status::NO_SUCH) => "it does not have what it counted".to_owned(),
        (true, other) => format!("it ended with the unknown status {other}"),
    }
}
