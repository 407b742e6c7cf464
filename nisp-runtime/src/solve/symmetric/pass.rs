//! A pass over the matrix: rows are updated and multiplied at once.

use std::ops::Range;

use super::{Lanes, RankTwo, TILE};
use crate::solve::vector::sum_lanes;
use crate::wide::widest;

/// The groups of rows `groups`, with their share of the products.
pub(super) struct Chunk {
    pub(super) groups: Range<usize>,
    /// Tiles of the groups one after the other, each row-major.
    pub(super) tiles: Vec<[Lanes; TILE]>,
    pub(super) products: [Vec<Lanes>; 2],
}

/// What a pass reads.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub(super) update: RankTwo,
    pub(super) s: &'a [Lanes],
    pub(super) w: &'a [Lanes],
    pub(super) y: &'a [Lanes],
    pub(super) g: &'a [Lanes],
}

widest! { pub(super) fn pass(chunk: &mut Chunk, input: Input<'_>) = pass_loop }

#[inline(always)]
fn pass_loop(chunk: &mut Chunk, input: Input<'_>) {
    let Chunk { groups, tiles, products: [hy, hg] } = chunk;
    hy.as_flattened_mut().fill(0.0);
    hg.as_flattened_mut().fill(0.0);
    let mut rest = tiles.as_mut_slice();
    for group in groups.clone() {
        let (row_tiles, others) = rest.split_at_mut(group + 1);
        rest = others;
        // Four rows at a time: their sums then stay in registers.
        pass_rows::<0>(row_tiles, group, input, hy, hg);
        pass_rows::<4>(row_tiles, group, input, hy, hg);
    }
}

/// Updates the rows `FIRST .. FIRST + 4` of a group and adds their share of the products.
#[inline(always)]
fn pass_rows<const FIRST: usize>(
    tiles: &mut [[Lanes; TILE]],
    group: usize,
    input: Input<'_>,
    hy: &mut [Lanes],
    hg: &mut [Lanes],
) {
    const ROWS: usize = 4;
    let RankTwo { scale, a, b, c } = input.update;
    let mut to_s = [0.0; ROWS];
    let mut to_w = [0.0; ROWS];
    let mut y = [0.0; ROWS];
    let mut g = [0.0; ROWS];
    for r in 0..ROWS {
        let (s, w) = (input.s[group][FIRST + r], input.w[group][FIRST + r]);
        to_s[r] = a * s + b * w;
        to_w[r] = b * s + c * w;
        y[r] = input.y[group][FIRST + r];
        g[r] = input.g[group][FIRST + r];
    }
    let mut sum_y = [[0.0; TILE]; ROWS];
    let mut sum_g = [[0.0; TILE]; ROWS];
    for (column, tile) in tiles.iter_mut().enumerate() {
        let (s, w, yc, gc) = (input.s[column], input.w[column], input.y[column], input.g[column]);
        // The tile on the diagonal is whole: it must not count again as its own transpose.
        let mirror = if column < group { 1.0 } else { 0.0 };
        let (mut column_y, mut column_g) = (hy[column], hg[column]);
        for r in 0..ROWS {
            let row = &mut tile[FIRST + r];
            let (mirror_y, mirror_g) = (mirror * y[r], mirror * g[r]);
            for lane in 0..TILE {
                let h = row[lane] * scale + s[lane] * to_s[r] + w[lane] * to_w[r];
                row[lane] = h;
                sum_y[r][lane] += h * yc[lane];
                sum_g[r][lane] += h * gc[lane];
                column_y[lane] += h * mirror_y;
                column_g[lane] += h * mirror_g;
            }
        }
        (hy[column], hg[column]) = (column_y, column_g);
    }
    for r in 0..ROWS {
        hy[group][FIRST + r] += sum_lanes(&sum_y[r]);
        hg[group][FIRST + r] += sum_lanes(&sum_g[r]);
    }
}
