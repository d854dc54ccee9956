//! Machines as their profiles describe them.
//!
//! ```ron
//! Machine(
//!     format: 1,
//!     name: "my_router",                  // the file's name if left out
//!     about: "Router in the cellar",
//!     dialect: "grbl",
//!     travel: (x: "425mm", y: "425mm", z: "75mm"),
//!     max_feed: (x: "5m/min", y: "5m/min", z: "1m/min"),
//!     acceleration: (x: "400mm/s2", y: "400mm/s2", z: "100mm/s2"),
//!     junction_deviation: "0.02mm",
//!     rapid: "5m/min",
//!     arcs: true,
//!     spindle: (min: "10000rpm", max: "30000rpm", set_by: "program"),
//!     tool_change: "none",                // manual, automatic
//!     safe_z: "5mm",
//! )
//! ```
//!
//! Format, dialect and travel must be there. What is left out is not known and not checked. A travel is a
//! length, for where the work zero lies on the machine is not known; a machine with a work zero of its own
//! gives what can be reached as seen from there: `x: (min: "-10mm", max: "415mm")`.

use super::{NONE, file, short, version};
use carvegraph_core::Diagnostics;
use carvegraph_core::ron::{Form, Item, ValueKind, parse};
use carvegraph_core::source::Source;
use carvegraph_core::units::Dimension;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// No machine is longer than a hundred metres, and none that carves is shorter than a millimetre.
const TRAVELS_MM: RangeInclusive<f64> = 1.0..=100_000.0;

/// Places as seen from a work zero.
const PLACES_MM: RangeInclusive<f64> = -100_000.0..=100_000.0;

/// Feeds and rapids, those that `link` takes.
const SPEEDS_MM_PER_MIN: RangeInclusive<f64> = 1.0..=500_000.0;

/// Up to ten times that of gravity.
const ACCELERATIONS_MM_PER_S2: RangeInclusive<f64> = 0.1..=100_000.0;

/// GRBL's is some hundredths of a millimetre.
const JUNCTION_DEVIATIONS_MM: RangeInclusive<f64> = 0.0001..=10.0;

/// Those that `post` takes.
const SPINDLES_RPM: RangeInclusive<f64> = 1.0..=200_000.0;

/// Those that `link` takes.
const SAFE_HEIGHTS_MM: RangeInclusive<f64> = 0.1..=500.0;

/// How far an axis goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Travel {
    /// So far, in mm; where the work zero lies is not known.
    Length(f64),
    /// From here to there, in mm as seen from the work zero.
    Range {
        /// The least coordinate.
        min: f64,
        /// The greatest.
        max: f64,
    },
}

/// Who sets the spindle's speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SetBy {
    /// The program.
    Program,
    /// The operator, at a knob: the program can only say which one it wants.
    Hand,
}

/// Speeds that the spindle turns at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpindleRange {
    /// The lowest, in rpm.
    pub min_rpm: Option<f64>,
    /// The highest, in rpm.
    pub max_rpm: Option<f64>,
    /// Who sets it.
    pub set_by: SetBy,
}

/// How a machine changes tools.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToolChange {
    /// Not within a program.
    None,
    /// The program waits for the operator.
    Manual,
    /// By itself.
    Automatic,
}

/// A machine, as far as it is known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// What recipes call it.
    pub name: String,
    /// What it is, in a line.
    pub about: String,
    /// What its controller understands.
    pub dialect: Option<String>,
    /// Where the profile says so: `file:line:column`.
    pub dialect_place: String,
    /// How far X, Y and Z go.
    pub travel: [Option<Travel>; 3],
    /// The greatest feeds of X, Y and Z in mm/min.
    pub max_feed_mm_per_min: [Option<f64>; 3],
    /// How fast X, Y and Z gather speed, in mm/s².
    pub acceleration_mm_per_s2: [Option<f64>; 3],
    /// How far the controller thinks itself off a corner, in mm, when it decides how fast to take it.
    pub junction_deviation_mm: Option<f64>,
    /// Speed of rapids in mm/min.
    pub rapid_mm_per_min: Option<f64>,
    /// Whether it takes arcs.
    pub arcs: Option<bool>,
    /// The spindle's speeds.
    pub spindle: Option<SpindleRange>,
    /// How it changes tools.
    pub tool_change: Option<ToolChange>,
    /// How far above the part it may travel anywhere, in mm.
    pub safe_z_mm: Option<f64>,
    /// Changes with the profile.
    pub version: String,
}

