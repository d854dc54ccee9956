//! OpenSBP, the language of ShopBots: moves (M), jogs (J), arcs (CG), speeds a second (MS), the spindle by
//! its macros C6 and C7, tools by C9.

use super::Stop;
use super::number::whole;
use super::recorder::Recorder;
use carvegraph_geometry::{DVec3, Direction, PathArc, Plane};

/// What is in force.
#[derive(Default)]
pub(super) struct Reader {
    unit_mm: Option<f64>,
    relative: bool,
    tool: Option<u32>,
    ended: bool,
}

impl super::Reader for Reader {
    fn line(&mut self, line: &str, recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        let line = line.split('\'').next().unwrap_or_default().trim();
        if line.is_empty() || self.ended {
            return Ok(());
        }
        if let Some(test) = line.strip_prefix("IF %(25)=") {
            // It goes to an error where the units are the others.
            self.unit_mm = match test.bytes().next() {
                Some(b'0') => Some(1.0),
                Some(b'1') => Some(25.4),
                _ => return Err(format!("{line:?} cannot be followed")),
            };
            return Ok(());
        }
        if let Some((name, value)) = line.strip_prefix('&').and_then(|rest| rest.split_once('=')) {
            if name.trim().eq_ignore_ascii_case("tool") {
                self.tool = whole(value.trim()).map(|number| number as u32);
            }
            return Ok(());
        }
        let (command, rest) = line.split_once([',', ' ']).unwrap_or((line, ""));
        let fields: Vec<Option<f64>> = rest.split(',').map(|field| whole(field.trim())).collect();
        self.command(command, &fields, rest, recorder)
    }

    fn ended(&self) -> bool {
        self.ended
    }
}

impl Reader {
    fn command(
        &mut self,
        command: &str,
        fields: &[Option<f64>],
        rest: &str,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Stop> {
        match command {
            "SA" => self.relative = false,
            "SR" => self.relative = true,
            "C6" => recorder.spindle(true),
            "C7" => recorder.spindle(false),
            "C9" => recorder.change_tool(self.tool),
            "TR" | "JS" | "VS" | "CN" | "SO" | "SF" => {}
            "PAUSE" => recorder.dwell(fields[0].unwrap_or_default()),
            "END" => self.ended = true,
            "MS" => self.speed(fields, recorder)?,
            "JX" | "JY" | "JZ" | "J2" | "J3" => {
                let to = self.target(command, fields, recorder)?;
                recorder.rapid(to);
            }
            "MX" | "MY" | "MZ" | "M2" | "M3" => {
                let to = self.target(command, fields, recorder)?;
                recorder.cut(to);
            }
            "CG" => self.arc(fields, rest, recorder)?,
            _ => return Err(format!("{command:?} is no command that can be followed")),
        }
        Ok(())
    }

    fn unit(&mut self, recorder: &mut Recorder<'_>) -> f64 {
        *self.unit_mm.get_or_insert_with(|| {
            let text = "it moves, and does not make sure whether in mm or in inches";
            recorder.fault("units", text.to_owned());
            1.0
        })
    }

    fn speed(&mut self, fields: &[Option<f64>], recorder: &mut Recorder<'_>) -> Result<(), Stop> {
        let unit = self.unit(recorder);
        let speeds: Vec<f64> = fields.iter().flatten().copied().collect();
        match speeds[..] {
            [across] => recorder.feed_mm_per_min = Some(across * unit * 60.0),
            // The slower of both goes for moves of all axes.
            [across, down] => recorder.feed_mm_per_min = Some(across.min(down) * unit * 60.0),
            _ => return Err("MS has no speed".to_owned()),
        }
        Ok(())
    }

    fn target(
        &mut self,
        command: &str,
        fields: &[Option<f64>],
        recorder: &mut Recorder<'_>,
    ) -> Result<[Option<f64>; 3], Stop> {
        let unit = self.unit(recorder);
        let axes: &[usize] = match &command[1..] {
            "X" => &[0],
            "Y" => &[1],
            "Z" => &[2],
            "2" => &[0, 1],
            _ => &[0, 1, 2],
        };
        let mut to = [None; 3];
        for (axis, field) in axes.iter().zip(fields) {
            let from = if self.relative { recorder.at()[*axis] } else { Some(0.0) };
            to[*axis] = field.and_then(|field| Some(field * unit + from?));
        }
        if to == [None; 3] || fields.len() > axes.len() {
            return Err(format!("{command} does not have the coordinates that it needs"));
        }
        Ok(to)
    }

    /// `CG,,x,y,i,j,T,direction`: an arc to x, y about a centre at i, j from its start.
    fn arc(
        &mut self,
        fields: &[Option<f64>],
        rest: &str,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Stop> {
        let unit = self.unit(recorder);
        let turns = rest.split(',').nth(5).map(str::trim) == Some("T");
        let [_, Some(x), Some(y), Some(i), Some(j), _, Some(side)] = fields[..] else {
            return Err("CG does not have the fields that it needs".to_owned());
        };
        if !turns || self.relative {
            return Err("an arc of this form is not followed".to_owned());
        }
        let from = recorder.at().map(Option::unwrap_or_default);
        let center = DVec3::new(from[0] + i * unit, from[1] + j * unit, 0.0);
        let direction = if side > 0.0 { Direction::Clockwise } else { Direction::CounterClockwise };
        let arc = PathArc { plane: Plane::Xy, direction, center };
        recorder.cut_arc([Some(x * unit), Some(y * unit), None], arc);
        Ok(())
    }
}
