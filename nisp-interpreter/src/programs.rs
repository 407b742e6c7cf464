//! Residual programs, interpreted.

use nisp_compiler::plan::{GroupPlan, RowKind};
use nisp_compiler::program::{Program, Slot};
use nisp_runtime::residual::{Points, Programs};
use nisp_runtime::simd::{Element, Isa, Kernel, Simd, dispatch};

use crate::block::{Run, load, vectors};
use crate::tape::Tape;

/// The programs of a group: those of every step as tapes, those that run once as the compiler left them.
#[derive(Debug)]
pub(crate) struct InterpretedPrograms {
    residual: Tape,
    adjoint: Tape,
    magnitude: Program,
    /// Targets of integrals: first row, program.
    targets: Vec<(usize, Program)>,
    /// Their derivatives by the learned scalars: first entry, program.
    slopes: Vec<(usize, Program)>,
}

impl InterpretedPrograms {
    pub(crate) fn new(group: &GroupPlan) -> Self {
        let integrals = group.terms.iter().filter_map(|term| match &term.kind {
            RowKind::Integral(target) => Some((term.first, target.clone())),
            _ => None,
        });
        let slopes = group.terms.iter().filter(|term| !term.target_slopes.outputs.is_empty()).map(|term| {
            let entries = term.target_slopes.outputs.len();
            (term.first * entries / term.rows, term.target_slopes.clone())
        });
        Self {
            residual: Tape::new(&group.residual),
            adjoint: Tape::new(&group.adjoint),
            magnitude: group.magnitude.clone(),
            targets: integrals.collect(),
            slopes: slopes.collect(),
        }
    }
}

impl<E: Element> Programs<E> for InterpretedPrograms {
    fn residual(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]) {
        dispatch(isa, OverPoints { isa, tape: &self.residual, points, out: rows });
    }

    fn adjoint(&self, isa: Isa, points: Points<'_, E>, bars: &mut [E]) {
        dispatch(isa, OverPoints { isa, tape: &self.adjoint, points, out: bars });
    }

    fn magnitude(&self, points: Points<'_, f64>, rows: &mut [f64]) {
        for point in 0..points.count {
            let at = |quantities: &[f64], index: usize| quantities[index * points.stride + point];
            let outputs = self.magnitude.evaluate(|slot, index| match slot {
                Slot::Jet => at(points.jets, index),
                Slot::Coordinate => at(points.coordinates, index),
                Slot::Column => at(points.columns, index),
                Slot::Parameter => points.scalars[index],
                _ => at(points.seeds, index),
            });
            for (row, output) in outputs.into_iter().enumerate() {
                rows[row * points.stride + point] = output;
            }
        }
    }

    fn target(&self, scalars: &[f64], rows: &mut [f64]) {
        of_scalars(&self.targets, scalars, rows);
    }

    fn target_slopes(&self, scalars: &[f64], rows: &mut [f64]) {
        of_scalars(&self.slopes, scalars, rows);
    }
}

/// Programs over scalars alone; each writes its outputs from its first entry on.
fn of_scalars(programs: &[(usize, Program)], scalars: &[f64], out: &mut [f64]) {
    for (first, program) in programs {
        let outputs = program.evaluate(|_, index| scalars[index]);
        out[*first..][..outputs.len()].copy_from_slice(&outputs);
    }
}

/// A tape over the points of a tile.
struct OverPoints<'a, E> {
    isa: Isa,
    tape: &'a Tape,
    points: Points<'a, E>,
    out: &'a mut [E],
}

impl<E: Element> Kernel<E> for OverPoints<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, tape, points, out } = self;
        let Points { count, stride, jets, coordinates, columns, scalars, seeds } = points;
        let quantities = |slot: Slot| match slot {
            Slot::Jet => jets,
            Slot::Coordinate => coordinates,
            Slot::Column => columns,
            _ => seeds,
        };
        // Whole vectors: lanes past the last point are there, and finite.
        let end = count.next_multiple_of(V::LANES);
        assert!(end <= stride && out.len() >= tape.outputs.len() * stride - (stride - end));
        let mut blocks = vec![E::ZERO; tape.inputs.len() * Run::<V>::BLOCK];
        for (&(slot, index), block) in tape.inputs.iter().zip(blocks.chunks_exact_mut(Run::<V>::BLOCK)) {
            match slot {
                Slot::Parameter => block.fill(scalars[index]),
                _ => assert!(quantities(slot).len() >= index * stride + end),
            }
        }
        let blocks = blocks.as_ptr();
        let mut run = Run::<V>::new(isa, tape);
        let mut first = 0;
        while first < end {
            let vectors = vectors((end - first) / V::LANES);
            // SAFETY: lengths were checked above; a block does not reach past `end`.
            unsafe {
                run.point(|input, (slot, index)| match slot {
                    Slot::Parameter => blocks.add(input * Run::<V>::BLOCK),
                    _ => quantities(slot).as_ptr().add(index * stride + first),
                });
                if first == 0 {
                    run.once();
                }
                run.run(vectors);
                for output in 0..tape.outputs.len() {
                    let from = run.output(output);
                    let to = out.as_mut_ptr().add(output * stride + first);
                    for i in 0..vectors {
                        load::<V>(from, i).store(to.add(i * V::LANES));
                    }
                }
            }
            first += vectors * V::LANES;
        }
    }
}