/// No machine: nothing is known.
impl Default for Machine {
    fn default() -> Self {
        Self {
            name: NONE.into(),
            about: String::new(),
            dialect: None,
            dialect_place: String::new(),
            travel: [None; 3],
            max_feed_mm_per_min: [None; 3],
            acceleration_mm_per_s2: [None; 3],
            junction_deviation_mm: None,
            rapid_mm_per_min: None,
            arcs: None,
            spindle: None,
            tool_change: None,
            safe_z_mm: None,
            version: String::new(),
        }
    }
}

impl Machine {
    /// Reads a profile; answers the machine's name too.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn read(source: &Arc<Source>) -> Result<(String, Self), Diagnostics> {
        let value = parse(source)?;
        let form = Form::default();
        let read = machine(&form, form.item(&value, "the machine"), source);
        form.finish(read).map(|machine| (machine.name.clone(), machine))
    }

    /// Whether it is no machine.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }

    /// Whether its operator sets the speed of the spindle.
    #[must_use]
    pub fn spindle_by_hand(&self) -> bool {
        self.spindle.is_some_and(|spindle| spindle.set_by == SetBy::Hand)
    }

    /// The speed that is nearest to a wanted one, in rpm.
    pub(crate) fn nearest_spindle_rpm(&self, rpm: f64) -> f64 {
        let range = self.spindle;
        let least = range.and_then(|range| range.min_rpm).unwrap_or(0.0);
        let most = range.and_then(|range| range.max_rpm).unwrap_or(f64::INFINITY);
        rpm.max(least).min(most)
    }
}

/// The machines that the program knows.
pub struct Machines(pub Vec<Machine>);

/// The built-in profiles: file, text.
const BUILT_IN: [(&str, &str); 9] = [
    ("cnc_3018.ron", include_str!("../../../machines/cnc_3018.ron")),
    ("generic_router_600x400.ron", include_str!("../../../machines/generic_router_600x400.ron")),
    ("haas_mini_mill.ron", include_str!("../../../machines/haas_mini_mill.ron")),
    ("haas_vf_2.ron", include_str!("../../../machines/haas_vf_2.ron")),
    ("mpcnc_600x600.ron", include_str!("../../../machines/mpcnc_600x600.ron")),
    ("shapeoko_3.ron", include_str!("../../../machines/shapeoko_3.ron")),
    ("sherline_5400.ron", include_str!("../../../machines/sherline_5400.ron")),
    ("shopbot_96x48.ron", include_str!("../../../machines/shopbot_96x48.ron")),
    ("x_carve_1000.ron", include_str!("../../../machines/x_carve_1000.ron")),
];

impl Machines {
    /// Those that are part of the program, sorted by name.
    #[must_use]
    pub fn built_in() -> Self {
        let read = |(file, text): (&str, &str)| {
            let source = Arc::new(Source::new(format!("machines/{file}"), text));
            let machine = Machine::read(&source).map(|(_, machine)| machine);
            machine.unwrap_or_else(|faults| unreachable!("a test reads {file}: {faults}"))
        };
        Self(BUILT_IN.into_iter().map(read).collect())
    }

    /// The machine called `name`; [`NONE`] is one of which nothing is known.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<Machine> {
        if name == NONE {
            return Some(Machine::default());
        }
        self.0.iter().find(|machine| machine.name == name).cloned()
    }

    /// A row each: name, travel, dialect, spindle, what it is.
    #[must_use]
    pub fn rows(&self) -> Vec<Vec<String>> {
        self.0.iter().map(Machine::row).collect()
    }
}

