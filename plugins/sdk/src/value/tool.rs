//! What is carved and with what: boxes and cutters, in geometry's own types.

use super::fields::Fields;
use super::{Bounds, Cutter, DVec3, PortValue, Raw, ValueError};
use carvegraph_geometry::{Profile, Segment};
use std::borrow::Cow;

impl<'a> PortValue<'a> for Bounds {
    const TYPE: &'static str = "bounds";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with("min_mm", self.min.to_array().to_vec())
            .with("max_mm", self.max.to_array().to_vec())
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let mut corner = |name| fields.array_of(name, 3).map(|corner| DVec3::from_slice(&corner));
        let (min, max) = (corner("min_mm")?, corner("max_mm")?);
        fields.end()?;
        Ok(Self { min, max })
    }
}

/// Whether a segment is an arc, by its code: `CG_LINE`, `CG_ARC`.
const IS_ARC: [bool; 2] = [false, true];

impl<'a> PortValue<'a> for Cutter {
    const TYPE: &'static str = "cutter";

    fn into_raw(self) -> Raw<'a> {
        let segments = self.profile.segments();
        let kind = |segment: &Segment| u8::from(matches!(segment, Segment::Arc { .. }));
        let center = |segment: &Segment| match *segment {
            Segment::Line { .. } => [0.0; 2],
            Segment::Arc { center, .. } => center,
        };
        Raw::new(Self::TYPE)
            .with_text("name", Cow::Owned(self.name))
            .with("segment_kinds", segments.iter().map(kind).collect::<Vec<_>>())
            .with_tuples("segment_ends", segments.iter().map(Segment::to).collect())
            .with_tuples("segment_centers", segments.iter().map(center).collect())
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let name = fields.text("name")?.into_owned();
        let kinds = fields.words("segment_kinds", &IS_ARC)?;
        let ends = fields.tuples_of::<f64, 2>("segment_ends", kinds.len())?;
        let centers = fields.tuples_of::<f64, 2>("segment_centers", kinds.len())?;
        fields.end()?;
        let segments = kinds.into_iter().zip(ends.iter().zip(centers.iter()));
        let segments =
            segments.map(
                |(is_arc, (&to, &center))| {
                    if is_arc { Segment::Arc { to, center } } else { Segment::Line { to } }
                },
            );
        Ok(Self { name, profile: Profile::new(segments.collect())? })
    }
}
