//! Cells of one width that move along the coordinate, and where on them equations are asked to hold.

/// Cells whose rows are made anew in every step.
const TAIL: usize = 6;
/// Where equations are asked to hold at an end of the record, in cells from it: the centres of splines of degree five whose
/// last knots are repeated there. The first and second knot from an end are replaced by these.
const AT_END: [f64; 4] = [0.0, 0.2, 0.6, 1.2];

/// The cells of a window.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) cells: usize,
    pub(super) width: f64,
    /// Where cell zero of the record begins, and the number of the window's first cell.
    zero: f64,
    first: i64,
}

impl Grid {
    /// A window that reaches back by a lag. A record that begins at `start` begins with the first cell of the tail.
    pub(super) fn new(start: f64, width: f64, lag: f64) -> Self {
        let cells = (lag / width).ceil() as usize + TAIL + 2;
        Self { cells, width, zero: start, first: -((cells - TAIL) as i64) }
    }

    /// Where the window begins.
    pub(super) fn left(&self) -> f64 {
        self.zero + self.first as f64 * self.width
    }

    /// Where the window ends.
    pub(super) fn right(&self) -> f64 {
        self.zero + (self.first + self.cells as i64) as f64 * self.width
    }

    /// The first cell of the tail.
    pub(super) fn tail_start(&self) -> usize {
        self.cells - TAIL
    }

    /// One cell farther.
    pub(super) fn advance(&mut self) {
        self.first += 1;
    }

    /// The cell of a place; places outside belong to the nearest. It follows from the place's number in the record: rows often lie where
    /// two cells meet, and the beginning of the window is rounded differently in every step. A row that changes its cell as it leaves the
    /// tail would be lost, or count twice.
    pub(super) fn cell(&self, at: f64) -> usize {
        (self.number(at) - self.first).clamp(0, self.cells as i64 - 1) as usize
    }

    /// The first cell of the window that is part of the record.
    pub(super) fn begun(&self) -> usize {
        (-self.first).max(0) as usize
    }

    /// The number of a place's cell in the record. A place that rounding puts before the record belongs to the first cell.
    pub(super) fn number(&self, at: f64) -> i64 {
        ((at - self.zero) / self.width).floor().max(0.0) as i64
    }

    /// The number in the record of a cell of the window.
    pub(super) fn number_of(&self, cell: usize) -> i64 {
        self.first + cell as i64
    }

    /// The cell of the window that has a number in the record.
    pub(super) fn index_of(&self, number: i64) -> Option<usize> {
        usize::try_from(number - self.first).ok().filter(|cell| *cell < self.cells)
    }

    /// Whether equations are asked for at the beginning of a cell: the record may begin behind it, or with places of its own.
    pub(super) fn has_equation(&self, cell: usize) -> bool {
        let number = self.number_of(cell);
        number >= 0 && number != 1
    }

    /// Places of the equations from the window's first cell on: knots from the cell before the tail on, and those of the end.
    pub(super) fn equations(&self) -> Vec<f64> {
        let knots = (self.tail_start() - 1..self.cells - 1).map(|knot| knot as f64);
        let end = AT_END.iter().rev().map(|from_end| self.cells as f64 - from_end);
        knots.chain(end).map(|at| at * self.width).collect()
    }

    /// The cell in whose rows one of these places counts; nothing if it is not asked for, because the record begins behind it
    /// or with places of its own.
    pub(super) fn cell_of_equation(&self, place: usize) -> Option<usize> {
        let cell = (self.tail_start() - 1 + place).min(self.cells - 1);
        (self.has_equation(cell) || cell == self.cells - 1).then_some(cell)
    }

    /// Places of equations at the beginning of the record, beside those at knots.
    pub(super) fn beginning(&self) -> impl Iterator<Item = f64> + '_ {
        AT_END[1..].iter().map(|from| self.zero + from * self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evenly spaced rows lie where cells meet, to rounding. What a row says is kept for good when its cell comes to lie before the tail.
    #[test]
    fn a_row_leaves_the_tail_once() {
        for (start, width) in [(0.0, 0.1), (0.3, 0.02), (-7.7, 1.0 / 3.0), (1e6, 0.01)] {
            let mut grid = Grid::new(start, width, 10.0 * width);
            for at in (0..300).map(|row| start + f64::from(row) * width) {
                while grid.right() < at {
                    grid.advance();
                }
                let mut later = grid.clone();
                let leaves = |_: &usize| {
                    later.advance();
                    later.cell(at) + 1 == later.tail_start()
                };
                assert_eq!((0..grid.cells).filter(leaves).count(), 1, "{at} of cells of {width} from {start} on");
            }
        }
    }

    /// A condition where the record begins: what another unit is rounded to may lie before it.
    #[test]
    fn the_beginning_belongs_to_the_first_cell() {
        let grid = Grid::new(0.3, 0.02, 0.2);
        assert_eq!(grid.number(0.3 - 1e-12), 0);
        assert_eq!(grid.cell(0.3 - 1e-12), grid.begun());
    }
}
