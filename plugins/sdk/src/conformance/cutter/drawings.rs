//! Drawings that are missing, broken or changed.

use super::{Fault, ensure, profile, sound};
use crate::{CutterError, CutterShape};
use fastrand::Rng;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Changed drawings tried for each drawing.
const CHANGES: usize = 600;

/// Drawings that show nothing.
const BAD: [&str; 6] = [
    "",
    "profile",
    "<svg",
    "<html xmlns='http://www.w3.org/1999/xhtml'/>",
    "<svg xmlns='http://www.w3.org/2000/svg'/>",
    "<svg xmlns='http://www.w3.org/2000/svg'><path d=''/></svg>",
];

pub(super) fn bad_ones_are_refused(shape: &dyn CutterShape) -> Fault {
    let without = profile(shape, &[], None)?;
    ensure(without == Err(CutterError::NoDrawing), || {
        format!("without a drawing it must answer CutterError::NoDrawing, not {without:?}")
    })?;
    for text in BAD {
        let answer = answer(shape, text)?;
        ensure(answer.is_err(), || format!("the drawing {text:?} must be refused"))?;
    }
    Ok(())
}

/// Whatever is changed in a drawing: a sound profile or an error.
pub(super) fn changed(shape: &dyn CutterShape, text: &str) -> Fault {
    let mut random = Rng::with_seed(2);
    let letters: Vec<char> = text.chars().collect();
    for _ in 0..CHANGES {
        let text = change(&letters, &mut random);
        if let Ok(made) = answer(shape, &text)? {
            sound(&made, shape.dimensions(), &[])
                .map_err(|fault| format!("{fault}, with the drawing\n{text}"))?;
        }
    }
    Ok(())
}

/// What the shape answers to a drawing, however broken.
fn answer(
    shape: &dyn CutterShape,
    text: &str,
) -> Result<Result<crate::Profile, CutterError>, String> {
    let answer = catch_unwind(AssertUnwindSafe(|| profile(shape, &[], Some(text))));
    let answer = answer.map_err(|_| format!("it panics with the drawing\n{text}"))??;
    if let Err(error) = &answer {
        ensure(!error.to_string().trim().is_empty(), || format!("no words for\n{text}"))?;
    }
    Ok(answer)
}

/// A drawing with its end cut off, or some of its letters dropped, doubled or put in place of others.
fn change(letters: &[char], random: &mut Rng) -> String {
    let mut letters = letters.to_vec();
    if random.usize(..8) == 0 {
        letters.truncate(random.usize(..letters.len()));
    }
    for _ in 0..random.usize(1..4) {
        if letters.is_empty() {
            break;
        }
        let from = random.usize(..letters.len());
        let to = (from + random.usize(1..9)).min(letters.len());
        match random.usize(..4) {
            0 => drop(letters.drain(from..to)),
            1 => letters.extend_from_within(from..to),
            2 => letters.insert(from, other(random)),
            _ => letters[from] = other(random),
        }
    }
    letters.into_iter().collect()
}

/// A letter that means something in a drawing, or nothing anywhere.
fn other(random: &mut Rng) -> char {
    const OTHERS: &[u8] = b"0123456789.-+eE,; MmLlHhVvCcSsQqTtAaZz<>/&#\"'()=%\0";
    char::from(OTHERS[random.usize(..OTHERS.len())])
}
