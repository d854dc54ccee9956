//! Outputs: programs, models, pictures, words.

mod operation;
mod post;
mod preview;
mod save_3mf;
mod save_gcode;
mod save_points;
mod save_stl;
mod summary;
pub(crate) mod zero;

pub(crate) use operation::OperationNode;
pub(crate) use post::Post;
pub(crate) use preview::{Preview, draw_deviation, save_png};
pub(crate) use save_3mf::Save3mf;
pub(crate) use save_gcode::SaveGcode;
pub(crate) use save_points::SavePoints;
pub(crate) use save_stl::{MAX_TRIANGLES, SaveStl};
pub(crate) use summary::Summary;
