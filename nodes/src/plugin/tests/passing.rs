//! What passes through a plugin comes back bit for bit.

use super::*;
use crate::values::{Channels, Gcode, GrayImage, Image, Remark, Samples};
use carvegraph_geometry::{
    Bounds, Cutter, DVec2, HeightField, Mesh, Pattern, PatternSpan, PointCloud, Profile, Segment,
};
use carvegraph_sdk::value as seen;
use carvegraph_sdk::value::PortValue;

/// Gives what it gets.
fn echo(type_name: &'static str) -> Box<dyn Node> {
    toy(type_name, |job| Ok(job.inputs().iter().flatten().cloned().map(Raw::into_owned).collect()))
}

/// Whether a value comes back bit for bit: what `Debug` shows tells -0 from 0 and rounds nothing.
#[track_caller]
fn passes<T: Any + Send + Sync + std::fmt::Debug + Clone>(type_name: &'static str, value: T) {
    let made = through(echo(type_name), value.clone()).unwrap();
    let made = made[0].downcast_ref::<T>().unwrap();
    assert_eq!(format!("{made:?}"), format!("{value:?}"));
}

fn image(channels: Channels, samples: Samples) -> Image {
    Image { width: 2, height: 1, channels, samples }
}

#[test]
fn pictures_pass_unharmed() {
    let values = vec![0.0, -0.0, f32::MIN_POSITIVE, 1.0 / 3.0, f32::MAX, -7.5];
    passes("gray_image", GrayImage { width: 3, height: 2, values });
    passes("image", image(Channels::Gray, Samples::U8(vec![0, 255])));
    passes("image", image(Channels::GrayAlpha, Samples::U16(vec![0, 1, 2, 65535])));
    passes("image", image(Channels::Rgb, Samples::F32(vec![0.1, f32::NAN, 3.0, 4.0, 5.0, 6.0])));
    passes("image", image(Channels::Rgba, Samples::U8((0..8).collect())));
}

#[test]
fn surfaces_pass_unharmed() {
    let heights = (0..12).map(|k| k as f32 / 7.0).collect();
    passes("height_field", HeightField::new(4, 3, 0.1, heights).unwrap());
    let points = Arc::new((0..6).map(point).collect::<Vec<_>>());
    passes("point_cloud", PointCloud { points: Arc::clone(&points), grid: Some((3, 2)) });
    passes("point_cloud", PointCloud { points: Arc::clone(&points), grid: None });
    passes("mesh", Mesh { vertices: points, triangles: vec![[0, 1, 5], [2, 4, 3]] });
    passes("bounds", Bounds { min: point(0), max: point(0) + DVec3::ONE });
}

#[test]
fn paths_pass_unharmed() {
    passes("toolpath", path());
    passes("toolpath", Toolpath { feeds: None, ..path() });
    passes("toolpath", Toolpath::default());
    let span = |points, link, joined| PatternSpan { points, link, joined };
    let spans = vec![span(0..2, false, false), span(2..3, true, true), span(3..5, false, true)];
    let points = (0..5).map(|k| DVec2::new(k as f64 / 3.0, -0.0)).collect();
    passes("pattern", Pattern { points, spans });
    passes("reduction", REDUCTION);
}

#[test]
fn cutters_and_texts_pass_unharmed() {
    let cutter = |profile| Cutter { name: "its name".to_owned(), profile };
    passes("cutter", cutter(Profile::ball(3.0).unwrap()));
    passes("cutter", cutter(Profile::bull_nose(3.1, 0.7).unwrap()));
    let steps = [[1.0, 0.0], [1.0, 2.0], [3.0, 2.5]].map(|to| Segment::Line { to });
    passes("cutter", cutter(Profile::new(steps.to_vec()).unwrap()));
    let (dialect, extension) = ("grbl".to_owned(), "nc".to_owned());
    passes("gcode", Gcode::single(b"G1\r\n\xff".to_vec(), dialect, extension));
    passes("remark", Remark { text: "Größe".to_owned() });
}

#[test]
fn several_programs_are_not_shown_as_one() {
    let mut two = Gcode::single(b"G1\n".to_vec(), "grbl".to_owned(), "nc".to_owned());
    two.programs.push(two.programs[0].clone());
    let fault = through(echo("gcode"), two).unwrap_err().to_string();
    assert_eq!(
        fault,
        "input \"value\": it is 2 programs, one for each tool, and a plugin takes one"
    );
}

#[test]
fn a_surface_is_lent_not_copied() {
    let field = HeightField::new(2, 2, 0.1, vec![1.0; 4]).unwrap();
    let place = field.heights().as_ptr() as usize;
    let node = toy("height_field", move |job| {
        let seen: seen::HeightField<'_> = job.input("value")?;
        assert_eq!(seen.heights.as_ptr() as usize, place);
        Ok(vec![seen.with_heights(vec![2.0; 4]).into_raw()])
    });
    let made = through(node, field).unwrap();
    assert_eq!(made[0].downcast_ref::<HeightField>().unwrap().heights(), [2.0; 4]);
}
