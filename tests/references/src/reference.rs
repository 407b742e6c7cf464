//! The network and the loss in plain loops over dense jets: what the engine is compared with.

use nisp::engine::{Engine, Scaling};
use nisp::network::{Activation, Architecture, Fourier, Inputs, Kind, Layout, Matrix, Stretched, initialise};
use nisp::schema::{self, Loss, TermKind};
use nisp::simd::Isa;
use nisp::solve::objective::LeastSquares;
use nisp::{Points, Problem};

use crate::dense_jet::{Jet, Space};
use crate::number::Number;

/// A scene together with its equations written by hand.
pub trait Model {
    /// Highest derivative in the equations.
    const ORDER: usize;
    /// The scene, bound.
    fn problem(&self) -> Problem {
        self.groups().into_iter().fold(Problem::new(self.scene()), |mut problem, data| {
            let points = Points { coordinates: data.points, weights: data.weights, partners: data.partners };
            problem.set_group(data.name, points, data.columns).expect("a group of the scene");
            if !data.cloud.is_empty() {
                problem.set_cloud(data.name, "cloud", data.cloud).expect("a group of the scene");
            }
            problem
        })
    }
    /// The scene.
    fn scene(&self) -> nisp::SceneRef;
    /// Points and columns, in the scene's order of groups.
    fn groups(&self) -> Vec<Data>;
    /// Values of the learned scalars, given their parameters.
    fn learned<T: Number>(&self, _theta: &[T]) -> Vec<T> {
        Vec::new()
    }
    /// Coordinates that a head does not depend on: it is the network's output where they are in the middle.
    fn held(&self, _head: usize) -> &'static [usize] {
        &[]
    }
    /// Rows of a group at a point; heads come as series in the user's coordinates.
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T>;
    /// What the integral in this row should be.
    fn target<T: Number>(&self, _row: usize, _learned: &[T]) -> T {
        T::of(0.0)
    }
}

/// What is bound to a group.
#[derive(Clone, Debug, Default)]
pub struct Data {
    /// The group.
    pub name: &'static str,
    /// Coordinates of its points, flat.
    pub points: Vec<f64>,
    /// Its columns, point by point.
    pub columns: Vec<Vec<f64>>,
    /// Quadrature weights of its points; empty if it has none.
    pub weights: Vec<f64>,
    /// Coordinates of the points' partners, flat; empty if they have none.
    pub partners: Vec<f64>,
    /// Of the group's term `cloud`.
    pub cloud: Vec<f64>,
}

/// What equations read at a point.
pub struct Point<'a, 's, T> {
    /// Its coordinates.
    pub x: &'a [f64],
    /// Fields and sources, by head.
    pub heads: &'a [Jet<'s, T>],
    /// At the point's partner; empty if it has none.
    pub partner: &'a [Jet<'s, T>],
    /// What the columns say there.
    pub columns: &'a [f64],
    /// Learned scalars.
    pub learned: &'a [T],
}

impl<T: Number> Point<'_, '_, T> {
    /// A derivative of a head.
    pub fn d(&self, head: usize, orders: &[usize]) -> T {
        self.heads[head].derivative(orders)
    }
}

/// A model with a network of some shape.
pub struct Reference<'m, M> {
    /// Equations by hand.
    pub model: &'m M,
    /// The same as a bound problem.
    pub problem: Problem,
    /// Where weights and learned scalars are.
    pub layout: Layout,
    /// How coordinates and heads are scaled.
    pub scaling: Scaling,
    /// Natural size of each term's rows.
    pub sizes: Vec<f64>,
    /// The powers of the learned scalars that these go with, by term.
    powers: Vec<Vec<f64>>,
    space: Space,
}

impl<'m, M: Model> Reference<'m, M> {
    /// The model with a network of this shape.
    pub fn new(model: &'m M, architecture: Architecture) -> Self {
        let problem = model.problem();
        let engine = engine::<f64>(&problem, architecture);
        let scaling = problem.scaling(architecture.inputs).expect("a bound problem");
        Self {
            model,
            layout: engine.layout().clone(),
            sizes: engine.blocks().iter().map(|block| block.sigma).collect(),
            powers: powers(&problem, architecture),
            space: Space::new(scaling.half.len(), M::ORDER),
            scaling,
            problem,
        }
    }

