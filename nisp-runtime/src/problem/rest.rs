//! What a problem compares its measurements with.

use crate::schema::Column;

/// Where a condition holds a measured quantity while nothing changes and no source acts, or where its bounds do.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// The group and the name of the condition; nothing for declared bounds.
    pub by: Option<(&'static str, &'static str)>,
    /// The column that measures the quantity.
    pub column: &'static Column,
    /// Least and greatest value of the middle four fifths of what was measured, in the column's unit.
    pub measured: [f64; 2],
    /// The least value that was measured, in the column's unit.
    pub least: f64,
    /// Least and greatest value that would be measured, in the column's unit.
    pub at: [f64; 2],
}
