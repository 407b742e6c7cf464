//! How many numbers of a head its data settle: those that its prior alone does not, and equations do not by themselves.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use super::prior::Prior;
use crate::local::block::Block;
use crate::local::normal::Normal;
use crate::local::normal::factor::Factor;

/// Random combinations of the prior's rows: a count of ten is known to a twentieth.
const PROBES: usize = 64;
/// What keeps the prior's matrix definite along what it does not speak of, beside its diagonal.
const RIDGE: f64 = 1e-10;

/// Random combinations of the rows of a head's prior, and how many numbers the prior alone settles of each.
pub(super) struct Freedom {
    first: usize,
    probes: Vec<Vec<f64>>,
    alone: Vec<f64>,
}

impl Freedom {
    /// How many numbers of a head are free; nothing if the prior's matrix cannot be factorised.
    pub(super) fn new(prior: &Prior, first: usize, len: usize) -> Option<Self> {
        let mut blocks = prior.blocks(&vec![0.0; first + len], 1.0, 0);
        blocks.iter_mut().flat_map(|block| &mut block.dofs).for_each(|dof| *dof -= first as u32);
        let together: Vec<Vec<u32>> = blocks.iter().map(|block| block.dofs.clone()).collect();
        let mut normal = Normal::new(len, 0, &together)?;
        normal.add_all(&blocks);
        let ridge = RIDGE * normal.typical(0..len);
        (0..len).for_each(|at| normal.add_stiffness(at, ridge));
        let factor = normal.factor()?;
        let mut random = StdRng::seed_from_u64(0);
        let mut probe = || {
            let mut sum = vec![0.0; len];
            blocks.iter().for_each(|block: &Block| block.add_signed(0, random.random(), &mut sum, &mut []));
            sum
        };
        let probes: Vec<Vec<f64>> = (0..PROBES).map(|_| probe()).collect();
        let alone = factor.products(&probes, &vec![Vec::new(); PROBES])?;
        Some(Self { first, probes, alone })
    }

    /// How many numbers the data settle under a roughness, where there are `len` coefficients of all heads.
    pub(super) fn settled(&self, factor: &Factor, len: usize, roughness: f64) -> Option<f64> {
        let side = |probe: &Vec<f64>| {
            let mut side = vec![0.0; len];
            side[self.first..][..probe.len()].iter_mut().zip(probe).for_each(|(x, probe)| *x = probe / roughness);
            side
        };
        let right: Vec<Vec<f64>> = self.probes.iter().map(side).collect();
        let together = factor.products(&right, &vec![Vec::new(); PROBES])?;
        Some(self.alone.iter().zip(together).map(|(alone, together)| alone - together).sum::<f64>() / PROBES as f64)
    }
}

/// Of a head: how many of its numbers equations settle, and the sum of squares that they ask of the rows of its prior.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before {
    pub(super) settled: f64,
    pub(super) squares: f64,
}

/// By head what equations settle, and by head the roughness for which it was counted.
#[derive(Clone, Debug, Default)]
pub(super) struct Unmeasured {
    of: Vec<Before>,
    sizes: Vec<f64>,
}

impl Unmeasured {
    pub(super) fn new(of: Vec<Before>, sizes: Vec<f64>) -> Self {
        Self { of, sizes }
    }

    /// By head, the roughness for which it was counted.
    pub(super) fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    pub(super) fn of(&self, head: usize) -> Before {
        self.of.get(head).copied().unwrap_or_default()
    }

    /// As plain numbers, three to a head.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let all = self.sizes.iter().enumerate().map(|(head, size)| (self.of(head), *size));
        all.flat_map(|(before, size)| [before.settled, before.squares, size]).collect()
    }

    pub(super) fn from_numbers(numbers: &[f64]) -> Self {
        let all = || numbers.as_chunks::<3>().0.iter();
        let of = all().map(|&[settled, squares, _]| Before { settled, squares }).collect();
        Self { of, sizes: all().map(|&[_, _, size]| size).collect() }
    }
}
