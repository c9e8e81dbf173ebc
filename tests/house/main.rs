//! The house itself: which module may use which, and which packages.

#![allow(clippy::unwrap_used, reason = "tests")]

mod architecture;
mod dependencies;
mod reading;
