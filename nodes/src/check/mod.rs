//! From the program's text back to what a machine makes of it.
