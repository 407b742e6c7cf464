//! The layers of a group behind the engine's seam: each method enters its kernel.

use nisp_runtime::layer::{
    Affine, AffineAdjoint, Features, Gate, GateAdjoint, Gated, GatedAdjoint, Layer, LayerAdjoint, Layers,
};
use nisp_runtime::simd::{Element, Isa, dispatch};

use crate::affine::{AffineAdjointKernel, AffineKernel, FeaturesKernel};
use crate::hidden::{GateAdjointKernel, GateKernel, LayerAdjointKernel, LayerKernel};
use crate::rules::InterpretedLayers;

impl<E: Element> Layers<E> for InterpretedLayers {
    fn channels(&self) -> usize {
        self.channels
    }

    fn takes_values(&self) -> bool {
        self.slopes.are_given::<E>(self.coordinates)
    }

    fn affine(&self, isa: Isa, layer: Affine<'_, E>) {
        dispatch(isa, AffineKernel { isa, layers: self, layer });
    }

    fn affine_adjoint(&self, isa: Isa, layer: AffineAdjoint<'_, E>) {
        dispatch(isa, AffineAdjointKernel { isa, layers: self, layer });
    }

    fn features(&self, isa: Isa, features: Features<'_, E>) {
        dispatch(isa, FeaturesKernel { isa, layers: self, features });
    }

    fn layer(&self, isa: Isa, layer: Layer<'_, E>, gate: Option<Gate<'_, E>>, last: bool) {
        dispatch(isa, LayerKernel { isa, layers: self, layer, gate, last });
    }

    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool) {
        dispatch(isa, LayerAdjointKernel { isa, layers: self, layer, gate, last });
    }

    fn gate(&self, isa: Isa, layer: Gated<'_, E>) {
        dispatch(isa, GateKernel { isa, layers: self, layer });
    }

    fn gate_adjoint(&self, isa: Isa, layer: GatedAdjoint<'_, E>) {
        dispatch(isa, GateAdjointKernel { isa, layers: self, layer });
    }
}
