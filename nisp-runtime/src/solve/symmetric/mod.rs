//! A dense symmetric matrix that is updated by rank two and multiplied by two vectors in one pass over memory.
//!
//! Quasi-Newton methods are bound by memory: at 2000 parameters the matrix is 32 MB. So only the lower triangle is
//! kept, and an update waits until the next products need the matrix: each element is read and written once an
//! iteration. Rows come in groups of eight, cut into tiles of 8 x 8 that lie in memory in the order in which they are
//! used; the tile on the diagonal is kept whole. Large matrices are cut into a fixed number of chunks whose partial
//! products are added in a fixed order, so that the number of threads does not change a bit.

mod pass;

use pass::{Chunk, Input, pass};
use rayon::prelude::*;

const TILE: usize = 8;
type Lanes = [f64; TILE];

/// Size from which several threads pay.
const PARALLEL: usize = 600;
/// Chunks of a large matrix.
const CHUNKS: usize = 8;

/// `scale H + a s s^T + b (s w^T + w s^T) + c w w^T`
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RankTwo {
    pub(crate) scale: f64,
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
}

impl RankTwo {
    /// Changes nothing.
    pub(crate) const NONE: Self = Self { scale: 1.0, a: 0.0, b: 0.0, c: 0.0 };
}

/// The matrix, an update that waits, and the products of the last pass. All vectors are padded with zeros to whole
/// tiles.
pub(crate) struct Symmetric {
    len: usize,
    chunks: Vec<Chunk>,
    pending: RankTwo,
    s: Vec<Lanes>,
    w: Vec<Lanes>,
    y: Vec<Lanes>,
    g: Vec<Lanes>,
    products: [Vec<Lanes>; 2],
}

impl Symmetric {
    /// The unit matrix of size `len`.
    pub(crate) fn new(len: usize) -> Self {
        let groups = len.div_ceil(TILE);
        let count = if len < PARALLEL { 1 } else { CHUNKS };
        // Equal areas of the triangle.
        let bound = |k: usize| ((k as f64 / count as f64).sqrt() * groups as f64).round() as usize;
        let zeros = |n: usize| vec![[0.0; TILE]; n];
        let chunks = (0..count)
            .map(|k| {
                let groups = bound(k)..bound(k + 1);
                let tiles = groups.clone().map(|group| group + 1).sum();
                Chunk {
                    tiles: vec![[[0.0; TILE]; TILE]; tiles],
                    products: [zeros(groups.end), zeros(groups.end)],
                    groups,
                }
            })
            .collect();
        let mut matrix = Self {
            len,
            chunks,
            pending: RankTwo::NONE,
            s: zeros(groups),
            w: zeros(groups),
            y: zeros(groups),
            g: zeros(groups),
            products: [zeros(groups), zeros(groups)],
        };
        matrix.set_identity(1.0);
        matrix
    }

    /// `H = factor I`
    pub(crate) fn set_identity(&mut self, factor: f64) {
        self.pending = RankTwo::NONE;
        for chunk in &mut self.chunks {
            chunk.tiles.as_flattened_mut().as_flattened_mut().fill(0.0);
            let mut tiles = chunk.tiles.iter_mut();
            for group in chunk.groups.clone() {
                let Some(tile) = tiles.nth(group) else { return };
                for (i, row) in tile.iter_mut().enumerate() {
                    // The padding stays zero.
                    row[i] = if group * TILE + i < self.len { factor } else { 0.0 };
                }
            }
        }
    }

    /// Applies the update that waits, then multiplies: gives `H y` and `H g`.
    pub(crate) fn products(&mut self, y: &[f64], g: &[f64]) -> (&[f64], &[f64]) {
        self.y.as_flattened_mut()[..self.len].copy_from_slice(y);
        self.g.as_flattened_mut()[..self.len].copy_from_slice(g);
        let input = Input { update: self.pending, s: &self.s, w: &self.w, y: &self.y, g: &self.g };
        match self.chunks.as_mut_slice() {
            [chunk] => {
                pass(chunk, input);
                std::mem::swap(&mut self.products, &mut chunk.products);
            }
            chunks => {
                chunks.par_iter_mut().for_each(|chunk| pass(chunk, input));
                for (k, product) in self.products.iter_mut().enumerate() {
                    product.as_flattened_mut().fill(0.0);
                    for chunk in chunks.iter() {
                        let sum = product.as_flattened_mut().iter_mut();
                        sum.zip(chunk.products[k].as_flattened()).for_each(|(sum, part)| *sum += part);
                    }
                }
            }
        }
        self.pending = RankTwo::NONE;
        let [hy, hg] = &self.products;
        (&hy.as_flattened()[..self.len], &hg.as_flattened()[..self.len])
    }

