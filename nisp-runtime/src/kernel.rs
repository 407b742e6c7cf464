//! What a scene consists of: a schema, and the kernels of its groups, compiled or interpreted.
//!
//! The macro emits implementations of [`Rules`](crate::rules::Rules) (one per channel set) and
//! [`Residuals`](crate::residual::Residuals) (one per scene and group), generic over the vector type. The module
//! [`compiled`](crate::compiled) turns them into the object-safe [`Layers`] and [`Programs`], whose methods work on a whole
//! tile of points, so that one engine serves every equation and the choice of instruction set costs one branch per tile and
//! layer.

use std::marker::PhantomData;

use crate::layer::Layers;
use crate::real::Real;
use crate::residual::Programs;
use crate::schema;
use crate::values::Precompiled;

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
    fn kernels<E: Precision>() -> Vec<GroupKernel<E>>;
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
pub trait Precision: Precompiled {
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
