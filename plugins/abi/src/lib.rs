//! The C layout of a plugin: what crosses between `carve` and a shared library.
//!
//! `carvegraph.h` beside this crate says the same in C, with a sentence on every field; a test holds
//! the two together. This crate has no code: the safe sides are `carvegraph-sdk` (in a plugin) and
//! `carvegraph-host` (in `carve`).
//!
//! # How a library is read
//! It exports one constant, [`SYMBOL`], a [`Plugin`]. The host looks at the magic, then at the major
//! version, then calls `init`, then asks for a table by [capability]. A table lists what
//! the plugin offers; each entry is described and called by its index.
//!
//! # Rules
//! * Data crosses as pointer and length. What a call is given is valid until it returns. What a
//!   `describe` gives, and every table, stays valid and unchanged for good: libraries are never
//!   unloaded.
//! * Results go through sinks that the host provides. Nobody frees what the other side allocated.
//! * No panic, exception or `longjmp` crosses. Functions may be called from any thread, several at once.
//! * A plugin starts no thread that outlives a call and no thread pool: see [`Host::parallel_for`].
//! * Texts are UTF-8 without a terminator.
//!
//! # Versions
//! * A major version is never changed once released: the host refuses any other and names both.
//! * Within a major, structs only grow at their end, and the minor goes up. Whoever fills a struct sets
//!   its `struct_size`; whoever reads it takes no more than that. A field beyond it counts as zero.
//!   So the smaller minor of the two is spoken.
//! * Numbers that name kinds (of commands, params, elements) are only added to. A plugin that is given
//!   one that it does not know refuses the call with a message.
//! * A capability that must change its meaning gets a new id (`carvegraph.dialect/2`); a host may ask
//!   for both.

use std::ffi::{CStr, c_void};
use std::mem::{MaybeUninit, offset_of, size_of};

/// First field of every [`Plugin`]: "CARVEGRF" read as a big-endian number.
pub const MAGIC: u64 = 0x4341_5256_4547_5246;

/// Another major is refused.
pub const MAJOR: u32 = 1;

/// A larger minor only adds.
pub const MINOR: u32 = 0;

/// The name under which a library exports its [`Plugin`].
pub const SYMBOL: &CStr = c"carvegraph_plugin";

/// Ids of capabilities, and the tables that [`Plugin::get_factory`] gives for them.
pub mod capability {
    /// An [`About`](super::About).
    pub const ABOUT: &str = "carvegraph.about/1";
    /// A [`CutterFactory`](super::CutterFactory).
    pub const CUTTER: &str = "carvegraph.cutter/1";
    /// A [`DialectFactory`](super::DialectFactory).
    pub const DIALECT: &str = "carvegraph.dialect/1";
    /// A [`NodeFactory`](super::NodeFactory).
    pub const NODE: &str = "carvegraph.node/1";
}

/// How a call ended.
pub type Status = u32;

/// Values of [`Status`].
pub mod status {
    use super::Status;
    /// Done.
    pub const OK: Status = 0;
    /// Refused or failed; the fault sink was told why.
    pub const FAILED: Status = 1;
    /// The sink, or progress, said to stop.
    pub const STOPPED: Status = 2;
    /// The plugin panicked; what panicked is not called again.
    pub const PANICKED: Status = 3;
    /// There is nothing at that index.
    pub const NO_SUCH: Status = 4;
}

/// UTF-8, or bytes where it is said so; `data` may be null if `size` is 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Text {
    /// Its first byte.
    pub data: *const u8,
    /// Bytes.
    pub size: usize,
}

/// Takes bytes: a program, or the message of a fault.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sink {
    /// Handed back to `write`.
    pub data: *mut c_void,
    /// Takes the bytes and answers [`status::OK`]; anything else means: write no more and return.
    pub write: unsafe extern "C" fn(data: *mut c_void, bytes: *const u8, size: usize) -> Status,
}

/// One run of a node or post, to be handed back to the services of the [`Host`].
#[repr(C)]
#[derive(Debug)]
pub struct Run {
    _opaque: [u8; 0],
}

