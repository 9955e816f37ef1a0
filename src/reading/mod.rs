//! Reading files: mistakes with line and column, words for messages, files beside a scene.

pub(crate) mod beside;
pub(crate) mod captions;
pub(crate) mod collector;
pub(crate) mod coordinates;
mod mistake;
pub(crate) mod setting;
pub(crate) mod source;
pub(crate) mod words;

pub use mistake::{Mistake, Mistakes};
