//! What holds for the values of all types.

use super::*;
use carvegraph_geometry::{Profile, Segment};
use std::borrow::Cow;

/// One well-formed value of each type.
pub(crate) fn samples() -> Vec<Raw<'static>> {
    let bounds = Bounds { min: DVec3::new(-1.0, 0.0, 0.5), max: DVec3::new(1.0, 2.0, 3.0) };
    vec![
        bounds.into_raw(),
        cutter().into_raw(),
        Gcode { text: b"G0 X1\n"[..].into(), dialect: "grbl".into(), extension: "nc".into() }
            .into_raw(),
        GrayImage { width: 3, height: 1, values: vec![0.0, 0.5, 1.0].into() }.into_raw(),
        field().into_raw(),
        image(Samples::U16(vec![7; 12].into())).into_raw(),
        Mesh { vertices: vec![[0.0, 1.0, 2.0]; 3].into(), triangles: vec![[0, 1, 2]].into() }
            .into_raw(),
        pattern().into_raw(),
        PointCloud { points: vec![[0.0, 1.0, 2.0]; 6].into(), grid: Some((3, 2)) }.into_raw(),
        reduction().into_raw(),
        Remark { text: "ü".into() }.into_raw(),
        toolpath().into_raw(),
    ]
}

fn cutter() -> Cutter {
    let segments = vec![
        Segment::Line { to: [2.0, 0.0] },
        Segment::Arc { to: [3.0, 1.0], center: [2.0, 1.0] },
        Segment::Line { to: [3.0, 4.0] },
    ];
    Cutter { name: "bull".to_owned(), profile: Profile::new(segments).unwrap() }
}

fn field() -> HeightField<'static> {
    HeightField { columns: 3, rows: 2, pitch_mm: 0.1, heights: vec![1.0; 6].into() }
}

fn image(samples: Samples<'static>) -> Image<'static> {
    Image { width: 2, height: 2, channels: Channels::Rgb, samples }
}

fn pattern() -> Pattern<'static> {
    let spans = vec![
        PatternSpan { points: 0..2, link: false, joined: false },
        PatternSpan { points: 2..3, link: true, joined: true },
    ];
    Pattern { points: vec![[0.0, 1.0]; 3].into(), spans }
}

fn reduction() -> Reduction {
    Reduction {
        points_in: 10,
        points_out: 4,
        max_deviation_mm: 0.01,
        max_above_mm: 0.009,
        max_below_mm: 0.001,
    }
}

fn toolpath() -> Toolpath<'static> {
    use ContactKind::{Edge, Facet, None, Vertex};
    use SpanKind::{Link, Pass, Plunge, Rapid};
    let span = |(k, kind)| Span { points: k..k + 1, kind, joined: k > 0 };
    Toolpath {
        tips: vec![[0.0, 1.0, 2.0]; 4].into(),
        contact_points: vec![[3.0, 4.0, 5.0]; 4].into(),
        contact_kinds: vec![None, Facet, Edge, Vertex],
        spans: [Pass, Link, Plunge, Rapid].into_iter().enumerate().map(span).collect(),
        feeds: Some(Feeds {
            cut_mm_per_min: 600.0,
            plunge_mm_per_min: 300.0,
            rapid_mm_per_min: 3000.0,
        }),
    }
}

/// The sample of type `name` with its array `array` made into something else.
fn spoilt(name: &str, array: &str, elements: impl Into<Elements<'static>>) -> String {
    let mut raw = samples().into_iter().find(|raw| raw.type_name == name).unwrap();
    let spoilt = raw.arrays.iter_mut().find(|known| known.name == array).unwrap();
    spoilt.elements = elements.into();
    check(&raw).unwrap_err().to_string()
}

/// Type, array and elements of each line of the table in `carvegraph.h`.
fn table() -> Vec<(String, String, String)> {
    let header = include_str!("../../../abi/carvegraph.h");
    let (_, table) = header.split_once("A value at a port").unwrap();
    let (table, _) = table.split_once("*/").unwrap();
    let mut rows = Vec::new();
    let mut of = String::new();
    for line in table.lines().skip_while(|line| !line.contains(" type ")).skip(1) {
        let columns: Vec<&str> = line.trim_start_matches(" *").split_whitespace().collect();
        // A line whose second column is empty goes on with the description.
        let starts_type = line.get(5..6).is_some_and(|c| c != " ");
        let continues = line.get(18..19).is_none_or(|c| c == " ");
        match columns.as_slice() {
            [] => {}
            _ if continues => {}
            [type_name, array, elements, ..] if starts_type => {
                of = (*type_name).to_owned();
                rows.push((of.clone(), (*array).to_owned(), (*elements).to_owned()));
            }
            [array, elements, ..] => {
                rows.push((of.clone(), (*array).to_owned(), (*elements).to_owned()));
            }
            [_] => panic!("{line}"),
        }
    }
    rows
}

