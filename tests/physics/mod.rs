//! The physics compared with the paper and with closed forms, without files and without a graphics device.

#[cfg(feature = "render")]
mod asked;
mod checkpoints;
mod fig4a;
mod fig4b;
mod fig4c;
mod free_form;
mod restore;
mod shipped;
mod stability;
mod support;
