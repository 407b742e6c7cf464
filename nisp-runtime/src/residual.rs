//! Residual programs on a tile of points: what they read, where they write.

use crate::real::Real;
use crate::simd::Simd;

/// Everything a residual program reads, for a tile of points, each quantity contiguous over the points.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a, E> {
    /// Number of points.
    pub count: usize,
    /// Distance between quantities: at least `count`, a multiple of every vector length.
    pub stride: usize,
    /// Jets, `[jet][point]`.
    pub jets: &'a [E],
    /// Coordinates, `[coordinate][point]`.
    pub coordinates: &'a [E],
    /// Per-point data, `[column][point]`.
    pub columns: &'a [E],
    /// Scalars, the same for all points.
    pub scalars: &'a [E],
    /// Adjoints of the rows, `[row][point]`; empty in forward programs.
    pub seeds: &'a [E],
}

/// As many points of a tile as a vector has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Lane<'a, V: Simd> {
    points: Points<'a, V::Elem>,
    first: usize,
}

/// Where a residual program writes: quantities contiguous over the points.
#[derive(Debug)]
pub struct Sink<'a, E> {
    values: &'a mut [E],
    stride: usize,
    first: usize,
}

#[inline(always)]
fn read<V: Simd>(values: &[V::Elem], start: usize) -> V {
    let lane = &values[start..start + V::LANES];
    // SAFETY: the slice has LANES elements.
    unsafe { V::load(lane.as_ptr()) }
}

impl<'a, V: Simd> Lane<'a, V> {
    /// The lane that begins with point `first`.
    #[inline(always)]
    pub fn new(points: Points<'a, V::Elem>, first: usize) -> Self {
        Self { points, first }
    }

    /// Jet `index`, as listed in the group's schema.
    #[inline(always)]
    pub fn jet(&self, index: usize) -> V {
        read(self.points.jets, index * self.points.stride + self.first)
    }

    /// Coordinate `index`.
    #[inline(always)]
    pub fn coordinate(&self, index: usize) -> V {
        read(self.points.coordinates, index * self.points.stride + self.first)
    }

    /// Column `index` of the group.
    #[inline(always)]
    pub fn column(&self, index: usize) -> V {
        read(self.points.columns, index * self.points.stride + self.first)
    }

    /// Scalar `index` of the scene.
    #[inline(always)]
    pub fn scalar(&self, index: usize) -> V {
        V::splat(self.points.scalars[index])
    }

    /// Adjoint of row `index`.
    #[inline(always)]
    pub fn seed(&self, index: usize) -> V {
        read(self.points.seeds, index * self.points.stride + self.first)
    }
}

impl<'a, E: Real> Sink<'a, E> {
    /// A sink for the lane that begins with point `first`; quantities are `stride` apart.
    #[inline(always)]
    pub fn new(values: &'a mut [E], stride: usize, first: usize) -> Self {
        Self { values, stride, first }
    }

    /// Writes quantity `index`.
    #[inline(always)]
    pub fn put<V: Simd<Elem = E>>(&mut self, index: usize, value: V) {
        let start = index * self.stride + self.first;
        let lane = &mut self.values[start..start + V::LANES];
        // SAFETY: the slice has LANES elements.
        unsafe { value.store(lane.as_mut_ptr()) }
    }
}
