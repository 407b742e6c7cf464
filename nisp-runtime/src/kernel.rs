//! The contract between emitted code and the engine.
//!
//! The macro emits implementations of [`Rules`] (one per channel set) and [`Residuals`] (one per scene and group),
//! generic over the vector type. [`Compiled`] turns them into the object-safe [`GroupKernel`], whose methods work on a
//! whole tile of points, so that one engine serves every equation and the choice of instruction set costs one
//! branch per tile and layer.

use std::marker::PhantomData;

use crate::features::{Features, FeaturesKernel};
use crate::layer::{
    Affine, AffineAdjoint, AffineAdjointKernel, AffineKernel, Gate, GateAdjoint, Layer, LayerAdjoint,
    LayerAdjointKernel, LayerKernel,
};
use crate::real::Real;
use crate::residual::{Lane, Points, Sink};
use crate::schema;
use crate::simd::{Isa, Kernel, Simd, dispatch};

/// Propagation rules of one channel set: `K` channels, derivatives of the activation up to `D - 1`, `S` coordinates.
///
/// Channel 0 is the value. `phi[n]` is the n-th derivative of the activation at the value of its argument; forward
/// rules read up to `phi[D - 2]`, adjoints one more. Channels outside [`Rules::READ`] are not computed and their
/// entries have no meaning.
pub trait Rules<const K: usize, const D: usize, const S: usize>: Send + Sync + 'static {
    /// Channels that the rules deliver.
    const READ: [bool; K];
    /// Channels of `phi(a)`; `a[0]` is not used.
    fn compose<V: Simd>(phi: &[V; D], a: &[V; K]) -> [V; K];
    /// Adjoint of [`Rules::compose`]: the adjoint of `a`, the value's included.
    fn compose_adjoint<V: Simd>(phi: &[V; D], a: &[V; K], seed: &[V; K]) -> [V; K];
    /// Channels of `phi(w . x + b)`.
    fn affine<V: Simd>(phi: &[V; D], w: &[V; S]) -> [V; K];
    /// Adjoint of [`Rules::affine`]: of the value `w . x + b`, and of `w` by way of the derivative channels.
    fn affine_adjoint<V: Simd>(phi: &[V; D], w: &[V; S], seed: &[V; K]) -> (V, [V; S]);
    /// Channels of the product of two functions.
    fn product<V: Simd>(f: &[V; K], g: &[V; K]) -> [V; K];
    /// Adjoint of [`Rules::product`].
    fn product_adjoint<V: Simd>(f: &[V; K], g: &[V; K], seed: &[V; K]) -> ([V; K], [V; K]);
}

/// Residual program of one group of one scene, for as many points as a vector has lanes.
pub trait Residuals: Send + Sync + 'static {
    /// Writes the rows of all terms.
    fn residual<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>);
    /// Writes the adjoint of every jet, then of every learned scalar.
    fn adjoint<V: Simd>(at: &Lane<'_, V>, bars: &mut Sink<'_, V::Elem>);
    /// Writes the rows with every sum replaced by the sum of magnitudes.
    fn magnitude<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>);
    /// Targets of integral terms, from scalars alone; `rows` is indexed like the group's rows.
    fn target(scalars: &[f64], rows: &mut [f64]);
    /// Their derivatives by the learned scalars, `[row][learned scalar]`; rows of other terms are left alone.
    fn target_slopes(scalars: &[f64], rows: &mut [f64]);
}

