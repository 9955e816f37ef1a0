//! Reading files of any kind: mistakes with line and column, words for messages, files in the same folder.

pub(crate) mod beside;
pub(crate) mod coordinates;
mod mistake;
pub(crate) mod report;
pub(crate) mod source;
pub(crate) mod variants;
pub(crate) mod words;

pub use mistake::{Mistake, Mistakes};
