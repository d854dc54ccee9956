//! What a plugin makes wrongly is refused in words.

use super::super::crossing::{CROSSINGS, Crosses};
use super::*;
use crate::values::Remark;
use carvegraph_geometry::{Bounds, PatternSpan};
use carvegraph_sdk::value as seen;
use carvegraph_sdk::value::{Elements, PortValue};

/// What is said of a node that makes `raw`.
fn refusal(raw: Raw<'static>) -> String {
    let mut types = CROSSINGS.iter().map(|crossing| crossing.type_name);
    let type_name = types.find(|name| raw.type_name == *name).unwrap();
    let (inputs, outputs) = (vec![port("value", "remark")], vec![port("value", type_name)]);
    let run = move |_: &Job<'_>| Ok(vec![raw.clone()]);
    let node = Toy { name: "toy", params: vec![], inputs, outputs, run };
    through(Box::new(node), Remark { text: "-".to_owned() }).unwrap_err().to_string()
}

/// What is said of an output, without the words around it.
fn bad(made: impl PortValue<'static>) -> String {
    let message = refusal(made.into_raw());
    let inner = message.strip_prefix("output \"value\": ").unwrap();
    inner.strip_suffix(": a fault of acme 1.2").unwrap().to_owned()
}

fn seen_path() -> seen::Toolpath<'static> {
    seen::Toolpath::read(path().seen().into_raw().into_owned()).unwrap()
}

#[test]
fn what_is_not_finite_is_refused() {
    let field = |heights: Vec<f32>| seen::HeightField {
        columns: 2,
        rows: 2,
        pitch_mm: 0.1,
        heights: heights.into(),
    };
    assert_eq!(bad(field(vec![0.0, 0.0, 0.0, f32::NAN])), "the height at column 1, row 1 is NaN");
    let gray = seen::GrayImage { width: 2, height: 1, values: vec![0.0, f32::INFINITY].into() };
    assert_eq!(bad(gray), "pixel 1 is inf; it must be finite");
    let points = vec![[0.0; 3], [0.0, f64::NAN, 1.0]];
    let cloud = seen::PointCloud { points: points.clone().into(), grid: None };
    assert_eq!(bad(cloud), "point 1 is [0.0, NaN, 1.0]; it must be finite");
    let mesh = seen::Mesh { vertices: points.into(), triangles: vec![].into() };
    assert_eq!(bad(mesh), "vertex 1 is [0.0, NaN, 1.0]; it must be finite");
    let spans = vec![PatternSpan { points: 0..1, link: false, joined: false }];
    let pattern = seen::Pattern { points: vec![[f64::INFINITY, 0.0]].into(), spans };
    assert_eq!(bad(pattern), "point 0 is [inf, 0.0]; it must be finite");
    let nan = vec![[f64::NAN; 3]; 4];
    let tips = seen::Toolpath { tips: nan.clone().into(), ..seen_path() };
    assert_eq!(bad(tips), "tip 0 is [NaN, NaN, NaN]; it must be finite");
    let contacts = seen::Toolpath { contact_points: nan.into(), ..seen_path() };
    assert_eq!(bad(contacts), "contact 0 is [NaN, NaN, NaN]; it must be finite");
    let bounds = Bounds { min: DVec3::NAN, max: DVec3::ONE };
    assert_eq!(bad(bounds), "corner 0 is [NaN, NaN, NaN]; it must be finite");
}

#[test]
fn what_no_node_could_make_is_refused() {
    let field = |columns, rows, pitch_mm| seen::HeightField {
        columns,
        rows,
        pitch_mm,
        heights: vec![0.0; columns * rows].into(),
    };
    assert_eq!(bad(field(1, 3, 0.1)), "a surface needs at least 2 × 2 points; this one has 1 × 3");
    assert_eq!(bad(field(2, 2, 0.0)), "the grid's pitch must be a positive length, not 0 mm");
    let empty = seen::GrayImage { width: 0, height: 5, values: vec![].into() };
    assert_eq!(bad(empty), "it is 0 × 5 pixels; a picture has one at least");
    let bounds = Bounds { min: DVec3::new(0.0, 2.0, 0.0), max: DVec3::ONE };
    assert_eq!(
        bad(bounds),
        "it reaches from [0, 2, 0] to [1, 1, 1]; give the corner with the lesser coordinates first"
    );
    let feeds = Feeds { plunge_mm_per_min: 0.0, ..path().feeds.unwrap() };
    assert_eq!(
        bad(seen::Toolpath { feeds: Some(feeds), ..seen_path() }),
        "its feed of plunges in mm/min is 0; it must be above 0"
    );
    assert_eq!(
        bad(Reduction { max_above_mm: f64::NAN, ..REDUCTION }),
        "its greatest excess in mm is NaN; it must be 0 or more"
    );
    let code = |dialect: &'static str, extension: &'static str| seen::Gcode {
        text: vec![].into(),
        dialect: dialect.into(),
        extension: extension.into(),
    };
    assert_eq!(bad(code("", "nc")), "its dialect is \"\"; it must be a line of text");
    assert_eq!(
        bad(code("grbl", "../x")),
        "its extension is \"../x\"; it must be 1 to 16 letters and digits"
    );
    let remark = seen::Remark { text: "a\u{1b}[2J".into() };
    assert_eq!(bad(remark), "its text is \"a\\u{1b}[2J\"; it must be a line of text");
    let long = seen::Remark { text: "a".repeat(10_001).into() };
    assert_eq!(bad(long), "it has 10001 bytes of text; the limit is 10000");
}

#[test]
fn what_is_malformed_is_refused() {
    let raw = Raw::new("mesh").with("vertices", vec![0.0; 9]).with("triangles", vec![0_u32, 1, 3]);
    assert_eq!(
        refusal(raw),
        "output \"value\": element 2 of \"triangles\" of the mesh is 3; it must be below 3: a fault of \
         acme 1.2"
    );
    let mut raw = seen_path().into_raw();
    let contacts = raw.arrays.iter_mut().find(|array| array.name == "contact_points").unwrap();
    contacts.elements = Elements::from(vec![0.0; 9]);
    assert!(refusal(raw).contains("has 9 elements; it must have 3 for each of 4"));
}

#[test]
fn the_wrong_values_are_refused() {
    let input = || Remark { text: "-".to_owned() };
    let says = |run: fn(&Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault>| {
        through(toy("remark", run), input()).unwrap_err().to_string()
    };
    assert_eq!(says(|_| Ok(vec![])), "it made 0 values for 1 outputs: a fault of acme 1.2");
    assert_eq!(
        says(|_| Ok(vec![REDUCTION.into_raw()])),
        "output \"value\": it is a reduction; it must be a remark: a fault of acme 1.2"
    );
    assert_eq!(
        says(|_| Err(NodeFault::failed("the wood is wet"))),
        "the wood is wet (says acme 1.2)"
    );
    assert_eq!(says(|_| Err(NodeFault::Cancelled)), "it stopped unasked: a fault of acme 1.2");
}

#[test]
fn a_bad_definition_is_refused_with_its_origin() {
    let fault = kind_of(toy("solid", |_| Ok(vec![])), ORIGIN.to_owned()).unwrap_err().to_string();
    let words =
        "the node \"toy\" of acme 1.2 cannot be used: the input \"value\" carries \"solid\"; ";
    assert!(fault.starts_with(words), "{fault}");
}
