//! The table of dialects.

use super::borrow;
use super::guard::{Fault, Stop};
use super::shelf::{Constant, count, kept_text, with};
use super::{Offer, Shelf};
use crate::{Arc, Command, Dialect, PostError, Program, Stock, Units};
use carvegraph_abi::{self as abi, Status, dialect_flag, status};
use std::io::{self, Write};
use std::mem::{offset_of, size_of};
use std::panic;
use std::ptr;

type Item = super::shelf::Item<dyn Dialect, abi::DialectInfo>;

pub(super) const fn factory<P: Offer>() -> abi::DialectFactory {
    abi::DialectFactory {
        struct_size: size_of::<abi::DialectFactory>() as u32,
        reserved: 0,
        count: dialect_count::<P>,
        describe: describe::<P>,
        post: post::<P>,
    }
}

fn board(shelf: &'static Shelf) -> &'static Vec<Item> {
    &shelf.dialects
}

unsafe extern "C" fn dialect_count<P: Offer>() -> u32 {
    count::<P, _>(board)
}

unsafe extern "C" fn describe<P: Offer>(index: u32, to: *mut abi::DialectInfo) -> Status {
    with::<P, _, _>(board, index, Fault(ptr::null()), |item| {
        let Constant(info) = item.info.get_or_init(|| Constant(info(&*item.thing)));
        // SAFETY: the host gives room for as many bytes as it says.
        unsafe { borrow::fill(to, info) };
        status::OK
    })
}

fn info(dialect: &dyn Dialect) -> abi::DialectInfo {
    let can = dialect.capabilities();
    let flag = |on: bool, flag: u32| if on { flag } else { 0 };
    abi::DialectInfo {
        struct_size: size_of::<abi::DialectInfo>() as u32,
        flags: flag(can.arcs, dialect_flag::ARCS)
            | flag(can.tool_change, dialect_flag::TOOL_CHANGE)
            | flag(can.path_tolerance, dialect_flag::PATH_TOLERANCE),
        name: kept_text(dialect.name()),
        about: kept_text(dialect.about()),
        extension: kept_text(dialect.extension()),
    }
}

unsafe extern "C" fn post<P: Offer>(
    index: u32,
    program: *const abi::Program,
    out: *const abi::Sink,
    _: *const abi::Run,
    fault: *const abi::Sink,
) -> Status {
    let fault = Fault(fault);
    with::<P, _, _>(board, index, fault, |item| {
        // SAFETY: the host lends both for the call.
        let (program, sink) = unsafe { (borrow::read(program), out.as_ref()) };
        // SAFETY: likewise for all that the program points to.
        let parts = unsafe { Parts::of(&program) };
        match (parts, sink) {
            (Ok(parts), Some(sink)) => written(&*item.thing, &parts.program(), sink, fault),
            (Err(message), _) => fault.tell(message),
            (_, None) => fault.tell("the host takes no output"),
        }
    })
}

fn written(dialect: &dyn Dialect, program: &Program<'_>, sink: &abi::Sink, fault: Fault) -> Status {
    let mut out = Out { sink, buffer: Vec::with_capacity(OUT_BYTES), refusals: 0 };
    match dialect.post(program, &mut out).and_then(|()| Ok(out.flush()?)) {
        Ok(()) => status::OK,
        Err(PostError::Io(_)) if out.refusals > 0 => status::STOPPED,
        Err(error) => fault.tell(&error.to_string()),
    }
}

/// A program in the host's memory.
struct Parts<'a> {
    title: &'a str,
    remarks: Vec<&'a str>,
    units: Units,
    path_tolerance_mm: f64,
    lines_only: bool,
    stock: Option<Stock>,
    commands: &'a [Command],
    texts: Vec<&'a str>,
    arcs: &'a [Arc],
}

const NOT_LENT: &str = "the host gave a program that cannot be read";
const TOO_NEW: &str =
    "carve is newer than this plugin and uses a command that it does not know: build it anew";

// A command and an arc are read where they lie: see `known_command` and `known_arc`.
const _: () = assert!(size_of::<Command>() == size_of::<abi::Command>());
const _: () = assert!(size_of::<Arc>() == size_of::<abi::Arc>());
const _: () = assert!(offset_of!(Arc, center) == offset_of!(abi::Arc, center));
const _: () = assert!(offset_of!(Arc, mm_per_min) == offset_of!(abi::Arc, mm_per_min));
const _: () = assert!(size_of::<Stock>() == size_of::<abi::Stock>());

impl<'a> Parts<'a> {
    /// # Safety
    /// All that the program points to lives for `'a`.
    unsafe fn of(program: &abi::Program) -> Result<Self, &'static str> {
        // SAFETY: the caller's promise.
        let lent = unsafe {
            (
                borrow::text(program.title),
                borrow::texts(program.remarks, program.remark_count),
                borrow::slice(program.commands, program.command_count),
                borrow::texts(program.texts, program.text_count),
                borrow::slice(program.arcs, program.arc_count),
            )
        };
        let (Some(title), Some(remarks), Some(commands), Some(texts), Some(arcs)) = lent else {
            return Err(NOT_LENT);
        };
        if !(commands.iter().all(known_command) && arcs.iter().all(known_arc) && program.units <= 1)
        {
            return Err(TOO_NEW);
        }
        // SAFETY: same layout, and every kind and direction in them was found to be a known one.
        let (commands, arcs) = unsafe {
            (
                &*(ptr::from_ref(commands) as *const [Command]),
                &*(ptr::from_ref(arcs) as *const [Arc]),
            )
        };
        // SAFETY: the caller's promise.
        let stock = unsafe { program.stock.as_ref() };
        Ok(Self {
            title,
            remarks,
            units: if program.units == 0 { Units::Mm } else { Units::Inch },
            path_tolerance_mm: program.path_tolerance_mm,
            lines_only: program.lines_only != 0,
            stock: stock.map(|stock| Stock { min: stock.min, max: stock.max }),
            commands,
            texts,
            arcs,
        })
    }

    fn program(&self) -> Program<'_> {
        Program {
            title: self.title,
            remarks: &self.remarks,
            units: self.units,
            path_tolerance_mm: self.path_tolerance_mm,
            lines_only: self.lines_only,
            stock: self.stock,
            commands: self.commands,
            texts: &self.texts,
            arcs: self.arcs,
        }
    }
}

