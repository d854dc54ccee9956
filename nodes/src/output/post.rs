//! A path becomes a program in a dialect.
//!
//! The program's frame follows from where the user sets the machine to zero: `z_zero: bottom,
//! xy_zero: corner` is the frame of the saved model; `top` and `center` shift it.

use crate::registry::Dialects;
use crate::values::Gcode;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, Cutter, DVec3, SpanKind, Toolpath};
use carvegraph_sdk::{Command, Direction, PostError, Program, Stock, Units};
use std::io;

/// Bytes that are taken between two looks at the cancel token.
const LOOK_BYTES: usize = 1 << 18;

/// Writes a path as a program that a machine can run. `carve dialects` lists the dialects.
#[derive(Clone, Debug, Params)]
pub(crate) struct Post {
    /// What the controller understands.
    #[param(catalog = "dialect", default = "grbl")]
    pub(crate) dialect: String,
    /// Speed of the spindle.
    #[param(unit = "rpm", default = 12_000.0, range = 1.0..=200_000.0)]
    pub(crate) spindle: f64,
    /// Where Z is 0: at the top of the part or at its bottom.
    #[param(default = ZZero::Top)]
    pub(crate) z_zero: ZZero,
    /// Where X and Y are 0: at the near left corner of the part or above its middle.
    #[param(default = XyZero::Corner)]
    pub(crate) xy_zero: XyZero,
    /// Units of the program.
    #[param(default = UnitSystem::Mm)]
    pub(crate) units: UnitSystem,
    /// Number of the cutter in the controller's tool table; 0 takes the one that is in the spindle.
    #[param(default = 0, range = 0..=9999)]
    pub(crate) tool: u32,
    /// How far the controller may round corners off to keep its speed, where it can be told.
    #[param(unit = "mm", default = 0.01, range = 0.0001..=10.0)]
    pub(crate) blend: f64,
}

/// Where Z is 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum ZZero {
    /// The part's highest point.
    Top,
    /// The part's own frame.
    Bottom,
}

/// Where X and Y are 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum XyZero {
    /// The near left corner of the part.
    Corner,
    /// The middle of the part.
    Center,
}

/// Units of a program.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum UnitSystem {
    /// Millimetres.
    Mm,
    /// Inches.
    Inch,
}

#[derive(Inputs)]
pub(crate) struct Job<'a> {
    /// The path with all its moves and speeds.
    toolpath: &'a Toolpath,
    /// The box that holds the part.
    part: &'a Bounds,
    /// The cutter, for the program's head.
    cutter: &'a Cutter,
}

#[derive(Outputs)]
pub(crate) struct Posted {
    /// The program.
    program: Gcode,
}

impl Node for Post {
    const KIND: &'static str = "post";
    const USES_PREFIX: bool = true;
    type Inputs<'a> = Job<'a>;
    type Outputs = Posted;

    fn run(&self, inputs: Job<'_>, cx: &Context<'_>) -> Result<Posted, NodeError> {
        let dialects: &Dialects = cx.service()?;
        let dialect = dialects
            .find(&self.dialect)
            .ok_or_else(|| NodeError::failed(format!("there is no dialect {:?}", self.dialect)))?;
        let origin = self.origin(inputs.part);
        let commands = self.commands(inputs.toolpath, origin)?;
        let remarks = self.remarks(&inputs);
        let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
        let program = Program {
            title: cx.prefix(),
            remarks: &remarks,
            units: match self.units {
                UnitSystem::Mm => Units::Mm,
                UnitSystem::Inch => Units::Inch,
            },
            path_tolerance_mm: self.blend,
            stock: Some(Stock {
                min: (inputs.part.min - origin).to_array(),
                max: (inputs.part.max - origin).to_array(),
            }),
            commands: &commands,
            ..Program::default()
        };
        // About 24 bytes a block.
        let text = Vec::with_capacity(commands.len() * 24);
        let mut sink = Sink { text, cx, looked: 0 };
        dialect.post(&program, &mut sink).map_err(|fault| match fault {
            PostError::Io(_) if cx.is_cancelled() => NodeError::Cancelled,
            fault => NodeError::Failed(format!("dialect {:?}: {fault}", self.dialect)),
        })?;
        let (dialect, extension) = (self.dialect.clone(), dialect.extension().to_owned());
        Ok(Posted { program: Gcode { text: sink.text, dialect, extension } })
    }
}

impl Post {
    /// The point of the part's frame that is the program's zero.
    fn origin(&self, part: &Bounds) -> DVec3 {
        let xy = match self.xy_zero {
            XyZero::Corner => DVec3::ZERO,
            XyZero::Center => part.center(),
        };
        let z = match self.z_zero {
            ZZero::Top => part.max.z,
            ZZero::Bottom => 0.0,
        };
        xy.with_z(z)
    }

