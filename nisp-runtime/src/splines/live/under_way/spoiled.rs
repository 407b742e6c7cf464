//! Steps without the rows that are strays.

use super::{Live, SLACK};
use crate::solve::fault::Fault;
use crate::splines::live::record::MeasuredRow;
use crate::splines::live::strays::Strays;
use crate::units::{Declared, Number};

impl Live {
    /// A step, down to the first row that waits. Rows that are left out leave nothing behind: what they did to the state is undone.
    pub(super) fn solve(&mut self) -> Result<(), Fault> {
        let before = self.window.state();
        self.window.readmit();
        let stepped = self.step();
        if stepped.is_err() {
            // A stray may lead to where equations cannot be evaluated, as a level below zero under a root. About the state before it they can.
            self.window.return_to(&before);
            self.window.solve(self.wanted())?;
        }
        let Strays { found, aside } = self.window.leave_out_strays();
        self.mark(&found);
        let is_left_out = !found.is_empty() || !aside.is_empty();
        if is_left_out || stepped.is_err() {
            self.window.return_to(&before);
        }
        if is_left_out { self.step() } else { stepped }
    }

    /// Marks rows of the tail as strays.
    fn mark(&mut self, strays: &[f64]) {
        for row in self.recent.iter_mut().filter(|row| strays.contains(&row.at)) {
            row.is_stray = true;
        }
        for (_, events) in self.pending.iter_mut().filter(|(at, _)| strays.contains(at)) {
            events.iter_mut().for_each(|event| event.is_stray = true);
        }
    }

    /// Marks those of the first rows that the window found to be strays; false if there are none.
    pub(in super::super) fn mark_strays(&self, rows: &mut [MeasuredRow<Declared>]) -> bool {
        let own = self.recent.iter().filter(|row| row.is_stray);
        let places: Vec<f64> = own.map(|row| row.outward(&self.inward).at).collect();
        let mut found = false;
        for row in rows.iter_mut().filter(|row| !row.is_stray) {
            let slack = SLACK * self.window.grid().width;
            let slack = self.inward.at.back(Number::engine(slack)).as_declared();
            row.is_stray = places.iter().any(|place| (place - row.at).abs() <= slack);
            found |= row.is_stray;
        }
        found
    }
}
