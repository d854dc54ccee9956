//! Definitions of nodes: what the derives make of them, and what is no registry.

use crate::toy::{Lab, Style, catalogs, kinds, types};
use carvegraph_core::{
    Context, Node, NodeError, NodeKind, Params, Registry, RegistryError, units::Dimension,
};
use std::sync::Arc;

fn registry(kinds: Vec<NodeKind>) -> Result<Registry, RegistryError> {
    Registry::new(kinds, types(), catalogs(&Arc::new(Lab::default()), "1"))
}

#[test]
fn parameters_are_read_off_the_struct() {
    let registry = registry(kinds()).unwrap();
    let tool = registry.kind("tool").unwrap();
    assert_eq!(tool.about, "Has a parameter of every kind.");
    let lines: Vec<String> = tool
        .params
        .iter()
        .map(|spec| {
            let default = spec.default.as_ref().unwrap();
            format!("{}: {}, default {default}. {}", spec.name, spec.kind, spec.about)
        })
        .collect();
    assert_eq!(
        lines,
        [
            "diameter: number, 0.1 to 50 mm, default 6. How wide.",
            "feed: number, more than 0 up to 20000 mm/min, default 600. How fast.",
            "kernel: odd whole number, 1 to 255 px, default 5. How many pixels.",
            "on: true or false, default false. On or off.",
            "title: text, default tool. What it is called.",
            "style: one of one_way, to_and_fro, none, default to_and_fro. How it goes.",
            "dialect: a dialect's name (carve dialects), default grbl. What it speaks.",
        ]
    );
    assert!(registry.kind("load").unwrap().param("path").unwrap().default.is_none());
    let carvegraph_core::ParamKind::Number { dimension, .. } = tool.params[0].kind else {
        panic!()
    };
    assert_eq!(dimension, Dimension::Length);
    let carvegraph_core::ParamKind::Choice(options) = tool.params[5].kind else { panic!() };
    assert_eq!((options[1].name, options[1].about), ("to_and_fro", "To and fro."));
    let word = carvegraph_core::ParamField::to_value(&Style::OneWay);
    assert_eq!(<Style as carvegraph_core::ParamField>::from_value(&word), Style::OneWay);
}

#[test]
fn ports_are_read_off_the_structs() {
    let registry = registry(kinds()).unwrap();
    let ports = |kind: &str| {
        let kind = registry.kind(kind).unwrap();
        let port = |port: &carvegraph_core::PortSpec| {
            let optional = if port.optional { "?" } else { "" };
            format!("{}{optional}: {}, {}", port.name, registry.type_of(port).name, port.about)
        };
        kind.inputs.iter().chain(&kind.outputs).map(port).collect::<Vec<_>>()
    };
    assert_eq!(
        ports("add"),
        ["a: number, A number.", "b?: number, Another number.", "number: number, The number."]
    );
    assert_eq!(
        ports("split"),
        [
            "number: number, Any number.",
            "low: number, Half of it.",
            "high: number, Twice as much.",
            "text: words, What was split."
        ]
    );
}

#[test]
fn lists_out_of_order_are_refused() {
    let mut list = kinds();
    list.swap(0, 1);
    assert_eq!(registry(list).err(), Some(RegistryError::Order("add")));
    let mut list = kinds();
    list.insert(1, kinds().remove(0));
    list[1].origin = Some("acme 1.2".to_owned());
    assert_eq!(
        registry(list).err().unwrap().to_string(),
        "two nodes are called \"add\": one from the program, one from acme 1.2"
    );
}

#[test]
fn types_that_are_not_described_are_refused() {
    let types = types().into_iter().filter(|port| port.name != "token").collect();
    let fault = Registry::new(kinds(), types, catalogs(&Arc::default(), "1")).err().unwrap();
    let RegistryError::UnknownType { kind, port, .. } = fault else { panic!("{fault}") };
    assert_eq!((kind, port), ("melt", "a"));
}

macro_rules! odd_node {
    ($name:ident, $kind:literal, $(#[$param:meta])* $ty:ty) => {
        /// Odd.
        #[derive(Params)]
        struct $name {
            /// Odd.
            $(#[$param])*
            value: $ty,
        }

        impl Node for $name {
            const KIND: &'static str = $kind;
            type Inputs<'a> = ();
            type Outputs = ();

            fn run(&self, (): (), _: &Context<'_>) -> Result<(), NodeError> {
                let _ = &self.value;
                Ok(())
            }
        }
    };
}

odd_node!(
    TooLarge,
    "too_large",
    #[param(default = 60.0, range = 0.0..=50.0, unit = "mm")]
    f64
);
odd_node!(
    Even,
    "even",
    #[param(default = 4, odd)]
    u32
);
odd_node!(
    Infinite,
    "infinite",
    #[param(default = f64::INFINITY)]
    f64
);
odd_node!(
    Foreign,
    "foreign",
    #[param(default = "klingon", catalog = "dialect")]
    String
);
odd_node!(
    Called,
    "recipe",
    #[param(default = 1.0)]
    f64
);

#[test]
fn defaults_that_do_not_do_are_refused() {
    let check = |kind: NodeKind, expected: &str| {
        assert_eq!(registry(vec![kind]).err().unwrap().to_string(), expected);
    };
    check(
        NodeKind::of::<TooLarge>("odd"),
        "the default of \"value\" of \"too_large\" does not do: value must be between 0 and 50 mm, not 60",
    );
    check(
        NodeKind::of::<Even>("odd"),
        "the default of \"value\" of \"even\" does not do: value must be odd, not 4",
    );
    check(
        NodeKind::of::<Infinite>("odd"),
        "the default of \"value\" of \"infinite\" does not do: value: \"inf\" is not a finite number",
    );
    check(
        NodeKind::of::<Foreign>("odd"),
        "the default of \"value\" of \"foreign\" does not do: value cannot be \"klingon\"",
    );
    check(NodeKind::of::<Called>("odd"), "no node may be called \"recipe\"");
}
