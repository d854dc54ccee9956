//! A dialect in a library.

use crate::borrow::{self, Given, all_lent, handle, lent};
use crate::message::{heard, reason};
use crate::watch::{Line, watched};
use carvegraph_abi::{self as abi, Status, dialect_flag, status};
use carvegraph_sdk::node::Alone;
use carvegraph_sdk::{Capabilities, Dialect, PostError, Program, Units};
use std::ffi::c_void;
use std::mem::{size_of, zeroed};
use std::{io, ptr, slice};

/// Bytes that go from the plugin's thread to the caller's at once. Each time costs two threads a
/// waking, some tens of microseconds; with 64 KiB that showed in a program of 10 MB.
const CHUNK_BYTES: usize = 1 << 20;

/// What a program may have besides what its commands need: a long head.
const MAX_HEAD_BYTES: usize = 64 << 20;

/// What a command may need: an arc of ten metres in chords of a micrometre's deviation.
const MAX_COMMAND_BYTES: usize = 64 << 10;

/// A dialect, and where it is in its library's table.
pub(crate) struct LibraryDialect {
    table: &'static abi::DialectFactory,
    index: u32,
    name: String,
    about: String,
    extension: String,
    capabilities: Capabilities,
}

impl LibraryDialect {
    /// Asks the library what dialect stands at an index.
    ///
    /// # Safety
    /// The table keeps the rules of the ABI.
    pub(crate) unsafe fn describe(
        table: &'static abi::DialectFactory,
        index: u32,
    ) -> Result<Self, Given> {
        // SAFETY: numbers and pointers are valid as zeros.
        let mut info: abi::DialectInfo = unsafe { zeroed() };
        info.struct_size = size_of::<abi::DialectInfo>() as u32;
        // SAFETY: the caller's promise.
        let answer = unsafe { (table.describe)(index, &raw mut info) };
        if answer != status::OK {
            return Err(Given::Nothing { why: reason(answer, String::new()) });
        }
        let can = |flag: u32| info.flags & flag != 0;
        // SAFETY: the ABI says that a description stays valid for good.
        unsafe {
            Ok(Self {
                table,
                index,
                name: borrow::name("dialect's name", info.name)?,
                about: borrow::text("dialect's description", info.about)?,
                extension: borrow::extension(info.extension)?,
                capabilities: Capabilities {
                    arcs: can(dialect_flag::ARCS),
                    tool_change: can(dialect_flag::TOOL_CHANGE),
                    path_tolerance: can(dialect_flag::PATH_TOLERANCE),
                },
            })
        }
    }

    /// Calls the library.
    fn call(&self, program: &Lent<'_>, line: &Line<'_>) -> (Status, String, Option<TooLong>) {
        let room = MAX_HEAD_BYTES + MAX_COMMAND_BYTES * program.commands;
        let mut out = Out { line, chunk: Vec::with_capacity(CHUNK_BYTES), room, stopped: None };
        let sink = abi::Sink { data: handle(&mut out), write };
        let (answer, said) = heard(|fault| {
            // SAFETY: the table keeps the rules of the ABI, and all that is lent outlives the call.
            unsafe {
                let (program, sink) = (&raw const program.program, &raw const sink);
                (self.table.post)(self.index, program, sink, line.handle(), fault)
            }
        });
        out.flush();
        let too_long = matches!(out.stopped, Some(Stopped::TooLong)).then_some(TooLong(room));
        (answer, said, too_long)
    }
}

impl Dialect for LibraryDialect {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn extension(&self) -> &str {
        &self.extension
    }

    fn capabilities(&self) -> Capabilities {
        self.capabilities
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn io::Write) -> Result<(), PostError> {
        let texts = Texts::of(program);
        let lent = Lent::of(program, &texts);
        let ended = watched(&Alone, |bytes| out.write_all(bytes), |line| self.call(&lent, line));
        let ((answer, said, too_long), written) =
            ended.map_err(|trouble| PostError::Plugin(trouble.to_string()))?;
        written?;
        match too_long {
            Some(TooLong(room)) => {
                let commands = program.commands.len();
                let message = format!(
                    "it wrote more than {room} bytes for {commands} commands and was stopped"
                );
                Err(PostError::Plugin(message))
            }
            None if answer != status::OK => Err(PostError::Plugin(reason(answer, said))),
            None => Ok(()),
        }
    }
}