#[test]
fn types_are_sorted_and_every_one_has_a_sample() {
    assert!(TYPES.is_sorted());
    let names: Vec<_> = samples().iter().map(|raw| raw.type_name.to_string()).collect();
    assert_eq!(names, TYPES);
}

#[test]
fn the_header_lists_every_array_of_every_type_in_order() {
    let array = |raw: &Raw<'_>, array: &RawArray<'_>| {
        let element = match (array.name.as_ref(), array.elements.element()) {
            ("samples", _) => "u8/u16/f32",
            (_, element) => element,
        };
        (raw.type_name.to_string(), array.name.to_string(), element.to_owned())
    };
    let samples = samples();
    let arrays = samples.iter().flat_map(|raw| raw.arrays.iter().map(|known| array(raw, known)));
    assert_eq!(table(), arrays.collect::<Vec<_>>());
}

#[test]
fn what_crosses_comes_back_equal() {
    for raw in samples() {
        assert_eq!(check(&raw), Ok(()));
    }
    let (bull, path) = (cutter().into_raw(), toolpath().into_raw());
    assert_eq!(Cutter::from_raw(&bull), Ok(cutter()));
    assert_eq!(Toolpath::from_raw(&path), Ok(toolpath()));
    assert_eq!(Reduction::read(reduction().into_raw()), Ok(reduction()));
    assert_eq!(Pattern::read(pattern().into_raw()), Ok(pattern()));
    for samples in [
        Samples::U8(vec![1; 12].into()),
        Samples::U16(vec![2; 12].into()),
        Samples::F32(vec![0.3; 12].into()),
    ] {
        assert_eq!(Image::read(image(samples.clone()).into_raw()), Ok(image(samples)));
    }
}

#[test]
fn nothing_big_is_copied_on_its_way_in() {
    let heights = vec![1.0_f32; 6];
    let view = HeightField { heights: heights.as_slice().into(), ..field() };
    let raw = view.into_raw();
    assert_eq!(HeightField::from_raw(&raw).unwrap().heights.as_ptr(), heights.as_ptr());
    let tips = vec![0.0_f64; 9];
    let raw =
        Raw::new("point_cloud").with("points", tips.as_slice()).with("grid", Vec::<u64>::new());
    let cloud = PointCloud::from_raw(&raw).unwrap();
    assert_eq!(cloud.points.as_ptr().cast(), tips.as_ptr());
}

#[test]
fn what_is_owned_is_taken_over() {
    let heights = vec![1.0_f32; 6];
    let place = heights.as_ptr();
    let raw = HeightField { heights: heights.into(), ..field() }.into_raw();
    let Cow::Owned(heights) = HeightField::read(raw).unwrap().heights else { panic!("borrowed") };
    assert_eq!(heights.as_ptr(), place);
}

#[test]
fn other_types_and_arrays_are_refused() {
    let type_of = |raw: &Raw<'_>| Mesh::from_raw(raw).unwrap_err().to_string();
    assert_eq!(type_of(&field().into_raw()), "it is a height_field; it must be a mesh");
    let unknown = Raw::new("solid\n").with("x", vec![0_u8]);
    let message = check(&unknown).unwrap_err().to_string();
    assert!(
        message.starts_with("there is no type \"solid\\\\n\"; there are bounds, "),
        "{message}"
    );

    let mut raw = field().into_raw();
    let heights = raw.arrays.pop().unwrap();
    let fault = |raw: &Raw<'_>| check(raw).unwrap_err().to_string();
    assert_eq!(fault(&raw), "the height_field ends before its array \"heights\"");
    raw.arrays.push(RawArray { name: "z".into(), ..heights.clone() });
    assert_eq!(fault(&raw), "the height_field has an array \"z\" where \"heights\" must stand");
    raw.arrays.pop();
    raw.arrays.extend([heights.clone(), heights]);
    assert_eq!(fault(&raw), "the height_field has an array \"heights\" more than it must have");
}