/// Emitted code of one group, erased: each method works on a tile.
pub trait GroupKernel<E: Real>: Send + Sync {
    /// Number of channels of the hidden layers.
    fn channels(&self) -> usize;
    /// Channels that the heads read.
    fn read(&self) -> &'static [bool];
    /// Channels of `phi(W x + b)`, with `phi` and its slope kept for the adjoint.
    fn affine(&self, isa: Isa, layer: Affine<'_, E>);
    /// Adjoint of [`GroupKernel::affine`].
    fn affine_adjoint(&self, isa: Isa, layer: AffineAdjoint<'_, E>);
    /// Channels of fixed features of the coordinates.
    fn features(&self, isa: Isa, features: Features<'_, E>);
    /// A hidden layer after its matrix product; `last` delivers only the channels that heads read.
    fn layer(&self, isa: Isa, layer: Layer<'_, E>, gate: Option<Gate<'_, E>>, last: bool);
    /// Adjoint of [`GroupKernel::layer`].
    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool);
    /// The gate alone, after an affine layer.
    fn gate(&self, isa: Isa, layer: Layer<'_, E>, gate: Gate<'_, E>, last: bool);
    /// Adjoint of [`GroupKernel::gate`].
    fn gate_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: GateAdjoint<'_, E>, last: bool);
    /// Residual rows of a tile, `[row][point]`.
    fn residual(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]);
    /// Magnitude rows of a tile, `[row][point]`.
    fn magnitude(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]);
    /// Adjoints of jets, then of learned scalars, `[jet or scalar][point]`.
    fn adjoint(&self, isa: Isa, points: Points<'_, E>, bars: &mut [E]);
    /// Targets of integral terms.
    fn target(&self, scalars: &[f64], rows: &mut [f64]);
    /// Derivatives of the targets of integral terms by the learned scalars, `[row][learned scalar]`.
    fn target_slopes(&self, scalars: &[f64], rows: &mut [f64]);
}

/// A scene as emitted by the macro: its schema, and its groups' kernels in the schema's order.
pub trait Scene: Copy + Send + Sync + 'static {
    /// What the compiler knows of the scene.
    const SCHEMA: &'static schema::Scene;
    /// One kernel per group of the schema, then that of the outputs.
    fn kernels<E: Real>() -> Vec<Box<dyn GroupKernel<E>>>;
}

/// The erased form of a group: hidden rules `H`, rules of the last layer `L`, residuals `R`.
#[derive(Debug)]
#[expect(
    clippy::type_complexity,
    reason = "a function type that makes the marker Send and Sync whatever the rules are"
)]
pub struct Compiled<H, L, R, const K: usize, const D: usize, const S: usize>(PhantomData<fn() -> (H, L, R)>);

impl<H, L, R, const K: usize, const D: usize, const S: usize> Default for Compiled<H, L, R, K, D, S> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<E, H, L, R, const K: usize, const D: usize, const S: usize> GroupKernel<E> for Compiled<H, L, R, K, D, S>
where
    E: Real,
    H: Rules<K, D, S>,
    L: Rules<K, D, S>,
    R: Residuals,
{
    fn channels(&self) -> usize {
        K
    }

    fn read(&self) -> &'static [bool] {
        const { &L::READ }
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
        match (gate, last) {
            (Some(gate), false) => forward::<E, H, H, K, D, S, true, true>(isa, layer, gate),
            (Some(gate), true) => forward::<E, H, L, K, D, S, true, true>(isa, layer, gate),
            (None, false) => forward::<E, H, H, K, D, S, true, false>(isa, layer, Gate::none()),
            (None, true) => forward::<E, L, L, K, D, S, true, false>(isa, layer, Gate::none()),
        }
    }

    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool) {
        match (gate, last) {
            (Some(gate), false) => backward::<E, H, H, K, D, S, true, true>(isa, layer, gate),
            (Some(gate), true) => backward::<E, H, L, K, D, S, true, true>(isa, layer, gate),
            (None, false) => backward::<E, H, H, K, D, S, true, false>(isa, layer, GateAdjoint::none()),
            (None, true) => backward::<E, L, L, K, D, S, true, false>(isa, layer, GateAdjoint::none()),
        }
    }

    fn gate(&self, isa: Isa, layer: Layer<'_, E>, gate: Gate<'_, E>, last: bool) {
        if last {
            forward::<E, H, L, K, D, S, false, true>(isa, layer, gate);
        } else {
            forward::<E, H, H, K, D, S, false, true>(isa, layer, gate);
        }
    }

    fn gate_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: GateAdjoint<'_, E>, last: bool) {
        if last {
            backward::<E, H, L, K, D, S, false, true>(isa, layer, gate);
        } else {
            backward::<E, H, H, K, D, S, false, true>(isa, layer, gate);
        }
    }

    fn residual(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]) {
        dispatch(isa, ResidualKernel::<E, R, RESIDUAL> { points, out: rows, program: PhantomData });
    }

    fn magnitude(&self, isa: Isa, points: Points<'_, E>, rows: &mut [E]) {
        dispatch(isa, ResidualKernel::<E, R, MAGNITUDE> { points, out: rows, program: PhantomData });
    }

    fn adjoint(&self, isa: Isa, points: Points<'_, E>, bars: &mut [E]) {
        dispatch(isa, ResidualKernel::<E, R, ADJOINT> { points, out: bars, program: PhantomData });
    }

    fn target(&self, scalars: &[f64], rows: &mut [f64]) {
        R::target(scalars, rows);
    }

    fn target_slopes(&self, scalars: &[f64], rows: &mut [f64]) {
        R::target_slopes(scalars, rows);
    }
}

