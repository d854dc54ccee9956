//! The table of cutter shapes.

use super::borrow;
use super::guard::Fault;
use super::shelf::{Constant, count, kept, kept_text, with};
use super::{Offer, Shelf};
use crate::{CutterError, CutterShape, DimensionSpec, DimensionUnit, Dimensions, Profile, Segment};
use carvegraph_abi::{self as abi, Status, status};
use std::mem::size_of;
use std::ptr;

type Item = super::shelf::Item<dyn CutterShape, abi::CutterInfo>;

pub(super) const fn factory<P: Offer>() -> abi::CutterFactory {
    abi::CutterFactory {
        struct_size: size_of::<abi::CutterFactory>() as u32,
        reserved: 0,
        count: cutter_count::<P>,
        describe: describe::<P>,
        profile: profile::<P>,
    }
}

fn board(shelf: &'static Shelf) -> &'static Vec<Item> {
    &shelf.cutters
}

unsafe extern "C" fn cutter_count<P: Offer>() -> u32 {
    count::<P, _>(board)
}

unsafe extern "C" fn describe<P: Offer>(index: u32, to: *mut abi::CutterInfo) -> Status {
    with::<P, _, _>(board, index, Fault(ptr::null()), |item| {
        let Constant(info) = item.info.get_or_init(|| Constant(info(&*item.thing)));
        // SAFETY: the host gives room for as many bytes as it says.
        unsafe { borrow::fill(to, info) };
        status::OK
    })
}

fn info(shape: &dyn CutterShape) -> abi::CutterInfo {
    let dimensions = kept(shape.dimensions().iter().map(dimension));
    abi::CutterInfo {
        struct_size: size_of::<abi::CutterInfo>() as u32,
        dimension_count: dimensions.len() as u32,
        name: kept_text(shape.name()),
        about: kept_text(shape.about()),
        drawing: kept_text(shape.drawing().unwrap_or_default()),
        dimensions: dimensions.as_ptr(),
    }
}

fn dimension(spec: &DimensionSpec) -> abi::Dimension {
    abi::Dimension {
        name: borrow::lent(spec.name),
        about: borrow::lent(spec.about),
        unit: match spec.unit {
            DimensionUnit::Mm => abi::unit::MM,
            DimensionUnit::Deg => abi::unit::DEG,
        },
        reserved: 0,
        default_value: spec.default,
        min: spec.min,
        max: spec.max,
    }
}

unsafe extern "C" fn profile<P: Offer>(
    index: u32,
    values: *const f64,
    count: usize,
    drawing: abi::Text,
    segments: *const abi::SegmentSink,
    fault: *const abi::Sink,
) -> Status {
    let fault = Fault(fault);
    with::<P, _, _>(board, index, fault, |item| {
        // SAFETY: the host lends all of them for the call.
        let lent =
            unsafe { (borrow::slice(values, count), borrow::text(drawing), segments.as_ref()) };
        let (Some(values), Some(drawing), Some(sink)) = lent else {
            return fault.tell("the host gave no dimensions or no drawing");
        };
        match made(&*item.thing, values, drawing) {
            Ok(profile) => put(&profile, sink),
            Err(error) => fault.tell(&error.to_string()),
        }
    })
}

fn made(shape: &dyn CutterShape, values: &[f64], drawing: &str) -> Result<Profile, CutterError> {
    let specs = shape.dimensions();
    let given: Vec<_> = specs.iter().map(|spec| spec.name).zip(values.iter().copied()).collect();
    let dimensions = Dimensions::new(specs, &given)?;
    shape.profile(&match shape.drawing() {
        Some(_) if !drawing.is_empty() => dimensions.with_drawing(drawing),
        _ => dimensions,
    })
}

fn put(profile: &Profile, sink: &abi::SegmentSink) -> Status {
    let segments: Vec<abi::Segment> = profile.segments().iter().map(segment).collect();
    // SAFETY: the host's own function with the host's own data.
    unsafe { (sink.put)(sink.data, segments.as_ptr(), segments.len()) }
}

fn segment(segment: &Segment) -> abi::Segment {
    let (kind, to, center) = match *segment {
        Segment::Line { to } => (abi::segment::LINE, to, [0.0; 2]),
        Segment::Arc { to, center } => (abi::segment::ARC, to, center),
    };
    abi::Segment { kind, reserved: 0, to, center }
}
