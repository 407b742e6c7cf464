//! Where the points of a group lie.

/// Where a group's points lie, in the declared units of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Which part of the domain.
    pub portion: Portion,
    /// The domain: a product of regions over the coordinates in their order.
    pub domain: &'static [Region],
    /// About how many points the group shall have, if it says so.
    pub points: Option<usize>,
}

/// A part of a domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portion {
    /// Everywhere in it.
    Inside,
    /// On the edge of its first region.
    Boundary,
    /// Where its last region, an interval, begins.
    Start,
    /// Where its last region ends.
    End,
}

/// A region over some coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Lower and upper end for each coordinate.
    Box(&'static [[f64; 2]]),
    /// An ellipse with its axes along the coordinates; a disc.
    Ellipse {
        /// Its centre.
        centre: [f64; 2],
        /// Half its diameters.
        semi_axes: [f64; 2],
    },
    /// The corners of a polygon.
    Polygon(&'static [[f64; 2]]),
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
        path: &'static str,
        /// One of the file's unit in the coordinates' own; 1 of a table, whose headers have units.
        scale: f64,
    },
    /// What is in either.
    Plus(&'static [Region; 2]),
    /// What is in the first and not in the second.
    Minus(&'static [Region; 2]),
}

/// What a file holds that a region is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// The corners of a polygon, as a table of two columns.
    Polygon,
    /// A closed surface of triangles, as STL.
    Solid,
}
