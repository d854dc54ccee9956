//! A job of several operations: which path is cut with which cutter, in which order.
//!
//! An operation says which tool and which speed it asks for; which it gets depends on the program that
//! it becomes part of, and is settled there ([`post`](crate::output::Post)).

use crate::shop::Setup;
use carvegraph_core::{NodeError, Yielding};
use carvegraph_geometry::{Cutter, SpanKind, Toolpath};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The longest name of an operation: it becomes part of file names.
const MAX_NAME: usize = 24;

/// Operations in the order in which they are cut; never none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Shared, so that a longer job holds no copies of the paths of a shorter one.
    pub operations: Vec<Arc<Operation>>,
}

/// A path and what cuts it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Operation {
    /// What it is called, in remarks and file names.
    pub name: String,
    /// The path with all its moves and speeds.
    pub toolpath: Toolpath,
    /// The cutter.
    pub cutter: Cutter,
    /// The machine, the tool and the material.
    pub setup: Setup,
    /// The tool and the speed that it asks for.
    pub drive: Drive,
}

/// What an operation asks of the machine besides its path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// The tool's number, if it was set; 0 wants none.
    pub tool: Option<u32>,
    /// Speed of the spindle.
    pub spindle_rpm: f64,
    /// Whether that speed is a default, which gives way to what the machine can do.
    pub spindle_yields: bool,
}

impl Drive {
    /// What the parameters of a node say, else the setup.
    pub(crate) fn new(tool: &Yielding<u32>, spindle: &Yielding<f64>, setup: &Setup) -> Self {
        let of_tool = setup.conditions.spindle_rpm;
        Self {
            tool: tool.is_set().then(|| tool.or(None)),
            spindle_rpm: spindle.or(of_tool),
            spindle_yields: !spindle.is_set() && of_tool.is_none(),
        }
    }
}

/// An operation as a program is made of it: of a job, or the path that `post` itself was given, which
/// is not copied for it.
#[derive(Clone, Copy)]
pub(crate) struct Step<'a> {
    pub(crate) name: &'a str,
    pub(crate) toolpath: &'a Toolpath,
    pub(crate) cutter: &'a Cutter,
    pub(crate) setup: &'a Setup,
    pub(crate) drive: Drive,
}

impl Job {
    /// Its operations, as a program is made of them.
    pub(crate) fn steps(&self) -> impl Iterator<Item = Step<'_>> {
        self.operations.iter().map(|operation| Step {
            name: &operation.name,
            toolpath: &operation.toolpath,
            cutter: &operation.cutter,
            setup: &operation.setup,
            drive: operation.drive,
        })
    }
}

impl Step<'_> {
    /// Finds what keeps a path from being part of a program.
    pub(crate) fn check_speeds(&self) -> Result<(), NodeError> {
        match self.toolpath.feeds {
            Some(_) => Ok(()),
            None => Err(NodeError::failed(
                "the path has no speeds and no approach: put a link node before this one",
            )),
        }
    }

    /// Finds what keeps another operation from coming before or after this one: that its path does
    /// not come from above everything and end there, `top_mm` being the part's highest point.
    pub(crate) fn check_ends(&self, top_mm: f64) -> Result<(), NodeError> {
        let path = self.toolpath;
        let is_rapid = |span: Option<&carvegraph_geometry::Span>| {
            span.is_some_and(|span| span.kind == SpanKind::Rapid)
        };
        let ends = [path.tips.first(), path.tips.last()];
        let lowest = ends.map(|tip| tip.map_or(f64::NEG_INFINITY, |tip| tip.z));
        let lowest = lowest[0].min(lowest[1]);
        let highest = path.heights_mm().1.max(top_mm);
        let from_above = is_rapid(path.spans.first()) && is_rapid(path.spans.last());
        if from_above && lowest >= highest {
            return Ok(());
        }
        Err(NodeError::Failed(format!(
            "the path of operation {:?} does not begin and end at one height above all of the part and \
             all of the path, so that no other may come before or after it: link it, above the same part",
            self.name
        )))
    }
}

/// Finds what is wrong with an operation's name.
pub(crate) fn check_name(name: &str) -> Result<(), String> {
    let fits = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    let begins = name.bytes().next().is_some_and(|byte| byte.is_ascii_alphanumeric());
    if begins && name.len() <= MAX_NAME && name.bytes().all(fits) {
        return Ok(());
    }
    Err(format!(
        "{name:?} is no name for an operation; letters, digits, - and _ do, {MAX_NAME} at most, a letter \
         or digit first"
    ))
}

