//! Derivatives of every order through networks of every size, against dense series of twice the precision and against
//! derivatives along a few lines, of which sums over evenly turned directions make isotropic operators.

use std::f64::consts::PI;

use nisp::Precision;
use nisp::network::Architecture;
use nisp::scene_in_both_precisions as scene;

use crate::double_double::Dd;
use crate::line;
use crate::row::{Extent, Row};
use nisp_references::number::Number;
use nisp_references::reference::{Data, Model, Point, Reference, engine};

nisp::pde! {
    mod ladder {
        units: off;
        coordinates: x, y;
        fields: u;
        on one { slope: d(u, x) == 0, d(u, y) == 0; }
        on two { mixed: d(u, x, y) == 0; bent: laplacian(u) == 0; }
        on three { twist: d(laplacian(u), x) == 0; }
        on four { plate: biharmonic(u) == 0; beam: d(u, x, 4) == 0; }
        on five { odd: d(biharmonic(u), y) == 0; }
        on six { sixth: laplacian(biharmonic(u)) == 0; }
        scene all { }
    }
}

const GROUPS: [&str; 6] = ["one", "two", "three", "four", "five", "six"];

/// An operator of each order from 1 to 6, in groups of their own so that each has its own smallest set of channels.
struct Ladder {
    points: Vec<f64>,
}

impl Ladder {
    fn new(count: usize) -> Self {
        // Multiples of the golden ratio of the plane.
        let place = |n: usize, step: f64| 2.0 * (n as f64 * step).fract() - 1.0;
        let points = (1..=count).flat_map(|n| [place(n, 0.754_877_666_246_692_7), place(n, 0.569_840_290_998_053_3)]);
        Self { points: points.collect() }
    }
}

impl Model for Ladder {
    const ORDER: usize = 6;
    fn scene(&self) -> nisp::SceneRef {
        scene::<ladder::all::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        GROUPS.map(|name| Data { name, points: self.points.clone(), ..Data::default() }).into()
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let u = &at.heads[0];
        match group {
            "one" => vec![at.d(0, &[1, 0]), at.d(0, &[0, 1])],
            "two" => vec![at.d(0, &[1, 1]), u.laplacian(2).value()],
            "three" => vec![u.laplacian(2).by(0).value()],
            "four" => vec![u.laplacian(2).laplacian(2).value(), at.d(0, &[4, 0])],
            "five" => vec![u.laplacian(2).laplacian(2).by(1).value()],
            _ => vec![u.laplacian(2).laplacian(2).laplacian(2).value()],
        }
    }
}

/// Weights of a reference, times a factor, and representable in `E`.
fn weights<E: Precision>(reference: &Reference<'_, Ladder>, factor: f64) -> Vec<f64> {
    let mut theta = reference.theta(3);
    for m in reference.layout.matrices() {
        theta[m.weights..m.weights + m.rows * m.columns].iter_mut().for_each(|w| *w *= factor);
    }
    theta.iter().map(|&x| E::from_f64(x).to_f64()).collect()
}

/// The largest difference of rows `[row][point]` from what is expected, over the largest value of its row.
fn difference(expected: &[Vec<Dd>], found: &[f64]) -> f64 {
    let count = expected.len();
    let row_error = |row: usize| {
        let largest = expected.iter().map(|rows| rows[row].abs().hi).fold(0.0, f64::max);
        let error = |(p, rows): (usize, &Vec<Dd>)| (Dd::from(found[row * count + p]) - rows[row]).abs().hi;
        expected.iter().enumerate().map(error).fold(0.0, f64::max) / largest
    };
    (0..expected[0].len()).map(row_error).fold(0.0, f64::max)
}

