//! Moves as straight strokes of the tip.

use super::ARC_TOLERANCE_MM;
use crate::{Motion, MoveKind};
use glam::{DVec2, DVec3};

/// A stroke shorter than this in plan counts as upright, in mm: its slope would mean nothing, and no
/// surface shows a billionth of a millimetre.
const UPRIGHT_MM: f64 = 1e-9;

/// A straight way of the tip, as it is seen in plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Where it begins, in mm.
    pub(super) from: DVec2,
    /// Its direction, a unit vector.
    pub(super) way: DVec2,
    /// Its length in plan, in mm; 0 if it stands upright.
    pub(super) length: f64,
    /// Height of the tip where it begins, in mm; of an upright one its lower end.
    pub(super) z: f64,
    /// Rise a mm of its length in plan; 0 of an upright one.
    pub(super) slope: f64,
    /// Index of the move that it is a part of.
    pub(super) index: u32,
    /// Whether it is made without cutting.
    pub(super) rapid: bool,
}

impl Stroke {
    fn new(from: DVec3, to: DVec3, index: u32, rapid: bool) -> Self {
        let way = (to - from).truncate();
        let length = way.length();
        let stroke = Self {
            from: from.truncate(),
            way: DVec2::X,
            length: 0.0,
            z: from.z.min(to.z),
            slope: 0.0,
            index,
            rapid,
        };
        if length <= UPRIGHT_MM {
            return stroke;
        }
        Self { way: way / length, length, z: from.z, slope: (to.z - from.z) / length, ..stroke }
    }

    /// Where it ends in plan, in mm.
    pub(super) fn to(&self) -> DVec2 {
        self.from + self.way * self.length
    }
}

/// All strokes of a motion, in order.
pub(super) fn strokes(motion: &Motion) -> impl Iterator<Item = Stroke> + '_ {
    motion.legs().enumerate().flat_map(|(index, (from, moved))| {
        let rapid = moved.kind == MoveKind::Rapid;
        let chords = motion.arc(moved).map(|arc| arc.chords(from, moved.to, ARC_TOLERANCE_MM));
        let line = chords.is_none().then_some(moved.to);
        let mut at = from;
        chords.into_iter().flatten().chain(line).map(move |to| {
            let stroke = Stroke::new(at, to, index as u32, rapid);
            at = to;
            stroke
        })
    })
}
