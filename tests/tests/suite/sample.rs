//! The bundled sample is what its generator makes. The tests stand in the generator; they are run
//! here, since cargo does not run those of an example by itself.

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/medallion.rs"]
mod medallion;
