//! Heidenhain's conversational language, as far as three-axis programs need it: `L`, `CC`, `C`, `CP`,
//! `TOOL CALL`, `CYCL DEF` 9 (dwell) and 32 (tolerance).

use super::Stop;
use super::number::whole;
use super::recorder::Recorder;
use carvegraph_geometry::{DVec3, Direction, PathArc, Plane};

const AXES: [char; 3] = ['X', 'Y', 'Z'];

/// What is in force.
#[derive(Default)]
pub(super) struct Reader {
    unit_mm: f64,
    feed_unit_mm: f64,
    center_mm: [Option<f64>; 2],
    ended: bool,
}

impl super::Reader for Reader {
    fn line(&mut self, line: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        let block = line.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()).trim();
        let block = block.split(';').next().unwrap_or_default().trim_end();
        let mut words = block.split_ascii_whitespace();
        match words.next() {
            None => Ok(()),
            Some("BEGIN") => self.begin(block),
            Some("END") => {
                self.ended = true;
                Ok(())
            }
            Some("M30" | "M2" | "M0" | "M1" | "M8" | "M9" | "BLK" | "STOP") => Ok(()),
            Some(turns @ ("M3" | "M4" | "M5")) => {
                recorder.spindle(turns != "M5");
                Ok(())
            }
            Some("TOOL") => tool(block, recorder),
            Some("CYCL") => cycle(block, recorder),
            Some("CC") => self.center(words),
            Some("L") => self.straight(words, recorder),
            Some("C") => self.circle(words, recorder),
            Some("CP") => self.polar(words, recorder),
            Some(other) => Err(format!("{other:?} is no block that can be followed")),
        }
    }

    fn ended(&self) -> bool {
        self.ended
    }
}

impl Reader {
    fn begin(&mut self, block: &str) -> Result<(), Stop> {
        // An inch program counts feeds in tenths of an inch a minute.
        (self.unit_mm, self.feed_unit_mm) = match block.split_ascii_whitespace().last() {
            Some("MM") => (1.0, 1.0),
            Some("INCH") => (25.4, 2.54),
            _ => return Err("the program does not say whether it is in MM or in INCH".to_owned()),
        };
        Ok(())
    }

    /// A word of an axis: which, and where, in mm.
    fn axis(&self, word: &str, recorder: &Recorder<'_>) -> Option<Result<(usize, f64), Stop>> {
        let (incremental, word) = match word.strip_prefix('I') {
            Some(rest) => (true, rest),
            None => (false, word),
        };
        let axis = AXES.iter().position(|axis| word.starts_with(*axis))?;
        let place = whole(&word[1..]).ok_or_else(|| format!("{word:?} is no coordinate"));
        Some(place.and_then(|place| {
            let place = place * self.unit_mm;
            let from = if incremental { recorder.at()[axis] } else { Some(0.0) };
            let from = from.ok_or_else(|| format!("{word:?} counts from an unknown place"))?;
            Ok((axis, from + place))
        }))
    }

