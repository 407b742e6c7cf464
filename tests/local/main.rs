//! Local functions on a drumhead with known answers (`drum.rs`).

mod clouds;
mod contact;
mod drum;
mod limits;
mod sessions;
