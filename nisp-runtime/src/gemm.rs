//! Matrix products of the small, tall shapes that a tile of points makes.
