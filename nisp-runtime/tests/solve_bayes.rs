//! Evidence, noise and error bars against closed-form Bayesian linear regression.
//!
//! The design has orthogonal columns, so that every formula is a sum over columns.

mod solve_common;

use nisp_runtime::solve::curvature::Curvature;
use nisp_runtime::solve::driver::{Flow, Limits, Status, run};
use nisp_runtime::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use nisp_runtime::solve::evidence::evidence;
use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::BlockKind;
use nisp_runtime::solve::posterior::{leading, posterior, spread};
use nisp_runtime::solve::prior::{PriorGroup, WeightPrior};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use solve_common::rows::{Rows, cosine};

const ROWS: usize = 60;
const LEN: usize = 12;

/// Data: a few cosines and a rough deterministic disturbance in place of noise.
fn data(i: usize) -> f64 {
    let signal: f64 = (0..5).map(|k| (2.0 - 0.3 * k as f64) * cosine(k, i, ROWS)).sum();
    signal + 0.2 * ((12.9898 * i as f64).sin() * 43758.5453).fract()
}

/// `y = X theta + noise` with the first `LEN` cosines as columns of `X`.
fn regression(sigma: f64) -> Rows {
    let mut rows = Rows::new(LEN, ROWS, |i, theta, row| {
        (0..LEN).for_each(|k| row[k] = cosine(k, i, ROWS));
        row.iter().zip(theta).map(|(x, t)| x * t).sum::<f64>() - data(i)
    });
    rows.blocks[0].sigma = sigma;
    rows
}

/// Squared length of column `k`.
fn square(k: usize) -> f64 {
    if k == 0 { ROWS as f64 } else { ROWS as f64 / 2.0 }
}

/// `x_k . y`
fn projection(k: usize) -> f64 {
    (0..ROWS).map(|i| cosine(k, i, ROWS) * data(i)).sum()
}

fn minimise(rows: &mut Rows, prior: WeightPrior) -> Vec<f64> {
    let mut method = Marquardt::new(vec![0.0; LEN], prior);
    for _ in 0..50 {
        method.step(rows).unwrap();
    }
    Method::<f64, Rows>::theta(&method).to_vec()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1e-3), "{a} against {b}");
}

#[test]
fn evidence_of_a_linear_model_is_the_probability_of_the_data() {
    let (sigma, alpha) = (0.15, 0.7);
    let mut rows = regression(sigma);
    let prior = WeightPrior::uniform(alpha, LEN);
    let theta = minimise(&mut rows, prior.clone());
    let curvature = Curvature::at(&mut rows, &theta, &prior).unwrap();
    let found = evidence(&curvature, &prior, &theta, &rows.blocks);
    // y ~ N(0, sigma^2 I + X X^T / alpha), whose eigenvalues are known: columns of X and the rest.
    let total: f64 = (0..ROWS).map(|i| data(i).powi(2)).sum();
    let mut inside = 0.0;
    let mut expected = 0.0;
    for k in 0..LEN {
        let along = projection(k).powi(2) / square(k);
        let variance = sigma * sigma + square(k) / alpha;
        expected -= 0.5 * (along / variance + (std::f64::consts::TAU * variance).ln());
        inside += along;
    }
    expected -= 0.5 * (total - inside) / (sigma * sigma);
    expected -= 0.5 * (ROWS - LEN) as f64 * (std::f64::consts::TAU * sigma * sigma).ln();
    close(found.log_evidence, expected, 1e-10);
    let gamma: f64 = (0..LEN).map(|k| square(k) / (square(k) + alpha * sigma * sigma)).sum();
    close(found.effective_parameters, gamma, 1e-10);
    close(found.groups[0].effective, gamma, 1e-10);
}

