//! Five operators: as `pde!` scenes, and as scenes of the dense jet that read the same derivatives.

use nisp::__private::{CompiledLayers, CompiledPrograms, GroupKernel, Lane, Residuals, Simd, Sink, schema, units};
use nisp::{Precision, Problem, Scene, scene};

use crate::dense::{Dense, channel};
use crate::support::{group, scatter};

nisp::pde! {
    pub mod second {
        units: off;
        coordinates: x;
        fields: u;
        on inside { balance: d(u, x, 2) == 1; }
        on rim { held: u == 0, d(u, x) == 0; }
        scene generated { }
    }
}

nisp::pde! {
    pub mod laplacian {
        units: off;
        coordinates: x, y;
        fields: u;
        on inside { balance: laplacian(u) == 1; }
        on rim { held: u == 0; }
        scene generated { }
    }
}

nisp::pde! {
    pub mod karman {
        units: off;
        coordinates: x, y;
        fields: w;
        on inside {
            balance: biharmonic(w) + d(w, x) * d(w, y) + d(w, x, 2) * d(w, y, 2) - d(w, x, y)^2 == 1;
        }
        on rim { held: w == 0, d(w, x) == 0; }
        scene generated { }
    }
}

nisp::pde! {
    pub mod elasticity {
        units: off;
        coordinates: x, y, z;
        fields: u: vector;
        parameters: lambda = 1.3, mu = 0.7;
        on inside { balance: mu * laplacian(u) + (lambda + mu) * grad(div(u)) == [0, 0, 1]; }
        on rim { held: u == 0; }
        scene generated { }
    }
}

nisp::pde! {
    pub mod triharmonic {
        units: off;
        coordinates: x, y;
        fields: w;
        on inside { balance: laplacian(laplacian(laplacian(w))) == 1; }
        on rim { held: w == 0, d(w, x) == 0, laplacian(w) == 0; }
        scene generated { }
    }
}

/// The sum of all jets: the residual program hardly counts beside the network.
struct Sum<const JETS: usize>;

impl<const JETS: usize> Residuals for Sum<JETS> {
    #[inline(always)]
    fn residual<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>) {
        rows.put::<V>(0, (0..JETS).fold(V::lit(-1.0), |sum, jet| sum.add(at.jet(jet))));
    }
    #[inline(always)]
    fn adjoint<V: Simd>(at: &Lane<'_, V>, bars: &mut Sink<'_, V::Elem>) {
        (0..JETS).for_each(|jet| bars.put::<V>(jet, at.seed(0)));
    }
    #[inline(always)]
    fn magnitude<V: Simd>(at: &Lane<'_, V>, rows: &mut Sink<'_, V::Elem>) {
        rows.put::<V>(0, (0..JETS).fold(V::lit(1.0), |sum, jet| sum.add(at.jet(jet).abs())));
    }
    fn target(_: &[f64], _: &mut [f64]) {}
    fn target_slopes(_: &[f64], _: &mut [f64]) {}
}

const NO_UNIT: schema::Unit = schema::Unit { exponents: [0.0; 7], factor: units::Scale::new(1.0), text: "" };

/// Whatever a schema holds beside channels, jets and coordinates is that of the simplest emitted scene.
const SIMPLEST: schema::Scene = *<second::generated::Scene as Scene>::SCHEMA;

/// A scene of one group whose residual is the sum of the jets listed: `head: degree, [monomial: coefficient, ..];`
macro_rules! dense_scene {
    ($name:ident, $channels:literal channels, order $order:literal, $coordinates:literal coordinates, $heads:literal heads,
     $jets:literal jets: $($head:literal: $degree:tt, [$($monomial:tt: $coefficient:literal),*];)*) => {
        #[derive(Clone, Copy)]
        pub(crate) struct $name;

        impl Scene for $name {
            const TEXT: &'static str = "";
            const SCHEMA: &'static schema::Scene = &schema::Scene {
                module: "dense",
                name: stringify!($name),
                coordinates: &[schema::Coordinate { name: "x", unit: NO_UNIT, scale_group: 0 }; $coordinates],
                heads: &[SIMPLEST.heads[0]; $heads],
                groups: &[schema::Group {
                    channels: &[""; $channels],
                    order: $order,
                    dense: $channels,
                    jets: &[$(schema::Jet {
                        head: $head,
                        name: "",
                        degree: &$degree,
                        combination: &[$(
                            (channel::<$channels, $coordinates>($order, $monomial), $coefficient)
                        ),*],
                        operator: &[],
                        site: 0,
                    }),*],
                    ..SIMPLEST.groups[0]
                }],
                ..SIMPLEST
            };
            fn kernels<E: Precision>() -> Vec<GroupKernel<E>> {
                type Rules = Dense<$channels, { $order + 2 }, $coordinates>;
                vec![GroupKernel {
                    layers: CompiledLayers::<Rules, Rules, $channels, { $order + 2 }, $coordinates>::erased(),
                    programs: CompiledPrograms::<Sum<$jets>>::erased(),
                }]
            }
        }
    };
}

