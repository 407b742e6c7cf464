//! Tapes run on blocks: up to eight vectors of units or points at once, so that choosing an operation costs little beside it.

use std::marker::PhantomData;

use nisp_compiler::program::Slot;
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Element, Isa, Kernel, Simd, dispatch};

use crate::scratch::Scratch;
use crate::tape::{Code, Step, Tape};

/// Vectors in a block at most.
pub(crate) const VECTORS: usize = 8;

/// A tape with memory for its registers, and with the addresses of its inputs.
pub(crate) struct Run<'a, V: Simd> {
    tape: &'a Tape,
    /// Address of every place. Registers lie in `memory`; inputs are the caller's.
    at: Vec<*mut V::Elem>,
    /// A block of zeros, then the registers: what `at` points into.
    start: *const V::Elem,
    _memory: Scratch,
    isa: Isa,
    vector: PhantomData<V>,
}

impl<'a, V: Simd> Run<'a, V> {
    /// Numbers in a block at most.
    pub(crate) const BLOCK: usize = VECTORS * V::LANES;

    /// Memory for a tape. Inputs point at zeros until they are [set](Run::point).
    #[inline(always)]
    pub(crate) fn new(isa: Isa, tape: &'a Tape) -> Self {
        let mut memory = Scratch::of::<V::Elem>((1 + tape.registers) * Self::BLOCK);
        let start: *mut V::Elem = memory.start();
        let mut at = Vec::with_capacity(tape.inputs.len() + tape.registers);
        at.resize(tape.inputs.len(), start);
        // SAFETY: the block of zeros is the first of the memory. What was there before is overwritten.
        unsafe { (0..VECTORS).for_each(|i| V::splat(V::Elem::ZERO).store(start.add(i * V::LANES))) };
        // SAFETY: registers lie within the memory.
        at.extend((1..=tape.registers).map(|register| unsafe { start.add(register * Self::BLOCK) }));
        Self { tape, at, start, _memory: memory, isa, vector: PhantomData }
    }

    /// Points every input, by its number and by what it is, at where `address` has it.
    ///
    /// # Safety
    /// As many numbers as a block has must be readable there when the tape is run.
    #[inline(always)]
    pub(crate) unsafe fn point(&mut self, address: impl Fn(usize, (Slot, usize)) -> *const V::Elem) {
        for (input, (place, &read)) in self.at.iter_mut().zip(&self.tape.inputs).enumerate() {
            *place = address(input, read).cast_mut();
        }
    }

    /// Computes what is the same for all points. Inputs that it reads must have been set.
    ///
    /// # Safety
    /// A whole block must be readable at the inputs that these steps read.
    #[inline(always)]
    pub(crate) unsafe fn once(&mut self) {
        dispatch(self.isa, Steps::<V::Elem> { steps: &self.tape.once, at: &self.at, vectors: VECTORS });
    }

    /// Runs the steps on a block of so many vectors: one, two, four or eight.
    ///
    /// # Safety
    /// As for [`Run::point`].
    #[inline(always)]
    pub(crate) unsafe fn run(&mut self, vectors: usize) {
        dispatch(self.isa, Steps::<V::Elem> { steps: &self.tape.steps, at: &self.at, vectors });
    }

    /// Where an output is: readable until the next run; zeros for a structural zero.
    #[inline(always)]
    pub(crate) fn output(&self, index: usize) -> *const V::Elem {
        self.tape.outputs[index].map_or(self.start, |place| self.at[place].cast_const())
    }

    /// A block of zeros.
    #[inline(always)]
    pub(crate) fn zeros(&self) -> *const V::Elem {
        self.start
    }
}

/// How many vectors the next block has, of so many that are left: a power of two.
#[inline(always)]
pub(crate) fn vectors(left: usize) -> usize {
    let most = left.min(VECTORS);
    1 << most.ilog2()
}

/// Steps on a block of so many vectors. Entered anew for each, so that there is one interpreter for an instruction set and not
/// one wherever it is called. Whoever enters vouches that every place that the steps name is valid for a block.
struct Steps<'a, E> {
    steps: &'a [Step],
    at: &'a [*mut E],
    vectors: usize,
}

impl<E: Element> Kernel<E> for Steps<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { steps, at, vectors } = self;
        // SAFETY: as said above.
        unsafe {
            match vectors {
                8 => run::<V, 8>(steps, at),
                4 => run::<V, 4>(steps, at),
                2 => run::<V, 2>(steps, at),
                _ => run::<V, 1>(steps, at),
            }
        }
    }
}

/// Runs steps on blocks of `N` vectors.
///
/// # Safety
/// Every place that the steps name is valid for a block.
#[inline(always)]
unsafe fn run<V: Simd, const N: usize>(steps: &[Step], at: &[*mut V::Elem]) {
    for step in steps {
        // SAFETY: as the caller vouches. A vector is read before it is written, so that places may be the same.
        unsafe {
            let to = *at.get_unchecked(step.to);
            let a = *at.get_unchecked(step.from[0]);
            let b = *at.get_unchecked(step.from[1]);
            let c = *at.get_unchecked(step.from[2]);
            // A macro and no closure: a closure that is not inlined loses the instruction set.
            macro_rules! each {
                (|$i:ident| $value:expr) => {
                    for $i in 0..N {
                        let value: V = $value;
                        value.store(to.add($i * V::LANES));
                    }
                };
            }
            match step.code {
                Code::Constant(value) => each!(|i| V::lit(value)),
                Code::Add => each!(|i| load::<V>(a, i).add(load(b, i))),
                Code::Sub => each!(|i| load::<V>(a, i).sub(load(b, i))),
                Code::Mul => each!(|i| load::<V>(a, i).mul(load(b, i))),
                Code::Div => each!(|i| load::<V>(a, i).div(load(b, i))),
                Code::Neg => each!(|i| load::<V>(a, i).neg()),
                Code::MulAdd => each!(|i| load::<V>(a, i).mul_add(load(b, i), load(c, i))),
                Code::MulSub => each!(|i| load::<V>(a, i).mul_sub(load(b, i), load(c, i))),
                Code::NegMulAdd => each!(|i| load::<V>(a, i).neg_mul_add(load(b, i), load(c, i))),
                Code::Min => each!(|i| load::<V>(a, i).min(load(b, i))),
                Code::Max => each!(|i| load::<V>(a, i).max(load(b, i))),
                Code::Sqrt => each!(|i| load::<V>(a, i).sqrt()),
                Code::Abs => each!(|i| load::<V>(a, i).abs()),
                Code::Call(function) => each!(|i| load::<V>(a, i).map(function)),
            }
        }
    }
}

/// Vector `i` of a block.
///
/// # Safety
/// `from` is valid for it.
#[inline(always)]
pub(crate) unsafe fn load<V: Simd>(from: *const V::Elem, i: usize) -> V {
    // SAFETY: as the caller vouches.
    unsafe { V::load(from.add(i * V::LANES)) }
}
