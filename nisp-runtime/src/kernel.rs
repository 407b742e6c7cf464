//! The contract between emitted code and the engine.
//!
//! The macro emits implementations of [`Rules`] (one per channel set) and [`Residuals`] (one per scene and group),
//! generic over the vector type. The module [`compiled`](crate::compiled) turns them into the object-safe [`Layers`] and
//! [`Programs`], whose methods work on a whole tile of points, so that one engine serves every equation and the choice of
//! instruction set costs one branch per tile and layer.

use std::marker::PhantomData;

use crate::features::Features;
use crate::layer::{Affine, AffineAdjoint, Gate, GateAdjoint, Gated, GatedAdjoint, Layer, LayerAdjoint};
use crate::real::Real;
use crate::residual::{Lane, Points, Sink};
use crate::schema;
use crate::simd::{Isa, Simd};

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
    /// Writes the rows with every sum replaced by the sum of magnitudes; run once, when a scene is bound.
    fn magnitude<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>);
    /// Targets of integral terms, from scalars alone; `rows` is indexed like the group's rows.
    fn target(scalars: &[f64], rows: &mut [f64]);
    /// Their derivatives by the learned scalars, `[row][learned scalar]`; rows of other terms are left alone.
    fn target_slopes(scalars: &[f64], rows: &mut [f64]);
}

/// The rules of a group's hidden layers, erased: each method works on a tile.
pub trait Layers<E: Real>: Send + Sync {
    /// Number of channels of the hidden layers.
    fn channels(&self) -> usize;
    /// True if activations and their slopes are given instead of computed, for they are needed in a higher precision: whoever
    /// calls [`Layers::affine`] or [`Layers::layer`] has written them to where they are kept.
    fn takes_values(&self) -> bool;
    /// Channels of `phi(W x + b)`, with `phi` and its slope kept for the adjoint.
    fn affine(&self, isa: Isa, layer: Affine<'_, E>);
    /// Adjoint of [`Layers::affine`].
    fn affine_adjoint(&self, isa: Isa, layer: AffineAdjoint<'_, E>);
    /// Channels of fixed features of the coordinates.
    fn features(&self, isa: Isa, features: Features<'_, E>);
    /// A hidden layer after its matrix product; `last` delivers only the channels that heads read, if there is a gate.
    fn layer(&self, isa: Isa, layer: Layer<'_, E>, gate: Option<Gate<'_, E>>, last: bool);
    /// Adjoint of [`Layers::layer`]. Without a gate it reads the seeds of all channels.
    fn layer_adjoint(&self, isa: Isa, layer: LayerAdjoint<'_, E>, gate: Option<GateAdjoint<'_, E>>, last: bool);
    /// The gate alone, after an affine layer.
    fn gate(&self, isa: Isa, layer: Gated<'_, E>);
    /// Adjoint of [`Layers::gate`].
    fn gate_adjoint(&self, isa: Isa, layer: GatedAdjoint<'_, E>);
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

/// Emitted code of one group.
#[derive(Clone, Copy)]
pub struct GroupKernel<E: Real> {
    /// From coordinates to the last hidden layer, and back.
    pub layers: &'static dyn Layers<E>,
    /// From the heads' values and derivatives to rows, and back.
    pub programs: &'static dyn Programs<E>,
}

/// A scene as emitted by the macro: its schema, and its groups' kernels in the schema's order.
pub trait Scene: Copy + Send + Sync + 'static {
    /// What the compiler knows of the scene.
    const SCHEMA: &'static schema::Scene;
    /// The text of the whole equation, as the compiler reads it.
    const TEXT: &'static str;
    /// One kernel per group of the schema, then that of the outputs.
    fn kernels<E: Real>() -> Vec<GroupKernel<E>>;
}

/// Where a scene's kernels come from: compiled in a user's crate, or interpreted.
pub trait Kernels: Send + Sync {
    /// One kernel per group of the schema, then that of the outputs, in double precision.
    fn double(&self) -> Vec<GroupKernel<f64>>;
    /// The same in single precision, if the scene has it.
    fn single(&self) -> Option<Vec<GroupKernel<f32>>>;
}

/// A scene without its type: its schema and its kernels.
#[derive(Clone, Copy)]
pub struct SceneRef {
    /// What the compiler knows of the scene.
    pub schema: &'static schema::Scene,
    /// The text of the whole equation, as the compiler reads it.
    pub text: &'static str,
    kernels: &'static dyn Kernels,
}

/// The kernels of a compiled scene in double precision.
struct Double<S>(PhantomData<fn() -> S>);

/// The kernels of a compiled scene in both precisions.
struct Both<S>(PhantomData<fn() -> S>);

impl<S: Scene> Kernels for Double<S> {
    fn double(&self) -> Vec<GroupKernel<f64>> {
        S::kernels()
    }

    fn single(&self) -> Option<Vec<GroupKernel<f32>>> {
        None
    }
}

impl<S: Scene> Kernels for Both<S> {
    fn double(&self) -> Vec<GroupKernel<f64>> {
        S::kernels()
    }

    fn single(&self) -> Option<Vec<GroupKernel<f32>>> {
        Some(S::kernels())
    }
}

/// A scene without its type, in double precision.
pub fn scene<S: Scene>() -> SceneRef {
    SceneRef::new(S::SCHEMA, S::TEXT, &Double::<S>(PhantomData))
}

/// A scene without its type, in single precision too: twice the code of [`scene`] to compile.
pub fn scene_in_both_precisions<S: Scene>() -> SceneRef {
    SceneRef::new(S::SCHEMA, S::TEXT, &Both::<S>(PhantomData))
}

impl SceneRef {
    /// A scene of a schema, the equation's text, and kernels in the schema's order.
    pub fn new(schema: &'static schema::Scene, text: &'static str, kernels: &'static dyn Kernels) -> Self {
        Self { schema, text, kernels }
    }

    /// True if it has kernels in single precision too.
    pub(crate) fn has_single(&self) -> bool {
        self.kernels.single().is_some()
    }

    /// The kernels in double precision.
    pub(crate) fn double(&self) -> Vec<GroupKernel<f64>> {
        self.kernels.double()
    }
}

impl std::fmt::Debug for SceneRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}::{}", self.schema.module, self.schema.name)
    }
}

/// An element type in which scenes may have kernels.
pub trait Precision: Real {
    /// The kernels of a scene in this precision, if it has been compiled in it.
    fn kernels(scene: &SceneRef) -> Option<Vec<GroupKernel<Self>>>;
}

impl Precision for f32 {
    fn kernels(scene: &SceneRef) -> Option<Vec<GroupKernel<f32>>> {
        scene.kernels.single()
    }
}

impl Precision for f64 {
    fn kernels(scene: &SceneRef) -> Option<Vec<GroupKernel<f64>>> {
        Some(scene.double())
    }
}
