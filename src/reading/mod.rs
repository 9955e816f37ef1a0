//! What reading a file needs, whatever it is about: mistakes at their places, words, files that lie beside it.

pub(crate) mod beside;
pub(crate) mod coordinates;
mod mistake;
pub(crate) mod report;
pub(crate) mod source;
pub(crate) mod words;

pub use mistake::{Mistake, Mistakes};
