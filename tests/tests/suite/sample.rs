//! The bundled samples are what their generators make. The tests stand in the generators; they are run
//! here, since cargo does not run those of an example by itself.

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/medallion.rs"]
mod medallion;

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/portrait.rs"]
mod portrait;

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/shell.rs"]
mod shell;

#[allow(dead_code, unreachable_pub, reason = "an example is a program of its own")]
#[path = "../../../nodes/examples/sun_mask.rs"]
mod sun_mask;
