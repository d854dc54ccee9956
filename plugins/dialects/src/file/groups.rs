//! The settings that a dialect's file says in groups.

use super::fields::{Choice, EIGHT_DIGITS, Field, Kind, field};
use super::rules::{bad_close, bad_open, bad_prefix, bad_punctuation};
use crate::block::Numbering;
use crate::comment::{CommentStyle, brackets};
use crate::front::{Arcs, FEED_LIMIT_MM_PER_MIN};
use crate::number::FeedUnit;
use crate::rs274::{Center, Rs274};
use carvegraph_core::units::Dimension;

/// Decimals beyond are finer than any machine, and than what `f64` rounds exactly at a kilometre.
const DECIMALS: [u32; 2] = [0, 5];

/// Feeds a controller can be told: from one a rounding cannot take away.
const FEEDS: [f64; 2] = [1.0, FEED_LIMIT_MM_PER_MIN];

/// No arc is divided into more than four.
const SWEEPS: [f64; 2] = [90.0, 360.0];

/// Five digits: more than that not every controller reads.
const LAST_NUMBER: u32 = 99_999;

pub(super) fn arcs(settings: &mut Rs274) -> &mut Arcs {
    settings.arcs.get_or_insert(Arcs::ALL)
}

pub(super) fn comments(settings: &mut Rs274) -> &mut CommentStyle {
    settings.comments.get_or_insert_with(brackets)
}

pub(super) fn numbering(settings: &mut Rs274) -> &mut Numbering {
    settings.numbering.get_or_insert_with(|| Numbering {
        prefix: "N".into(),
        first: 10,
        step: 10,
        last: LAST_NUMBER,
    })
}

pub(super) const WORDS: &[Field] = &[
    field("rapid", "Travels.", Kind::Word(|s| &mut s.words.rapid)),
    field("feed", "Cuts a line.", Kind::Word(|s| &mut s.words.feed)),
    field("arc_clockwise", "Cuts an arc clockwise.", Kind::Word(|s| &mut s.words.clockwise)),
    field(
        "arc_counterclockwise",
        "Cuts an arc counter-clockwise.",
        Kind::Word(|s| &mut s.words.counterclockwise),
    ),
    field("plane_xy", "Arcs in XY.", Kind::Word(|s| &mut s.words.planes[0])),
    field("plane_zx", "Arcs in ZX.", Kind::Word(|s| &mut s.words.planes[1])),
    field("plane_yz", "Arcs in YZ.", Kind::Word(|s| &mut s.words.planes[2])),
    field(
        "mm",
        "What {{ units }} is in a program in millimetres.",
        Kind::Word(|s| &mut s.words.mm),
    ),
    field("inch", "What {{ units }} is in a program in inches.", Kind::Word(|s| &mut s.words.inch)),
    field(
        "repeat",
        "Whether every block has its motion word, because the controller forgets it.",
        Kind::Switch(|s| &mut s.repeat_motion),
    ),
];

pub(super) const NUMBERS: &[Field] = &[
    field(
        "decimals_mm",
        "Decimals of a millimetre; up to 3 are rounded exactly.",
        Kind::Count(|s| &mut s.numbers.decimals_mm, DECIMALS),
    ),
    field(
        "decimals_inch",
        "Decimals of an inch; up to 4 are rounded exactly.",
        Kind::Count(|s| &mut s.numbers.decimals_inch, DECIMALS),
    ),
    field(
        "least_decimals",
        "Decimals that are written even if they are zeros: with 1 the point is never missing.",
        Kind::Count(|s| &mut s.numbers.least_decimals, DECIMALS),
    ),
    field(
        "plus",
        "Whether a sign stands before positive coordinates too.",
        Kind::Switch(|s| &mut s.numbers.plus),
    ),
    field(
        "feeds",
        "What F counts, in mm or inches: per_minute, per_second or tenth_inch_per_minute.",
        Kind::Choice(&[
            Choice {
                word: "per_minute",
                set: |s| s.feed_unit = FeedUnit::PerMinute,
                is: |s| s.feed_unit == FeedUnit::PerMinute,
            },
            Choice {
                word: "per_second",
                set: |s| s.feed_unit = FeedUnit::PerSecond,
                is: |s| s.feed_unit == FeedUnit::PerSecond,
            },
            Choice {
                word: "tenth_inch_per_minute",
                set: |s| s.feed_unit = FeedUnit::TenthInchPerMinute,
                is: |s| s.feed_unit == FeedUnit::TenthInchPerMinute,
            },
        ]),
    ),
];