    /// Ordinary weights with biases, and learned scalars away from their start.
    pub fn theta(&self, seed: u64) -> Vec<f64> {
        let mut theta = initialise(&self.layout, seed);
        let biases: Vec<usize> = self.layout.matrices().flat_map(|m| m.bias..m.bias + m.rows).collect();
        for at in biases.into_iter().chain(self.layout.learned.clone()) {
            theta[at] = 0.3 * (at as f64 * 0.7 + seed as f64).sin();
        }
        theta
    }

    /// Size of a term's rows where learned scalars are not at their start.
    pub fn size<T: Number>(&self, term: usize, theta: &[T]) -> T {
        let theta = &theta[self.layout.learned.clone()];
        let (values, starts) = (self.model.learned(theta), self.model.learned(&vec![0.0; theta.len()]));
        let pairs = values.into_iter().zip(starts).zip(&self.powers[term]);
        pairs.fold(T::of(self.sizes[term]), |size, ((value, start), &power)| {
            let ratio = value * T::of(1.0 / start);
            let grown = ratio.value().powf(power);
            size * ratio.chain(grown, power * grown / ratio.value())
        })
    }

    /// Series of all heads at a point, those of some coordinates only where the others are held.
    fn heads<'s, T: Number>(&'s self, theta: &[T], x: &[f64]) -> Vec<Jet<'s, T>> {
        let mut heads = self.outputs(theta, x);
        for (at, head) in heads.iter_mut().enumerate().filter(|(at, _)| !self.model.held(*at).is_empty()) {
            let mut place = x.to_vec();
            self.model.held(at).iter().for_each(|&i| place[i] = self.scaling.centre[i]);
            *head = self.outputs(theta, &place).swap_remove(at);
        }
        heads
    }

    /// Series of the network's outputs at a point, in the engine's units, which are the user's where units are off.
    fn outputs<'s, T: Number>(&'s self, theta: &[T], x: &[f64]) -> Vec<Jet<'s, T>> {
        let layout = &self.layout;
        let inputs: Vec<Jet<'s, T>> = x
            .iter()
            .zip(self.scaling.centre.iter().zip(&self.scaling.half))
            .enumerate()
            .map(|(i, (x, (centre, half)))| Jet::variable(&self.space, i, (x - centre) / half, 1.0 / half))
            .collect();
        let inputs = match layout.architecture.inputs {
            Inputs::Fourier(fourier) => turns(&fourier.projections(x.len()), &inputs),
            Inputs::Stretched(stretched) => logarithms(stretched.ratio, inputs),
            _ => inputs,
        };
        let layer =
            |m: &Matrix, input: &[Jet<'s, T>]| activate(layout.architecture.activation, affine(m, theta, input));
        let lifted: Vec<Vec<Jet<'s, T>>> = layout.affine.iter().map(|m| layer(m, &inputs)).collect();
        let gate = |z: Vec<Jet<'s, T>>| -> Vec<Jet<'s, T>> {
            match layout.architecture.kind {
                Kind::Plain => z,
                Kind::Modified => z
                    .into_iter()
                    .zip(lifted[1].iter().zip(&lifted[2]))
                    .map(|(z, (c, d))| c.clone() * z.clone() + d.clone() * (-z).shift(T::of(1.0)))
                    .collect(),
            }
        };
        let first = gate(lifted[0].clone());
        let last = layout.hidden.iter().fold(first, |z, m| gate(layer(m, &z)));
        let heads = affine(&layout.head, theta, &last).into_iter();
        heads
            .zip(self.scaling.scale.iter().zip(&self.scaling.offset))
            .map(|(y, (&scale, &offset))| y.scale(T::of(scale)).shift(T::of(offset)))
            .collect()
    }

    /// Rows of a group before any weighting, `[point][row]`.
    pub fn rows<T: Number>(&self, theta: &[T], data: &Data) -> Vec<Vec<T>> {
        let learned = self.model.learned(&theta[self.layout.learned.clone()]);
        let at = |(p, x): (usize, &[f64])| {
            let columns: Vec<f64> = data.columns.iter().map(|column| column[p]).collect();
            let heads = self.heads(theta, x);
            let partner = data.partners.chunks_exact(x.len()).nth(p).map_or_else(Vec::new, |x| self.heads(theta, x));
            let at = Point { x, heads: &heads, partner: &partner, columns: &columns, learned: &learned };
            self.model.rows(data.name, &at)
        };
        data.points.chunks_exact(self.scaling.half.len()).enumerate().map(at).collect()
    }

    /// The loss by definition.
    pub fn loss<T: Number>(&self, theta: &[T]) -> T {
        let learned = self.model.learned(&theta[self.layout.learned.clone()]);
        let mut sizes = (0..self.sizes.len()).map(|term| self.size(term, theta));
        let mut loss = T::of(0.0);
        for (data, group) in self.model.groups().iter().zip(self.problem.scene().schema.groups) {
            let rows = self.rows(theta, data);
            for (term, size) in group.terms.iter().zip(&mut sizes) {
                let each = term.first..term.first + term.rows;
                let mut misfits: Vec<T> = Vec::new();
                if let TermKind::Chamfer { symmetric, .. } = term.kind {
                    let surface: Vec<&[T]> = rows.iter().map(|r| &r[each.clone()]).collect();
                    loss = loss + T::of(term.weight) * chamfer(&surface, &data.cloud, symmetric, term, size.value());
                    continue;
                }
                if term.kind == TermKind::Integral {
                    misfits.extend(each.map(|row| {
                        let weight = |p: usize| T::of(data.weights.get(p).copied().unwrap_or(1.0));
                        let sum = rows.iter().enumerate().fold(T::of(0.0), |sum, (p, r)| sum + weight(p) * r[row]);
                        sum - self.model.target(row, &learned)
                    }));
                } else {
                    misfits.extend(rows.iter().flat_map(|r| each.clone().map(|row| r[row])));
                }
                let count = if term.kind == TermKind::Integral { 1 } else { rows.len() };
                let weight = T::of(term.weight / count as f64);
                loss = misfits.iter().fold(loss, |loss, &r| loss + weight * cost(term, r / size));
            }
        }
        loss
    }
}

