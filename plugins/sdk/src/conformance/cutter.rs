//! What every cutter shape must fulfil.