#[test]
fn precisions_and_noise_settle_where_the_evidence_is_largest() {
    let mut rows = regression(1.0);
    rows.blocks[0].kind = BlockKind::ObservationOfUnknownNoise;
    let group = |name: &str, range| PriorGroup { name: name.into(), range, precision: 1.0 };
    let prior = WeightPrior::new(vec![group("low", 0..6), group("high", 6..LEN)], LEN).unwrap();
    let settings =
        EmpiricalBayesSettings { warm_up: 3, every: 1, tolerance: 1e-7, ..EmpiricalBayesSettings::default() };
    let mut method = EmpiricalBayes::new(vec![0.0; LEN], prior, settings);
    for _ in 0..400 {
        if method.step(&mut rows).unwrap().verdict == Verdict::Exhausted {
            break;
        }
    }
    // MacKay's fixed point, column by column: alpha = gamma / |theta|^2, sigma^2 = |r|^2 / (N - gamma).
    let noise = rows.blocks[0].sigma.powi(2);
    let mut total_gamma = 0.0;
    let mut explained = 0.0;
    for group in method.prior().groups() {
        let alpha = group.precision;
        let (mut gamma, mut weights) = (0.0, 0.0);
        for k in group.range.clone() {
            let theta = projection(k) / (square(k) + alpha * noise);
            gamma += square(k) / (square(k) + alpha * noise);
            weights += theta * theta;
            explained += 2.0 * theta * projection(k) - theta * theta * square(k);
        }
        close(alpha, gamma / weights, 1e-4);
        total_gamma += gamma;
    }
    let residual: f64 = (0..ROWS).map(|i| data(i).powi(2)).sum::<f64>() - explained;
    close(noise, residual / (ROWS as f64 - total_gamma), 1e-4);
    let [low, high] = method.prior().groups() else { panic!() };
    assert!(high.precision > 10.0 * low.precision, "the empty columns are pruned");
}

#[test]
fn deviations_are_those_of_linear_regression() {
    let (sigma, alpha) = (0.2, 0.5);
    let mut rows = regression(sigma);
    let prior = WeightPrior::uniform(alpha, LEN);
    let curvature = Curvature::at(&mut rows, &[0.0; LEN], &prior).unwrap();
    // The fitted curve at three places.
    let mut derivatives = Vec::new();
    for i in [0, 7, 30] {
        derivatives.extend((0..LEN).map(|k| cosine(k, i, ROWS)));
    }
    let found = posterior(&curvature, &derivatives);
    for (by_noise, i) in found.by_noise.iter().zip([0, 7, 30]) {
        let kept = |k: usize| sigma * square(k).sqrt() / (square(k) + alpha * sigma * sigma);
        let variance: f64 = (0..LEN).map(|k| (cosine(k, i, ROWS) * kept(k)).powi(2)).sum();
        close(*by_noise, variance.sqrt(), 1e-12);
    }
    // Ridge regression misses (1 - shrinkage) of each coefficient, whose deviation is that of the prior.
    for (by_prior, i) in found.by_prior.iter().zip([0, 7, 30]) {
        let missed = |k: usize| 1.0 - square(k) / (square(k) + alpha * sigma * sigma);
        let variance: f64 = (0..LEN).map(|k| (cosine(k, i, ROWS) * missed(k)).powi(2) / alpha).sum();
        close(*by_prior, variance.sqrt(), 1e-12);
    }
}

