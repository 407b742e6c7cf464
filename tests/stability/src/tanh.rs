//! tanh and its derivatives, against f64 for f32 and double-double for f64.

use nisp::simd::{Isa, dispatch};
use rayon::prelude::*;

use crate::digits;
use crate::double_double::Dd;
use crate::row::{Extent, Row};
use crate::single::wanted_single;
use crate::tanh_errors::{D, Rows, Worst, largest_ratios, reference_double};

/// Inputs at a time.
const PIECE: u32 = 1 << 14;

/// Largest errors: of tanh, of its derivatives in units in the last place, and near their zeros in units of their size.
type Errors = [f64; 3];

fn larger(a: Errors, b: Errors) -> Errors {
    std::array::from_fn(|i| a[i].max(b[i]))
}

fn largest_of(worst: &Worst) -> Errors {
    let most = |errors: &[f64; D]| errors[1..].iter().copied().fold(0.0, f64::max);
    [worst.ulps[0], most(&worst.ulps), most(&worst.near_zeros)]
}

/// Errors on each instruction set; sets that give the same bits are judged once.
fn single(isas: &[Isa], inputs: &[f32], largest: &[f64; D]) -> Vec<Errors> {
    let wanted: Vec<[f64; D]> = inputs.iter().map(|&a| wanted_single(a)).collect();
    let mut before: Option<(Vec<[f32; D]>, Errors)> = None;
    isas.iter()
        .map(|&isa| {
            let found = dispatch(isa, Rows(inputs));
            if let Some((same, errors)) = &before
                && *same == found
            {
                return *errors;
            }
            let mut worst = Worst::default();
            for (got, want) in found.iter().zip(wanted.iter().chain(&wanted)) {
                worst.add::<f32>(want, &std::array::from_fn(|n| f64::from(got[n]) - want[n]), largest);
            }
            let errors = largest_of(&worst);
            before = Some((found, errors));
            errors
        })
        .collect()
}

fn double(isas: &[Isa], inputs: &[f64], largest: &[f64; D]) -> Vec<Errors> {
    let wanted: Vec<[Dd; D]> = inputs.iter().map(|&a| reference_double(a)).collect();
    isas.iter()
        .map(|&isa| {
            let mut worst = Worst::default();
            for (got, want) in dispatch(isa, Rows(inputs)).iter().zip(wanted.iter().chain(&wanted)) {
                let error = std::array::from_fn(|n| (Dd::from(got[n]) - want[n]).abs().hi);
                worst.add::<f64>(&want.map(|x| x.hi), &error, largest);
            }
            largest_of(&worst)
        })
        .collect()
}

fn gather(pieces: impl ParallelIterator<Item = Vec<Errors>>, isas: usize) -> Vec<Errors> {
    let nothing = || vec![[0.0; 3]; isas];
    pieces.reduce(nothing, |a, b| a.into_iter().zip(b).map(|(a, b)| larger(a, b)).collect())
}

/// Samples on which tanh and the slope of `-a` do not mirror those of `a` to the bit.
fn asymmetric(inputs: &[f32]) -> usize {
    let mirrored: Vec<f32> = inputs.iter().map(|a| -a).collect();
    let (here, there) = (dispatch(Isa::detect(), Rows(inputs)), dispatch(Isa::detect(), Rows(&mirrored)));
    let sign = |n: usize| if n.is_multiple_of(2) { -1.0 } else { 1.0 };
    here.iter().zip(&there).filter(|(a, b)| (0..D).any(|n| a[n] != sign(n) * b[n])).count()
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let largest = largest_ratios();
    let isas: Vec<Isa> = Isa::available().collect();
    // All numbers from the least denormal to 20; where a part is taken, every magnitude is in it.
    let (end, stride) = (20.0_f32.to_bits(), extent.pick(4001, 1));
    let pieces = (end / stride).div_ceil(PIECE);
    let piece = |k: u32| {
        let within = k * PIECE..((k + 1) * PIECE).min(end / stride + 1);
        within.map(|i| f32::from_bits(i * stride)).collect::<Vec<f32>>()
    };
    let every_f32 = gather((0..pieces).into_par_iter().map(|k| single(&isas, &piece(k), &largest)), isas.len());
    let mirrored: usize = (0..pieces).into_par_iter().map(|k| asymmetric(&piece(k))).sum();

    let count = extent.pick(100_000_u32, 10_000_000);
    let double_piece = |k: u32| {
        let sample = |i: u32| match i % 8 {
            // Every size down to the denormals, and beyond saturation.
            0 => f64::from_bits(u64::from(i) * (370.0_f64.to_bits() / u64::from(count))),
            1 => 370.0 * f64::from(i) / f64::from(count),
            _ => 40.0 * f64::from(i) / f64::from(count) - 20.0,
        };
        (k * PIECE..((k + 1) * PIECE).min(count)).map(sample).collect::<Vec<f64>>()
    };
    let pieces = count.div_ceil(PIECE);
    let f64s = gather((0..pieces).into_par_iter().map(|k| double(&isas, &double_piece(k), &largest)), isas.len());

    let mut rows = digits::rows(extent);
    for (element, samples, errors, tanh) in [
        ("f32", format!("{} in [0, 20], denormals too", end / stride + 1), every_f32, 1.5),
        ("f64", format!("{count} up to 370, denormals too"), f64s, 4.0),
    ] {
        for (isa, [value, derivatives, near]) in isas.iter().zip(errors) {
            let name = isa.name();
            let whats =
                ["tanh", "derivatives 1 to 6, away from zeros", "derivatives 1 to 6, near zeros, over their size"];
            for (what, (worst, target)) in whats.iter().zip([(value, tanh), (derivatives, 8.0), (near, 8.0)]) {
                rows.push(Row::new(format!("{what}, {element}, {name}, ulp"), &samples, worst, target));
            }
        }
    }
    rows.push(Row::count("tanh and derivatives of -a do not mirror those of a", (end / stride) as usize, mirrored));
    let [t, slope, ..] = dispatch(Isa::detect(), Rows(&[10.0_f32]))[0];
    // 1 / cosh(10)^2
    let lost = (f64::from(slope) / 8.244_614_512_554_7e-9 - 1.0).abs();
    rows.push(Row::new(format!("slope at 10 in f32, where 1 - t^2 is {}", 1.0 - t * t), "1", lost, 1e-6));
    rows
}