    fn remarks(&self, inputs: &Job<'_>) -> Vec<String> {
        let size = inputs.part.size();
        let cutter = inputs.cutter;
        let z_zero = match self.z_zero {
            ZZero::Top => "top of the part",
            ZZero::Bottom => "bottom: the frame of the saved model",
        };
        let xy_zero = match self.xy_zero {
            XyZero::Corner => "near left corner",
            XyZero::Center => "middle of the part",
        };
        vec![
            format!("Cutter: {}, diameter {} mm", cutter.name, 2.0 * cutter.profile.radius_mm()),
            format!("Part: {:.3} x {:.3} x {:.3} mm", size.x, size.y, size.z),
            format!("Z0: {z_zero}"),
            format!("X0 Y0: {xy_zero}"),
        ]
    }

    fn commands(&self, path: &Toolpath, origin: DVec3) -> Result<Vec<Command>, NodeError> {
        let Some(feeds) = path.feeds else {
            let message = "the path has no speeds and no approach: put a link node before this one";
            return Err(NodeError::failed(message));
        };
        let mut commands = Vec::with_capacity(path.tips.len() + 2);
        if self.tool > 0 {
            commands.push(Command::ToolChange { number: self.tool });
        }
        commands.push(Command::Spindle { rpm: self.spindle, direction: Direction::Clockwise });
        for span in &path.spans {
            for tip in &path.tips[span.points.clone()] {
                let to = (*tip - origin).to_array();
                commands.push(match span.kind {
                    SpanKind::Rapid => Command::Rapid { to },
                    SpanKind::Plunge => Command::Feed { to, mm_per_min: feeds.plunge_mm_per_min },
                    SpanKind::Pass | SpanKind::Link => {
                        Command::Feed { to, mm_per_min: feeds.cut_mm_per_min }
                    }
                });
            }
        }
        Ok(commands)
    }
}

/// Where a dialect writes to; it refuses to take more when the run is called off.
struct Sink<'a> {
    text: Vec<u8>,
    cx: &'a Context<'a>,
    looked: usize,
}

impl io::Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        if self.text.len() >= self.looked + LOOK_BYTES {
            self.looked = self.text.len();
            if self.cx.is_cancelled() {
                return Err(io::Error::other("interrupted"));
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Contact, Profile, Span};

    fn post(z_zero: ZZero, xy_zero: XyZero) -> Post {
        let (dialect, units) = ("grbl".to_owned(), UnitSystem::Mm);
        Post { dialect, spindle: 9000.0, z_zero, xy_zero, units, tool: 0, blend: 0.01 }
    }

    #[test]
    fn zero_is_where_the_user_says() {
        let part = Bounds { min: DVec3::new(0.0, 0.0, -1.0), max: DVec3::new(8.0, 6.0, 4.0) };
        let origin = |z, xy| post(z, xy).origin(&part);
        assert_eq!(origin(ZZero::Bottom, XyZero::Corner), DVec3::ZERO);
        assert_eq!(origin(ZZero::Top, XyZero::Corner), DVec3::new(0.0, 0.0, 4.0));
        assert_eq!(origin(ZZero::Top, XyZero::Center), DVec3::new(4.0, 3.0, 4.0));
    }

    #[test]
    fn each_kind_of_move_has_its_speed() {
        let span = |at: usize, kind| Span { points: at..at + 1, kind, joined: at > 0 };
        let path = Toolpath {
            tips: vec![DVec3::Z, DVec3::ZERO, DVec3::X],
            contacts: vec![Contact::NONE; 3],
            spans: vec![
                span(0, SpanKind::Rapid),
                span(1, SpanKind::Plunge),
                span(2, SpanKind::Pass),
            ],
            feeds: Some(carvegraph_geometry::Feeds {
                cut_mm_per_min: 1000.0,
                plunge_mm_per_min: 300.0,
                rapid_mm_per_min: 5000.0,
            }),
        };
        let commands = post(ZZero::Bottom, XyZero::Corner).commands(&path, DVec3::ZERO).unwrap();
        assert_eq!(
            commands,
            [
                Command::Spindle { rpm: 9000.0, direction: Direction::Clockwise },
                Command::Rapid { to: [0.0, 0.0, 1.0] },
                Command::Feed { to: [0.0; 3], mm_per_min: 300.0 },
                Command::Feed { to: [1.0, 0.0, 0.0], mm_per_min: 1000.0 },
            ]
        );
        let loose = Toolpath { feeds: None, ..path };
        let fault = post(ZZero::Top, XyZero::Corner).commands(&loose, DVec3::ZERO).unwrap_err();
        assert!(fault.to_string().contains("put a link node before this one"));
    }

    #[test]
    fn a_dialect_that_is_not_there_is_named() {
        let cutter = Cutter { name: "ball".into(), profile: Profile::ball(3.0).unwrap() };
        let path = Toolpath { tips: vec![], contacts: vec![], spans: vec![], feeds: None };
        let part = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        let job = Job { toolpath: &path, part: &part, cutter: &cutter };
        // A context without catalogs: no dialects at all.
        let fault = run(|cx| post(ZZero::Top, XyZero::Corner).run(job, cx)).err();
        assert!(fault.is_some_and(|fault| fault.to_string().contains("Dialects")));
    }
}
