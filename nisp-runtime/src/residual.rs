//! Residual programs on a tile of points: what they read, what they do, where they write.

use crate::real::Real;
use crate::simd::{Isa, Simd};

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

/// Residual program of one group of one scene, for as many points as a vector has lanes.
pub trait Residuals: Send + Sync + 'static {
    /// Writes the rows of all terms.
    fn residual<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>);
    /// Writes the adjoint of every jet, then of every learned scalar.
    fn adjoint<V: Simd>(at: &Lane<'_, V>, bars: &mut Sink<'_, V::Elem>);
    /// Writes the rows with every sum replaced by the sum of magnitudes, for the sizes of equations.
    fn magnitude<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>);
    /// Targets of integral terms, from scalars alone; `rows` is indexed like the group's rows.
    fn target(scalars: &[f64], rows: &mut [f64]);
    /// Their derivatives by the learned scalars, `[row][learned scalar]`; rows of other terms are left alone.
    fn target_slopes(scalars: &[f64], rows: &mut [f64]);
}

/// The residual programs of a group, erased: each method works on a tile.
pub trait Programs<E: Real>: Send + Sync {
    /// Residual rows of a tile, `[row][point]`.
    fn residual(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]);
    /// Adjoints of jets, then of learned scalars, `[jet or scalar][point]`.
    fn adjoint(&self, isa: Isa, points: Points<'_, E>, bars: &mut [E]);
    /// Magnitude rows, `[row][point]`.
    fn magnitude(&self, points: Points<'_, f64>, rows: &mut [f64]);
    /// Targets of integral terms.
    fn target(&self, scalars: &[f64], rows: &mut [f64]);
    /// Derivatives of the targets of integral terms by the learned scalars, `[row][learned scalar]`.
    fn target_slopes(&self, scalars: &[f64], rows: &mut [f64]);
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
