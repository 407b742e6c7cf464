//! Figures for papers and talks: SVG text laid out here, so that every axis has its unit, legends stay outside the data
//! and labels never overlap.
//!
//! [`line_plot`] stacks source and states over one axis, [`field_map`] colours a plane region, [`surface_view`] a surface in
//! space, [`log_log`] shows error against time. Each returns a [`Picture`].

mod axis;
mod bar;
mod canvas;
mod contour;
mod decimate;
mod field_map;
mod grid;
mod heading;
mod legend;
mod line_plot;
mod log_log;
mod quantity;
mod raster;
mod style;
mod surface_view;
mod text;
mod ticks;

use std::path::Path;

pub use field_map::{FieldMap, MapPanel, field_map};
pub use grid::Grid;
pub use line_plot::{Curve, LinePanel, LinePlot, line_plot};
pub use log_log::{LogLog, Mark, Series, log_log};
pub use quantity::Quantity;
pub use surface_view::{SurfaceView, surface_view};

use crate::DataError;
use crate::atomic::write_atomic;

/// A finished figure.
#[derive(Debug, Clone)]
pub struct Picture {
    svg: String,
}

impl Picture {
    /// The figure as SVG text.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Writes the figure as SVG, whole or not at all.
    pub fn write_svg(&self, path: impl AsRef<Path>) -> Result<(), DataError> {
        write_atomic(path.as_ref(), |out| out.write_all(self.svg.as_bytes()))
    }
}