/// How sizes go with learned scalars, from those of problems that start elsewhere; robust losses and data have sizes that stay.
fn powers(problem: &Problem, architecture: Architecture) -> Vec<Vec<f64>> {
    const STEP: f64 = 1e-4;
    let schema = problem.scene().schema;
    let learned: Vec<(&str, f64)> = schema
        .scalars
        .iter()
        .filter_map(|scalar| match scalar.origin {
            schema::Origin::Learned { start, .. } => {
                Some((scalar.name, scalar.unit.factor.back(start.expect("a start")).as_declared()))
            }
            _ => None,
        })
        .collect();
    let sizes = |name: &str, value: f64| -> Vec<f64> {
        let mut moved = problem.clone();
        moved.set_parameter(name, value).expect("a parameter");
        engine::<f64>(&moved, architecture).blocks().iter().map(|block| block.sigma).collect()
    };
    let power = |(above, below): (f64, f64)| (above / below).ln() / (2.0 * STEP.atanh());
    let by_scalar: Vec<Vec<f64>> = learned
        .iter()
        .map(|&(name, start)| {
            let pairs = sizes(name, start * (1.0 + STEP)).into_iter().zip(sizes(name, start * (1.0 - STEP)));
            pairs.map(power).collect()
        })
        .collect();
    let terms = schema.groups.iter().flat_map(|group| group.terms).enumerate();
    terms
        .map(|(at, term)| {
            let equation = matches!(term.kind, TermKind::Residual | TermKind::Integral) && term.loss == Loss::Square;
            let follows = equation && by_scalar.iter().any(|powers| powers[at].abs() > 1e-6);
            by_scalar.iter().map(|powers| if follows { powers[at] } else { 0.0 }).collect()
        })
        .collect()
}

/// Mean cost of the distances from a cloud to a surface, and from the surface to the cloud.
fn chamfer<T: Number>(surface: &[&[T]], cloud: &[f64], symmetric: bool, term: &schema::Term, size: f64) -> T {
    let cloud: Vec<&[f64]> = cloud.chunks_exact(term.rows).collect();
    let square = |x: &[T], y: &[f64]| {
        x.iter().zip(y).map(|(&x, &y)| (x - T::of(y)) * (x - T::of(y))).reduce(|a, b| a + b).expect("dimensions")
    };
    let nearest = |squares: &mut dyn Iterator<Item = T>| -> T {
        squares.min_by(|a, b| a.value().total_cmp(&b.value())).expect("points")
    };
    let mean = |squares: Vec<T>| -> T {
        let share = T::of(1.0 / squares.len() as f64);
        let cost = |square: T| cost(term, square.sqrt() * T::of(1.0 / size));
        squares.into_iter().fold(T::of(0.0), |sum, square| sum + share * cost(square))
    };
    let there = mean(cloud.iter().map(|y| nearest(&mut surface.iter().map(|x| square(x, y)))).collect());
    let back = |x: &[T]| nearest(&mut cloud.iter().map(|y| square(x, y)));
    if symmetric { there + mean(surface.iter().map(|x| back(x)).collect()) } else { there }
}

