//! What the host lends for a call, as Rust sees it, and back.

use carvegraph_abi as abi;
use std::ffi::c_void;
use std::mem::{MaybeUninit, align_of, size_of};
use std::{ptr, slice, str};

/// A struct of the ABI that begins with its own size in bytes and is valid when all its bytes are 0.
///
/// # Safety
/// Both must hold.
pub(super) unsafe trait Sized32: Copy {}

// SAFETY: both begin with `struct_size`. A program holds numbers and pointers. The functions of a host
// are there in every minor version of this major, which `read` relies on.
unsafe impl Sized32 for abi::Program {}
// SAFETY: as above.
unsafe impl Sized32 for abi::Host {}
// SAFETY: descriptions begin with `struct_size`, and are numbers and pointers.
unsafe impl Sized32 for abi::CutterInfo {}
// SAFETY: likewise.
unsafe impl Sized32 for abi::DialectInfo {}
// SAFETY: likewise.
unsafe impl Sized32 for abi::NodeInfo {}

/// Reads a struct as far as both sides know it; the rest is zeros.
///
/// # Safety
/// `from` points to a struct of at least 4 bytes whose first field says truly how long it is.
pub(super) unsafe fn read<T: Sized32>(from: *const T) -> T {
    let mut to = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller promises as many bytes as the struct says; T is valid as zeros.
    unsafe {
        let size = from.cast::<u32>().read() as usize;
        let known = size.min(size_of::<T>());
        ptr::copy_nonoverlapping(from.cast::<u8>(), to.as_mut_ptr().cast::<u8>(), known);
        to.assume_init()
    }
}

/// Fills a struct as far as both sides know it.
///
/// # Safety
/// `to` points to as many bytes as its first field says, 4 at least.
pub(super) unsafe fn fill<T: Sized32>(to: *mut T, from: &T) {
    // SAFETY: the caller's promise.
    unsafe {
        let room = to.cast::<u32>().read();
        let known = (room as usize).min(size_of::<T>());
        ptr::copy_nonoverlapping(ptr::from_ref(from).cast::<u8>(), to.cast::<u8>(), known);
        to.cast::<u32>().write(known as u32);
    }
}

/// A slice of the caller's; empty for a null pointer. `None` if it is misaligned or absurdly long.
///
/// # Safety
/// `data` points to `count` valid elements that live for `'a`.
pub(super) unsafe fn slice<'a, T>(data: *const T, count: usize) -> Option<&'a [T]> {
    if count == 0 {
        return Some(&[]);
    }
    let bytes = count.checked_mul(size_of::<T>())?;
    if data.is_null() || !data.addr().is_multiple_of(align_of::<T>()) || bytes > isize::MAX as usize
    {
        return None;
    }
    // SAFETY: not null, aligned, not too long; the caller promises the rest.
    Some(unsafe { slice::from_raw_parts(data, count) })
}

/// A text of the caller's, if it is UTF-8.
///
/// # Safety
/// As for [`slice()`].
pub(super) unsafe fn text<'a>(text: abi::Text) -> Option<&'a str> {
    // SAFETY: the caller's promise.
    str::from_utf8(unsafe { slice(text.data, text.size) }?).ok()
}

/// All texts of a list, if they are UTF-8.
///
/// # Safety
/// As for [`slice()`], for the list and each text.
pub(super) unsafe fn texts<'a>(data: *const abi::Text, count: usize) -> Option<Vec<&'a str>> {
    // SAFETY: the caller's promise.
    let texts = unsafe { slice(data, count) }?;
    // SAFETY: likewise.
    texts.iter().map(|one| unsafe { text(*one) }).collect()
}

/// A text to be lent to the host.
pub(super) const fn lent(text: &str) -> abi::Text {
    abi::Text { data: text.as_ptr(), size: text.len() }
}

/// The address of something, to be handed through C and back.
pub(super) fn handle<T>(thing: &T) -> *mut c_void {
    ptr::from_ref(thing).cast_mut().cast()
}
