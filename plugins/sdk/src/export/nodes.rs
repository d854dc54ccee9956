//! The table of nodes.

use super::borrow::{self, handle, lent};
use super::guard::{self, Ended, Fault, Stop};
use super::shelf::{Constant, count, kept, kept_text, with};
use super::wire::{self, Lent};
use super::{HOST, Offer, Shelf};
use crate::node::{Argument, Job, Node, NodeFault, Param, ParamKind, ParamOption, Port, Services};
use crate::value::Raw;
use carvegraph_abi::{self as abi, Status, param, status};
use std::ffi::c_void;
use std::mem::size_of;
use std::panic;
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

type Item = super::shelf::Item<dyn Node, abi::NodeInfo>;

pub(super) const fn factory<P: Offer>() -> abi::NodeFactory {
    abi::NodeFactory {
        struct_size: size_of::<abi::NodeFactory>() as u32,
        reserved: 0,
        count: node_count::<P>,
        describe: describe::<P>,
        run: run::<P>,
    }
}

fn board(shelf: &'static Shelf) -> &'static Vec<Item> {
    &shelf.nodes
}

unsafe extern "C" fn node_count<P: Offer>() -> u32 {
    count::<P, _>(board)
}

unsafe extern "C" fn describe<P: Offer>(index: u32, to: *mut abi::NodeInfo) -> Status {
    with::<P, _, _>(board, index, Fault(ptr::null()), |item| {
        let Constant(info) = item.info.get_or_init(|| Constant(info(&*item.thing)));
        // SAFETY: the host gives room for as many bytes as it says.
        unsafe { borrow::fill(to, info) };
        status::OK
    })
}

fn info(node: &dyn Node) -> abi::NodeInfo {
    let params = kept(node.params().iter().map(param_info));
    let inputs = kept(node.inputs().iter().map(port_info));
    let outputs = kept(node.outputs().iter().map(port_info));
    abi::NodeInfo {
        struct_size: size_of::<abi::NodeInfo>() as u32,
        version: node.version(),
        name: kept_text(node.name()),
        about: kept_text(node.about()),
        params: params.as_ptr(),
        param_count: params.len(),
        inputs: inputs.as_ptr(),
        input_count: inputs.len(),
        outputs: outputs.as_ptr(),
        output_count: outputs.len(),
    }
}

fn port_info(port: &Port) -> abi::Port {
    abi::Port {
        name: lent(port.name),
        about: lent(port.about),
        type_name: lent(port.type_name),
        optional: u32::from(port.optional),
        reserved: 0,
    }
}

fn param_info(from: &Param) -> abi::Param {
    let info = abi::Param {
        name: lent(from.name),
        about: lent(from.about),
        kind: 0,
        option_count: 0,
        unit: lent(""),
        default_number: 0.0,
        default_text: lent(""),
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        options: ptr::null(),
    };
    match from.kind {
        ParamKind::Number { unit, default, min, max } => abi::Param {
            kind: param::NUMBER,
            unit: lent(unit),
            default_number: default,
            min,
            max,
            ..info
        },
        ParamKind::Integer { unit, default, min, max } => abi::Param {
            kind: param::INTEGER,
            unit: lent(unit),
            default_number: default as f64,
            min: min as f64,
            max: max as f64,
            ..info
        },
        ParamKind::Switch { default } => {
            abi::Param { kind: param::SWITCH, default_number: f64::from(default), ..info }
        }
        ParamKind::Text { default } => {
            abi::Param { kind: param::TEXT, default_text: lent(default), ..info }
        }
        ParamKind::Choice { options, default } => {
            let options = kept(options.iter().map(option_info));
            abi::Param {
                kind: param::CHOICE,
                default_text: lent(default),
                option_count: options.len() as u32,
                options: options.as_ptr(),
                ..info
            }
        }
    }
}

fn option_info(option: &ParamOption) -> abi::ParamOption {
    abi::ParamOption { name: lent(option.name), about: lent(option.about) }
}

unsafe extern "C" fn run<P: Offer>(
    index: u32,
    arguments: *const abi::Argument,
    inputs: *const *const abi::Value,
    outputs: *const abi::ValueSink,
    run: *const abi::Run,
    fault: *const abi::Sink,
) -> Status {
    let fault = Fault(fault);
    with::<P, _, _>(board, index, fault, |item| {
        let node = &*item.thing;
        // SAFETY: the host lends as many as the description has, for the call.
        let lent = unsafe {
            arguments_of(arguments, node.params().len()).and_then(|given| {
                Ok((given, inputs_of(inputs, node.inputs().len())?, outputs.as_ref()))
            })
        };
        let result = lent.map_err(NodeFault::Failed).and_then(|(arguments, inputs, outputs)| {
            let outputs =
                outputs.ok_or_else(|| NodeFault::Failed("no outputs are taken".into()))?;
            let host = HostServices { run, refusals: AtomicU32::new(0) };
            let job = Job::new(node, &arguments, &inputs, &host)?;
            let made = node.run(&job)?;
            Ok(put(&made, outputs))
        });
        match result {
            Ok(status) => status,
            Err(NodeFault::Cancelled) => status::STOPPED,
            Err(NodeFault::Failed(why)) => fault.tell(&why),
        }
    })
}

const NOT_LENT: &str = "the host gave arguments or inputs that cannot be read";

/// # Safety
/// There are `count` of them, living for `'a`.
unsafe fn arguments_of<'a>(
    data: *const abi::Argument,
    count: usize,
) -> Result<Vec<Argument<'a>>, String> {
    // SAFETY: the caller's promise.
    let arguments = unsafe { borrow::slice(data, count) }.ok_or(NOT_LENT)?;
    let read = |from: &abi::Argument| match from.kind {
        param::NUMBER => Ok(Argument::Number(from.number)),
        param::INTEGER => Ok(Argument::Integer(from.number as i64)),
        param::SWITCH => Ok(Argument::Switch(from.number != 0.0)),
        // SAFETY: the caller's promise.
        param::TEXT | param::CHOICE => {
            unsafe { borrow::text(from.text) }.map(Argument::Text).ok_or(NOT_LENT.to_owned())
        }
        other => {
            Err(format!("carve is newer than this plugin and gives a parameter of kind {other}"))
        }
    };
    arguments.iter().map(read).collect()
}

