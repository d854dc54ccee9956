//! How geometry's types cross.
//!
//! A [`DVec3`] is laid out as three numbers, but safe Rust has no view of many of them as numbers: points
//! are copied once each way. Heights and triangles are not.

use super::crossing::{Crosses, MAX_CL_POINTS, MAX_NODES, OutputFault, check_count, check_finite};
use crate::output::MAX_TRIANGLES;
use carvegraph_geometry::{
    Bounds, Contact, Cutter, DVec2, DVec3, Feeds, HeightField, Mesh, Pattern, PointCloud,
    Reduction, Toolpath,
};
use carvegraph_sdk::value as seen;
use std::borrow::Cow;
use std::sync::Arc;

/// Segments of a profile: a traced drawing has some hundred.
const MAX_SEGMENTS: usize = 100_000;

fn numbers(points: &[DVec3]) -> Cow<'static, [[f64; 3]]> {
    points.iter().map(DVec3::to_array).collect()
}

fn points(numbers: Cow<'_, [[f64; 3]]>) -> Vec<DVec3> {
    numbers.into_owned().into_iter().map(DVec3::from_array).collect()
}

impl Crosses for Bounds {
    type Seen<'a> = Self;

    fn seen(&self) -> Self {
        *self
    }

    fn taken(made: Self) -> Result<Self, OutputFault> {
        check_finite("corner", &[made.min.to_array(), made.max.to_array()])?;
        if made.min.cmple(made.max).all() {
            return Ok(made);
        }
        let (min, max) = (made.min.to_string(), made.max.to_string());
        Err(OutputFault::Inverted { min, max })
    }
}

impl Crosses for Cutter {
    type Seen<'a> = Self;

    fn seen(&self) -> Self {
        self.clone()
    }

    fn taken(made: Self) -> Result<Self, OutputFault> {
        check_count("segments", made.profile.segments().len(), MAX_SEGMENTS)?;
        super::values::check_line("name", &made.name)?;
        Ok(made)
    }
}

impl Crosses for HeightField {
    type Seen<'a> = seen::HeightField<'a>;

    fn seen(&self) -> seen::HeightField<'_> {
        seen::HeightField {
            columns: self.columns(),
            rows: self.rows(),
            pitch_mm: self.pitch_mm(),
            heights: self.heights().into(),
        }
    }

    fn taken(made: seen::HeightField<'static>) -> Result<Self, OutputFault> {
        check_count("heights", made.heights.len(), MAX_NODES)?;
        Ok(Self::new(made.columns, made.rows, made.pitch_mm, made.heights.into_owned())?)
    }
}

impl Crosses for Mesh {
    type Seen<'a> = seen::Mesh<'a>;

    fn seen(&self) -> seen::Mesh<'_> {
        seen::Mesh {
            vertices: numbers(&self.vertices),
            triangles: self.triangles.as_slice().into(),
        }
    }

    fn taken(made: seen::Mesh<'static>) -> Result<Self, OutputFault> {
        check_count("vertices", made.vertices.len(), MAX_NODES)?;
        check_count("triangles", made.triangles.len(), MAX_TRIANGLES)?;
        check_finite("vertex", &made.vertices)?;
        let vertices = Arc::new(points(made.vertices));
        Ok(Self { vertices, triangles: made.triangles.into_owned() })
    }
}

impl Crosses for PointCloud {
    type Seen<'a> = seen::PointCloud<'a>;

    fn seen(&self) -> seen::PointCloud<'_> {
        seen::PointCloud { points: numbers(&self.points), grid: self.grid }
    }

    fn taken(made: seen::PointCloud<'static>) -> Result<Self, OutputFault> {
        check_count("points", made.points.len(), MAX_NODES)?;
        check_finite("point", &made.points)?;
        Ok(Self { points: Arc::new(points(made.points)), grid: made.grid })
    }
}

impl Crosses for Pattern {
    type Seen<'a> = seen::Pattern<'a>;

    fn seen(&self) -> seen::Pattern<'_> {
        let points = self.points.iter().map(DVec2::to_array).collect();
        seen::Pattern { points, spans: self.spans.clone() }
    }

    fn taken(made: seen::Pattern<'static>) -> Result<Self, OutputFault> {
        check_count("points", made.points.len(), MAX_CL_POINTS)?;
        check_finite("point", &made.points)?;
        let points = made.points.into_owned().into_iter().map(DVec2::from_array).collect();
        Ok(Self { points, spans: made.spans })
    }
}

/// Plugins see arcs as chords so close to them, in mm: what a program's last decimal can say.
const ARC_TOLERANCE_MM: f64 = 0.001;

impl Crosses for Toolpath {
    type Seen<'a> = seen::Toolpath<'a>;

    fn seen(&self) -> seen::Toolpath<'_> {
        let path = self.flattened(ARC_TOLERANCE_MM);
        seen::Toolpath {
            tips: numbers(&path.tips),
            contact_points: path.contacts.iter().map(|contact| contact.point.to_array()).collect(),
            contact_kinds: path.contacts.iter().map(|contact| contact.kind).collect(),
            spans: path.spans.clone(),
            feeds: path.feeds,
        }
    }

    fn taken(made: seen::Toolpath<'static>) -> Result<Self, OutputFault> {
        check_count("points", made.tips.len(), MAX_CL_POINTS)?;
        check_finite("tip", &made.tips)?;
        check_finite("contact", &made.contact_points)?;
        made.feeds.as_ref().map_or(Ok(()), check_feeds)?;
        let contacts = made.contact_points.iter().zip(made.contact_kinds);
        let contact = |(point, kind): (&[f64; 3], _)| Contact { point: (*point).into(), kind };
        Ok(Self {
            contacts: contacts.map(contact).collect(),
            tips: points(made.tips),
            spans: made.spans,
            feeds: made.feeds,
            arcs: Vec::new(),
        })
    }
}

fn check_feeds(feeds: &Feeds) -> Result<(), OutputFault> {
    let speeds = [
        ("feed of passes in mm/min", feeds.cut_mm_per_min),
        ("feed of plunges in mm/min", feeds.plunge_mm_per_min),
        ("speed of rapids in mm/min", feeds.rapid_mm_per_min),
    ];
    check_measures(&speeds, "above 0", |value| value > 0.0)
}

fn check_measures(
    measures: &[(&'static str, f64)],
    wanted: &'static str,
    fits: impl Fn(f64) -> bool,
) -> Result<(), OutputFault> {
    match measures.iter().find(|(_, value)| !(value.is_finite() && fits(*value))) {
        None => Ok(()),
        Some(&(what, value)) => Err(OutputFault::Measure { what, value, wanted }),
    }
}

impl Crosses for Reduction {
    type Seen<'a> = Self;

    fn seen(&self) -> Self {
        *self
    }

    fn taken(made: Self) -> Result<Self, OutputFault> {
        let distances = [
            ("greatest deviation in mm", made.max_deviation_mm),
            ("greatest excess in mm", made.max_above_mm),
            ("greatest gouge in mm", made.max_below_mm),
        ];
        check_measures(&distances, "0 or more", |value| value >= 0.0)?;
        Ok(made)
    }
}
