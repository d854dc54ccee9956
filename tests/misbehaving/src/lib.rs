//! A plugin that does what none should: everything in it panics, or goes on for ever.
//!
//! By `CARVE_TEST_PANIC=describe` it panics as soon as it is asked what it has.

use carvegraph_sdk::export::Offers;
use carvegraph_sdk::node::{Job, Node, NodeFault, Port};
use carvegraph_sdk::value::Raw;
use carvegraph_sdk::{
    Capabilities, CutterError, CutterShape, Dialect, DimensionSpec, Dimensions, PostError, Profile,
    Program,
};
use std::io::Write;

struct Panicking;

fn name() -> &'static str {
    assert!(std::env::var_os("CARVE_TEST_PANIC").is_none(), "asked for a name");
    "panicking"
}

impl CutterShape for Panicking {
    fn name(&self) -> &str {
        name()
    }

    fn about(&self) -> &str {
        "Panics when its profile is wanted, but not at its defaults"
    }

    fn dimensions(&self) -> &[DimensionSpec] {
        &[DimensionSpec::DIAMETER]
    }

    fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
        let diameter = dimensions.get("diameter")?;
        assert!(diameter == DimensionSpec::DIAMETER.default, "no profile of {diameter}");
        Ok(Profile::ball(diameter / 2.0)?)
    }
}

impl Dialect for Panicking {
    fn name(&self) -> &str {
        name()
    }

    fn about(&self) -> &str {
        "Panics in the middle of a program"
    }

    fn extension(&self) -> &str {
        "nc"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: false, tool_change: false, path_tolerance: false }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn Write) -> Result<(), PostError> {
        writeln!(out, "(half a program)")?;
        assert!(program.commands.len() < 10, "too many commands");
        Ok(())
    }
}

impl Node for Panicking {
    fn name(&self) -> &str {
        name()
    }

    fn about(&self) -> &str {
        "Panics when it is run, in one part of a parallel loop."
    }

    fn outputs(&self) -> &[Port] {
        &[Port { name: "remark", about: "Nothing.", type_name: "remark", optional: false }]
    }

    fn run(&self, job: &Job<'_>) -> Result<Vec<Raw<'static>>, NodeFault> {
        job.parallel_for(100, |part| assert!(part != 57, "part {part}"))?;
        Ok(Vec::new())
    }
}

/// Writes on, whatever it is told.
struct Deaf;

impl Dialect for Deaf {
    fn name(&self) -> &str {
        "deaf"
    }

    fn about(&self) -> &str {
        "Writes a program without end"
    }

    fn extension(&self) -> &str {
        "nc"
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { arcs: false, tool_change: false, path_tolerance: false }
    }

    fn post(&self, program: &Program<'_>, out: &mut dyn Write) -> Result<(), PostError> {
        while program.commands.len() > 10 {
            let _ = out.write_all(&[b' '; 4096]);
        }
        Ok(())
    }
}

carvegraph_sdk::export!(
    Offers::new().cutter(Panicking).dialect(Panicking).node(Panicking).dialect(Deaf)
);
