//! Every command as a user runs it: the program, its files, its words and its exit status.

#[cfg(feature = "render")]
mod animate;
mod bodies;
mod check;
mod compare;
mod disk;
mod export;
#[cfg(feature = "render")]
mod figure;
mod folders;
#[cfg(feature = "render")]
mod goldens;
mod info;
mod interrupt;
#[cfg(feature = "render")]
mod parts;
#[cfg(feature = "render")]
mod recorded;
#[cfg(feature = "render")]
mod render;
mod resume;
mod set;
#[cfg(feature = "render")]
mod shards;
mod simulate;
mod support;
mod usage;
