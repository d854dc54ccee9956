//! Paths: patterns over the plane and paths of the cutter's tip.

use super::fields::Fields;
use super::{ContactKind, Feeds, PatternSpan, PortValue, Raw, Span, SpanKind, ValueError};
use std::borrow::Cow;

/// Flags, by their code.
const FLAGS: [bool; 2] = [false, true];

/// Kinds of contact, by their code: it never changes.
const CONTACT_KINDS: [ContactKind; 4] =
    [ContactKind::None, ContactKind::Facet, ContactKind::Edge, ContactKind::Vertex];

/// Kinds of span, by their code: it never changes.
const SPAN_KINDS: [SpanKind; 4] =
    [SpanKind::Pass, SpanKind::Link, SpanKind::Plunge, SpanKind::Rapid];

fn contact_code(kind: ContactKind) -> u8 {
    match kind {
        ContactKind::None => 0,
        ContactKind::Facet => 1,
        ContactKind::Edge => 2,
        ContactKind::Vertex => 3,
    }
}

fn span_code(kind: SpanKind) -> u8 {
    match kind {
        SpanKind::Pass => 0,
        SpanKind::Link => 1,
        SpanKind::Plunge => 2,
        SpanKind::Rapid => 3,
    }
}

/// Where a cutter is to be dropped: passes over the plane and the links between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern<'a> {
    /// Points x, y in mm, in the order in which they are visited.
    pub points: Cow<'a, [[f64; 2]]>,
    /// The runs that they make up, in order, without gaps, none empty.
    pub spans: Vec<PatternSpan>,
}

impl<'a> PortValue<'a> for Pattern<'a> {
    const TYPE: &'static str = "pattern";

    fn into_raw(self) -> Raw<'a> {
        let counts = self.spans.iter().map(|span| span.points.len() as u64);
        let links = self.spans.iter().map(|span| u8::from(span.link));
        let joined = self.spans.iter().map(|span| u8::from(span.joined));
        Raw::new(Self::TYPE)
            .with_tuples("points", self.points)
            .with("span_points", counts.collect::<Vec<_>>())
            .with("span_links", links.collect::<Vec<_>>())
            .with("span_joined", joined.collect::<Vec<_>>())
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let points: Cow<'_, [[f64; 2]]> = fields.tuples("points")?;
        let counts = fields.array("span_points")?;
        let links = fields.words_of("span_links", &FLAGS, counts.len())?;
        let joined = fields.words_of("span_joined", &FLAGS, counts.len())?;
        let spans = fields.runs(&counts, points.len())?.into_iter().zip(links).zip(joined);
        let spans = spans.map(|((points, link), joined)| PatternSpan { points, link, joined });
        fields.end()?;
        Ok(Self { points, spans: spans.collect() })
    }
}

/// A path of the cutter's tip, three-axis, tool axis +Z.
#[derive(Clone, Debug, PartialEq)]
pub struct Toolpath<'a> {
    /// Positions x, y, z of the tip (CL) in mm, in the order in which they are visited.
    pub tips: Cow<'a, [[f64; 3]]>,
    /// Where the cutter touches the surface (CC) at each tip, in mm; meaningless where it touches
    /// nothing.
    pub contact_points: Cow<'a, [[f64; 3]]>,
    /// What it touches there.
    pub contact_kinds: Vec<ContactKind>,
    /// The runs that the path is made of, in order, without gaps, none empty.
    pub spans: Vec<Span>,
    /// Speeds, once they are known.
    pub feeds: Option<Feeds>,
}

impl<'a> PortValue<'a> for Toolpath<'a> {
    const TYPE: &'static str = "toolpath";

    fn into_raw(self) -> Raw<'a> {
        let counts = self.spans.iter().map(|span| span.points.len() as u64);
        let kinds = self.spans.iter().map(|span| span_code(span.kind));
        let joined = self.spans.iter().map(|span| u8::from(span.joined));
        let contacts = self.contact_kinds.into_iter().map(contact_code);
        let feeds = self.feeds.map_or(vec![], |feeds| {
            vec![feeds.cut_mm_per_min, feeds.plunge_mm_per_min, feeds.rapid_mm_per_min]
        });
        Raw::new(Self::TYPE)
            .with_tuples("tips", self.tips)
            .with_tuples("contact_points", self.contact_points)
            .with("contact_kinds", contacts.collect::<Vec<_>>())
            .with("span_points", counts.collect::<Vec<_>>())
            .with("span_kinds", kinds.collect::<Vec<_>>())
            .with("span_joined", joined.collect::<Vec<_>>())
            .with("feeds_mm_per_min", feeds)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let tips: Cow<'_, [[f64; 3]]> = fields.tuples("tips")?;
        let contact_points = fields.tuples_of("contact_points", tips.len())?;
        let contact_kinds = fields.words_of("contact_kinds", &CONTACT_KINDS, tips.len())?;
        let counts = fields.array("span_points")?;
        let kinds = fields.words_of("span_kinds", &SPAN_KINDS, counts.len())?;
        let joined = fields.words_of("span_joined", &FLAGS, counts.len())?;
        let feeds = fields.none_or("feeds_mm_per_min")?;
        let spans = fields.runs(&counts, tips.len())?.into_iter().zip(kinds).zip(joined);
        let spans = spans.map(|((points, kind), joined)| Span { points, kind, joined }).collect();
        fields.end()?;
        Ok(Self { tips, contact_points, contact_kinds, spans, feeds: feeds.map(feeds_of) })
    }
}

fn feeds_of([cut_mm_per_min, plunge_mm_per_min, rapid_mm_per_min]: [f64; 3]) -> Feeds {
    Feeds { cut_mm_per_min, plunge_mm_per_min, rapid_mm_per_min }
}