// Coefficients are those of Taylor coefficients: the operator's times the monomial's factorials.
dense_scene!(DenseSecond, 3 channels, order 2, 1 coordinates, 1 heads, 1 jets: 0: [2], [[2]: 2.0];);
dense_scene!(DenseLaplacian, 6 channels, order 2, 2 coordinates, 1 heads, 1 jets:
    0: [2, 0], [[2, 0]: 2.0, [0, 2]: 2.0];
);
dense_scene!(DenseKarman, 15 channels, order 4, 2 coordinates, 1 heads, 6 jets:
    0: [1, 0], [[1, 0]: 1.0];
    0: [0, 1], [[0, 1]: 1.0];
    0: [2, 0], [[2, 0]: 2.0];
    0: [1, 1], [[1, 1]: 1.0];
    0: [0, 2], [[0, 2]: 2.0];
    0: [4, 0], [[4, 0]: 24.0, [2, 2]: 8.0, [0, 4]: 24.0];
);
dense_scene!(DenseElasticity, 10 channels, order 2, 3 coordinates, 3 heads, 12 jets:
    0: [2, 0, 0], [[2, 0, 0]: 2.0, [0, 2, 0]: 2.0, [0, 0, 2]: 2.0];
    0: [2, 0, 0], [[2, 0, 0]: 2.0];
    0: [1, 1, 0], [[1, 1, 0]: 1.0];
    0: [1, 0, 1], [[1, 0, 1]: 1.0];
    1: [2, 0, 0], [[2, 0, 0]: 2.0, [0, 2, 0]: 2.0, [0, 0, 2]: 2.0];
    1: [1, 1, 0], [[1, 1, 0]: 1.0];
    1: [0, 2, 0], [[0, 2, 0]: 2.0];
    1: [0, 1, 1], [[0, 1, 1]: 1.0];
    2: [2, 0, 0], [[2, 0, 0]: 2.0, [0, 2, 0]: 2.0, [0, 0, 2]: 2.0];
    2: [1, 0, 1], [[1, 0, 1]: 1.0];
    2: [0, 1, 1], [[0, 1, 1]: 1.0];
    2: [0, 0, 2], [[0, 0, 2]: 2.0];
);
dense_scene!(DenseTriharmonic, 28 channels, order 6, 2 coordinates, 1 heads, 1 jets:
    0: [6, 0], [[6, 0]: 720.0, [4, 2]: 144.0, [2, 4]: 144.0, [0, 6]: 720.0];
);

/// An operator in both forms.
pub(crate) struct Operator {
    pub(crate) name: &'static str,
    pub(crate) coordinates: usize,
    pub(crate) generated: Problem,
    pub(crate) dense: Problem,
    /// Forward passes of nested duals, each by the variables of its second derivatives, outermost first.
    pub(crate) passes: &'static [&'static [[usize; 2]]],
}

fn problem<G: Scene, D: Scene>(coordinates: usize, points: usize) -> [Problem; 2] {
    let extents = vec![2.0; coordinates];
    let (mut generated, mut dense) = (Problem::new(scene::<G>()), Problem::new(scene::<D>()));
    group(&mut generated, "inside", scatter(points, &extents), vec![]);
    group(&mut generated, "rim", scatter(1, &extents), vec![]);
    group(&mut dense, "inside", scatter(points, &extents), vec![]);
    [generated, dense]
}

/// All operators, with `points` points.
pub(crate) fn operators(points: usize) -> Vec<Operator> {
    let operator = |name, coordinates, [generated, dense]: [Problem; 2], passes| Operator {
        name,
        coordinates,
        generated,
        dense,
        passes,
    };
    vec![
        operator("1-D, order 2", 1, problem::<second::generated::Scene, DenseSecond>(1, points), &[&[[0, 0]]]),
        operator(
            "2-D Laplacian",
            2,
            problem::<laplacian::generated::Scene, DenseLaplacian>(2, points),
            &[&[[0, 0]], &[[1, 1]]],
        ),
        operator(
            "von Karman's w",
            2,
            problem::<karman::generated::Scene, DenseKarman>(2, points),
            &[&[[0, 0], [0, 0]], &[[0, 0], [1, 1]], &[[1, 1], [1, 1]], &[[0, 1]]],
        ),
        operator(
            "3-D elasticity",
            3,
            problem::<elasticity::generated::Scene, DenseElasticity>(3, points),
            &[&[[0, 0]], &[[1, 1]], &[[2, 2]], &[[0, 1]], &[[0, 2]], &[[1, 2]]],
        ),
        operator(
            "2-D triharmonic",
            2,
            problem::<triharmonic::generated::Scene, DenseTriharmonic>(2, points),
            &[
                &[[0, 0], [0, 0], [0, 0]],
                &[[0, 0], [0, 0], [1, 1]],
                &[[0, 0], [1, 1], [1, 1]],
                &[[1, 1], [1, 1], [1, 1]],
            ],
        ),
    ]
}
