//! Gates of a block: `d + g y` and its adjoint.

use nisp_compiler::program::Slot;
use nisp_runtime::layer::{Gate, GateAdjoint, Shape};
use nisp_runtime::simd::{Isa, Simd};

use crate::block::{Run, load};
use crate::rules::{Rules, holds};

/// Checks that the gates' rows hold so many channels.
pub(super) fn gate_holds<E>(shape: Shape, gate: &Gate<'_, E>, channels: usize) {
    holds(shape, gate.difference, channels);
    holds(shape, gate.floor, channels);
}

/// Checks that the gates' rows and those of their adjoints hold so many channels.
pub(super) fn gate_adjoint_holds<E>(shape: Shape, gate: &GateAdjoint<'_, E>, channels: usize) {
    gate_holds(shape, &gate.gate, channels);
    holds(shape, gate.difference_bar, channels);
    holds(shape, gate.floor_bar, channels);
}

/// Where a block's rows are: from `at` on, `ld` apart.
#[derive(Clone, Copy)]
pub(super) struct Block {
    pub(super) at: usize,
    pub(super) ld: usize,
    pub(super) vectors: usize,
}

impl Block {
    /// Where row `channel` of the block starts.
    #[inline(always)]
    pub(super) fn row(self, channel: usize) -> usize {
        self.at + channel * self.ld
    }
}

/// Copies a block.
///
/// # Safety
/// Both ends are valid for it.
#[inline(always)]
pub(super) unsafe fn copy<V: Simd>(from: *const V::Elem, to: *mut V::Elem, vectors: usize) {
    for i in 0..vectors {
        // SAFETY: as the caller vouches.
        unsafe { load::<V>(from, i).store(to.add(i * V::LANES)) };
    }
}

/// Writes the sum of two blocks.
///
/// # Safety
/// All three are valid for it.
#[inline(always)]
pub(super) unsafe fn sum<V: Simd>(a: *const V::Elem, b: *const V::Elem, to: *mut V::Elem, vectors: usize) {
    for i in 0..vectors {
        // SAFETY: as the caller vouches.
        unsafe { load::<V>(a, i).add(load::<V>(b, i)).store(to.add(i * V::LANES)) };
    }
}

/// The gate `d + g y` of a block, in the channels that are read, and its adjoint.
pub(super) struct GateRun<'a, V: Simd> {
    product: Run<'a, V>,
    adjoint: Run<'a, V>,
    read: &'a [bool],
}

impl<'a, V: Simd> GateRun<'a, V> {
    #[inline(always)]
    pub(super) fn new(isa: Isa, rules: &'a Rules) -> Self {
        let mut runs = [Run::new(isa, &rules.product), Run::new(isa, &rules.product_adjoint)];
        // SAFETY: rules of a product have no scalars, so that what is the same for all points reads no input.
        unsafe { runs.iter_mut().for_each(|run| run.once()) };
        let [product, adjoint] = runs;
        Self { product, adjoint, read: &rules.read }
    }

    /// Writes `d + g y` to `output`, where `y(channel)` is the argument's channel.
    ///
    /// # Safety
    /// All rows hold the block.
    #[inline(always)]
    pub(super) unsafe fn forward(
        &mut self,
        gate: &Gate<'_, V::Elem>,
        y: impl Fn(usize) -> *const V::Elem,
        output: *mut V::Elem,
        block: Block,
    ) {
        // SAFETY: as the caller vouches.
        unsafe {
            let difference = gate.difference.as_ptr();
            self.product.point(|_, (slot, channel)| match slot {
                Slot::Left => difference.add(block.row(channel)),
                _ => y(channel),
            });
            self.product.run(block.vectors);
            for (channel, _) in self.read.iter().enumerate().filter(|(_, read)| **read) {
                let row = block.row(channel);
                sum::<V>(self.product.output(channel), gate.floor.as_ptr().add(row), output.add(row), block.vectors);
            }
        }
    }

    /// Writes `d + g y` to `output` and adds to the adjoints of the gates; afterwards [`GateRun::y_bar`] is the adjoint of `y`.
    ///
    /// # Safety
    /// All rows hold the block.
    #[inline(always)]
    pub(super) unsafe fn backward(
        &mut self,
        gate: &mut GateAdjoint<'_, V::Elem>,
        y: impl Fn(usize) -> *const V::Elem,
        seed: *const V::Elem,
        output: *mut V::Elem,
        block: Block,
    ) {
        // SAFETY: as the caller vouches.
        unsafe {
            self.forward(&gate.gate, &y, output, block);
            let (difference, zeros, read) = (gate.gate.difference.as_ptr(), self.adjoint.zeros(), self.read);
            self.adjoint.point(|_, (slot, channel)| match slot {
                Slot::Left => difference.add(block.row(channel)),
                Slot::Right => y(channel),
                _ if read[channel] => seed.add(block.row(channel)),
                _ => zeros,
            });
            self.adjoint.run(block.vectors);
            for (channel, read) in self.read.iter().enumerate() {
                let row = block.row(channel);
                let bar = gate.difference_bar.as_mut_ptr().add(row);
                sum::<V>(bar, self.adjoint.output(channel), bar, block.vectors);
                if *read {
                    let bar = gate.floor_bar.as_mut_ptr().add(row);
                    sum::<V>(bar, seed.add(row), bar, block.vectors);
                }
            }
        }
    }

    /// Adjoint of a channel of `y`, after [`GateRun::backward`].
    #[inline(always)]
    pub(super) fn y_bar(&self, channel: usize) -> *const V::Elem {
        self.adjoint.output(self.read.len() + channel)
    }
}
