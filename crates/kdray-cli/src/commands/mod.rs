//! One module a command.

pub(crate) mod bench;
pub(crate) mod build;
pub(crate) mod info;
pub(crate) mod render;
pub(crate) mod validate;