#[test]
fn a_direction_that_no_row_sees_is_shown() {
    // Rows depend on theta through everything but the pattern exp(-t): reported values theta_i at t_i = i / 4 may
    // move along that pattern at no cost but the prior's.
    let len = 20;
    let pattern: Vec<f64> = (0..len).map(|i| (-0.25 * i as f64).exp()).collect();
    let norm = pattern.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit: Vec<f64> = pattern.iter().map(|x| x / norm).collect();
    let unit_rows = unit.clone();
    let mut rows = Rows::new(len, len, move |i, theta, row| {
        // 100 (I - u u^T) theta
        (0..len).for_each(|k| row[k] = 100.0 * (f64::from(u8::from(i == k)) - unit_rows[i] * unit_rows[k]));
        row.iter().zip(theta).map(|(j, x)| j * x).sum()
    });
    let prior = WeightPrior::uniform(0.25, len);
    let curvature = Curvature::at(&mut rows, &vec![0.0; len], &prior).unwrap();
    let mut identity = vec![0.0; len * len];
    (0..len).for_each(|i| identity[i * (len + 1)] = 1.0);
    let values = spread(&curvature, &identity);
    let found = leading(&values, len).unwrap();
    close(found.deviation, 2.0, 1e-9);
    // Of the other directions, rows leave a variance of a ten-thousandth each.
    close(found.share, 4.0 / (4.0 + (len - 1) as f64 * 1e-4), 1e-6);
    for (a, b) in found.shape.iter().zip(&unit) {
        assert!((a - b).abs() < 1e-8);
    }
    // One standard deviation along it moves every value by twice its share of the pattern.
    for (row, share) in values.chunks_exact(len).zip(&unit) {
        close(row.iter().zip(&found.columns).map(|(x, z)| x * z).sum(), 2.0 * share, 1e-8);
    }
    // The same from more outputs than parameters.
    let twice = leading(&spread(&curvature, &[identity.clone(), identity].concat()), 2 * len).unwrap();
    close(twice.deviation, 8.0_f64.sqrt(), 1e-9);
    close(twice.shape[len], unit[0] / 2.0_f64.sqrt(), 1e-8);
    assert!(twice.columns.iter().zip(&found.columns).all(|(a, b)| (a - b).abs() < 1e-8));
}

/// A hidden layer of tanh fitted to a sine with a reproducible disturbance of standard deviation 0.1.
fn noisy_network(units: usize, points: usize) -> Rows {
    let mut random = StdRng::seed_from_u64(7);
    // Twelve uniform numbers less six: mean 0, variance 1.
    let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
    let data: Vec<f64> =
        (0..points).map(|i| (3.0 * (-1.0 + 2.0 * i as f64 / points as f64)).sin() + 0.1 * normal()).collect();
    let mut rows = Rows::new(3 * units, points, move |i, theta, row| {
        let x = -1.0 + 2.0 * i as f64 / points as f64;
        let mut y = 0.0;
        for (unit, d) in theta.chunks_exact(3).zip(row.chunks_exact_mut(3)) {
            let t = (unit[0] * x + unit[1]).tanh();
            let slope = unit[2] * (1.0 - t * t);
            d.copy_from_slice(&[slope * x, slope, t]);
            y += unit[2] * t;
        }
        y - data[i]
    });
    rows.blocks[0].kind = BlockKind::ObservationOfUnknownNoise;
    rows
}

#[test]
fn a_network_learns_its_own_noise() {
    let (units, points) = (15, 200);
    let mut rows = noisy_network(units, points);
    let start = (0..3 * units).map(|i| (12.9898 * i as f64).sin()).collect();
    let prior = WeightPrior::uniform(1.0, 3 * units);
    let mut method = EmpiricalBayes::new(start, prior, EmpiricalBayesSettings::default());
    // Losses are in units of log probability: a share of 3e-3 of about 100 is far below one.
    let limits = Limits { iterations: 800, tolerance: 3e-3, ..Limits::default() };
    let outcome = run(&mut method, &mut rows, limits, &mut |_| Flow::Continue);
    assert_eq!(outcome.status, Status::Converged);
    let sigma = rows.blocks[0].sigma;
    assert!((0.08..0.12).contains(&sigma), "{sigma}");
    let evidence = method.evidence().unwrap();
    assert!((0.9..1.1).contains(&evidence.blocks[0].chi_square));
    // A sine takes a handful of directions, not all 45.
    assert!((3.0..15.0).contains(&evidence.effective_parameters), "{}", evidence.effective_parameters);
    println!("{} steps, {:.1} directions", outcome.iterations, evidence.effective_parameters);
}
