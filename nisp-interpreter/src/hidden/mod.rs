//! Hidden layers and gates, interpreted: the rules of a channel set on tiles of points.
//!
//! The arrangement is that of the compiled layers in `nisp_runtime::layer`, where shapes are described; rules are tapes.

mod gate;

use gate::{Block, GateRun, copy, gate_adjoint_holds, gate_holds};
use nisp_compiler::program::Slot;
use nisp_runtime::layer::{Gate, GateAdjoint, Gated, GatedAdjoint, Layer, LayerAdjoint};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Isa, Kernel, Simd};

use crate::block::{Run, vectors};
use crate::rules::{InterpretedLayers, holds};

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
