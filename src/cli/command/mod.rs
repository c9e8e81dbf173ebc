//! The commands, one file each.

pub(crate) mod board;
pub(crate) mod calibrate;
pub(crate) mod certify;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod design;
pub(crate) mod diff;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod figures;
pub(crate) mod follow;
pub(crate) mod init;
pub(crate) mod next;
pub(crate) mod noise;
pub(crate) mod plan;
pub(crate) mod polish;
pub(crate) mod reach;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod score;
pub(crate) mod study;
pub(crate) mod sweep;
pub(crate) mod verify;