    fn center<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), Stop> {
        for word in words {
            let axis = AXES[..2].iter().position(|axis| word.starts_with(*axis));
            let place = whole(word.get(1..).unwrap_or_default());
            let (Some(axis), Some(place)) = (axis, place) else {
                return Err(format!("{word:?} is no coordinate of a centre"));
            };
            self.center_mm[axis] = Some(place * self.unit_mm);
        }
        Ok(())
    }

    fn straight<'w>(
        &mut self,
        words: impl Iterator<Item = &'w str>,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Stop> {
        let (mut to, mut rapid) = ([None; 3], false);
        for word in words {
            match self.axis(word, recorder) {
                Some(place) => {
                    let (axis, place) = place?;
                    to[axis] = Some(place);
                }
                None if word == "FMAX" => rapid = true,
                None => self.other(word, recorder)?,
            }
        }
        if rapid {
            recorder.rapid(to)
        } else {
            recorder.cut(to)
        }
        Ok(())
    }

    /// A word of a block that is no coordinate.
    fn other(&self, word: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        match word {
            "R0" | "M8" | "M9" => {}
            "M3" | "M4" => recorder.spindle(true),
            "M5" => recorder.spindle(false),
            _ => {
                let feed = word.strip_prefix('F').and_then(whole).filter(|feed| *feed > 0.0);
                let feed = feed.ok_or_else(|| format!("{word:?} cannot be followed"))?;
                recorder.feed_mm_per_min = Some(feed * self.feed_unit_mm);
            }
        }
        Ok(())
    }

    fn circle<'w>(
        &mut self,
        words: impl Iterator<Item = &'w str>,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Stop> {
        let Turn { to, direction, .. } = self.turn(words, recorder)?;
        let arc = self.arc(direction)?;
        recorder.cut_arc(to, arc);
        Ok(())
    }

    /// A helix: an angle about the centre and a height.
    fn polar<'w>(
        &mut self,
        words: impl Iterator<Item = &'w str>,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Stop> {
        let Turn { mut to, direction, angle_deg } = self.turn(words, recorder)?;
        let angle_deg = angle_deg.ok_or("a helix has no IPA")?;
        if angle_deg.abs() > 360.0 {
            return Err("a helix of more than a turn is not followed".to_owned());
        }
        let arc = self.arc(direction)?;
        // A whole turn ends where it begins, to the last bit.
        if let ([Some(x), Some(y), _], true) = (recorder.at(), angle_deg.abs() < 360.0) {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            let away = [x - arc.center.x, y - arc.center.y];
            to[0] = Some(arc.center.x + away[0] * cos - away[1] * sin);
            to[1] = Some(arc.center.y + away[0] * sin + away[1] * cos);
        }
        recorder.cut_arc(to, arc);
        Ok(())
    }

    /// The words of an arc.
    fn turn<'w>(
        &self,
        words: impl Iterator<Item = &'w str>,
        recorder: &mut Recorder<'_>,
    ) -> Result<Turn, Stop> {
        let mut turn = Turn { to: [None; 3], direction: None, angle_deg: None };
        for word in words {
            if let Some(angle) = word.strip_prefix("IPA").and_then(whole) {
                turn.angle_deg = Some(angle);
                continue;
            }
            match (self.axis(word, recorder), direction_of(word)) {
                (Some(place), _) => {
                    let (axis, place) = place?;
                    turn.to[axis] = Some(place);
                }
                (None, Some(direction)) => turn.direction = Some(direction),
                (None, None) => self.other(word, recorder)?,
            }
        }
        Ok(turn)
    }

    fn arc(&self, direction: Option<Direction>) -> Result<PathArc, Stop> {
        let [Some(x), Some(y)] = self.center_mm else {
            return Err("an arc comes before its centre (CC)".to_owned());
        };
        let direction = direction.ok_or("an arc has no DR+ or DR-")?;
        Ok(PathArc { plane: Plane::Xy, direction, center: DVec3::new(x, y, 0.0) })
    }
}

/// What the words of an arc say.
struct Turn {
    /// Where it ends, in mm, by the axes that are named.
    to: [Option<f64>; 3],
    direction: Option<Direction>,
    /// Of a helix: how far it turns.
    angle_deg: Option<f64>,
}

fn direction_of(word: &str) -> Option<Direction> {
    match word {
        "DR-" => Some(Direction::Clockwise),
        "DR+" => Some(Direction::CounterClockwise),
        _ => None,
    }
}

/// `TOOL CALL 3 Z S12000`, or without a number a new speed of the same tool.
fn tool(block: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
    let Some(rest) = block.strip_prefix("TOOL CALL ") else {
        return match block.starts_with("TOOL DEF ") {
            true => Ok(()),
            false => Err(format!("{block:?} cannot be followed")),
        };
    };
    let first = rest.split_ascii_whitespace().next().unwrap_or_default();
    if first.starts_with(['S', 'X', 'Y', 'Z']) {
        return Ok(());
    }
    let number = first.parse().map_err(|_| format!("{first:?} is no number of a tool"))?;
    recorder.change_tool(Some(number));
    Ok(())
}

fn cycle(block: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
    if let Some(seconds) = block.strip_prefix("CYCL DEF 9.1 DWELL ") {
        recorder.dwell(whole(seconds).ok_or_else(|| format!("{seconds:?} is no time"))?);
        return Ok(());
    }
    match ["CYCL DEF 9.0", "CYCL DEF 32."].iter().any(|begin| block.starts_with(begin)) {
        true => Ok(()),
        false => Err(format!("{block:?} cannot be followed")),
    }
}