/// By order, the largest error of rows in `E`, and how much rounding the weights to `E` changes them.
fn errors<E: Precision>(architecture: Architecture, factor: f64, count: usize) -> [[f64; 2]; 6] {
    let model = Ladder::new(count);
    let reference = Reference::new(&model, architecture);
    let theta = weights::<E>(&reference, factor);
    let wide: Vec<Dd> = theta.iter().map(|&x| x.into()).collect();
    let narrow: Vec<E> = theta.iter().map(|&x| E::from_f64(x)).collect();
    let mut engine = engine::<E>(&reference.problem, architecture);
    let mut double = nisp_references::reference::engine::<f64>(&reference.problem, architecture);
    let unrounded = weights::<f64>(&reference, factor);
    let groups = model.groups();
    std::array::from_fn(|order| {
        let expected = reference.rows(&wide, &groups[order]);
        let found = [engine.raw_rows(order, &narrow), double.raw_rows(order, &unrounded)];
        found.map(|found| difference(&expected, &found))
    })
}

/// The largest error of the isotropic operators of order 2, 4 and 6 against sums of derivatives along lines: the mean of
/// `cos^n` over `k` evenly turned lines is that over all directions if `n < 2k`.
fn directional_error(architecture: Architecture, count: usize) -> f64 {
    let model = Ladder::new(count);
    let reference = Reference::new(&model, architecture);
    let theta = weights::<f64>(&reference, 1.0);
    let mut engine = engine::<f64>(&reference.problem, architecture);
    let mut worst = 0.0_f64;
    // Group, its row, order, lines, and the operator over the mean of the derivatives.
    for (group, row, order, lines, share) in [(1, 1, 2, 3, 2.0), (3, 0, 4, 3, 8.0 / 3.0), (5, 0, 6, 4, 16.0 / 5.0)] {
        let found = engine.raw_rows(group, &theta);
        let expected: Vec<f64> = model
            .points
            .chunks_exact(2)
            .map(|x| {
                let along = |k: usize| {
                    let angle = PI * k as f64 / lines as f64 + 0.1;
                    line::derivatives(&reference.layout, &reference.scaling, &theta, x, &[angle.cos(), angle.sin()])
                };
                share * (0..lines).map(|k| along(k)[order]).sum::<f64>() / lines as f64
            })
            .collect();
        let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let error = |(p, x): (usize, &f64)| (found[row * count + p] - x).abs() / largest;
        worst = expected.iter().enumerate().map(error).fold(worst, f64::max);
    }
    worst
}

fn networks(extent: Extent) -> Vec<Architecture> {
    let fast = vec![Architecture::modified(16, 2), Architecture::plain(24, 3)];
    let full = vec![
        Architecture::modified(8, 1),
        Architecture::modified(16, 2),
        Architecture::plain(32, 3),
        Architecture::modified(64, 4),
        Architecture::plain(128, 5),
        Architecture::modified(256, 5),
    ];
    extent.pick(fast, full)
}

fn orders<E: Precision>(extent: Extent, factor: f64) -> [[f64; 2]; 6] {
    let count = extent.pick(5, 8);
    networks(extent).into_iter().fold([[0.0; 2]; 6], |worst, architecture| {
        let errors = errors::<E>(architecture, factor, count);
        std::array::from_fn(|order| std::array::from_fn(|i| worst[order][i].max(errors[order][i])))
    })
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let sizes = extent.pick("widths 16, 24, L 2, 3", "widths 8 to 256, L 1 to 5");
    let mut rows = Vec::new();
    for (precision, factor, found, target) in [
        ("f64", 1.0, orders::<f64>(extent, 1.0), 1e-12),
        ("f32", 1.0, orders::<f32>(extent, 1.0), 2e-6),
        ("f32", 8.0, orders::<f32>(extent, 8.0), 1e-4),
    ] {
        for (order, [worst, rounded]) in found.into_iter().enumerate() {
            let weights = if factor == 1.0 { "ordinary weights" } else { "weights times 8" };
            let what = format!("order {}, {precision}, {weights}, against dense double-double series", order + 1);
            if precision == "f64" {
                rows.push(Row::new(what, sizes, worst, target));
                continue;
            }
            let samples = format!("{sizes}; rounding the weights to f32 changes {rounded:.1e}");
            rows.push(Row::new(what, samples, worst, target));
        }
    }
    let worst = networks(extent).into_iter().map(|a| directional_error(a, extent.pick(9, 40))).fold(0.0, f64::max);
    rows.push(Row::new("orders 2, 4 (lines 60 degrees apart) and 6 (45), f64", sizes, worst, 1e-12));
    rows
}
