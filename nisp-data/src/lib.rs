//! What goes into NISP and what comes out: tables, point clouds, domains, pictures.
//!
//! Nothing here knows of equations or networks. Every fault of a user's file is a [`DataError`] whose one line names
//! the place and says what to do; no input makes this crate panic.

pub mod atomic;
pub mod cloud;
pub mod colour;
mod components;
pub mod domain;
mod elsewhere;
pub mod error;
pub mod export;
pub mod input;
mod lock;
mod names;
pub mod out_dir;
pub mod overlap;
pub mod picture;
mod replace;
pub mod table;

pub use cloud::Cloud;
pub use elsewhere::Written;
pub use error::DataError;
pub use names::nearest_name;
pub use out_dir::OutDir;
pub use table::{Rows, Table, moment};