/// The part of a loop that [`Host::parallel_for`] calls with each index.
pub type LoopBody = unsafe extern "C" fn(data: *mut c_void, index: usize);

/// What the host does for a plugin. Valid for good.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// The host's [`MAJOR`].
    pub abi_major: u32,
    /// The host's [`MINOR`].
    pub abi_minor: u32,
    /// 0.
    pub reserved: u32,
    /// Tells the user something: `level` 0 is a note, 1 a warning.
    pub log: unsafe extern "C" fn(run: *const Run, level: u32, message: Text),
    /// Tells how much is done, from 0 to 1; answers [`status::OK`] to go on or [`status::STOPPED`].
    pub progress: unsafe extern "C" fn(run: *const Run, share: f64) -> Status,
    /// Calls `body` with each index below `count` on the host's threads, several at once, and returns
    /// when all are done. A loop within a loop runs on one thread.
    pub parallel_for: unsafe extern "C" fn(
        run: *const Run,
        count: usize,
        body: LoopBody,
        data: *mut c_void,
    ) -> Status,
}

/// What a library exports as [`SYMBOL`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Plugin {
    /// [`MAGIC`].
    pub magic: u64,
    /// The [`MAJOR`] it was built for.
    pub abi_major: u32,
    /// The [`MINOR`] it was built for.
    pub abi_minor: u32,
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Called once, before anything else; refuses by [`status::FAILED`] and a message.
    pub init: Option<unsafe extern "C" fn(host: *const Host, fault: *const Sink) -> Status>,
    /// The table of a capability, null if the plugin does not have it.
    pub get_factory: Option<unsafe extern "C" fn(capability: Text) -> *const c_void>,
}

/// What a plugin says of itself; optional, for `carve plugins install`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// The plugin's name: lower case, digits, `_`, `-` and `.`.
    pub id: Text,
    /// Its version.
    pub version: Text,
}

/// Values of [`Dimension::unit`].
pub mod unit {
    /// Millimetres.
    pub const MM: u32 = 0;
    /// Degrees.
    pub const DEG: u32 = 1;
}

/// One dimension of a cutter shape.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Dimension {
    /// Its name in recipes.
    pub name: Text,
    /// What it measures, in a line.
    pub about: Text,
    /// See [`mod@unit`].
    pub unit: u32,
    /// 0.
    pub reserved: u32,
    /// Within `min..=max`.
    pub default_value: f64,
    /// Least value allowed.
    pub min: f64,
    /// Greatest value allowed.
    pub max: f64,
}

/// What a cutter shape is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CutterInfo {
    /// Set by the host: bytes that may be filled.
    pub struct_size: u32,
    /// Number of dimensions.
    pub dimension_count: u32,
    /// Its name in recipes: lower case, digits and `_`.
    pub name: Text,
    /// What it is, in a line.
    pub about: Text,
    /// What its drawing must show, in a line; empty if it needs none.
    pub drawing: Text,
    /// Its dimensions, `diameter` first.
    pub dimensions: *const Dimension,
}

/// Values of [`Segment::kind`].
pub mod segment {
    /// A straight piece.
    pub const LINE: u32 = 0;
    /// A piece of a circle that curves upward.
    pub const ARC: u32 = 1;
}

/// One piece of a cutter's profile, from the end of the one before; the first begins at the tip (0, 0).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// See [`segment`].
    pub kind: u32,
    /// 0.
    pub reserved: u32,
    /// Its end: distance from the axis and height above the tip, in mm.
    pub to: [f64; 2],
    /// Centre of an arc, likewise.
    pub center: [f64; 2],
}

/// Takes the segments of a profile, from the tip outwards.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SegmentSink {
    /// Handed back to `put`.
    pub data: *mut c_void,
    /// Takes some segments; anything but [`status::OK`] means: no more.
    pub put:
        unsafe extern "C" fn(data: *mut c_void, segments: *const Segment, count: usize) -> Status,
}

