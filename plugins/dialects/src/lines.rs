//! The lines that a dialect says by itself, as templates, and how they are rendered.

use crate::Text;
use crate::block::Blocks;
use crate::comment::{CommentStyle, brackets, harmless};
use crate::name;
use crate::template::{self, PROGRAM_VALUES, settled, title_value, unmarked};
use crate::words::rejected;
use carvegraph_sdk::{PostError, Program, Units};
use minijinja::value::Value;
use minijinja::{Environment, Template};
use std::convert::Infallible;

/// The longest name that Siemens takes, and longer than anybody reads.
const NAME_LENGTH: usize = 24;

/// Characters of a title that a line holds; what stands beside them must fit too.
pub(crate) const TITLE_LENGTH: usize = 40;

/// All the lines of a dialect: their templates, or what is made of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines<T> {
    /// Before everything else, without block numbers.
    pub(crate) opening: T,
    /// Remarks that the operator must know, after the program's own: one a line.
    pub(crate) notes: T,
    /// Remarks for a program that takes up no tool.
    pub(crate) note_without_tool: T,
    /// Remarks before the first dwell.
    pub(crate) note_on_dwell: T,
    /// Modes set at the head.
    pub(crate) header: T,
    /// Tells how far the controller may leave the path.
    pub(crate) path_tolerance: T,
    /// Sends Z to the machine's top, before a tool change or a program that has none. With it, the
    /// first rapid travels up there.
    pub(crate) retract: T,
    /// Remarks on a tool, before it is changed to.
    pub(crate) tool_note: T,
    /// Changes to a tool.
    pub(crate) tool_change: T,
    /// Takes up a tool's length: words for the block that first moves Z.
    pub(crate) tool_length: T,
    /// Starts the spindle or changes its speed.
    pub(crate) spindle_clockwise: T,
    /// The same the other way; empty where it cannot turn so.
    pub(crate) spindle_counterclockwise: T,
    /// Stops the spindle.
    pub(crate) spindle_stop: T,
    /// Waits.
    pub(crate) dwell: T,
    /// How a program ends, after the spindle's stop.
    pub(crate) footer: T,
    /// After the end, without block numbers.
    pub(crate) closing: T,
}

/// What a line is, for messages and checks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// What a dialect's file calls it.
    pub(crate) name: &'static str,
    /// What it may name besides [`PROGRAM_VALUES`].
    pub(crate) values: &'static [&'static str],
    /// Whether it becomes a comment, not a block.
    pub(crate) is_remark: bool,
}

impl<T> Lines<T> {
    /// Looks at each line.
    pub(crate) fn each<'t>(&'t self, mut look: impl FnMut(Line, &'t T)) {
        let looked = self.try_map(|line, text| {
            look(line, text);
            Ok::<(), Infallible>(())
        });
        let Ok(_) = looked;
    }

    /// Makes something of each line.
    pub(crate) fn try_map<'t, U, E>(
        &'t self,
        mut make: impl FnMut(Line, &'t T) -> Result<U, E>,
    ) -> Result<Lines<U>, E> {
        let mut block = |name, values, line| make(Line { name, values, is_remark: false }, line);
        let (opening, header) =
            (block("opening", &[], &self.opening)?, block("header", &[], &self.header)?);
        let path_tolerance = block("path_tolerance", &["tolerance"], &self.path_tolerance)?;
        let retract = block("retract", &[], &self.retract)?;
        let tool_change = block("tool_change", &["tool"], &self.tool_change)?;
        let tool_length = block("tool_length", &["tool"], &self.tool_length)?;
        let spindle_clockwise = block("spindle.clockwise", &["rpm"], &self.spindle_clockwise)?;
        let spindle_counterclockwise =
            block("spindle.counterclockwise", &["rpm"], &self.spindle_counterclockwise)?;
        let spindle_stop = block("spindle.stop", &[], &self.spindle_stop)?;
        let dwell = block("dwell", &["seconds", "milliseconds"], &self.dwell)?;
        let (footer, closing) =
            (block("footer", &[], &self.footer)?, block("closing", &[], &self.closing)?);
        let mut remark = |name, values, line| make(Line { name, values, is_remark: true }, line);
        Ok(Lines {
            opening,
            notes: remark("notes", &[], &self.notes)?,
            note_without_tool: remark("note_without_tool", &[], &self.note_without_tool)?,
            note_on_dwell: remark("note_on_dwell", &[], &self.note_on_dwell)?,
            header,
            path_tolerance,
            retract,
            tool_note: remark("tool_note", &["tool"], &self.tool_note)?,
            tool_change,
            tool_length,
            spindle_clockwise,
            spindle_counterclockwise,
            spindle_stop,
            dwell,
            footer,
            closing,
        })
    }
}

impl Line {
    /// All that it may name, sorted.
    pub(crate) fn known(&self) -> Vec<&'static str> {
        let mut known = [self.values, &PROGRAM_VALUES].concat();
        known.sort_unstable();
        known
    }
}

/// What the lines of one program have in common.
#[derive(Clone, Copy)]
pub(crate) struct Common<'a> {
    pub(crate) dialect: &'a str,
    pub(crate) comments: Option<&'a CommentStyle>,
    /// Words that the controller must not be told, blanks between them.
    pub(crate) rejects: &'a str,
    /// What stands for the program's units.
    pub(crate) units_word: &'a str,
    pub(crate) program_number: ProgramNumber,
    /// The longest name that the controller takes.
    pub(crate) name_length: usize,
}

