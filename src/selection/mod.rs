//! Choosing the k views that together teach most.

mod method;

pub use method::Method;