/// A cutter in a remark: "ball, diameter 6 mm".
pub(crate) fn described(cutter: &Cutter) -> String {
    format!("{}, diameter {} mm", cutter.name, 2.0 * cutter.profile.radius_mm())
}

#[cfg(test)]
pub(crate) mod testing {
    //! Operations to make programs of.

    use super::*;
    use carvegraph_geometry::{Contact, DVec3, Feeds, Profile, Span, link_passes};

    /// A linked path across a part whose top is at 0, at a depth, 5 mm above it at its ends.
    pub(crate) fn path(depth_mm: f64) -> Toolpath {
        let path = Toolpath {
            tips: vec![DVec3::new(0.0, 0.0, -depth_mm), DVec3::new(10.0, 0.0, -depth_mm)],
            contacts: vec![Contact::NONE; 2],
            spans: vec![Span { points: 0..2, kind: SpanKind::Pass, joined: false }],
            ..Toolpath::default()
        };
        let feeds =
            Feeds { cut_mm_per_min: 1000.0, plunge_mm_per_min: 300.0, rapid_mm_per_min: 5000.0 };
        link_passes(&path, 5.0, feeds).unwrap()
    }

    pub(crate) fn flat(diameter_mm: f64) -> Cutter {
        Cutter { name: "flat".into(), profile: Profile::flat(diameter_mm / 2.0).unwrap() }
    }

    pub(crate) fn ball(diameter_mm: f64) -> Cutter {
        Cutter { name: "ball".into(), profile: Profile::ball(diameter_mm / 2.0).unwrap() }
    }

    pub(crate) const DRIVE: Drive = Drive { tool: None, spindle_rpm: 9000.0, spindle_yields: true };

    pub(crate) fn operation(name: &str, cutter: Cutter, tool: Option<u32>) -> Operation {
        let drive = Drive { tool, ..DRIVE };
        Operation { name: name.into(), toolpath: path(1.0), cutter, setup: Setup::default(), drive }
    }

    pub(crate) fn job(operations: impl IntoIterator<Item = Operation>) -> Job {
        Job { operations: operations.into_iter().map(Arc::new).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::{ball, flat, job, operation, path};
    use super::*;
    use carvegraph_geometry::DVec3;

    #[test]
    fn names_become_parts_of_file_names() {
        for good in ["rough", "2nd-pass", "Semi_Finish", "x"] {
            assert_eq!(check_name(good), Ok(()));
        }
        for bad in ["", "-x", "a/b", "..", "a b", "größe", "a234567890123456789012345"] {
            assert!(check_name(bad).unwrap_err().contains("is no name for an operation"), "{bad}");
        }
    }

    #[test]
    fn a_path_that_ends_in_the_work_is_no_neighbour() {
        let whole = job([operation("a", flat(6.0), None)]);
        let step = whole.steps().next().unwrap();
        assert!(step.check_ends(0.0).is_ok());
        // Another operation may leave more of the part standing than this one's safe height knows of.
        let fault = step.check_ends(5.1).unwrap_err().to_string();
        assert!(fault.contains("the path of operation \"a\" does not begin and end"), "{fault}");
        let mut low = path(1.0);
        *low.tips.last_mut().unwrap() = DVec3::new(10.0, 0.0, 0.5);
        assert!(Step { toolpath: &low, ..step }.check_ends(0.0).is_err());
        let mut cut = path(1.0);
        cut.spans.pop();
        assert!(Step { toolpath: &cut, ..step }.check_ends(0.0).is_err());
    }

    #[test]
    fn speeds_come_from_the_node_then_the_tool_then_the_default() {
        let mut setup = Setup::default();
        let (tool, left) = (Yielding::left(0), Yielding::left(9000.0));
        let drive = Drive::new(&tool, &left, &setup);
        assert_eq!(drive, Drive { tool: None, spindle_rpm: 9000.0, spindle_yields: true });
        setup.conditions.spindle_rpm = Some(7000.0);
        let drive = Drive::new(&tool, &left, &setup);
        assert_eq!((drive.spindle_rpm, drive.spindle_yields), (7000.0, false));
        let drive = Drive::new(&Yielding::given(3), &Yielding::given(8000.0), &setup);
        assert_eq!(drive, Drive { tool: Some(3), spindle_rpm: 8000.0, spindle_yields: false });
    }

    #[test]
    fn cutters_are_described_by_shape_and_size() {
        assert_eq!(described(&ball(3.175)), "ball, diameter 3.175 mm");
    }
}
