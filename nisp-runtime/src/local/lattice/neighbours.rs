//! Which functions of a lattice lie side by side.

use super::{Lattice, NONE};

impl Lattice {
    /// Pairs of kept neighbours along a coordinate: the number of a function, and that of the next.
    pub(in crate::local) fn neighbours(&self, axis: usize) -> impl Iterator<Item = (u32, u32)> + '_ {
        (0..self.full.len()).filter_map(move |number| {
            let next = self.beside(number, axis, 1)?;
            Some((number as u32, next))
        })
    }

    /// The kept function that is so many further than another along a coordinate, if there is one.
    fn beside(&self, number: usize, axis: usize, further: isize) -> Option<u32> {
        let stride: usize = (0..axis).map(|a| self.cells[a] + self.degree).product();
        let along = self.cells[axis] + self.degree;
        let at = self.full[number];
        let is_inside = ((at / stride) % along).checked_add_signed(further).is_some_and(|place| place < along);
        let next = is_inside.then(|| self.kept[at.wrapping_add_signed(further * stride as isize)])?;
        (next != NONE).then_some(next)
    }

    /// Lines of functions that share a cell: along each coordinate, from every outermost function inwards.
    pub(in crate::local) fn ends(&self) -> impl Iterator<Item = Vec<u32>> + '_ {
        let ways = (0..self.dimensions()).flat_map(|axis| [(axis, -1), (axis, 1)]);
        ways.flat_map(move |(axis, inwards)| {
            let outermost = (0..self.full.len()).filter(move |&number| self.beside(number, axis, -inwards).is_none());
            outermost.filter_map(move |number| {
                (0..=self.degree as isize).map(|further| self.beside(number, axis, further * inwards)).collect()
            })
        })
    }
}