/// The table of [`capability::CUTTER`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CutterFactory {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Number of shapes.
    pub count: unsafe extern "C" fn() -> u32,
    /// Fills `info`.
    pub describe: unsafe extern "C" fn(index: u32, info: *mut CutterInfo) -> Status,
    /// Gives the profile for these dimensions, one value for each in the order of the description. The
    /// drawing is empty for a shape that needs none.
    pub profile: unsafe extern "C" fn(
        index: u32,
        values: *const f64,
        count: usize,
        drawing: Text,
        segments: *const SegmentSink,
        fault: *const Sink,
    ) -> Status,
}

/// Bits of [`DialectInfo::flags`].
pub mod dialect_flag {
    /// Takes arcs.
    pub const ARCS: u32 = 1;
    /// Takes tool changes.
    pub const TOOL_CHANGE: u32 = 2;
    /// Is told the path tolerance.
    pub const PATH_TOLERANCE: u32 = 4;
}

/// What a dialect is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DialectInfo {
    /// Set by the host: bytes that may be filled.
    pub struct_size: u32,
    /// See [`dialect_flag`].
    pub flags: u32,
    /// Its name in recipes: lower case, digits and `_`.
    pub name: Text,
    /// The controllers it is for, in a line.
    pub about: Text,
    /// File name extension of its programs, without the dot.
    pub extension: Text,
}

/// Values of [`Command::kind`].
pub mod command {
    /// A remark: `number` is an index into the texts.
    pub const COMMENT: u32 = 0;
    /// A tool change: `number` is that of the tool.
    pub const TOOL_CHANGE: u32 = 1;
    /// Spindle on: `number` is 0 for clockwise, `values[0]` in rpm.
    pub const SPINDLE: u32 = 2;
    /// Spindle off.
    pub const SPINDLE_STOP: u32 = 3;
    /// A wait of `values[0]` seconds.
    pub const DWELL: u32 = 4;
    /// A rapid to `values[0..3]`.
    pub const RAPID: u32 = 5;
    /// A straight feed to `values[0..3]` at `values[3]` mm/min.
    pub const FEED: u32 = 6;
    /// An arc: `number` is an index into the arcs.
    pub const ARC: u32 = 7;
    /// One more than the greatest known.
    pub const COUNT: u32 = 8;
}

/// One step of a program. Only what its kind names has a value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// See [`command`].
    pub kind: u32,
    /// An index, a number or a direction.
    pub number: MaybeUninit<u32>,
    /// A point, a speed, a time.
    pub values: [MaybeUninit<f64>; 4],
}

/// An arc from where the tip is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// 0 is XY, 1 is ZX, 2 is YZ.
    pub plane: u32,
    /// 0 is clockwise seen against the axis that stands on the plane, 1 counter-clockwise.
    pub direction: u32,
    /// Centre in mm; the coordinate off the plane does not count.
    pub center: [f64; 3],
    /// End in mm.
    pub to: [f64; 3],
    /// Speed in mm/min.
    pub mm_per_min: f64,
}

/// A block of stock, in mm.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Stock {
    /// Least x, y, z.
    pub min: [f64; 3],
    /// Greatest x, y, z.
    pub max: [f64; 3],
}

/// A whole program, in mm whatever its units are.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// What the text is to be in: 0 mm, 1 inches.
    pub units: u32,
    /// What the job is, in a line; any text.
    pub title: Text,
    /// Remarks for the head.
    pub remarks: *const Text,
    /// How many.
    pub remark_count: usize,
    /// How far the controller may leave the path, in mm; 0 if not said.
    pub path_tolerance_mm: f64,
    /// Null if not known.
    pub stock: *const Stock,
    /// What to do, in order.
    pub commands: *const Command,
    /// How many.
    pub command_count: usize,
    /// Texts of comments.
    pub texts: *const Text,
    /// How many.
    pub text_count: usize,
    /// Arcs.
    pub arcs: *const Arc,
    /// How many.
    pub arc_count: usize,
    /// Not 0: write arcs as straight moves.
    pub lines_only: u32,
    /// 0.
    pub reserved: u32,
}