impl<'a> Common<'a> {
    /// For a dialect of its own language.
    pub(crate) fn new(dialect: &'a str, units_word: &'a str) -> Self {
        Self {
            dialect,
            comments: None,
            rejects: "",
            units_word,
            program_number: ProgramNumber { digits: 4, limit: 7999 },
            name_length: NAME_LENGTH,
        }
    }
}

/// How a program's number is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProgramNumber {
    pub(crate) digits: u32,
    pub(crate) limit: u32,
}

/// A dialect's lines, compiled for one program.
pub(crate) struct Sheet<'a> {
    common: Common<'a>,
    lines: Lines<Compiled<'a>>,
    /// What every line may name.
    values: Vec<(&'static str, Value)>,
}

/// A template, or `None` for a line that the dialect does not have.
type Compiled<'a> = Option<Template<'a, 'a>>;

/// What a template gives: lines, or why not.
type Rendered = Result<Vec<String>, PostError>;

/// One of a sheet's templates.
pub(crate) type Pick = for<'s, 'a> fn(&'s Lines<Compiled<'a>>) -> &'s Compiled<'a>;

impl<'a> Sheet<'a> {
    /// Compiles `lines` by `engine`.
    ///
    /// # Errors
    /// If one is no template. Lines from a file were found good when the dialect was made of it.
    pub(crate) fn new(
        engine: &'a Environment<'a>,
        lines: &'a Lines<Text>,
        common: Common<'a>,
        program: &Program<'_>,
    ) -> Result<Self, PostError> {
        let lines = lines.try_map(|line, source| {
            if source.trim().is_empty() {
                return Ok(None);
            }
            let compiled = engine.template_from_named_str(line.name, source);
            compiled.map(Some).map_err(|error| fault(common.dialect, &error.to_string()))
        })?;
        Ok(Self { values: values(&common, program), lines, common })
    }

    /// Writes lines as blocks.
    ///
    /// # Errors
    /// Those of [`Sheet::render`] and of writing.
    pub(crate) fn write(
        &self,
        pick: Pick,
        more: &[(&'static str, Value)],
        blocks: &mut Blocks<'_>,
    ) -> Result<(), PostError> {
        self.render(pick, more)?.iter().try_for_each(|line| blocks.line(line))
    }

    /// The lines that a template gives, ready to be written.
    ///
    /// # Errors
    /// If it cannot be rendered with these values, or gives what must not be written.
    pub(crate) fn render(&self, pick: Pick, more: &[(&'static str, Value)]) -> Rendered {
        self.blocks_of(pick(&self.lines), more)
    }

    /// The same for remarks, which become comments and may say anything.
    pub(crate) fn remarks(&self, pick: Pick, more: &[(&'static str, Value)]) -> Rendered {
        self.remarks_of(pick(&self.lines), more)
    }

    /// Renders every line with these values.
    pub(crate) fn each(
        &self,
        more: &[(&'static str, Value)],
        mut look: impl FnMut(Line, Rendered),
    ) {
        self.lines.each(|line, template| {
            let is_remark = line.is_remark;
            look(
                line,
                match template {
                    template if is_remark => self.remarks_of(template, more),
                    template => self.blocks_of(template, more),
                },
            );
        });
    }

    fn blocks_of(&self, template: &Compiled<'_>, more: &[(&'static str, Value)]) -> Rendered {
        self.rendered(template, more)?.iter().map(|line| self.line(line)).collect()
    }

    fn remarks_of(&self, template: &Compiled<'_>, more: &[(&'static str, Value)]) -> Rendered {
        Ok(self.rendered(template, more)?.iter().map(|line| unmarked(line)).collect())
    }

    fn rendered(&self, template: &Compiled<'_>, more: &[(&'static str, Value)]) -> Rendered {
        let Some(template) = template else { return Ok(Vec::new()) };
        let values = self.values.iter().chain(more).map(|(name, value)| (*name, value.clone()));
        let rendered = template::render(template, values);
        rendered.map_err(|error| fault(self.common.dialect, &error.to_string()))
    }

    fn line(&self, line: &str) -> Result<String, PostError> {
        let Common { dialect, comments, rejects, .. } = self.common;
        let text = settled(line, comments)
            .map_err(|why| fault(dialect, &format!("it would write {line:?}: {why}")))?;
        if comments.is_some_and(|style| style.opens(&text)) {
            return Ok(text);
        }
        match rejected(&text, rejects) {
            Some(word) => {
                let (dialect, word) = (dialect.to_owned(), word.to_owned());
                Err(PostError::Rejected { dialect, line: text, word })
            }
            None => Ok(text),
        }
    }
}

fn fault(dialect: &str, message: &str) -> PostError {
    PostError::Plugin(format!("the dialect {dialect} is at fault: {message}"))
}

fn values(common: &Common<'_>, program: &Program<'_>) -> Vec<(&'static str, Value)> {
    let ProgramNumber { digits, limit } = common.program_number;
    let digits = digits as usize;
    let number = format!("{:0digits$}", name::number(program.title, limit));
    let unit = match program.units {
        Units::Mm => "millimetres",
        Units::Inch => "inches",
    };
    let plain = brackets();
    let title = harmless(common.comments.unwrap_or(&plain), program.title, TITLE_LENGTH);
    vec![
        ("name", Value::from(name::name(program.title, common.name_length))),
        ("number", Value::from(number)),
        ("title", title_value(&title)),
        ("unit", Value::from(unit)),
        ("units", Value::from(common.units_word)),
    ]
}