#[test]
fn wrong_elements_and_lengths_are_refused() {
    assert_eq!(
        spoilt("height_field", "heights", vec![0.0_f64; 6]),
        "\"heights\" of the height_field is of f64; it must be of f32"
    );
    assert_eq!(
        spoilt("height_field", "heights", vec![0.0_f32; 5]),
        "\"heights\" of the height_field has 5 elements; it must have 3 × 2"
    );
    assert_eq!(
        spoilt("height_field", "rows", vec![u64::MAX]),
        format!("\"heights\" of the height_field has 6 elements; it must have 3 × {}", usize::MAX)
    );
    assert_eq!(
        spoilt("height_field", "pitch_mm", vec![1.0, 2.0]),
        "\"pitch_mm\" of the height_field has 2 elements; it must have 1"
    );
    assert_eq!(
        spoilt("image", "samples", vec![0_u32; 12]),
        "\"samples\" of the image is of u32; it must be of u8, u16 or f32"
    );
    assert_eq!(
        spoilt("image", "channels", vec![5_u64]),
        "the image has 5 samples a pixel; it must have 1 to 4"
    );
    assert_eq!(
        spoilt("gray_image", "values", vec![0.0_f32; 2]),
        "\"values\" of the gray_image has 2 elements; it must have 3 × 1"
    );
    assert_eq!(
        spoilt("point_cloud", "points", vec![0.0; 17]),
        "\"points\" of the point_cloud has 17 elements; it must have a multiple of 3"
    );
    assert_eq!(
        spoilt("point_cloud", "grid", vec![2_u64, 2]),
        "\"points\" of the point_cloud has 18 elements; it must have 3 × 2 × 2, as the grid says"
    );
    assert_eq!(
        spoilt("point_cloud", "grid", vec![6_u64]),
        "\"grid\" of the point_cloud has 1 elements; it must have 2 or none"
    );
    assert_eq!(
        spoilt("bounds", "min_mm", vec![0.0; 2]),
        "\"min_mm\" of the bounds has 2 elements; it must have 3"
    );
    assert_eq!(
        spoilt("toolpath", "contact_points", vec![0.0; 9]),
        "\"contact_points\" of the toolpath has 9 elements; it must have 3 for each of 4"
    );
    assert_eq!(
        spoilt("toolpath", "contact_kinds", vec![0_u8; 5]),
        "\"contact_kinds\" of the toolpath has 5 elements; it must have 4"
    );
    assert_eq!(
        spoilt("toolpath", "feeds_mm_per_min", vec![600.0]),
        "\"feeds_mm_per_min\" of the toolpath has 1 elements; it must have 3 or none"
    );
}

#[test]
fn indices_and_codes_that_lead_nowhere_are_refused() {
    assert_eq!(
        spoilt("mesh", "triangles", vec![0_u32, 1, 2, 0, 3, 1]),
        "element 4 of \"triangles\" of the mesh is 3; it must be below 3"
    );
    assert_eq!(
        spoilt("toolpath", "contact_kinds", vec![0_u8, 1, 2, 4]),
        "element 3 of \"contact_kinds\" of the toolpath is 4; it must be below 4"
    );
    assert_eq!(
        spoilt("pattern", "span_links", vec![0_u8, 2]),
        "element 1 of \"span_links\" of the pattern is 2; it must be below 2"
    );
    assert_eq!(
        spoilt("cutter", "segment_kinds", vec![0_u8, 1, 2]),
        "element 2 of \"segment_kinds\" of the cutter is 2; it must be below 2"
    );
}

#[test]
fn spans_hold_every_point_once() {
    let of_counts = |counts: [u64; 2]| spoilt("pattern", "span_points", counts.to_vec());
    assert_eq!(of_counts([3, 0]), "span 1 of the pattern has no point; leave it out");
    assert_eq!(of_counts([2, 2]), "span 1 of the pattern has 2 points, but only 1 are left for it");
    assert_eq!(
        of_counts([u64::MAX, 2]),
        format!("span 0 of the pattern has {} points, but only 3 are left for it", u64::MAX)
    );
    assert_eq!(
        of_counts([1, 1]),
        "the spans of the pattern hold 2 of its 3 points; they must hold all"
    );
}

#[test]
fn texts_and_profiles_are_checked() {
    assert_eq!(spoilt("remark", "text", vec![0xff_u8]), "\"text\" of the remark is not UTF-8");
    assert_eq!(
        spoilt("cutter", "segment_ends", vec![2.0, 0.0, f64::NAN, 1.0, 3.0, 4.0]),
        "segment 2 of the profile holds a number that is not finite"
    );
}

#[test]
fn an_empty_path_is_one() {
    let empty = Toolpath {
        tips: vec![].into(),
        contact_points: vec![].into(),
        contact_kinds: vec![],
        spans: vec![],
        feeds: None,
    };
    assert_eq!(Toolpath::read(empty.clone().into_raw()), Ok(empty));
}
