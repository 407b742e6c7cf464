//! Emitted rules and programs, erased. Everything here is compiled in users' crates, once for each channel set or group
//! and each instruction set: no more kernels than differ in their inner loops.

use std::marker::PhantomData;

use crate::layer::{
    Affine, AffineAdjoint, AffineAdjointKernel, AffineKernel, Ending, EndingAdjoint, Features, FeaturesKernel, Gate,
    GateAdjoint, GateAdjointKernel, GateKernel, Gated, GatedAdjoint, Layer, LayerAdjoint, LayerAdjointKernel,
    LayerKernel, Layers, takes_values,
};
use crate::residual::{Lane, Points, Programs, Residuals, Sink};
use crate::rules::Rules;
use crate::simd::{Element, Isa, Kernel, Simd, dispatch, plain};

/// Layers with hidden rules `H`, of which the last has rules `L`.
#[derive(Debug)]
pub struct CompiledLayers<H, L, const K: usize, const D: usize, const S: usize>(PhantomData<fn() -> (H, L)>);

impl<H: Rules<K, D, S>, L: Rules<K, D, S>, const K: usize, const D: usize, const S: usize>
    CompiledLayers<H, L, K, D, S>
{
    /// The layers without their type.
    pub fn erased<E: Element>() -> &'static dyn Layers<E> {
        &Self(PhantomData)
    }
}

impl<E, H, L, const K: usize, const D: usize, const S: usize> Layers<E> for CompiledLayers<H, L, K, D, S>
where
    E: Element,
    H: Rules<K, D, S>,
    L: Rules<K, D, S>,
{
    fn channels(&self) -> usize {
        K
    }

    fn takes_values(&self) -> bool {
        const { takes_values::<E>(D, S) }
    }

    fn affine(&self, isa: Isa, layer: Affine<'_, E>) {
        dispatch(isa, AffineKernel::<E, H, K, D, S>(layer, PhantomData));
    }

    fn affine_adjoint(&self, isa: Isa, layer: AffineAdjoint<'_, E>) {
        dispatch(isa, AffineAdjointKernel::<E, H, K, D, S>(layer, PhantomData));
    }

    fn features(&self, isa: Isa, features: Features<'_, E>) {
        dispatch(isa, FeaturesKernel::<E, H, K, D, S>(features, PhantomData));
    }

    fn layer(&self, isa: Isa, layer: Layer<'_, E>, gate: Option<Gate<'_, E>>, last: bool) {
        match gate {
            Some(gate) if last => forward::<E, _, H, L, K, D, S>(isa, layer, gate),
            Some(gate) => forward::<E, _, H, H, K, D, S>(isa, layer, gate),
            None => forward::<E, _, H, H, K, D, S>(isa, layer, ()),
        }
    }

    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool) {
        match gate {
            Some(gate) if last => backward::<E, _, H, L, K, D, S>(isa, layer, gate),
            Some(gate) => backward::<E, _, H, H, K, D, S>(isa, layer, gate),
            None => backward::<E, _, H, H, K, D, S>(isa, layer, ()),
        }
    }

    fn gate(&self, isa: Isa, layer: Gated<'_, E>) {
        dispatch(isa, GateKernel::<E, H, K, D, S>(layer, PhantomData));
    }

    fn gate_adjoint(&self, isa: Isa, layer: GatedAdjoint<'_, E>) {
        dispatch(isa, GateAdjointKernel::<E, H, K, D, S>(layer, PhantomData));
    }
}

fn forward<E, G, C, P, const K: usize, const D: usize, const S: usize>(isa: Isa, layer: Layer<'_, E>, gate: G)
where
    E: Element,
    G: Ending<E>,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    dispatch(isa, LayerKernel::<E, G, C, P, K, D, S> { layer, gate, rules: PhantomData });
}

fn backward<E, G, C, P, const K: usize, const D: usize, const S: usize>(isa: Isa, layer: LayerAdjoint<'_, E>, gate: G)
where
    E: Element,
    G: EndingAdjoint<E>,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    dispatch(isa, LayerAdjointKernel::<E, G, C, P, K, D, S> { layer, gate, rules: PhantomData });
}

/// The programs of residuals `R`.
#[derive(Debug)]
pub struct CompiledPrograms<R>(PhantomData<fn() -> R>);

impl<R: Residuals> CompiledPrograms<R> {
    /// The programs without their type.
    pub fn erased<E: Element>() -> &'static dyn Programs<E> {
        &Self(PhantomData)
    }
}

impl<E: Element, R: Residuals> Programs<E> for CompiledPrograms<R> {
    fn residual(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]) {
        dispatch(isa, Program::<E, R, RESIDUAL> { points, out: rows, program: PhantomData });
    }

    fn adjoint(&self, isa: Isa, points: Points<'_, E>, bars: &mut [E]) {
        dispatch(isa, Program::<E, R, ADJOINT> { points, out: bars, program: PhantomData });
    }

    fn magnitude(&self, points: Points<'_, f64>, rows: &mut [f64]) {
        plain(Program::<f64, R, MAGNITUDE> { points, out: rows, program: PhantomData });
    }

    fn target(&self, scalars: &[f64], rows: &mut [f64]) {
        R::target(scalars, rows);
    }

    fn target_slopes(&self, scalars: &[f64], rows: &mut [f64]) {
        R::target_slopes(scalars, rows);
    }
}

const RESIDUAL: u8 = 0;
const ADJOINT: u8 = 1;
const MAGNITUDE: u8 = 2;

/// Runs one program of a group over a tile.
struct Program<'a, E, R, const PROGRAM: u8> {
    points: Points<'a, E>,
    out: &'a mut [E],
    program: PhantomData<R>,
}

impl<E: Element, R: Residuals, const PROGRAM: u8> Kernel<E> for Program<'_, E, R, PROGRAM> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        for first in (0..self.points.count).step_by(V::LANES) {
            let at = Lane::<V>::new(self.points, first);
            let mut out = Sink::new(&mut *self.out, self.points.stride, first);
            match PROGRAM {
                RESIDUAL => R::residual(&at, &mut out),
                ADJOINT => R::adjoint(&at, &mut out),
                _ => R::magnitude(&at, &mut out),
            }
        }
    }
}
