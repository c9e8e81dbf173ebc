//! Numbers, names and comments as the formats take them.

mod comment;
mod name;
mod number;

pub(super) use comment::{comments, header, is_printable, one_line, plain, wrapped};
pub(super) use name::{Names, file_name};
pub(super) use number::{decimal, fixed, rounded_down, rounded_up};