/// Whether a command is one of [`Command`]'s.
fn known_command(command: &abi::Command) -> bool {
    match command.kind {
        // SAFETY: a spindle has a direction.
        abi::command::SPINDLE => unsafe { command.number.assume_init() <= 1 },
        kind => kind < abi::command::COUNT,
    }
}

fn known_arc(arc: &abi::Arc) -> bool {
    arc.plane <= 2 && arc.direction <= 1
}

/// Bytes that go to the host at once.
const OUT_BYTES: usize = 1 << 16;

/// A dialect that has been told so many times that no more is taken does not listen.
const REFUSALS: u32 = 1000;

/// The host's sink as a [`Write`].
struct Out<'a> {
    sink: &'a abi::Sink,
    buffer: Vec<u8>,
    refusals: u32,
}

impl Out<'_> {
    fn refused(&mut self) -> io::Error {
        self.refusals += 1;
        if self.refusals > REFUSALS {
            panic::resume_unwind(Box::new(Stop));
        }
        io::Error::other("carve takes no more of the program")
    }
}

impl Write for Out<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.refusals > 0 {
            return Err(self.refused());
        }
        self.buffer.extend_from_slice(bytes);
        if self.buffer.len() >= OUT_BYTES {
            self.flush()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.refusals > 0 {
            return Err(self.refused());
        }
        // SAFETY: the host's own function with the host's own data.
        let taken =
            unsafe { (self.sink.write)(self.sink.data, self.buffer.as_ptr(), self.buffer.len()) };
        self.buffer.clear();
        if taken == status::OK { Ok(()) } else { Err(self.refused()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Direction, Plane};

    /// What the ABI says a command is.
    fn seen(command: &Command) -> (u32, u32, [f64; 4]) {
        use abi::command as kind;
        // SAFETY: same size, and what a kind does not name is not looked at.
        let seen = unsafe { &*ptr::from_ref(command).cast::<abi::Command>() };
        // SAFETY: the kind has a number.
        let number = || unsafe { seen.number.assume_init() };
        let values = |count: usize| {
            let mut values = [0.0; 4];
            // SAFETY: the kind has as many values.
            (0..count).for_each(|i| values[i] = unsafe { seen.values[i].assume_init() });
            values
        };
        match seen.kind {
            kind::COMMENT | kind::TOOL_CHANGE | kind::ARC => (seen.kind, number(), values(0)),
            kind::SPINDLE => (seen.kind, number(), values(1)),
            kind::DWELL => (seen.kind, 0, values(1)),
            kind::RAPID => (seen.kind, 0, values(3)),
            kind::FEED => (seen.kind, 0, values(4)),
            _ => (seen.kind, 0, values(0)),
        }
    }

    #[test]
    fn commands_lie_in_memory_as_the_abi_says() {
        use abi::command as kind;
        let zero = [0.0; 4];
        assert_eq!(seen(&Command::Comment { text: 7 }), (kind::COMMENT, 7, zero));
        assert_eq!(seen(&Command::ToolChange { number: 3 }), (kind::TOOL_CHANGE, 3, zero));
        let spindle = Command::Spindle { direction: Direction::CounterClockwise, rpm: 9e3 };
        assert_eq!(seen(&spindle), (kind::SPINDLE, 1, [9e3, 0.0, 0.0, 0.0]));
        assert_eq!(seen(&Command::SpindleStop), (kind::SPINDLE_STOP, 0, zero));
        let dwell = Command::Dwell { seconds: 2.0 };
        assert_eq!(seen(&dwell), (kind::DWELL, 0, [2.0, 0.0, 0.0, 0.0]));
        let rapid = Command::Rapid { to: [1.0, 2.0, 3.0] };
        assert_eq!(seen(&rapid), (kind::RAPID, 0, [1.0, 2.0, 3.0, 0.0]));
        let feed = Command::Feed { to: [1.0, 2.0, 3.0], mm_per_min: 4.0 };
        assert_eq!(seen(&feed), (kind::FEED, 0, [1.0, 2.0, 3.0, 4.0]));
        assert_eq!(seen(&Command::Arc { arc: 5 }), (kind::ARC, 5, zero));
    }

    #[test]
    fn planes_and_directions_have_the_numbers_of_the_abi() {
        assert_eq!([Plane::Xy, Plane::Zx, Plane::Yz].map(|plane| plane as u32), [0, 1, 2]);
        let both = [Direction::Clockwise, Direction::CounterClockwise];
        assert_eq!(both.map(|direction| direction as u32), [0, 1]);
    }
}
