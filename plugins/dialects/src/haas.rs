//! Haas mills.
//!
//! As Fanuc, except:
//!
//! * `O` and five digits, up to 99999.
//! * Z goes up by `G53 G0 Z0.`, in the machine's own coordinates: no point in between.
//! * Rapids may be dog-legs that leave the straight line: each moves one axis.
//! * `G187 P3 E` sets the path tolerance, until M30. Brackets do not nest.

use crate::fanuc::FANUC;
use crate::front::{Abilities, Tools};
use crate::rs274::{PathTolerance, ProgramNumber, Rs274};

/// Tool offsets of a Haas mill.
const TOOL_LIMIT: u32 = 200;

pub(crate) const HAAS: Rs274 = Rs274 {
    name: "haas",
    about: "Haas mills, classic and next generation control",
    abilities: Abilities {
        single_axis_rapids: true,
        tools: Tools::UpTo(TOOL_LIMIT),
        ..FANUC.abilities
    },
    program_number: ProgramNumber { digits: 5, limit: 99_999 },
    path_tolerance: PathTolerance::IfGiven("G187 P3 E{tolerance}"),
    retract: &["G53 G0 Z0.0"],
    end: &["G53 G0 Z0.0", "M30"],
    ..FANUC
};
