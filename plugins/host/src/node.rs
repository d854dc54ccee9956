//! A node in a library.

use crate::borrow::{self, Given, handle};
use crate::message::{heard, reason};
use crate::watch::{Line, watched};
use carvegraph_abi::{self as abi, Status, param, status};
use carvegraph_sdk::export::wire::{self, Lent};
use carvegraph_sdk::node::{Argument, Job, Node, NodeFault, Param, ParamKind, ParamOption, Port};
use carvegraph_sdk::value::Raw;
use std::ffi::c_void;
use std::mem::{size_of, zeroed};

/// A node, and where it is in its library's table.
pub(crate) struct LibraryNode {
    table: &'static abi::NodeFactory,
    index: u32,
    name: String,
    about: String,
    version: u32,
    params: Vec<Param>,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
}

impl LibraryNode {
    /// Asks the library what node stands at an index.
    ///
    /// # Safety
    /// The table keeps the rules of the ABI.
    pub(crate) unsafe fn describe(
        table: &'static abi::NodeFactory,
        index: u32,
    ) -> Result<Self, Given> {
        // SAFETY: numbers and pointers are valid as zeros.
        let mut info: abi::NodeInfo = unsafe { zeroed() };
        info.struct_size = size_of::<abi::NodeInfo>() as u32;
        // SAFETY: the caller's promise.
        let answer = unsafe { (table.describe)(index, &raw mut info) };
        if answer != status::OK {
            return Err(Given::Nothing { why: reason(answer, String::new()) });
        }
        // SAFETY: the ABI says that a description stays valid for good.
        unsafe {
            let params = borrow::short_list("params", info.params, info.param_count)?;
            let inputs = borrow::short_list("inputs", info.inputs, info.input_count)?;
            let outputs = borrow::short_list("outputs", info.outputs, info.output_count)?;
            Ok(Self {
                table,
                index,
                name: borrow::name("node's name", info.name)?,
                about: borrow::text("node's description", info.about)?,
                version: info.version,
                params: params.iter().map(|from| param_of(from)).collect::<Result<_, _>>()?,
                inputs: inputs.iter().map(|from| port_of(from)).collect::<Result<_, _>>()?,
                outputs: outputs.iter().map(|from| port_of(from)).collect::<Result<_, _>>()?,
            })
        }
    }

    /// Calls the library.
    fn call(&self, given: &Arguments<'_>, line: &Line<'_>) -> (Status, String, Made) {
        let mut made = Made { values: vec![None; self.outputs.len()], refused: None };
        let sink = abi::ValueSink { data: handle(&mut made), put };
        let (answer, said) = heard(|fault| {
            let (arguments, inputs) = (given.arguments.as_ptr(), given.inputs.as_ptr());
            // SAFETY: the table keeps the rules of the ABI, and all that is lent outlives the call.
            unsafe {
                let sink = &raw const sink;
                (self.table.run)(self.index, arguments, inputs, sink, line.handle(), fault)
            }
        });
        (answer, said, made)
    }
}

