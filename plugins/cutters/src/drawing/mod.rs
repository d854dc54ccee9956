//! From an SVG drawing to a cutter's profile.
//!
//! # What is drawn
//! The right half of the cutter as one open path, polyline or line: from the tip, on the axis and
//! the lowest point, outward and upward to the rim, or the other way round. The axis is the upright
//! line through the tip. If the drawing shows more shapes, the profile is the one whose id or Inkscape
//! label is `profile`; what is hidden or only defined does not count.
//!
//! # Scale
//! As in SVG 2, chapter 8: `width` and `height` over `viewBox`, if they are absolute lengths; else 96
//! units an inch. Transforms of the shape and of the groups around it are honoured.
//!
//! # What becomes of it
//! | drawn | profile |
//! |---|---|
//! | straight | line |
//! | circular arc that curves upward (a cove bit's) | the same arc |
//! | circular arc that curves downward (a round-over bit's) | chords within [`WITHIN_MM`] |
//! | elliptic arc, Bézier curve, curving downward | chords within [`WITHIN_MM`] |
//! | the same, curving upward | tangents within [`WITHIN_MM`] |
//!
//! Chords of a curve that curves downward and tangents of one that curves upward both lie below it, so
//! the cutter is taken for larger, never smaller, than drawn: it stays off the surface rather than
//! cutting into it. Distances are measured square to the curve. An arc counts as circular if its axes differ by no more than [`CIRCLE_MM`].
//!
//! Steps back or aside by no more than [`NOISE_MM`] are taken for noise of the drawing program and
//! straightened. Any other step inward or down is an undercut, which no tool from above can be, and
//! refused.
//!
//! Modules, in the order of the work: [`sheet`] finds the shape and its scale, [`outline`] reads its
//! curves, [`curve`] parts and flattens them, [`chain`] makes the profile.

mod chain;
mod curve;
mod outline;
mod sheet;

use carvegraph_sdk::{DimensionSpec, Profile, ProfileError};

/// How far line chains may lie below the curves drawn, in mm: a hundredth of what a good machine
/// repeats.
const WITHIN_MM: f64 = 1e-3;

/// Steps back or aside up to this, in mm, are noise: drawing programs write six to eight digits.
const NOISE_MM: f64 = 1e-6;

/// An ellipse whose semi-axes differ by less, in mm, is a circle with rounded numbers.
const CIRCLE_MM: f64 = 1e-4;

/// The longest text read, in bytes. A drawn profile has a few thousand.
const MAX_BYTES: usize = 256 * 1024;

/// XML namespaces; reading takes time by their square. Drawing programs declare a dozen.
const MAX_NAMESPACES: usize = 100;

/// Commands in the path. CAD programs that write curves as lines make some hundred.
const MAX_COMMANDS: usize = 2_000;

/// Segments of the profile; each costs time at every place the cutter is dropped.
const MAX_SEGMENTS: usize = 2_000;

/// How far from its first point the drawing may reach, in mm.
const MAX_REACH_MM: f64 = 1_000.0;

/// Why a drawing gives no profile. Places (r, h) are in mm from the axis and above the tip.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum DrawingError {
    #[error(
        "the drawing has {0} bytes; at most {MAX_BYTES} are read. Save it as plain SVG, without pictures \
         in it"
    )]
    TooLong(usize),
    #[error(
        "the drawing defines entities (<!ENTITY ...>), which could blow up and are not read. Save it as \
         plain SVG"
    )]
    Entities,
    #[error("the drawing declares more than {MAX_NAMESPACES} XML namespaces. Save it as plain SVG")]
    TooManyNamespaces,
    #[error("the drawing is not SVG that can be read: {0}")]
    Xml(#[from] roxmltree::Error),
    #[error("the drawing is a <{0}> document; it must be an <svg>")]
    NotSvg(String),
    #[error("the drawing's {what} {text:?} cannot be read: {why}")]
    Unreadable { what: &'static str, text: String, why: String },
    #[error("the drawing shows no path, polyline or line to take the profile from")]
    NoShape,
    #[error(
        "the drawing shows {0} shapes; leave only the profile, or give the profile the id \"profile\""
    )]
    Several(usize),
    #[error("{0} shapes of the drawing have the id or label \"profile\"; leave it to one")]
    SeveralProfiles(usize),
    #[error(
        "the profile is drawn as a <{0}>; it must be an open path. Convert it to a path and leave only the \
         edge from the tip to the rim"
    )]
    NotOpen(String),
    #[error(
        "the profile is a closed path; open it and leave only the edge from the tip to the rim, without \
         the axis and the top"
    )]
    Closed,
    #[error("the profile is in several pieces; join them to one path")]
    Pieces,
    #[error("the profile stands in an <svg> within the <svg>; move it out into the drawing itself")]
    Nested,
    #[error(
        "the profile or a group around it is transformed by its style; write the transform as an attribute"
    )]
    StyleTransform,
    #[error("the profile has more than {MAX_COMMANDS} path commands; simplify the path")]
    TooManyCommands,
    #[error(
        "the profile needs more than {MAX_SEGMENTS} lines and arcs; simplify the path, or check the \
         drawing's scale"
    )]
    TooManySegments,
    #[error(
        "the profile reaches more than {MAX_REACH_MM} mm; check the drawing's width, height and viewBox, \
         which give its scale"
    )]
    TooFar,
    #[error("the profile runs to the left of its tip; draw the right half of the cutter")]
    LeftHalf,
    #[error(
        "the drawing makes a cutter of {} mm in diameter; it must be {} to {} mm. Check the drawing's \
         width, height and viewBox, which give its scale",
        rounded(*diameter_mm), DimensionSpec::DIAMETER.min, DimensionSpec::DIAMETER.max
    )]
    Diameter { diameter_mm: f64 },
    #[error(
        "the profile goes {way} from r {} mm, h {} mm to r {} mm, h {} mm (r from the axis, h \
         above the tip); a cutter with an undercut can't be used, so draw it running outward and upward \
         only",
        rounded(.from[0]), rounded(.from[1]), rounded(.to[0]), rounded(.to[1])
    )]
    Falls { way: &'static str, from: [f64; 2], to: [f64; 2] },
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

/// A length in mm to six places, as far as noise goes.
fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}

/// The profile drawn in an SVG `text`.
///
/// # Errors
/// If the text is no drawing of one profile, or longer or larger than the limits.
pub(crate) fn profile(text: &str) -> Result<Profile, DrawingError> {
    if text.len() > MAX_BYTES {
        return Err(DrawingError::TooLong(text.len()));
    }
    let curves = sheet::profile_curves(text)?;
    chain::profile(&curves)
}
