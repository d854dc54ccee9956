//! Reads OpenSBP as strictly as a ShopBot would.

use carvegraph_sdk::conformance::dialect::{self, Move, sweep};
use carvegraph_sdk::{Arc, Direction, Plane};
use std::f64::consts::PI;

fn number(text: &str, whole: bool, line: &str) -> f64 {
    dialect::number(text, whole, 4).unwrap_or_else(|fault| panic!("{line:?}: {fault}"))
}

/// The moves of a program; a position that is unknown is NaN.
pub(crate) fn read(text: &str) -> Vec<Move> {
    assert!(text.ends_with('\n') && text.is_ascii());
    let body = text.strip_suffix("C7\nEND\nUNIT_ERROR:\nCN,91\nEND\n").unwrap();
    let mut unit_mm = f64::NAN;
    let mut absolute = false;
    let mut speed = f64::NAN;
    let mut at = [f64::NAN; 3];
    let mut moves = Vec::new();
    for line in body.lines() {
        assert!(line.len() <= 255, "{line:?}");
        if let Some(comment) = line.strip_prefix('\'') {
            assert!(comment.starts_with("- ") || comment.starts_with("Carvegraph: "), "{line:?}");
            assert!(comment.bytes().all(|b| (b' '..=b'~').contains(&b)), "{line:?}");
            continue;
        }
        if let Some(rest) = line.strip_prefix("IF %(25)=") {
            assert!(unit_mm.is_nan() && moves.is_empty(), "{line:?}");
            unit_mm = match rest {
                "0 THEN GOTO UNIT_ERROR" => 1.0,
                "1 THEN GOTO UNIT_ERROR" => 25.4,
                _ => panic!("{line:?}"),
            };
            continue;
        }
        assert!(!unit_mm.is_nan(), "{line:?} before the units are checked");
        let (command, rest) = line.split_once([',', ' ']).unwrap_or((line, ""));
        let fields: Vec<&str> = rest.split(',').collect();
        let value = |k: usize| number(fields[k], false, line) * unit_mm;
        let mut go = |axes: &[usize]| {
            assert!(absolute && fields.len() == axes.len(), "{line:?}");
            for (k, &axis) in axes.iter().enumerate() {
                at[axis] = value(k);
            }
            at
        };
        match command {
            "SA" => absolute = true,
            "MS" => {
                assert!(fields.len() == 2 && fields[0] == fields[1], "{line:?}");
                speed = 60.0 * value(0);
            }
            "TR" => assert!(number(rest, true, line) > 0.0),
            "PAUSE" => assert!(number(rest, false, line) >= 0.0),
            "C6" | "C7" => assert_eq!(line, command),
            "&Tool" => assert!(number(rest.strip_prefix("= ").unwrap(), true, line) > 0.0),
            "C9" => at = [f64::NAN; 3],
            "JX" | "JY" | "JZ" | "J2" => {
                let to = go(axes(command));
                moves.push(Move::Rapid { to });
            }
            "MX" | "MY" | "MZ" | "M2" | "M3" => {
                let to = go(axes(command));
                assert!(speed > 0.0 && to.iter().all(|c| c.is_finite()), "{line:?}");
                moves.push(Move::Feed { to, mm_per_min: speed });
            }
            "CG" => {
                assert!(fields.len() == 7 && fields[0].is_empty() && fields[5] == "T", "{line:?}");
                let to = [value(1), value(2), at[2]];
                let center = [at[0] + value(3), at[1] + value(4), at[2]];
                let direction = match fields[6] {
                    "1" => Direction::Clockwise,
                    "-1" => Direction::CounterClockwise,
                    _ => panic!("{line:?}"),
                };
                let mm_per_min = speed;
                let arc = Arc { plane: Plane::Xy, direction, center, to, mm_per_min };
                assert!(sweep(&arc, at) <= PI + 1e-9, "{line:?}");
                moves.push(Move::Arc(arc));
                at = to;
            }
            _ => panic!("{line:?}"),
        }
    }
    moves
}

fn axes(command: &str) -> &'static [usize] {
    match &command[1..] {
        "X" => &[0],
        "Y" => &[1],
        "Z" => &[2],
        "2" => &[0, 1],
        _ => &[0, 1, 2],
    }
}