/// # Safety
/// Its text keeps the rules of the ABI.
unsafe fn kept(what: &'static str, text: abi::Text) -> Result<&'static str, Given> {
    // Libraries stay for good, and so may the few words that describe them.
    // SAFETY: the caller's promise.
    unsafe { borrow::text(what, text) }.map(|text| &*String::leak(text))
}

/// # Safety
/// Its texts keep the rules of the ABI.
unsafe fn port_of(from: &abi::Port) -> Result<Port, Given> {
    // SAFETY: the caller's promise.
    unsafe {
        Ok(Port {
            name: kept("port's name", from.name)?,
            about: kept("port's description", from.about)?,
            type_name: kept("port's type", from.type_name)?,
            optional: from.optional != 0,
        })
    }
}

/// # Safety
/// What it points to keeps the rules of the ABI.
unsafe fn param_of(from: &abi::Param) -> Result<Param, Given> {
    // SAFETY: the caller's promise.
    unsafe {
        let name = kept("param's name", from.name)?;
        let about = kept("param's description", from.about)?;
        let unit = kept("param's unit", from.unit)?;
        let text = kept("param's default", from.default_text)?;
        let &abi::Param { default_number: default, min, max, .. } = from;
        let kind = match from.kind {
            param::NUMBER => ParamKind::Number { unit, default, min, max },
            param::INTEGER => {
                let (default, min, max) = (default as i64, min as i64, max as i64);
                ParamKind::Integer { unit, default, min, max }
            }
            param::SWITCH => ParamKind::Switch { default: default != 0.0 },
            param::TEXT => ParamKind::Text { default: text },
            param::CHOICE => {
                let count = from.option_count as usize;
                let options = borrow::short_list("options", from.options, count)?;
                let options = options.iter().map(|option| option_of(option));
                let options = options.collect::<Result<Vec<_>, _>>()?;
                ParamKind::Choice { options: Vec::leak(options), default: text }
            }
            number => return Err(Given::Unknown { what: "kind of param", number }),
        };
        Ok(Param { name, about, kind })
    }
}

/// # Safety
/// Its texts keep the rules of the ABI.
unsafe fn option_of(from: &abi::ParamOption) -> Result<ParamOption, Given> {
    // SAFETY: the caller's promise.
    unsafe {
        let name = kept("option's name", from.name)?;
        Ok(ParamOption { name, about: kept("option's description", from.about)? })
    }
}

impl Node for LibraryNode {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn version(&self) -> u32 {
        self.version
    }

    fn params(&self) -> &[Param] {
        &self.params
    }

    fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
        let lent = Lent::of(job.inputs().iter().map(Option::as_ref));
        let given = Arguments {
            arguments: job.arguments().iter().map(argument).collect(),
            inputs: lent.pointers(),
            _of: std::marker::PhantomData,
        };
        let ended = watched(job.services(), |_| Ok(()), |line| self.call(&given, line));
        let ((answer, said, made), _) = ended.map_err(NodeFault::failed)?;
        match (made.refused, answer) {
            (Some(why), _) => Err(NodeFault::Failed(why)),
            (None, status::OK) => all(made.values, &self.outputs),
            (None, status::STOPPED) if !job.services().progress(0.0) => Err(NodeFault::Cancelled),
            (None, _) => Err(NodeFault::Failed(reason(answer, said))),
        }
    }
}

/// The values of all outputs.
fn all(
    values: Vec<Option<Raw<'static>>>,
    outputs: &[Port],
) -> Result<Vec<Raw<'static>>, NodeFault> {
    let missing = |port: &Port| NodeFault::Failed(format!("it made no {:?}", port.name));
    values
        .into_iter()
        .zip(outputs)
        .map(|(value, port)| value.ok_or_else(|| missing(port)))
        .collect()
}

/// What a node is given, as the ABI has it.
struct Arguments<'a> {
    arguments: Vec<abi::Argument>,
    inputs: Vec<*const abi::Value>,
    _of: std::marker::PhantomData<&'a ()>,
}

// SAFETY: it points to what outlives it and is only read.
unsafe impl Sync for Arguments<'_> {}

fn argument(from: &Argument<'_>) -> abi::Argument {
    let (kind, number, text) = match *from {
        Argument::Number(number) => (param::NUMBER, number, ""),
        Argument::Integer(number) => (param::INTEGER, number as f64, ""),
        Argument::Switch(on) => (param::SWITCH, f64::from(on), ""),
        Argument::Text(text) => (param::TEXT, 0.0, text),
    };
    abi::Argument { kind, reserved: 0, number, text: borrow::lent(text) }
}

/// What a node has made so far, and why something was refused.
struct Made {
    values: Vec<Option<Raw<'static>>>,
    refused: Option<String>,
}

impl Made {
    /// # Safety
    /// The value keeps the rules of the ABI.
    unsafe fn take(&mut self, port: u32, value: *const abi::Value) -> Result<(), String> {
        let place = self.values.get_mut(port as usize);
        let place =
            place.ok_or_else(|| format!("it made a value for port {port}, which it lacks"))?;
        // SAFETY: the caller's promise.
        let value = unsafe { value.as_ref() }.ok_or("it made a value at no address")?;
        // SAFETY: the caller's promise.
        *place = Some(unsafe { wire::raw(value) }?.into_owned());
        Ok(())
    }
}

unsafe extern "C" fn put(data: *mut c_void, port: u32, value: *const abi::Value) -> Status {
    // SAFETY: `data` is what `call` handed over, which waits for the call to return; the plugin
    // promises the value.
    unsafe {
        let made = &mut *data.cast::<Made>();
        match made.take(port, value) {
            Ok(()) => status::OK,
            Err(why) => {
                made.refused = Some(why);
                status::FAILED
            }
        }
    }
}
