//! What must hold for a dialect as a whole: its templates can be rendered, and nothing that it says by
//! itself is rejected, too long or not harmless.

use super::read::Places;
use crate::lines::{Line, Sheet, TITLE_LENGTH};
use crate::rs274::Rs274;
use crate::template::{self, Fault};
use carvegraph_core::source::Span;
use carvegraph_core::{Diagnostic, Diagnostics};
use carvegraph_sdk::{PostError, Program, Units};
use minijinja::value::Value;

/// The longest values that the lines of a program take; the tool is the dialect's largest.
const SAMPLE_RPM: u32 = 5_000_000;
const SAMPLE_SECONDS: f64 = 1234.567;
const SAMPLE_TOLERANCE: f64 = 1234.567;

/// Digits of a block number, and a space.
const NUMBER_WIDTH: usize = 9;

/// Tells all that is wrong with the settings of a file.
pub(super) fn check(settings: &Rs274, places: &Places) -> Result<(), Diagnostics> {
    let mut faults = Diagnostics::new();
    contradictions(settings, places, &mut faults);
    templates(settings, places, &mut faults);
    if !faults.has_errors() {
        samples(settings, places, &mut faults);
    }
    if faults.has_errors() { Err(faults) } else { Ok(()) }
}

/// Settings that do not go together.
fn contradictions(settings: &Rs274, places: &Places, faults: &mut Diagnostics) {
    let mut fault = |paths: &[&str], message: String| {
        faults.push(Diagnostic::error(message).at(places.of(paths).clone()));
    };
    let lines = &settings.lines;
    let missing = [
        ("spindle.clockwise", &lines.spindle_clockwise, true),
        ("spindle.stop", &lines.spindle_stop, true),
        ("dwell", &lines.dwell, true),
        ("tool_change", &lines.tool_change, settings.tool_limit.is_some()),
    ];
    for (path, _, _) in missing.iter().filter(|(_, line, needed)| *needed && line.is_empty()) {
        fault(&[path], format!("{path} must not be empty"));
    }
    let (spin_up, limit) = (settings.spin_up_s.unwrap_or(0.0), settings.dwell_limit_s);
    if spin_up > limit {
        let message = format!("spin_up is {spin_up} s, but longest_dwell {limit} s");
        fault(&["spin_up", "longest_dwell"], message);
    }
    if let Some(style) = &settings.comments
        && let Some(sign) = style.punctuation.chars().find(|c| style.close.contains(*c))
    {
        let message = format!("{sign:?} ends a comment, so it cannot stand in one");
        fault(&["comments.punctuation", "comments.close"], message);
    }
    if let Some(numbering) = &settings.numbering
        && numbering.last < numbering.first
    {
        let (first, last) = (numbering.first, numbering.last);
        let message = format!("the last number, {last}, is less than the first, {first}");
        fault(&["line_numbers.last", "line_numbers.first"], message);
    }
    if let Some((word, reject)) = settings.rejected_word() {
        let message = format!("{word} would be written, but rejects holds {reject:?}");
        fault(&["rejects", "words"], message);
    }
}

/// Templates that this file states and that are none; its parent's are good.
fn templates(settings: &Rs274, places: &Places, faults: &mut Diagnostics) {
    settings.lines.each(|line, source| {
        let Some(span) = places.said.get(line.name) else { return };
        for Fault { range, message, help } in template::faults(source, &line.known()) {
            // A text without escapes stands in the file as it is.
            let place = match span.text().find(&**source) {
                Some(begin) => {
                    let begin = span.start + begin;
                    span.source.span(begin + range.start..begin + range.end)
                }
                None => span.clone(),
            };
            let fault = Diagnostic::error(format!("{}: {message}", line.name)).at(place);
            faults.push(Diagnostic { help: help.map(Into::into), ..fault });
        }
    });
}

/// Renders all lines with long values, in both units.
fn samples(settings: &Rs274, places: &Places, faults: &mut Diagnostics) {
    let title = "W".repeat(TITLE_LENGTH);
    let sample = |units, faults: &mut Diagnostics| {
        let program = Program { title: &title, units, ..Program::default() };
        sampled(settings, &program, places, faults)
    };
    let mm = sample(Units::Mm, faults);
    // What is wrong in one is so in the other.
    if faults.has_errors() {
        return;
    }
    if sample(Units::Inch, faults) == mm && !faults.has_errors() {
        let message = "programs in mm and in inches would begin alike";
        let fault = Diagnostic::error(message).at(places.of(&["header"]).clone());
        let help = "say {{ units }} in header, or tell the operator by {{ unit }} in notes";
        faults.push(fault.help(help));
    }
}

/// Renders the lines of one program; answers those that may tell its units.
fn sampled(
    settings: &Rs274,
    program: &Program<'_>,
    places: &Places,
    faults: &mut Diagnostics,
) -> Vec<String> {
    let engine = template::engine();
    let sheet = match Sheet::new(&engine, &settings.lines, settings.common(program.units), program)
    {
        Ok(sheet) => sheet,
        Err(error) => {
            faults.push(Diagnostic::error(error.to_string()).at(places.parent.clone()));
            return Vec::new();
        }
    };
    let values = [
        ("tool", Value::from(settings.tool_limit.unwrap_or(1))),
        ("rpm", Value::from(SAMPLE_RPM)),
        ("seconds", Value::from(SAMPLE_SECONDS)),
        ("milliseconds", Value::from((SAMPLE_SECONDS * 1000.0) as i64)),
        ("tolerance", Value::from(SAMPLE_TOLERANCE)),
    ];
    let mut head = Vec::new();
    sheet.each(&values, |line, rendered| match rendered {
        // It is never written.
        _ if settings.tool_limit.is_none() && line.values == ["tool"] => {}
        Ok(lines) => {
            too_long(settings, line, &lines, places, faults);
            if ["opening", "notes", "header"].contains(&line.name) {
                head.extend(lines);
            }
        }
        Err(error) => faults.push(blame(&line, &error, places)),
    });
    head
}

/// Whose fault it is that a line cannot be written.
fn blame(line: &Line, error: &PostError, places: &Places) -> Diagnostic {
    let place = |paths: &[&str]| -> Span { places.of(paths).clone() };
    match error {
        PostError::Rejected { word, .. } => {
            let fault = Diagnostic::error(error.to_string()).at(place(&[line.name, "rejects"]));
            fault.help(format!("take {word} out of {} or out of rejects", line.name))
        }
        _ => {
            let message = format!("{}: {error}", line.name);
            Diagnostic::error(message).at(place(&[line.name, "comments"]))
        }
    }
}

fn too_long(
    settings: &Rs274,
    line: Line,
    lines: &[String],
    places: &Places,
    faults: &mut Diagnostics,
) {
    let number = settings.numbering.as_ref().map_or(0, |n| n.prefix.len() + NUMBER_WIDTH);
    let limit = settings.line_limit as usize;
    let long = lines.iter().find(|text| !line.is_remark && text.len() + number > limit);
    if let Some(text) = long {
        let length = text.len() + number;
        let message = format!("{text:?} may take {length} characters, line_limit is {limit}");
        faults.push(Diagnostic::error(message).at(places.of(&[line.name, "line_limit"]).clone()));
    }
}