/// The output had more bytes than this.
struct TooLong(usize);

/// The lists of texts of a program, as the ABI has them.
struct Texts {
    remarks: Vec<abi::Text>,
    texts: Vec<abi::Text>,
    stock: Option<abi::Stock>,
}

impl Texts {
    fn of(program: &Program<'_>) -> Self {
        let stock = program.stock.map(|stock| abi::Stock { min: stock.min, max: stock.max });
        Self { remarks: all_lent(program.remarks), texts: all_lent(program.texts), stock }
    }
}

/// A program as the ABI has it.
struct Lent<'a> {
    program: abi::Program,
    commands: usize,
    _of: std::marker::PhantomData<&'a ()>,
}

// SAFETY: it points to what outlives it and is only read.
unsafe impl Sync for Lent<'_> {}

impl<'a> Lent<'a> {
    fn of(program: &'a Program<'_>, texts: &'a Texts) -> Self {
        let lent = abi::Program {
            struct_size: size_of::<abi::Program>() as u32,
            units: match program.units {
                Units::Mm => 0,
                Units::Inch => 1,
            },
            title: lent(program.title),
            remarks: texts.remarks.as_ptr(),
            remark_count: texts.remarks.len(),
            path_tolerance_mm: program.path_tolerance_mm,
            stock: texts.stock.as_ref().map_or(ptr::null(), ptr::from_ref),
            // The sdk holds the two layouts together.
            commands: program.commands.as_ptr().cast(),
            command_count: program.commands.len(),
            texts: texts.texts.as_ptr(),
            text_count: texts.texts.len(),
            arcs: program.arcs.as_ptr().cast(),
            arc_count: program.arcs.len(),
            lines_only: u32::from(program.lines_only),
            reserved: 0,
        };
        Self { program: lent, commands: program.commands.len(), _of: std::marker::PhantomData }
    }
}

/// Why no more output is taken.
#[derive(Clone, Copy)]
enum Stopped {
    /// The caller wants no more.
    Caller,
    /// It is longer than any program for these commands.
    TooLong,
}

/// Output on its way from the plugin to the caller.
struct Out<'a> {
    line: &'a Line<'a>,
    chunk: Vec<u8>,
    /// Bytes that may still come.
    room: usize,
    stopped: Option<Stopped>,
}

impl Out<'_> {
    fn take(&mut self, bytes: &[u8]) {
        match self.room.checked_sub(bytes.len()) {
            Some(room) => self.room = room,
            None => return self.stopped = Some(Stopped::TooLong),
        }
        self.chunk.extend_from_slice(bytes);
        if self.chunk.len() >= CHUNK_BYTES {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if self.stopped.is_none() && !self.chunk.is_empty() {
            let chunk = std::mem::replace(&mut self.chunk, Vec::with_capacity(CHUNK_BYTES));
            if !self.line.write(chunk) {
                self.stopped = Some(Stopped::Caller);
            }
        }
    }
}

unsafe extern "C" fn write(data: *mut c_void, bytes: *const u8, size: usize) -> Status {
    // SAFETY: `data` is what `call` handed over, which waits for the call to return.
    let out = unsafe { &mut *data.cast::<Out<'_>>() };
    if size > out.room {
        out.stopped = out.stopped.or(Some(Stopped::TooLong));
    }
    if out.stopped.is_none() && size > 0 && !bytes.is_null() {
        // SAFETY: the plugin promises the bytes.
        out.take(unsafe { slice::from_raw_parts(bytes, size) });
    }
    if out.stopped.is_some() { out.line.warned() } else { status::OK }
}