impl Machine {
    fn row(&self) -> Vec<String> {
        let travels = self.travel.iter().flatten().map(Travel::shown).collect::<Vec<_>>();
        let spindle = self.spindle.map(SpindleRange::shown).unwrap_or_default();
        let dialect = self.dialect.clone().unwrap_or_default();
        vec![
            self.name.clone(),
            format!("{} mm", travels.join(" x ")),
            dialect,
            spindle,
            self.about.clone(),
        ]
    }
}

impl Travel {
    fn shown(&self) -> String {
        match *self {
            Self::Length(length) => short(length),
            Self::Range { min, max } => format!("({} to {})", short(min), short(max)),
        }
    }
}

impl SpindleRange {
    fn shown(self) -> String {
        let range = match (self.min_rpm, self.max_rpm) {
            (Some(min), Some(max)) => format!("{min} to {max} rpm"),
            (Some(min), None) => format!("from {min} rpm"),
            (None, Some(max)) => format!("to {max} rpm"),
            (None, None) => String::new(),
        };
        let by_hand = if self.set_by == SetBy::Hand { "by hand" } else { "" };
        format!("{range} {by_hand}").trim().to_owned()
    }
}

fn machine(form: &Form, item: Item<'_>, source: &Source) -> Option<Machine> {
    let mut fields = item.fields(Some("Machine"))?;
    if !file::is_readable(form, &mut fields) {
        return None;
    }
    let number = |dimension, range: RangeInclusive<f64>| {
        move |item: Item<'_>| item.number(dimension, range.clone())
    };
    let speed = || number(Dimension::Feed, SPEEDS_MM_PER_MIN);
    let acceleration = number(Dimension::Acceleration, ACCELERATIONS_MM_PER_S2);
    let changes = [
        ("none", ToolChange::None),
        ("manual", ToolChange::Manual),
        ("automatic", ToolChange::Automatic),
    ];
    let name = file::name_of(form, &mut fields, source, "a machine");
    let about = file::text(fields.optional("about"));
    let dialect = fields.required("dialect").and_then(Item::name);
    let travel = fields.required("travel").map(|item| axes(item, true, travel));
    let read = Machine {
        name: name.unwrap_or_default(),
        about,
        dialect_place: dialect.as_ref().map(|dialect| dialect.span.to_string()).unwrap_or_default(),
        dialect: dialect.map(|dialect| dialect.text),
        travel: travel.unwrap_or_default(),
        max_feed_mm_per_min: fields
            .optional("max_feed")
            .map(|item| axes(item, false, speed()))
            .unwrap_or_default(),
        acceleration_mm_per_s2: fields
            .optional("acceleration")
            .map(|item| axes(item, false, acceleration))
            .unwrap_or_default(),
        junction_deviation_mm: fields
            .optional("junction_deviation")
            .and_then(number(Dimension::Length, JUNCTION_DEVIATIONS_MM)),
        rapid_mm_per_min: fields.optional("rapid").and_then(speed()),
        arcs: fields.optional("arcs").and_then(Item::switch),
        spindle: fields.optional("spindle").and_then(spindle),
        tool_change: fields.optional("tool_change").and_then(|item| item.choice(&changes)),
        safe_z_mm: fields.optional("safe_z").and_then(number(Dimension::Length, SAFE_HEIGHTS_MM)),
        version: version(source),
    };
    fields.no_more();
    Some(read)
}

/// A value for each axis, or for some of them unless `all` are wanted.
fn axes<'a, T>(
    item: Item<'a>,
    all: bool,
    read: impl Fn(Item<'a>) -> Option<T> + Clone,
) -> [Option<T>; 3] {
    let Some(mut fields) = item.fields(None) else { return [None, None, None] };
    let values = ["x", "y", "z"].map(|axis| {
        let item = if all { fields.required(axis) } else { fields.optional(axis) };
        item.and_then(read.clone())
    });
    fields.no_more();
    values
}

