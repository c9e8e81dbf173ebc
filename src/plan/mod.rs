//! From a problem to a plan, and what is asked of it.

pub mod assess;
pub mod choose;
pub mod document;
pub mod results;
pub mod survey;
