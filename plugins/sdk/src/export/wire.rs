//! Values as the ABI has them, for both sides.

use super::borrow::{lent, slice, text};
use crate::value::{Elements, Raw, RawArray};
use carvegraph_abi::{self as abi, element};
use std::borrow::Cow;

/// No standard type has half as many arrays.
const MAX_ARRAYS: usize = 64;

/// The longest array that is taken, 16 GiB: 700 million points in space.
const MAX_ARRAY_BYTES: usize = 16 << 30;

/// Values lent to the other side; they must not move or change while it has them.
pub struct Lent<'a> {
    values: Vec<Option<abi::Value>>,
    /// What the values point to.
    _arrays: Vec<Vec<abi::Array>>,
    _of: std::marker::PhantomData<&'a ()>,
}

impl<'a> Lent<'a> {
    /// Lends values; `None` stays `None`.
    pub fn of(raws: impl IntoIterator<Item = Option<&'a Raw<'a>>>) -> Self {
        let mut lent_out =
            Self { values: Vec::new(), _arrays: Vec::new(), _of: std::marker::PhantomData };
        for raw in raws {
            let value = raw.map(|raw| {
                let arrays: Vec<abi::Array> = raw.arrays.iter().map(array).collect();
                let type_name = lent(&raw.type_name);
                let value =
                    abi::Value { type_name, arrays: arrays.as_ptr(), array_count: arrays.len() };
                lent_out._arrays.push(arrays);
                value
            });
            lent_out.values.push(value);
        }
        lent_out
    }

    /// A pointer to each, null for `None`.
    pub fn pointers(&self) -> Vec<*const abi::Value> {
        let pointer = |value: &Option<abi::Value>| {
            value.as_ref().map_or(std::ptr::null(), std::ptr::from_ref)
        };
        self.values.iter().map(pointer).collect()
    }
}

fn array(from: &RawArray<'_>) -> abi::Array {
    let (element, data) = match &from.elements {
        Elements::U8(array) => (element::U8, array.as_ptr().cast()),
        Elements::U16(array) => (element::U16, array.as_ptr().cast()),
        Elements::U32(array) => (element::U32, array.as_ptr().cast()),
        Elements::U64(array) => (element::U64, array.as_ptr().cast()),
        Elements::F32(array) => (element::F32, array.as_ptr().cast()),
        Elements::F64(array) => (element::F64, array.as_ptr().cast()),
    };
    let (name, count) = (lent(&from.name), from.elements.count());
    abi::Array { name, element, reserved: 0, data, count }
}

/// A value of the other side's.
///
/// # Errors
/// What is wrong with it, as far as can be seen.
///
/// # Safety
/// All that it points to is there, if its lengths make sense, and lives for `'a`.
pub unsafe fn raw<'a>(value: &abi::Value) -> Result<Raw<'a>, String> {
    if value.array_count > MAX_ARRAYS {
        return Err(format!(
            "a value has {} arrays; {MAX_ARRAYS} at most are read",
            value.array_count
        ));
    }
    // SAFETY: the caller's promise.
    let parts = unsafe { (text(value.type_name), slice(value.arrays, value.array_count)) };
    let (Some(type_name), Some(arrays)) = parts else {
        return Err("a value has no readable type or arrays".to_owned());
    };
    // SAFETY: the caller's promise.
    let arrays = arrays.iter().map(|from| unsafe { raw_array(from) });
    let arrays = arrays.collect::<Result<_, _>>().map_err(|why| format!("{type_name}: {why}"))?;
    Ok(Raw { type_name: Cow::Borrowed(type_name), arrays })
}

/// # Safety
/// As for [`raw`].
unsafe fn raw_array<'a>(from: &abi::Array) -> Result<RawArray<'a>, String> {
    // SAFETY: the caller's promise.
    let name = unsafe { text(from.name) }.ok_or("an array's name is no UTF-8")?;
    // SAFETY: the caller's promise.
    let elements = unsafe {
        match from.element {
            element::U8 => elements(from).map(Elements::U8),
            element::U16 => elements(from).map(Elements::U16),
            element::U32 => elements(from).map(Elements::U32),
            element::U64 => elements(from).map(Elements::U64),
            element::F32 => elements(from).map(Elements::F32),
            element::F64 => elements(from).map(Elements::F64),
            other => {
                return Err(format!("array {name:?} has elements of the unknown kind {other}"));
            }
        }
    };
    let elements = elements.ok_or_else(|| {
        format!("array {name:?} has {} elements at {:?}, which cannot be", from.count, from.data)
    })?;
    Ok(RawArray { name: Cow::Borrowed(name), elements })
}

/// # Safety
/// As for [`raw`].
unsafe fn elements<'a, T: Clone>(from: &abi::Array) -> Option<Cow<'a, [T]>> {
    let bytes = from.count.checked_mul(size_of::<T>())?;
    if bytes > MAX_ARRAY_BYTES {
        return None;
    }
    // SAFETY: the caller's promise.
    unsafe { slice(from.data.cast::<T>(), from.count) }.map(Cow::Borrowed)
}
