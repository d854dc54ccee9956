//! Everything that a dialect's file can say, once: its name, what it means, what it may be, and which
//! setting it is. Reading a file and writing a starter both go by this list.

use crate::Text;
use crate::block::Numbering;
use crate::comment::{LEAST_WIDTH, brackets};
use crate::front::{Arcs, FEED_LIMIT_MM_PER_MIN};
use crate::number::FeedUnit;
use crate::rs274::{Center, Rs274};
use carvegraph_core::units::Dimension;

/// A setting.
pub(super) type Get<T> = fn(&mut Rs274) -> &mut T;

/// One thing that a file can say.
pub(super) struct Field {
    pub(super) name: &'static str,
    /// What it means, in a line; `""` where the group says it.
    pub(super) about: &'static str,
    pub(super) kind: Kind,
}

/// What a field may be.
pub(super) enum Kind {
    /// A text, and what is wrong with one.
    Text(Get<Text>, fn(&str) -> Option<&'static str>),
    /// Words for a block, without places for values.
    Word(Get<Text>),
    /// A template of several lines; empty, nothing is written.
    Template(Get<Text>),
    /// A list of words.
    Words(Get<Text>),
    Switch(Get<bool>),
    Count(Get<u32>, [u32; 2]),
    Number(Get<f64>, Dimension, [f64; 2]),
    /// `none`, or a count.
    MaybeCount(Get<Option<u32>>, [u32; 2]),
    /// `none`, or a number.
    MaybeNumber(Get<Option<f64>>, Dimension, [f64; 2]),
    Choice(&'static [Choice]),
    Group(&'static [Field]),
    /// `none`, or fields.
    MaybeGroup(Maybe, &'static [Field]),
}

/// One of the words that a field may be.
pub(super) struct Choice {
    pub(super) word: &'static str,
    pub(super) set: fn(&mut Rs274),
    pub(super) is: fn(&Rs274) -> bool,
}

/// How a group comes and goes.
pub(super) struct Maybe {
    pub(super) is_some: fn(&Rs274) -> bool,
    pub(super) clear: fn(&mut Rs274),
    /// Fills it with what is usual, if it is not there.
    pub(super) fill: fn(&mut Rs274),
}

const fn field(name: &'static str, about: &'static str, kind: Kind) -> Field {
    Field { name, about, kind }
}

/// Decimals beyond are finer than any machine, and than what `f64` rounds exactly at a kilometre.
const DECIMALS: [u32; 2] = [0, 5];

/// Feeds a controller can be told: from one a rounding cannot take away.
const FEEDS: [f64; 2] = [1.0, FEED_LIMIT_MM_PER_MIN];

/// No arc is divided into more than four.
const SWEEPS: [f64; 2] = [90.0, 360.0];

/// The longest dwell, a day.
const DAY_S: f64 = 86_400.0;

/// Counts of tools, program numbers and block numbers have at most eight digits.
const EIGHT_DIGITS: u32 = 99_999_999;

fn arcs(settings: &mut Rs274) -> &mut Arcs {
    settings.arcs.get_or_insert(Arcs::ALL)
}

fn comments(settings: &mut Rs274) -> &mut crate::comment::CommentStyle {
    settings.comments.get_or_insert_with(brackets)
}

fn numbering(settings: &mut Rs274) -> &mut Numbering {
    settings.numbering.get_or_insert_with(|| Numbering {
        prefix: "N".into(),
        first: 10,
        step: 10,
        last: EIGHT_DIGITS,
    })
}

/// All of them but `format`, `name` and `parent`, in the order of a starter.
pub(super) const FIELDS: &[Field] = &[
    field(
        "about",
        "The controllers it is for, in a line.",
        Kind::Text(|s| &mut s.about, bad_about),
    ),
    field(
        "extension",
        "File name extension of its programs, without the dot.",
        Kind::Text(|s| &mut s.extension, bad_extension),
    ),
    field("words", "Words of motion, plane and units.", Kind::Group(WORDS)),
    field("numbers", "How coordinates and feeds are written.", Kind::Group(NUMBERS)),
    field(
        "arcs",
        "Which arcs the controller takes: none, or as follows. Others become chords.",
        Kind::MaybeGroup(
            Maybe {
                is_some: |s| s.arcs.is_some(),
                clear: |s| s.arcs = None,
                fill: |s| {
                    arcs(s);
                },
            },
            ARCS,
        ),
    ),
    field("rapids", "How the controller travels.", Kind::Group(RAPIDS)),
    field(
        "comments",
        "How comments are written: none, or as follows.",
        Kind::MaybeGroup(
            Maybe {
                is_some: |s| s.comments.is_some(),
                clear: |s| s.comments = None,
                fill: |s| {
                    comments(s);
                },
            },
            COMMENTS,
        ),
    ),
    field(
        "line_numbers",
        "Numbers of blocks: none, or such as (prefix: \"N\", first: 10, step: 10, last: 9999).",
        Kind::MaybeGroup(
            Maybe {
                is_some: |s| s.numbering.is_some(),
                clear: |s| s.numbering = None,
                fill: |s| {
                    numbering(s);
                },
            },
            LINE_NUMBERS,
        ),
    ),
    field(
        "line_limit",
        "Characters of a line that the controller reads.",
        Kind::Count(|s| &mut s.line_limit, [LEAST_WIDTH as u32, 4096]),
    ),
    field(
        "program_number",
        "The number that {{ number }} stands for.",
        Kind::Group(PROGRAM_NUMBER),
    ),
    field(
        "opening",
        "Lines before everything else, without block numbers.",
        Kind::Template(|s| &mut s.lines.opening),
    ),
    field(
        "notes",
        "Remarks that the operator must read: one a line, each becomes a comment.",
        Kind::Template(|s| &mut s.lines.notes),
    ),
    field(
        "header",
        "Modes set at the head: units, plane, absolute coordinates, feed per minute.",
        Kind::Template(|s| &mut s.lines.header),
    ),
    field(
        "path_tolerance",
        "Tells how far the controller may leave the path to keep its speed; \"\" does not.",
        Kind::Template(|s| &mut s.lines.path_tolerance),
    ),
    field(
        "needs_path_tolerance",
        "Whether a program must say how far, because the controller would go as far as it likes.",
        Kind::Switch(|s| &mut s.needs_path_tolerance),
    ),
    field(
        "retract",
        "Sends Z to the machine's top at the start and before a tool change; \"\" does not. With it the first rapid travels up there.",
        Kind::Template(|s| &mut s.lines.retract),
    ),
    field(
        "tools",
        "The largest tool number, or none where the controller has no tool change.",
        Kind::MaybeCount(|s| &mut s.tool_limit, [1, EIGHT_DIGITS]),
    ),
    field(
        "tool_refusal",
        "Where there is none: what a program that changes tools is told, behind the dialect's name.",
        Kind::Text(|s| &mut s.tool_refusal, bad_about),
    ),
    field(
        "tool_note",
        "Remarks on a tool, before it is changed to.",
        Kind::Template(|s| &mut s.lines.tool_note),
    ),
    field(
        "tool_change",
        "Changes to a tool; the spindle stands still.",
        Kind::Template(|s| &mut s.lines.tool_change),
    ),
    field(
        "tool_length",
        "Words that take up the tool's length, for the block that first moves Z.",
        Kind::Template(|s| &mut s.lines.tool_length),
    ),
    field(
        "note_without_tool",
        "Remarks for a program that takes up no tool.",
        Kind::Template(|s| &mut s.lines.note_without_tool),
    ),
    field("spindle", "Starts and stops the spindle.", Kind::Group(SPINDLE)),
    field(
        "spin_up",
        "Dwell after the spindle starts, where the controller does not wait for it; or none.",
        Kind::MaybeNumber(|s| &mut s.spin_up_s, Dimension::Time, [0.0, DAY_S]),
    ),
    field("dwell", "Waits.", Kind::Template(|s| &mut s.lines.dwell)),
    field(
        "longest_dwell",
        "The longest time that the controller can wait.",
        Kind::Number(|s| &mut s.dwell_limit_s, Dimension::Time, [0.001, DAY_S]),
    ),
    field(
        "note_on_dwell",
        "Remarks before the first dwell.",
        Kind::Template(|s| &mut s.lines.note_on_dwell),
    ),
    field(
        "footer",
        "How a program ends, after the spindle's stop.",
        Kind::Template(|s| &mut s.lines.footer),
    ),
    field(
        "closing",
        "Lines after the end, without block numbers.",
        Kind::Template(|s| &mut s.lines.closing),
    ),
    field(
        "rejects",
        "Words that the controller refuses; a letter alone stands for all its words. Nothing is written with them.",
        Kind::Words(|s| &mut s.rejects),
    ),
];

const WORDS: &[Field] = &[
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

const NUMBERS: &[Field] = &[
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
        "What F counts, in mm or inches.",
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

const ARCS: &[Field] = &[
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

const RAPIDS: &[Field] = &[
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

const COMMENTS: &[Field] = &[
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

const LINE_NUMBERS: &[Field] = &[
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

const PROGRAM_NUMBER: &[Field] = &[
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

const SPINDLE: &[Field] = &[
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

fn bad_about(text: &str) -> Option<&'static str> {
    let fits = !text.trim().is_empty() && text.len() <= 200 && !text.contains(char::is_control);
    (!fits).then_some("must be a line of 1 to 200 characters")
}

fn bad_extension(text: &str) -> Option<&'static str> {
    let fits = (1..=8).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_alphanumeric());
    (!fits).then_some("must be 1 to 8 letters and digits")
}

/// It must not be read as a word.
fn bad_open(text: &str) -> Option<&'static str> {
    let sign = text.starts_with(|c: char| c.is_ascii_punctuation());
    let fits = sign && text.len() <= 4 && printable(text);
    (!fits).then_some("must be a sign such as ( or ; and 4 characters at most")
}

fn bad_close(text: &str) -> Option<&'static str> {
    let sign = text.is_empty() || text.bytes().all(|b| b.is_ascii_punctuation());
    (!sign || text.len() > 4).then_some("must be signs such as ) and 4 characters at most")
}

fn bad_punctuation(text: &str) -> Option<&'static str> {
    let harmless = text.chars().all(|c| crate::comment::PUNCTUATION.contains(c));
    let fits = harmless && text.contains('-') && text.contains('.');
    (!fits).then_some("must be some of .,:+-*/=_'\"@&#% with - and . among them")
}

fn bad_prefix(text: &str) -> Option<&'static str> {
    let fits = text.len() <= 4 && text.bytes().all(|b| b.is_ascii_uppercase() || b == b':');
    (!fits).then_some("must be upper-case letters, 4 at most")
}

/// Whether a text is ASCII without control characters.
pub(super) fn printable(text: &str) -> bool {
    text.bytes().all(|b| (b' '..=b'~').contains(&b))
}
