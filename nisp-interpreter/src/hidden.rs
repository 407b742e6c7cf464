//! Hidden layers and gates, interpreted: the rules of a channel set on tiles of points.
//!
//! The arrangement is that of the compiled layers in `nisp_runtime::layer`, where shapes are described; rules are tapes.

use nisp_compiler::program::Slot;
use nisp_runtime::layer::{Gate, GateAdjoint, Gated, GatedAdjoint, Layer, LayerAdjoint, Shape};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Isa, Kernel, Simd};

use crate::block::{Run, load, vectors};
use crate::rules::{InterpretedLayers, Rules, holds};

/// Checks that the gates' rows hold so many channels.
fn gate_holds<E>(shape: Shape, gate: &Gate<'_, E>, channels: usize) {
    holds(shape, gate.difference, channels);
    holds(shape, gate.floor, channels);
}

/// Checks that the gates' rows and those of their adjoints hold so many channels.
fn gate_adjoint_holds<E>(shape: Shape, gate: &GateAdjoint<'_, E>, channels: usize) {
    gate_holds(shape, &gate.gate, channels);
    holds(shape, gate.difference_bar, channels);
    holds(shape, gate.floor_bar, channels);
}

/// Where a block's rows are: from `at` on, `ld` apart.
#[derive(Clone, Copy)]
struct Block {
    at: usize,
    ld: usize,
    vectors: usize,
}

impl Block {
    /// Where row `channel` of the block starts.
    #[inline(always)]
    fn row(self, channel: usize) -> usize {
        self.at + channel * self.ld
    }
}

/// Copies a block.
///
/// # Safety
/// Both ends are valid for it.
#[inline(always)]
unsafe fn copy<V: Simd>(from: *const V::Elem, to: *mut V::Elem, vectors: usize) {
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
unsafe fn sum<V: Simd>(a: *const V::Elem, b: *const V::Elem, to: *mut V::Elem, vectors: usize) {
    for i in 0..vectors {
        // SAFETY: as the caller vouches.
        unsafe { load::<V>(a, i).add(load::<V>(b, i)).store(to.add(i * V::LANES)) };
    }
}

/// The gate `d + g y` of a block, in the channels that are read, and its adjoint.
struct GateRun<'a, V: Simd> {
    product: Run<'a, V>,
    adjoint: Run<'a, V>,
    read: &'a [bool],
}

impl<'a, V: Simd> GateRun<'a, V> {
    #[inline(always)]
    fn new(isa: Isa, rules: &'a Rules) -> Self {
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
    unsafe fn forward(
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
    unsafe fn backward(
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
    fn y_bar(&self, channel: usize) -> *const V::Elem {
        self.adjoint.output(self.read.len() + channel)
    }
}

pub(crate) struct LayerKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: Layer<'a, E>,
    pub(crate) gate: Option<Gate<'a, E>>,
    pub(crate) last: bool,
}

impl<E: Real> Kernel<E> for LayerKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer: Layer { shape, activation, argument, bias, slope, output }, gate, last } = self;
        let channels = layers.channels;
        holds(shape, argument, channels);
        holds(shape, output, channels);
        holds(shape, slope, 1);
        assert!(bias.len() >= shape.width && shape.width.is_multiple_of(V::LANES));
        if let Some(gate) = &gate {
            gate_holds(shape, gate, channels);
        }
        let given = layers.slopes.are_given::<E>(layers.coordinates);
        let rules = layers.rules(last && gate.is_some());
        let mut phi = layers.slopes.run::<V>();
        let mut compose = Run::<V>::new(isa, &layers.hidden.compose);
        let mut ending = gate.map(|gate| (gate, GateRun::<V>::new(isa, rules)));
        let (argument, slope, output) = (argument.as_mut_ptr(), slope.as_mut_ptr(), output.as_mut_ptr());
        // SAFETY: lengths were checked above; a block does not reach past the width. Composing reads no scalars.
        unsafe {
            compose.once();
            for point in 0..shape.points {
                let mut unit = 0;
                while unit < shape.width {
                    let vectors = vectors((shape.width - unit) / V::LANES);
                    let block = Block { at: point * channels * shape.ld + unit, ld: shape.ld, vectors };
                    let (value, slope) = (argument.add(block.at), slope.add(point * shape.ld + unit));
                    if !given {
                        phi.activate(activation, value, Some(bias.as_ptr().add(unit)), value, slope, vectors);
                    }
                    phi.derive(activation, value, slope, vectors);
                    compose.point(|_, (slot, index)| match slot {
                        Slot::Phi => phi.derivative(index),
                        _ => argument.add(block.row(index)).cast_const(),
                    });
                    compose.run(vectors);
                    match &mut ending {
                        Some((gate, ending)) => {
                            ending.forward(gate, |channel| compose.output(channel), output, block);
                        }
                        None => {
                            for channel in 0..channels {
                                copy::<V>(compose.output(channel), output.add(block.row(channel)), vectors);
                            }
                        }
                    }
                    unit += vectors * V::LANES;
                }
            }
        }
    }
}

pub(crate) struct LayerAdjointKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: LayerAdjoint<'a, E>,
    pub(crate) gate: Option<GateAdjoint<'a, E>>,
    pub(crate) last: bool,
}