/// # Safety
/// There are `count` of them, living for `'a`.
unsafe fn inputs_of<'a>(
    data: *const *const abi::Value,
    count: usize,
) -> Result<Vec<Option<Raw<'a>>>, String> {
    // SAFETY: the caller's promise.
    let inputs = unsafe { borrow::slice(data, count) }.ok_or(NOT_LENT)?;
    // SAFETY: likewise.
    let read =
        |value: &*const abi::Value| unsafe { value.as_ref().map(|v| wire::raw(v)).transpose() };
    inputs.iter().map(read).collect()
}

fn put(made: &[Raw<'static>], sink: &abi::ValueSink) -> Status {
    let lent = Lent::of(made.iter().map(Some));
    for (port, value) in lent.pointers().into_iter().enumerate() {
        // SAFETY: the host's own function with the host's own data.
        let taken = unsafe { (sink.put)(sink.data, port as u32, value) };
        if taken != status::OK {
            return taken;
        }
    }
    status::OK
}

/// A node that has been told so many times to stop does not listen.
const REFUSALS: u32 = 1000;

/// What the host does for a node.
struct HostServices {
    run: *const abi::Run,
    refusals: AtomicU32,
}

// SAFETY: the host's services may be called from any thread.
unsafe impl Sync for HostServices {}

impl HostServices {
    fn log(&self, level: u32, text: &str) {
        if let Some(Constant(host)) = HOST.get() {
            // SAFETY: the host's own function with what it handed over.
            unsafe { (host.log)(self.run, level, lent(text)) };
        }
    }

    fn go_on(&self, answer: Status) -> bool {
        if answer == status::OK {
            return true;
        }
        if self.refusals.fetch_add(1, Ordering::Relaxed) > REFUSALS {
            panic::resume_unwind(Box::new(Stop));
        }
        false
    }
}

impl Services for HostServices {
    fn note(&self, text: &str) {
        self.log(0, text);
    }

    fn warn(&self, text: &str) {
        self.log(1, text);
    }

    fn progress(&self, share: f64) -> bool {
        let Some(Constant(host)) = HOST.get() else { return true };
        // SAFETY: the host's own function with what it handed over.
        self.go_on(unsafe { (host.progress)(self.run, share) })
    }

    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> bool {
        let Some(Constant(host)) = HOST.get() else {
            (0..count).for_each(body);
            return true;
        };
        let part = Part { body, panicked: Mutex::new(None) };
        // SAFETY: the host's own function; what it hands on lives until it returns.
        let answer = unsafe { (host.parallel_for)(self.run, count, call_part, handle(&part)) };
        if let Some(ended) = part.panicked.into_inner().unwrap_or_else(PoisonError::into_inner) {
            match ended {
                Ended::Stopped => panic::resume_unwind(Box::new(Stop)),
                Ended::Panicked(said) => panic::resume_unwind(Box::new(said)),
            }
        }
        self.go_on(answer)
    }
}

/// The body of a loop, and how it ended if it ended badly.
struct Part<'a> {
    body: &'a (dyn Fn(usize) + Sync),
    panicked: Mutex<Option<Ended>>,
}

unsafe extern "C" fn call_part(data: *mut c_void, index: usize) {
    // SAFETY: what `parallel_for` handed over, which waits until all parts are done.
    let part = unsafe { &*data.cast::<Part<'_>>() };
    if let Err(ended) = guard::run(|| (part.body)(index)) {
        let mut panicked = part.panicked.lock().unwrap_or_else(PoisonError::into_inner);
        panicked.get_or_insert(ended);
    }
}