/// The table of [`capability::DIALECT`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DialectFactory {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Number of dialects.
    pub count: unsafe extern "C" fn() -> u32,
    /// Fills `info`.
    pub describe: unsafe extern "C" fn(index: u32, info: *mut DialectInfo) -> Status,
    /// Writes a program to `out`.
    pub post: unsafe extern "C" fn(
        index: u32,
        program: *const Program,
        out: *const Sink,
        run: *const Run,
        fault: *const Sink,
    ) -> Status,
}

/// Values of [`Param::kind`] and [`Argument::kind`].
pub mod param {
    /// A number with a unit: `number`.
    pub const NUMBER: u32 = 0;
    /// A whole number: `number`.
    pub const INTEGER: u32 = 1;
    /// True or false: `number` 1 or 0.
    pub const SWITCH: u32 = 2;
    /// Free text: `text`.
    pub const TEXT: u32 = 3;
    /// One of the options: `text`.
    pub const CHOICE: u32 = 4;
}

/// One word that a param may be set to.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ParamOption {
    /// The word.
    pub name: Text,
    /// What it means.
    pub about: Text,
}

/// One parameter of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Its name in recipes.
    pub name: Text,
    /// What it does.
    pub about: Text,
    /// See [`param`].
    pub kind: u32,
    /// Number of options.
    pub option_count: u32,
    /// "mm", "mm/min", "deg", "rpm", "s", "px", "%" or empty.
    pub unit: Text,
    /// Default of a number, integer or switch.
    pub default_number: f64,
    /// Default of a text or choice.
    pub default_text: Text,
    /// Least number.
    pub min: f64,
    /// Greatest number.
    pub max: f64,
    /// What a choice is between.
    pub options: *const ParamOption,
}

/// One port of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Port {
    /// Its name in recipes.
    pub name: Text,
    /// What passes through it.
    pub about: Text,
    /// One of the standard types, such as "height_field".
    pub type_name: Text,
    /// Not 0: an input that may be left open.
    pub optional: u32,
    /// 0.
    pub reserved: u32,
}

/// What a node is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct NodeInfo {
    /// Set by the host: bytes that may be filled.
    pub struct_size: u32,
    /// Raised whenever the same inputs give other outputs than before.
    pub version: u32,
    /// Its kind in recipes: lower case, digits and `_`.
    pub name: Text,
    /// What it does.
    pub about: Text,
    /// Its parameters.
    pub params: *const Param,
    /// How many.
    pub param_count: usize,
    /// Its inputs.
    pub inputs: *const Port,
    /// How many.
    pub input_count: usize,
    /// Its outputs.
    pub outputs: *const Port,
    /// How many.
    pub output_count: usize,
}

/// What a param is set to.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// See [`param`].
    pub kind: u32,
    /// 0.
    pub reserved: u32,
    /// Of a number (in its unit), integer or switch.
    pub number: f64,
    /// Of a text or choice.
    pub text: Text,
}

/// Values of [`Array::element`].
pub mod element {
    /// Bytes.
    pub const U8: u32 = 0;
    /// Unsigned, 16 bits.
    pub const U16: u32 = 1;
    /// Unsigned, 32 bits.
    pub const U32: u32 = 2;
    /// Unsigned, 64 bits.
    pub const U64: u32 = 3;
    /// IEEE single.
    pub const F32: u32 = 4;
    /// IEEE double.
    pub const F64: u32 = 5;
}

/// A named array of a value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Array {
    /// Its name, such as "heights".
    pub name: Text,
    /// See [`element`].
    pub element: u32,
    /// 0.
    pub reserved: u32,
    /// Its first element, aligned for its kind.
    pub data: *const c_void,
    /// Number of elements; a list of n points has 3 n.
    pub count: usize,
}

/// A value at a port: a type and its arrays. `carvegraph.h` lists those of each type.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Its type.
    pub type_name: Text,
    /// Its arrays, in the order of the list.
    pub arrays: *const Array,
    /// How many.
    pub array_count: usize,
}

