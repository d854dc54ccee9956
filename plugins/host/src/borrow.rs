//! What a plugin gives, checked before it is believed, and what it is lent.
//!
//! A pointer can't be checked; lengths, alignment, UTF-8 and counts can, with limits far above what an
//! honest plugin needs.

use carvegraph_abi as abi;
use std::ffi::c_void;
use std::{ptr, slice, str};

/// A page of prose; the longest text that a description may hold.
const MAX_TEXT_BYTES: usize = 1 << 16;

/// The longest list that a description may hold.
const MAX_LIST: usize = 4096;

/// Why something that a plugin gave can't be used.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Given {
    /// A text is too long to be one.
    #[error("its {what} has {size} bytes; {MAX_TEXT_BYTES} at most are read")]
    TextTooLong {
        /// What it should be.
        what: &'static str,
        /// Its length.
        size: usize,
    },
    /// A text is no text.
    #[error("its {what} is no UTF-8")]
    NotUtf8 {
        /// What it should be.
        what: &'static str,
    },
    /// A name that recipes could not use.
    #[error("its {what} is {name:?}; lower-case letters, digits and _ make a name, 64 at most")]
    BadName {
        /// What it should be.
        what: &'static str,
        /// What is given.
        name: String,
    },
    /// A list is too long.
    #[error("it gives {count} {what}; {limit} at most are read")]
    TooMany {
        /// What it is a list of.
        what: &'static str,
        /// Its length.
        count: usize,
        /// The longest that is read.
        limit: usize,
    },
    /// A pointer is null, or not aligned for what it points to.
    #[error("its {what} are at no valid address")]
    BadAddress {
        /// What it should point to.
        what: &'static str,
    },
    /// A description could not be had.
    #[error("it cannot be described: {why}")]
    Nothing {
        /// Why not.
        why: String,
    },
    /// A range that holds no default.
    #[error("its {name} is {default} at first, which does not lie within {min} to {max}")]
    BadRange {
        /// The dimension or param.
        name: String,
        /// Its default.
        default: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A number is not among those that this version knows.
    #[error("its {what} is {number}, which this version of carve does not know")]
    Unknown {
        /// What it should be.
        what: &'static str,
        /// What is given.
        number: u32,
    },
}

/// A list that a plugin gives.
///
/// # Safety
/// `data` points to `count` elements that live for `'a`, if the two make sense.
pub(crate) unsafe fn list<'a, T>(
    what: &'static str,
    data: *const T,
    count: usize,
    limit: usize,
) -> Result<&'a [T], Given> {
    match count {
        0 => Ok(&[]),
        _ if count > limit => Err(Given::TooMany { what, count, limit }),
        _ if data.is_null() || !data.is_aligned() => Err(Given::BadAddress { what }),
        // SAFETY: checked as far as can be; the caller promises the rest.
        _ => Ok(unsafe { slice::from_raw_parts(data, count) }),
    }
}

/// A list in a description.
///
/// # Safety
/// As for [`list`].
pub(crate) unsafe fn short_list<'a, T>(
    what: &'static str,
    data: *const T,
    count: usize,
) -> Result<&'a [T], Given> {
    // SAFETY: the caller's promise.
    unsafe { list(what, data, count, MAX_LIST) }
}

/// A text in a description.
///
/// # Safety
/// As for [`list`].
pub(crate) unsafe fn text(what: &'static str, text: abi::Text) -> Result<String, Given> {
    let abi::Text { data, size } = text;
    if size > MAX_TEXT_BYTES {
        return Err(Given::TextTooLong { what, size });
    }
    // SAFETY: the caller's promise.
    let bytes = unsafe { list(what, data, size, MAX_TEXT_BYTES) }?;
    str::from_utf8(bytes).map(str::to_owned).map_err(|_| Given::NotUtf8 { what })
}

/// A name that recipes can use.
///
/// # Safety
/// As for [`list`].
pub(crate) unsafe fn name(what: &'static str, from: abi::Text) -> Result<String, Given> {
    // SAFETY: the caller's promise.
    let name = unsafe { text(what, from) }?;
    let fits = |letter: char| matches!(letter, 'a'..='z' | '0'..='9' | '_');
    let good = (1..=64).contains(&name.len()) && name.chars().all(fits);
    if good { Ok(name) } else { Err(Given::BadName { what, name }) }
}

/// A file name extension: letters and digits.
///
/// # Safety
/// As for [`list`].
pub(crate) unsafe fn extension(from: abi::Text) -> Result<String, Given> {
    let what = "extension";
    // SAFETY: the caller's promise.
    let name = unsafe { text(what, from) }?;
    let good = (1..=16).contains(&name.len()) && name.chars().all(|c| c.is_ascii_alphanumeric());
    if good { Ok(name) } else { Err(Given::BadName { what, name }) }
}

/// A text to be lent to a plugin.
pub(crate) fn lent(text: &str) -> abi::Text {
    abi::Text { data: text.as_ptr(), size: text.len() }
}

/// All texts of a list, to be lent.
pub(crate) fn all_lent(texts: &[&str]) -> Vec<abi::Text> {
    texts.iter().map(|text| lent(text)).collect()
}

/// The address of something, to be handed to a plugin and back.
pub(crate) fn handle<T>(thing: &mut T) -> *mut c_void {
    ptr::from_mut(thing).cast()
}
