//! A group's programs at a sample of its points, before anything is solved.

use crate::kernel::GroupKernel;
use crate::residual::Points;
use crate::schema;
use crate::simd::Isa;

/// What is bound, by group, in the engine's units.
#[derive(Clone, Copy)]
pub(super) struct Data<'a> {
    /// Point by point.
    pub(super) coordinates: &'a [Vec<f64>],
    /// The coordinates of the points' partners; empty unless the group is paired.
    pub(super) partners: &'a [Vec<f64>],
    pub(super) columns: &'a [Vec<Vec<f64>>],
    /// By group and term; empty unless the term is a Chamfer distance.
    pub(super) clouds: &'a [Vec<Vec<f64>>],
}

/// Points of a group that are looked at, at most.
const SAMPLE: usize = 256;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// A group's programs on a sample of its points, with jets to choose.
pub(super) struct Probe {
    kernel: GroupKernel<f64>,
    pub(super) schema: &'static schema::Group,
    pub(super) count: usize,
    /// Distance between quantities: a multiple of every vector length.
    pub(super) stride: usize,
    coordinates: Vec<f64>,
    columns: Vec<f64>,
}

impl Probe {
    /// A probe of the group `at`, on points of `inputs` coordinates.
    pub(super) fn new(
        kernel: GroupKernel<f64>,
        schema: &'static schema::Group,
        data: Data<'_>,
        at: usize,
        inputs: usize,
    ) -> Self {
        let (coordinates, partners) = (&data.coordinates[at], &data.partners[at]);
        let points = coordinates.len() / inputs;
        let step = points.div_ceil(SAMPLE).max(1);
        let sample: Vec<usize> = (0..points).step_by(step).collect();
        let stride = sample.len().next_multiple_of(LANES);
        let spread = |value: &dyn Fn(usize) -> f64| {
            (0..stride).map(|p| value(sample[p.min(sample.len() - 1)])).collect::<Vec<_>>()
        };
        Self {
            kernel,
            schema,
            count: sample.len(),
            stride,
            coordinates: [coordinates, partners]
                .into_iter()
                .filter(|site| !site.is_empty())
                .flat_map(|site| (0..inputs).flat_map(move |i| spread(&|p| site[p * inputs + i])))
                .collect(),
            columns: data.columns[at].iter().flat_map(|column| spread(&|p| column[p])).collect(),
        }
    }

    /// The same with zeros in all columns.
    pub(super) fn without_columns(&self) -> Self {
        Self { columns: vec![0.0; self.columns.len()], coordinates: self.coordinates.clone(), ..*self }
    }

    fn points<'a>(&'a self, jets: &'a [f64], scalars: &'a [f64], seeds: &'a [f64]) -> Points<'a, f64> {
        Points {
            count: self.count,
            stride: self.stride,
            jets,
            coordinates: &self.coordinates,
            columns: &self.columns,
            scalars,
            seeds,
        }
    }

    /// Jets, `[jet][point]`, all points alike.
    pub(super) fn jets(&self, value: impl Fn(&schema::Jet) -> f64) -> Vec<f64> {
        self.schema.jets.iter().flat_map(|jet| std::iter::repeat_n(value(jet), self.stride)).collect()
    }

    /// Derivatives of a row by every jet, `[jet][point]`.
    pub(super) fn sensitivities(&self, row: usize, jets: &[f64], scalars: &[f64]) -> Vec<f64> {
        let mut seeds = vec![0.0; self.schema.rows * self.stride];
        seeds[row * self.stride..][..self.stride].fill(1.0);
        let mut bars = vec![0.0; (self.schema.jets.len() + scalars.len()) * self.stride];
        self.kernel.programs.adjoint(Isa::detect(), self.points(jets, scalars, &seeds), &mut bars);
        bars
    }

    pub(super) fn rows(&self, jets: &[f64], scalars: &[f64], magnitude: bool) -> Vec<f64> {
        let mut rows = vec![0.0; self.schema.rows * self.stride];
        let points = self.points(jets, scalars, &[]);
        if magnitude {
            self.kernel.programs.magnitude(points, &mut rows);
        } else {
            self.kernel.programs.residual(Isa::detect(), points, &mut rows);
        }
        rows
    }

    pub(super) fn rms(&self, values: &[f64]) -> f64 {
        let finite = values[..self.count].iter().filter(|x| x.is_finite());
        let (sum, count) = finite.fold((0.0, 0usize), |(sum, count), x| (sum + x * x, count + 1));
        (sum / count.max(1) as f64).sqrt()
    }
}