/// What a misfit costs.
fn cost<T: Number>(term: &schema::Term, u: T) -> T {
    match term.loss {
        Loss::Huber(delta) if u.value().abs() > delta => {
            let sign = T::of(u.value().signum());
            T::of(delta) * (sign * u - T::of(delta / 2.0))
        }
        Loss::Welsch(delta) => {
            let x = u * T::of(1.0 / delta);
            T::of(delta * delta) * (T::of(1.0) - (-(x * x) * T::of(0.5)).exp())
        }
        Loss::Tukey(delta) if u.value().abs() > delta => T::of(delta * delta / 6.0),
        Loss::Tukey(delta) => {
            let x = u * T::of(1.0 / delta);
            let rest = T::of(1.0) - x * x;
            T::of(delta * delta / 6.0) * (T::of(1.0) - rest * rest * rest)
        }
        _ => u * u * T::of(0.5),
    }
}

fn affine<'s, T: Number>(m: &Matrix, theta: &[T], input: &[Jet<'s, T>]) -> Vec<Jet<'s, T>> {
    let row = |i: usize| {
        let scale = m.scales.map_or(T::of(1.0), |at| theta[at + i].exp());
        let products =
            input.iter().enumerate().map(|(j, x)| x.clone().scale(scale * theta[m.weights + i * m.columns + j]));
        products.reduce(|a, b| a + b).expect("a layer has inputs").shift(theta[m.bias + i])
    };
    (0..m.rows).map(row).collect()
}

/// Cosines, then sines, of the projections of the coordinates.
fn turns<'s, T: Number>(projections: &[f64], inputs: &[Jet<'s, T>]) -> Vec<Jet<'s, T>> {
    let angles = projections.chunks_exact(inputs.len()).map(|b| {
        let products = inputs.iter().zip(b).map(|(x, &b)| x.clone().scale(T::of(b)));
        products.reduce(|a, b| a + b).expect("a coordinate")
    });
    let (sines, cosines): (Vec<_>, Vec<_>) = angles.map(|angle| angle.sin_cos()).unzip();
    cosines.into_iter().chain(sines).collect()
}

/// The coordinates, and `ln(1 + ratio (x + 1) / 2)` of each, brought to [-1, 1].
fn logarithms<'s, T: Number>(ratio: f64, inputs: Vec<Jet<'s, T>>) -> Vec<Jet<'s, T>> {
    let of = |x: &Jet<'s, T>| x.clone().scale(T::of(ratio / 2.0)).shift(T::of(1.0 + ratio / 2.0)).ln();
    let ends = (1.0 + ratio).ln();
    let stretched: Vec<_> = inputs.iter().map(|x| of(x).scale(T::of(2.0 / ends)).shift(T::of(-1.0))).collect();
    inputs.into_iter().chain(stretched).collect()
}

fn activate<'s, T: Number>(activation: Activation, arguments: Vec<Jet<'s, T>>) -> Vec<Jet<'s, T>> {
    let of = |argument: &Jet<'s, T>| match activation {
        Activation::Tanh => argument.tanh(),
        Activation::Sine => argument.sin_cos().0,
    };
    arguments.iter().map(of).collect()
}

/// The engine of a problem, on this machine's best vectors.
pub fn engine<E: nisp::Precision>(problem: &Problem, architecture: Architecture) -> Engine<E> {
    problem.engine(Isa::detect(), architecture).expect("a bound problem")
}

/// Shapes of networks that are tried: every depth, both kinds, plain and factorised weights, all inputs, widths that
/// need padding; and for some of them sine beside tanh.
pub fn architectures() -> Vec<Architecture> {
    (1..=5)
        .flat_map(|layers| {
            let width = 9 + layers;
            [Architecture::modified(width, layers), Architecture::plain(width, layers)]
        })
        .enumerate()
        .map(|(at, architecture)| Architecture {
            factorised: at % 3 == 1,
            inputs: match at % 4 {
                2 => Inputs::Fourier(Fourier { frequencies: 5, deviation: 1.0 }),
                3 => Inputs::Stretched(Stretched { ratio: 20.0 }),
                _ => Inputs::Coordinates,
            },
            ..architecture
        })
        .enumerate()
        .flat_map(|(at, tanh)| {
            let sine = Architecture { activation: Activation::Sine, ..tanh };
            std::iter::once(tanh).chain(matches!(at, 1 | 4 | 6 | 9).then_some(sine))
        })
        .collect()
}
