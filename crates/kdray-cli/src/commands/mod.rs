//! One module a command.

pub(crate) mod animate;
pub(crate) mod bench;
pub(crate) mod build;
pub(crate) mod devices;
pub(crate) mod info;
pub(crate) mod query;
pub(crate) mod render;
pub(crate) mod validate;
pub(crate) mod view;
