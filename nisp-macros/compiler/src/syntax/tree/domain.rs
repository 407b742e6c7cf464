//! Domains, and which part of one the points of a group lie in.

use super::{Expr, Name};
use crate::error::Place;

/// A domain: regions over the coordinates in their order, as a product.
#[derive(Clone, Debug)]
pub struct Domain {
    /// Its name.
    pub name: Name,
    /// Its factors.
    pub regions: Vec<Region>,
}

/// A region over one or more coordinates.
#[derive(Clone, Debug)]
pub struct Region {
    /// What it is.
    pub kind: RegionKind,
    /// Where it stands.
    pub place: Place,
}

/// What a region is, as written.
#[derive(Clone, Debug)]
pub enum RegionKind {
    /// `a .. b` or `box(a .. b, ...)`.
    Box(Vec<(Expr, Expr)>),
    /// `disc(x, y, radius)`.
    Disc(Vec<Expr>),
    /// `ellipse(x, y, a, b)`.
    Ellipse(Vec<Expr>),
    /// `polygon([x, y], ...)`.
    Polygon(Vec<Expr>),
    /// `ball(x, y, z, radius)`.
    Ball(Vec<Expr>),
    /// `cylinder(x, y, radius, a .. b)`, its axis along the third coordinate.
    Cylinder(Vec<Expr>, Option<(Expr, Expr)>),
    /// `polygon("outline.csv")` or `solid("tank.stl" [mm])`: one of the file's unit, as an expression.
    File(FileKind, String, Expr),
    /// `a plus b`: what is in either.
    Plus(Box<Region>, Box<Region>),
    /// `a minus b`: what is in the first and not in the second.
    Minus(Box<Region>, Box<Region>),
}

/// What a file holds that a region is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// The corners of a polygon, as a table of two columns.
    Polygon,
    /// A closed surface of triangles, as STL.
    Solid,
}

/// Which part of a domain a group lies in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portion {
    /// Everywhere in it.
    Inside,
    /// On the edge of its first factor.
    Boundary,
    /// Where the last factor, an interval, begins.
    Start,
    /// Where the last factor ends.
    End,
}

/// `in D`, `boundary of D`, `start of D` or `end of D`.
#[derive(Clone, Debug)]
pub struct Location {
    /// Which part.
    pub portion: Portion,
    /// The domain's name.
    pub domain: Name,
    /// `with 2000 points`: about how many, where that is written.
    pub points: Option<usize>,
}