impl<E: Real> Kernel<E> for LayerAdjointKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer, mut gate, last } = self;
        let LayerAdjoint { shape, activation, argument, slope, seed, argument_bar, output } = layer;
        let channels = layers.channels;
        for rows in [argument, seed, &*argument_bar, &*output] {
            holds(shape, rows, channels);
        }
        holds(shape, slope, 1);
        assert!(shape.width.is_multiple_of(V::LANES));
        if let Some(gate) = &gate {
            gate_adjoint_holds(shape, gate, channels);
        }
        let rules = layers.rules(last && gate.is_some());
        let mut phi = layers.slopes.run::<V>();
        let mut compose = Run::<V>::new(isa, &layers.hidden.compose);
        let mut adjoint = Run::<V>::new(isa, &layers.hidden.compose_adjoint);
        let mut ending = gate.is_some().then(|| GateRun::<V>::new(isa, rules));
        let (argument, slope, seed) = (argument.as_ptr(), slope.as_ptr(), seed.as_ptr());
        let (argument_bar, output) = (argument_bar.as_mut_ptr(), output.as_mut_ptr());
        // SAFETY: lengths were checked above; a block does not reach past the width. Composing reads no scalars.
        unsafe {
            compose.once();
            adjoint.once();
            for point in 0..shape.points {
                let mut unit = 0;
                while unit < shape.width {
                    let vectors = vectors((shape.width - unit) / V::LANES);
                    let block = Block { at: point * channels * shape.ld + unit, ld: shape.ld, vectors };
                    phi.derive(activation, argument.add(block.at), slope.add(point * shape.ld + unit), vectors);
                    let read = |slot: Slot, index: usize| match slot {
                        Slot::Phi => phi.derivative(index),
                        _ => argument.add(block.row(index)),
                    };
                    compose.point(|_, (slot, index)| read(slot, index));
                    compose.run(vectors);
                    match (&mut ending, &mut gate) {
                        (Some(ending), Some(gate)) => {
                            ending.backward(gate, |channel| compose.output(channel), seed, output, block);
                            adjoint.point(|_, (slot, index)| match slot {
                                Slot::Seed => ending.y_bar(index),
                                _ => read(slot, index),
                            });
                        }
                        _ => {
                            for channel in 0..channels {
                                copy::<V>(compose.output(channel), output.add(block.row(channel)), vectors);
                            }
                            adjoint.point(|_, (slot, index)| match slot {
                                Slot::Seed => seed.add(block.row(index)),
                                _ => read(slot, index),
                            });
                        }
                    }
                    adjoint.run(vectors);
                    for channel in 0..channels {
                        copy::<V>(adjoint.output(channel), argument_bar.add(block.row(channel)), vectors);
                    }
                    unit += vectors * V::LANES;
                }
            }
        }
    }
}

pub(crate) struct GateKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: Gated<'a, E>,
}

impl<E: Real> Kernel<E> for GateKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer: Gated { shape, input, gate, output } } = self;
        holds(shape, input, layers.channels);
        holds(shape, output, layers.channels);
        gate_holds(shape, &gate, layers.channels);
        assert!(shape.width.is_multiple_of(V::LANES));
        let mut ending = GateRun::<V>::new(isa, &layers.hidden);
        let (input, output) = (input.as_ptr(), output.as_mut_ptr());
        for point in 0..shape.points {
            let mut unit = 0;
            while unit < shape.width {
                let vectors = vectors((shape.width - unit) / V::LANES);
                let block = Block { at: point * layers.channels * shape.ld + unit, ld: shape.ld, vectors };
                // SAFETY: lengths were checked above; a block does not reach past the width.
                unsafe { ending.forward(&gate, |channel| input.add(block.row(channel)), output, block) };
                unit += vectors * V::LANES;
            }
        }
    }
}

pub(crate) struct GateAdjointKernel<'a, E> {
    pub(crate) isa: Isa,
    pub(crate) layers: &'a InterpretedLayers,
    pub(crate) layer: GatedAdjoint<'a, E>,
}

impl<E: Real> Kernel<E> for GateAdjointKernel<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let Self { isa, layers, layer: GatedAdjoint { shape, input, seed, mut gate, input_bar, output } } = self;
        for rows in [input, seed, &*input_bar, &*output] {
            holds(shape, rows, layers.channels);
        }
        gate_adjoint_holds(shape, &gate, layers.channels);
        assert!(shape.width.is_multiple_of(V::LANES));
        let mut ending = GateRun::<V>::new(isa, &layers.hidden);
        let (input, seed) = (input.as_ptr(), seed.as_ptr());
        let (input_bar, output) = (input_bar.as_mut_ptr(), output.as_mut_ptr());
        for point in 0..shape.points {
            let mut unit = 0;
            while unit < shape.width {
                let vectors = vectors((shape.width - unit) / V::LANES);
                let block = Block { at: point * layers.channels * shape.ld + unit, ld: shape.ld, vectors };
                // SAFETY: lengths were checked above; a block does not reach past the width.
                unsafe {
                    ending.backward(&mut gate, |channel| input.add(block.row(channel)), seed, output, block);
                    for channel in 0..layers.channels {
                        copy::<V>(ending.y_bar(channel), input_bar.add(block.row(channel)), vectors);
                    }
                }
                unit += vectors * V::LANES;
            }
        }
    }
}
