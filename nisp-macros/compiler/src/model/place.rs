//! Where the points of a group lie.

use crate::syntax::{FileKind, Portion};

/// Where a group's points lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Which part of the domain.
    pub portion: Portion,
    /// The domain's factors.
    pub domain: Vec<Region>,
    /// About how many points it shall have, if the group says so.
    pub points: Option<usize>,
}

/// A region over some coordinates, in their declared units.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Lower and upper end for each coordinate.
    Box(Vec<[f64; 2]>),
    /// An ellipse with its axes along the coordinates; a disc.
    Ellipse {
        /// Its centre.
        centre: [f64; 2],
        /// Half its diameters.
        semi_axes: [f64; 2],
    },
    /// The corners of a polygon.
    Polygon(Vec<[f64; 2]>),
    /// A ball.
    Ball {
        /// Its centre.
        centre: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A cylinder along the third coordinate.
    Cylinder {
        /// Its axis.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Where it begins and ends.
        ends: [f64; 2],
    },
    /// What a file holds.
    File {
        /// Its kind.
        kind: FileKind,
        /// Its path as written.
        path: String,
        /// One of the file's unit in the coordinates' own; 1 of a table, whose headers have units.
        scale: f64,
    },
    /// What is in either.
    Plus(Box<[Region; 2]>),
    /// What is in the first and not in the second.
    Minus(Box<[Region; 2]>),
}