/// Takes what a node makes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ValueSink {
    /// Handed back to `put`.
    pub data: *mut c_void,
    /// Takes the value of an output port, once each; copies it. Anything but [`status::OK`] means that
    /// it was refused: return.
    pub put: unsafe extern "C" fn(data: *mut c_void, port: u32, value: *const Value) -> Status,
}

/// The table of [`capability::NODE`].
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct NodeFactory {
    /// Bytes of this struct that are filled.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Number of nodes.
    pub count: unsafe extern "C" fn() -> u32,
    /// Fills `info`.
    pub describe: unsafe extern "C" fn(index: u32, info: *mut NodeInfo) -> Status,
    /// Does the work: one argument for each param and one pointer for each input, null where it is left
    /// open, in the order of the description.
    pub run: unsafe extern "C" fn(
        index: u32,
        arguments: *const Argument,
        inputs: *const *const Value,
        outputs: *const ValueSink,
        run: *const Run,
        fault: *const Sink,
    ) -> Status,
}

macro_rules! layout {
    ($($name:ident $size:literal { $($field:ident $at:literal),* $(,)? })*) => {
        #[cfg(target_pointer_width = "64")]
        const _: () = {
            $(
                assert!(size_of::<$name>() == $size && align_of::<$name>() == 8);
                $(assert!(offset_of!($name, $field) == $at);)*
            )*
        };

        /// Size and fields' offsets of every struct on 64-bit machines, for whoever writes the layout
        /// down in another language.
        pub const LAYOUT: &[(&str, usize, &[(&str, usize)])] = &[
            $((stringify!($name), $size, &[$((stringify!($field), $at)),*])),*
        ];
    };
}

// Once released, a line here only grows at its end.
layout! {
    Text 16 { data 0, size 8 }
    Sink 16 { data 0, write 8 }
    Host 40 { struct_size 0, abi_major 4, abi_minor 8, reserved 12, log 16, progress 24, parallel_for 32 }
    Plugin 40 {
        magic 0, abi_major 8, abi_minor 12, struct_size 16, reserved 20, init 24, get_factory 32,
    }
    About 40 { struct_size 0, reserved 4, id 8, version 24 }
    Dimension 64 { name 0, about 16, unit 32, reserved 36, default_value 40, min 48, max 56 }
    CutterInfo 64 { struct_size 0, dimension_count 4, name 8, about 24, drawing 40, dimensions 56 }
    Segment 40 { kind 0, reserved 4, to 8, center 24 }
    SegmentSink 16 { data 0, put 8 }
    CutterFactory 32 { struct_size 0, reserved 4, count 8, describe 16, profile 24 }
    DialectInfo 56 { struct_size 0, flags 4, name 8, about 24, extension 40 }
    Command 40 { kind 0, number 4, values 8 }
    Arc 64 { plane 0, direction 4, center 8, to 32, mm_per_min 56 }
    Stock 48 { min 0, max 24 }
    Program 112 {
        struct_size 0, units 4, title 8, remarks 24, remark_count 32, path_tolerance_mm 40, stock 48,
        commands 56, command_count 64, texts 72, text_count 80, arcs 88, arc_count 96, lines_only 104,
        reserved 108,
    }
    DialectFactory 32 { struct_size 0, reserved 4, count 8, describe 16, post 24 }
    ParamOption 32 { name 0, about 16 }
    Param 104 {
        name 0, about 16, kind 32, option_count 36, unit 40, default_number 56, default_text 64, min 80,
        max 88, options 96,
    }
    Port 56 { name 0, about 16, type_name 32, optional 48, reserved 52 }
    NodeInfo 88 {
        struct_size 0, version 4, name 8, about 24, params 40, param_count 48, inputs 56,
        input_count 64, outputs 72, output_count 80,
    }
    Argument 32 { kind 0, reserved 4, number 8, text 16 }
    Array 40 { name 0, element 16, reserved 20, data 24, count 32 }
    Value 32 { type_name 0, arrays 16, array_count 24 }
    ValueSink 16 { data 0, put 8 }
    NodeFactory 32 { struct_size 0, reserved 4, count 8, describe 16, run 24 }
}
