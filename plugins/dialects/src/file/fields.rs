//! Everything that a dialect's file can say, once: its name, what it means, what it may be, and which
//! setting it is. Reading a file and writing a starter both go by this list.

use super::groups::{
    ARCS, COMMENTS, LINE_NUMBERS, NUMBERS, PROGRAM_NUMBER, RAPIDS, SPINDLE, WORDS, arcs, comments,
    numbering,
};
use super::rules::{bad_about, bad_extension};
use crate::Text;
use crate::comment::LEAST_WIDTH;
use crate::rs274::Rs274;
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

pub(super) const fn field(name: &'static str, about: &'static str, kind: Kind) -> Field {
    Field { name, about, kind }
}

/// The longest dwell, a day.
const DAY_S: f64 = 86_400.0;

/// Counts of tools, program numbers and block numbers have at most eight digits.
pub(super) const EIGHT_DIGITS: u32 = 99_999_999;

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