fn forward<E, C, P, const K: usize, const D: usize, const S: usize, const COMPOSE: bool, const GATE: bool>(
    isa: Isa,
    layer: Layer<'_, E>,
    gate: Gate<'_, E>,
) where
    E: Real,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    dispatch(isa, LayerKernel::<E, C, P, K, D, S, COMPOSE, GATE> { layer, gate, rules: PhantomData });
}

fn backward<E, C, P, const K: usize, const D: usize, const S: usize, const COMPOSE: bool, const GATE: bool>(
    isa: Isa,
    layer: LayerAdjoint<'_, E>,
    gate: GateAdjoint<'_, E>,
) where
    E: Real,
    C: Rules<K, D, S>,
    P: Rules<K, D, S>,
{
    dispatch(isa, LayerAdjointKernel::<E, C, P, K, D, S, COMPOSE, GATE> { layer, gate, rules: PhantomData });
}

const RESIDUAL: u8 = 0;
const MAGNITUDE: u8 = 1;
const ADJOINT: u8 = 2;

/// Runs one program of a group over a tile.
struct ResidualKernel<'a, E, R, const PROGRAM: u8> {
    points: Points<'a, E>,
    out: &'a mut [E],
    program: PhantomData<R>,
}

impl<E: Real, R: Residuals, const PROGRAM: u8> Kernel<E> for ResidualKernel<'_, E, R, PROGRAM> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        for first in (0..self.points.count).step_by(V::LANES) {
            let at = Lane::<V>::new(self.points, first);
            let mut out = Sink::new(&mut *self.out, self.points.stride, first);
            match PROGRAM {
                RESIDUAL => R::residual(&at, &mut out),
                MAGNITUDE => R::magnitude(&at, &mut out),
                _ => R::adjoint(&at, &mut out),
            }
        }
    }
}

/// A scene without its type: its schema, and its kernels in both precisions.
#[derive(Clone, Copy)]
pub struct SceneRef {
    /// What the compiler knows of the scene.
    pub schema: &'static schema::Scene,
    single: fn() -> Vec<Box<dyn GroupKernel<f32>>>,
    double: fn() -> Vec<Box<dyn GroupKernel<f64>>>,
}

/// A scene without its type.
pub fn scene<S: Scene>() -> SceneRef {
    SceneRef { schema: S::SCHEMA, single: S::kernels::<f32>, double: S::kernels::<f64> }
}

impl std::fmt::Debug for SceneRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}::{}", self.schema.module, self.schema.name)
    }
}

/// An element type in which scenes have kernels.
pub trait Precision: Real {
    /// The kernels of a scene in this precision.
    fn kernels(scene: &SceneRef) -> Vec<Box<dyn GroupKernel<Self>>>;
}

impl Precision for f32 {
    fn kernels(scene: &SceneRef) -> Vec<Box<dyn GroupKernel<f32>>> {
        (scene.single)()
    }
}

impl Precision for f64 {
    fn kernels(scene: &SceneRef) -> Vec<Box<dyn GroupKernel<f64>>> {
        (scene.double)()
    }
}
