//! How a step is cut: points into tiles, tiles into chunks.

use super::group::BoundGroup;
use crate::aligned::AlignedVec;
use crate::kernel::Precision;
use crate::layer::row_distance;
use crate::network::Layout;
use crate::wide::add_rows;

/// Most chunks that a step is cut into; more threads than this find no work.
const CHUNKS: usize = 16;

/// Rows that a chunk should have at least, for its products to outweigh the addition of its gradient.
const CHUNK_ROWS: usize = 400;

/// Bytes that the rows of a tile may take together: within the second-level cache of one core.
const TILE_BYTES: usize = 640 << 10;

/// A share of a step: consecutive tiles, their gradient and their part of every term.
pub(super) struct Chunk<E: Precision> {
    pub(super) tiles: Vec<TileRange>,
    pub(super) gradient: AlignedVec<E>,
    pub(super) shares: Vec<f64>,
    pub(super) fault: Option<(usize, usize)>,
}

#[derive(Clone, Copy)]
pub(super) struct TileRange {
    pub(super) group: usize,
    pub(super) first: usize,
    pub(super) count: usize,
}

/// Points of a tile: as many as keep its rows in cache, and enough tiles to share out.
pub(super) fn tile_points<E: Precision>(layout: &Layout, channels: usize, points: usize) -> usize {
    let buffers = layout.affine.len() + layout.hidden.len() + 6;
    let bytes = channels * row_distance(layout.width) * size_of::<E>() * buffers;
    let fit = (TILE_BYTES / bytes).clamp(4, 64);
    let share = points.div_ceil(CHUNKS).next_multiple_of(4);
    fit.min(share).max(4).min(points.max(1))
}

/// Does the work of all chunks, of which there is at least one, and adds their gradients up in the first: in a fixed tree,
/// whatever the threads, and each sum as soon as both of its parts are there.
pub(super) fn add_up<E: Precision>(chunks: &mut [Chunk<E>], work: &(impl Fn(&mut Chunk<E>) + Sync)) {
    if let [chunk] = chunks {
        return work(chunk);
    }
    let (left, right) = chunks.split_at_mut(chunks.len().next_power_of_two() / 2);
    rayon::join(|| add_up(left, work), || add_up(right, work));
    let right = &right[0].gradient;
    add_rows(&mut left[0].gradient, right, right.len());
}

/// Cuts all tiles of all groups into chunks of about equal work.
pub(super) fn cut<E: Precision>(groups: &[BoundGroup<E>]) -> Vec<Vec<TileRange>> {
    let tiles: Vec<(TileRange, usize)> = groups
        .iter()
        .enumerate()
        .flat_map(|(at, group)| {
            let cost = group.sites() * group.reading.layers.channels();
            group.tiles().map(move |(first, count)| (TileRange { group: at, first, count }, count * cost))
        })
        .collect();
    let total: usize = tiles.iter().map(|(_, cost)| cost).sum();
    let chunks = (total / CHUNK_ROWS).clamp(CHUNKS / 2, CHUNKS);
    let mut chunks: Vec<Vec<TileRange>> = vec![Vec::new(); chunks.min(tiles.len()).max(1)];
    let mut done = 0;
    let count = chunks.len();
    for (tile, cost) in tiles {
        let at = (done * count / total.max(1)).min(count - 1);
        chunks[at].push(tile);
        done += cost;
    }
    chunks.retain(|chunk| !chunk.is_empty());
    if chunks.is_empty() {
        chunks.push(Vec::new());
    }
    chunks
}