    /// Updates the matrix, where `w` is the first product of the last call of [`Self::products`].
    pub(crate) fn update(&mut self, update: RankTwo, s: &[f64]) {
        self.pending = update;
        self.s.as_flattened_mut()[..self.len].copy_from_slice(s);
        self.w.copy_from_slice(&self.products[0]);
    }

    /// Everything that the next products depend on, in a fixed layout.
    pub(crate) fn export(&self) -> Vec<f64> {
        let RankTwo { scale, a, b, c } = self.pending;
        let mut out = vec![scale, a, b, c];
        out.extend_from_slice(self.s.as_flattened());
        out.extend_from_slice(self.w.as_flattened());
        for chunk in &self.chunks {
            out.extend_from_slice(chunk.tiles.as_flattened().as_flattened());
        }
        out
    }

    /// Takes over what [`Self::export`] gave for a matrix of the same size; false where the length does not fit.
    pub(crate) fn import(&mut self, data: &[f64]) -> bool {
        let tiles: usize = self.chunks.iter().map(|chunk| chunk.tiles.len()).sum();
        let padded = self.s.len() * TILE;
        if data.len() != 4 + 2 * padded + tiles * TILE * TILE {
            return false;
        }
        let (head, rest) = data.split_at(4);
        let (s, rest) = rest.split_at(padded);
        let (w, mut rest) = rest.split_at(padded);
        self.pending = RankTwo { scale: head[0], a: head[1], b: head[2], c: head[3] };
        self.s.as_flattened_mut().copy_from_slice(s);
        self.w.as_flattened_mut().copy_from_slice(w);
        for chunk in &mut self.chunks {
            let tiles = chunk.tiles.as_flattened_mut().as_flattened_mut();
            let (mine, others) = rest.split_at(tiles.len());
            tiles.copy_from_slice(mine);
            rest = others;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plain full matrix with the same updates.
    fn dense_update(h: &mut [Vec<f64>], update: RankTwo, s: &[f64], w: &[f64]) {
        let RankTwo { scale, a, b, c } = update;
        for (i, row) in h.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x = scale * *x + a * s[i] * s[j] + b * (s[i] * w[j] + w[i] * s[j]) + c * w[i] * w[j];
            }
        }
    }

    fn wave(len: usize, phase: f64) -> Vec<f64> {
        (0..len).map(|i| (phase + 0.7 * i as f64).sin()).collect()
    }

    #[test]
    fn agrees_with_a_full_matrix() {
        for len in [1, 7, 8, 21, 64, 611] {
            let mut matrix = Symmetric::new(len);
            matrix.set_identity(2.0);
            let mut full = vec![vec![0.0; len]; len];
            (0..len).for_each(|i| full[i][i] = 2.0);
            for round in 0..4 {
                let (y, g) = (wave(len, round as f64), wave(len, 3.0 + round as f64));
                let (hy, hg) = matrix.products(&y, &g);
                for (i, row) in full.iter().enumerate() {
                    let expected: f64 = row.iter().zip(&y).map(|(h, y)| h * y).sum();
                    assert!((hy[i] - expected).abs() < 1e-11 * len as f64, "{len} {i}: {} {expected}", hy[i]);
                    let expected: f64 = row.iter().zip(&g).map(|(h, g)| h * g).sum();
                    assert!((hg[i] - expected).abs() < 1e-11 * len as f64);
                }
                let (s, w) = (wave(len, 5.0), hy.to_vec());
                let update = RankTwo { scale: 0.9, a: 0.3, b: -0.02, c: 0.01 / len as f64 };
                matrix.update(update, &s);
                dense_update(&mut full, update, &s, &w);
            }
        }
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut matrix = Symmetric::new(900);
                matrix.products(&wave(900, 0.0), &wave(900, 1.0));
                matrix.update(RankTwo { scale: 0.5, a: 0.1, b: 0.2, c: 0.3 }, &wave(900, 2.0));
                let (hy, hg) = matrix.products(&wave(900, 3.0), &wave(900, 4.0));
                (hy.to_vec(), hg.to_vec())
            })
        };
        assert_eq!(run(1), run(3));
    }
}
