//! A cutter shape in a library.

use crate::borrow::{self, Given, handle};
use crate::message::{heard, reason};
use carvegraph_abi::{self as abi, Status, status};
use carvegraph_sdk::{
    CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile, Segment,
};
use std::ffi::c_void;
use std::mem::{size_of, zeroed};

/// A thousand times what a drawn profile has.
const MAX_SEGMENTS: usize = 1 << 20;

/// A shape, and where it is in its library's table.
pub(crate) struct LibraryCutter {
    table: &'static abi::CutterFactory,
    index: u32,
    name: String,
    about: String,
    drawing: Option<String>,
    dimensions: Vec<DimensionSpec>,
}

impl LibraryCutter {
    /// Asks the library what shape stands at an index.
    ///
    /// # Safety
    /// The table keeps the rules of the ABI.
    pub(crate) unsafe fn describe(
        table: &'static abi::CutterFactory,
        index: u32,
    ) -> Result<Self, Given> {
        // SAFETY: numbers and pointers are valid as zeros.
        let mut info: abi::CutterInfo = unsafe { zeroed() };
        info.struct_size = size_of::<abi::CutterInfo>() as u32;
        // SAFETY: the caller's promise.
        let answer = unsafe { (table.describe)(index, &raw mut info) };
        if answer != status::OK {
            return Err(Given::Nothing { why: reason(answer, String::new()) });
        }
        // SAFETY: the ABI says that a description stays valid for good.
        unsafe { Self::of(table, index, &info) }
    }

    /// # Safety
    /// As for [`describe`](Self::describe).
    unsafe fn of(
        table: &'static abi::CutterFactory,
        index: u32,
        info: &abi::CutterInfo,
    ) -> Result<Self, Given> {
        // SAFETY: the caller's promise.
        unsafe {
            let name = borrow::name("cutter's name", info.name)?;
            let about = borrow::text("cutter's description", info.about)?;
            let drawing = borrow::text("cutter's drawing", info.drawing)?;
            let count = info.dimension_count as usize;
            let dimensions = borrow::short_list("dimensions", info.dimensions, count)?;
            let dimensions =
                dimensions.iter().map(|from| dimension(from)).collect::<Result<_, _>>()?;
            let drawing = (!drawing.is_empty()).then_some(drawing);
            Ok(Self { table, index, name, about, drawing, dimensions })
        }
    }
}

/// # Safety
/// Its texts keep the rules of the ABI.
unsafe fn dimension(from: &abi::Dimension) -> Result<DimensionSpec, Given> {
    // SAFETY: the caller's promise.
    let (name, about) = unsafe {
        (borrow::name("dimension's name", from.name)?, borrow::text("dimension", from.about)?)
    };
    let unit = match from.unit {
        abi::unit::MM => DimensionUnit::Mm,
        abi::unit::DEG => DimensionUnit::Deg,
        number => return Err(Given::Unknown { what: "dimension's unit", number }),
    };
    let (default, min, max) = (from.default_value, from.min, from.max);
    if !(min.is_finite() && max.is_finite() && (min..=max).contains(&default)) {
        return Err(Given::BadRange { name, default, min, max });
    }
    // Libraries stay for good, and so may their few names.
    let (name, about) = (String::leak(name), String::leak(about));
    Ok(DimensionSpec { name, about, unit, default, min, max })
}

impl CutterShape for LibraryCutter {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &self.dimensions
    }

    fn drawing(&self) -> Option<&str> {
        self.drawing.as_deref()
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let drawing = match self.drawing {
            Some(_) => dimensions.drawing()?,
            None => "",
        };
        let values = dimensions.values();
        let mut taken = Taken { segments: Vec::new(), refused: None };
        let sink = abi::SegmentSink { data: handle(&mut taken), put };
        let (answer, said) = heard(|fault| {
            // SAFETY: the table keeps the rules of the ABI, and all that is lent outlives the call.
            unsafe {
                let (data, count) = (values.as_ptr(), values.len());
                let drawing = borrow::lent(drawing);
                (self.table.profile)(self.index, data, count, drawing, &raw const sink, fault)
            }
        });
        match taken.refused {
            Some(why) => Err(CutterError::Shape(why)),
            None if answer != status::OK => Err(CutterError::Shape(reason(answer, said))),
            None => Ok(Profile::new(taken.segments)?),
        }
    }
}

/// The segments that came so far, and why more are refused.
struct Taken {
    segments: Vec<Segment>,
    refused: Option<String>,
}

unsafe extern "C" fn put(data: *mut c_void, segments: *const abi::Segment, count: usize) -> Status {
    // SAFETY: `data` is what `profile` handed over, which waits for the call to return.
    let taken = unsafe { &mut *data.cast::<Taken>() };
    let total = count.saturating_add(taken.segments.len());
    let fits = if total <= MAX_SEGMENTS {
        // SAFETY: the plugin promises the segments.
        unsafe { borrow::list("segments", segments, count, MAX_SEGMENTS) }
    } else {
        Err(Given::TooMany { what: "segments", count: total, limit: MAX_SEGMENTS })
    };
    let more = fits.map_err(|fault| fault.to_string());
    match more.and_then(|more| more.iter().map(segment).collect::<Result<Vec<_>, _>>()) {
        Ok(more) => {
            taken.segments.extend(more);
            status::OK
        }
        Err(why) => {
            taken.refused = Some(why);
            status::STOPPED
        }
    }
}

fn segment(from: &abi::Segment) -> Result<Segment, String> {
    let (to, center) = (from.to, from.center);
    match from.kind {
        abi::segment::LINE => Ok(Segment::Line { to }),
        abi::segment::ARC => Ok(Segment::Arc { to, center }),
        number => Err(Given::Unknown { what: "kind of segment", number }.to_string()),
    }
}