pub(super) const ARCS: &[Field] = &[
    field(
        "centers",
        "How the centre is given: by I, J, K from the start (incremental) or from zero (absolute), or by the radius.",
        Kind::Choice(&[
            Choice {
                word: "incremental",
                set: |s| s.center = Center::Incremental,
                is: |s| s.center == Center::Incremental,
            },
            Choice {
                word: "absolute",
                set: |s| s.center = Center::Absolute,
                is: |s| s.center == Center::Absolute,
            },
            Choice {
                word: "radius",
                set: |s| s.center = Center::Radius,
                is: |s| s.center == Center::Radius,
            },
        ]),
    ),
    field(
        "radius_word",
        "What stands before a radius, such as \"R\" or \"CR=\".",
        Kind::Word(|s| &mut s.radius_word),
    ),
    field(
        "planes",
        "In which planes: all or xy.",
        Kind::Choice(&[
            Choice {
                word: "all",
                set: |s| arcs(s).all_planes = true,
                is: |s| s.arcs.as_ref().is_some_and(|arcs| arcs.all_planes),
            },
            Choice {
                word: "xy",
                set: |s| arcs(s).all_planes = false,
                is: |s| s.arcs.as_ref().is_some_and(|arcs| !arcs.all_planes),
            },
        ]),
    ),
    field("helices", "Whether an arc may leave its plane.", Kind::Switch(|s| &mut arcs(s).helices)),
    field(
        "largest_sweep",
        "The largest angle of one arc; wider ones are halved.",
        Kind::Number(|s| &mut arcs(s).sweep_limit_deg, Dimension::Angle, SWEEPS),
    ),
];

pub(super) const RAPIDS: &[Field] = &[
    field(
        "single_axis",
        "Whether a rapid moves one axis at a time, because the controller leaves the straight line.",
        Kind::Switch(|s| &mut s.single_axis_rapids),
    ),
    field(
        "speed",
        "The F of a rapid, where the controller has no speed of its own; or none.",
        Kind::MaybeNumber(|s| &mut s.rapid_mm_per_min, Dimension::Feed, FEEDS),
    ),
];

pub(super) const COMMENTS: &[Field] = &[
    field("open", "What begins a comment.", Kind::Text(|s| &mut comments(s).open, bad_open)),
    field(
        "close",
        "What ends it; \"\" where the line's end does.",
        Kind::Text(|s| &mut comments(s).close, bad_close),
    ),
    field(
        "upper",
        "Whether the controller knows upper case only.",
        Kind::Switch(|s| &mut comments(s).upper),
    ),
    field(
        "punctuation",
        "What may stand in a comment beside letters, digits and spaces: some of .,:+-*/=_'\"@&#% with - and .",
        Kind::Text(|s| &mut comments(s).punctuation, bad_punctuation),
    ),
];

pub(super) const LINE_NUMBERS: &[Field] = &[
    field(
        "prefix",
        "What stands before the number.",
        Kind::Text(|s| &mut numbering(s).prefix, bad_prefix),
    ),
    field(
        "first",
        "The first number.",
        Kind::Count(|s| &mut numbering(s).first, [0, EIGHT_DIGITS]),
    ),
    field(
        "step",
        "From one number to the next.",
        Kind::Count(|s| &mut numbering(s).step, [1, 10_000]),
    ),
    field(
        "last",
        "The largest number; behind it they begin again.",
        Kind::Count(|s| &mut numbering(s).last, [0, EIGHT_DIGITS]),
    ),
];

pub(super) const PROGRAM_NUMBER: &[Field] = &[
    field(
        "digits",
        "How many digits, zeros before it.",
        Kind::Count(|s| &mut s.program_number.digits, [1, 8]),
    ),
    field(
        "largest",
        "The largest; 8000 to 9999 are never used.",
        Kind::Count(|s| &mut s.program_number.limit, [1, EIGHT_DIGITS]),
    ),
];

pub(super) const SPINDLE: &[Field] = &[
    field(
        "clockwise",
        "Starts it clockwise, or changes its speed.",
        Kind::Template(|s| &mut s.lines.spindle_clockwise),
    ),
    field(
        "counterclockwise",
        "The same the other way; \"\" where it cannot turn so.",
        Kind::Template(|s| &mut s.lines.spindle_counterclockwise),
    ),
    field("stop", "Stops it.", Kind::Template(|s| &mut s.lines.spindle_stop)),
];