fn travel(item: Item<'_>) -> Option<Travel> {
    if !matches!(item.value().kind, ValueKind::Struct { .. }) {
        return item.number(Dimension::Length, TRAVELS_MM).map(Travel::Length);
    }
    let mut fields = item.clone().fields(None)?;
    let mut place =
        |name| fields.required(name).and_then(|item| item.number(Dimension::Length, PLACES_MM));
    let (min, max) = (place("min"), place("max"));
    fields.no_more();
    let (min, max) = (min?, max?);
    if min >= max {
        item.fault(format!("max ({max} mm) must be above min ({min} mm)"));
    }
    Some(Travel::Range { min, max })
}

fn spindle(item: Item<'_>) -> Option<SpindleRange> {
    let mut fields = item.clone().fields(None)?;
    let mut speed =
        |name| fields.optional(name).and_then(|item| item.number(Dimension::Spindle, SPINDLES_RPM));
    let (min_rpm, max_rpm) = (speed("min"), speed("max"));
    let set_by = fields.optional("set_by");
    let set_by =
        set_by.and_then(|item| item.choice(&[("program", SetBy::Program), ("hand", SetBy::Hand)]));
    fields.no_more();
    if let (Some(min), Some(max)) = (min_rpm, max_rpm)
        && min > max
    {
        item.fault(format!("max ({max} rpm) must not be below min ({min} rpm)"));
    }
    Some(SpindleRange { min_rpm, max_rpm, set_by: set_by.unwrap_or(SetBy::Program) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(String, Machine), Diagnostics> {
        Machine::read(&Arc::new(Source::new("shed/mill.ron", text)))
    }

    /// Each fault in a line: place, message, help.
    fn faults(text: &str) -> Vec<String> {
        let faults = read(text).err().unwrap();
        let line = |fault: &&carvegraph_core::Diagnostic| {
            let place = fault.span.as_ref().map(ToString::to_string).unwrap_or_default();
            let help = fault.help.as_deref().map(|help| format!("; {help}")).unwrap_or_default();
            format!("{place} {}{help}", fault.message)
        };
        faults.sorted().iter().map(line).collect()
    }

    const LEAST: &str = r#"(format: 1, dialect: "grbl", travel: (x: 300, y: "20cm", z: "2in"))"#;

    #[test]
    fn what_is_left_out_is_not_known() {
        let (name, machine) = read(LEAST).unwrap();
        assert_eq!(name, "mill");
        let travel = [300.0, 200.0, 50.8].map(|length| Some(Travel::Length(length)));
        let version = machine.version.clone();
        let expected = Machine {
            name: "mill".into(),
            dialect: Some("grbl".into()),
            dialect_place: "shed/mill.ron:1:22".into(),
            travel,
            version,
            ..Machine::default()
        };
        assert_eq!(machine, expected);
    }

    #[test]
    fn everything_that_can_be_said_is_read() {
        let text = r#"Machine(format: 1, name: "big", about: "Big", dialect: "haas",
            travel: (x: (min: -10, max: "1m"), y: 500, z: 100), max_feed: (x: "10m/min", z: 500),
            acceleration: (y: 250.5), junction_deviation: 0.02, rapid: "200in/min", arcs: false,
            spindle: (min: 100, max: "6000rpm", set_by: "hand"), tool_change: "manual", safe_z: "1in")"#;
        let (name, machine) = read(text).unwrap();
        assert_eq!((name.as_str(), machine.about.as_str()), ("big", "Big"));
        assert_eq!(machine.travel[0], Some(Travel::Range { min: -10.0, max: 1000.0 }));
        assert_eq!(machine.max_feed_mm_per_min, [Some(10_000.0), None, Some(500.0)]);
        assert_eq!(machine.acceleration_mm_per_s2, [None, Some(250.5), None]);
        assert_eq!(machine.junction_deviation_mm, Some(0.02));
        assert_eq!(machine.rapid_mm_per_min, Some(5080.0));
        assert_eq!((machine.arcs, machine.safe_z_mm), (Some(false), Some(25.4)));
        let (min_rpm, max_rpm) = (Some(100.0), Some(6000.0));
        assert_eq!(machine.spindle, Some(SpindleRange { min_rpm, max_rpm, set_by: SetBy::Hand }));
        assert_eq!(machine.tool_change, Some(ToolChange::Manual));
        assert_eq!(
            machine.row(),
            ["big", "(-10 to 1000) x 500 x 100 mm", "haas", "100 to 6000 rpm by hand", "Big"]
        );
    }

    #[test]
    fn all_faults_are_told_at_once() {
        assert_eq!(
            faults(
                r#"Machine(format: 1, name: "my mill", travell: 5, dialect: grbl,
travel: (x: "300deg", y: (min: 5, max: 5)),
spindle: (min: 9000, max: 800, rpm: 5), tool_change: "yes", max_feed: 800)"#
            ),
            [
                r#"shed/mill.ron:1:26 "my mill" is no name for a machine; letters, digits, _ and - do, 64 at most"#,
                r#"shed/mill.ron:1:37 the machine has no field "travell"; did you mean "travel"?"#,
                "shed/mill.ron:1:58 dialect must be a text in double quotes, not a bare word; write \"grbl\"",
                r#"shed/mill.ron:2:9 travel lacks the field "z""#,
                r#"shed/mill.ron:2:13 x: "300deg" is an angle; a length is wanted: mm, cm, m, um, in, thou, ft"#,
                "shed/mill.ron:2:26 max (5 mm) must be above min (5 mm)",
                "shed/mill.ron:3:10 max (800 rpm) must not be below min (9000 rpm)",
                r#"shed/mill.ron:3:32 spindle has no field "rpm"; there is max, min, set_by"#,
                r#"shed/mill.ron:3:54 tool_change cannot be "yes"; it is one of none, manual, automatic"#,
                "shed/mill.ron:3:71 max_feed must be fields in (...), not a whole number",
            ]
        );
        assert_eq!(
            faults("(dialect: \"grbl\")"),
            [
                r#"shed/mill.ron:1:1 the machine lacks the field "format""#,
                r#"shed/mill.ron:1:1 the machine lacks the field "travel""#,
            ]
        );
    }

    #[test]
    fn a_newer_format_is_told_and_nothing_else() {
        assert_eq!(
            faults("Machine(format: 2, axes: 5)"),
            ["shed/mill.ron:1:17 this file has format 2; this program reads formats up to 1; \
                 update carve to use it"]
        );
        let none = "shed/mill.ron:1:17 there is no format 0; the first one is 1".to_owned();
        assert!(faults("Machine(format: 0)").contains(&none));
    }

    #[test]
    fn none_is_the_name_of_no_machine() {
        let none = LEAST.replace("format: 1", "format: 1, name: \"none\"");
        assert!(
            faults(&none)[0]
                .contains("\"none\" is no name for a machine: it stands for having none")
        );
        let source = Arc::new(Source::new("none.ron", LEAST));
        let fault = Machine::read(&source).unwrap_err().to_string();
        assert!(fault.contains("the file's name, \"none\", is no name for a machine"), "{fault}");
        assert!(Machines(Vec::new()).find(NONE).is_some_and(|machine| machine.is_none()));
    }

    #[test]
    fn another_text_is_another_version() {
        let version = |text: &str| read(text).unwrap().1.version;
        assert_eq!(version(LEAST), version(LEAST));
        assert_ne!(version(LEAST), version(&LEAST.replace("300", "301")));
    }

    #[test]
    fn every_built_in_profile_is_read_and_listed_by_the_name_of_its_file() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../machines");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files = files.filter(|path| path.extension().is_some_and(|known| known == "ron"));
        let mut stems: Vec<String> =
            files.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
        stems.sort();
        let machines = Machines::built_in();
        let names: Vec<_> = machines.0.iter().map(|machine| machine.name.clone()).collect();
        assert_eq!(names, stems);
        for machine in &machines.0 {
            let known = machine.travel.iter().flatten().count() == 3 && !machine.about.is_empty();
            assert!(known, "{}", machine.name);
            assert!(machines.find(&machine.name).is_some());
        }
    }
}
