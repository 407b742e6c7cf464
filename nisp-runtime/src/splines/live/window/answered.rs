//! The rows of a cell whose rows have all been answered, and how they change with given numbers.

use super::Window;
use crate::facts::LARGER;
use crate::given::{SMALL, slope};
use crate::solve::fault::Fault;
use crate::splines::group::Group;
use crate::splines::live::event::Event;
use crate::splines::triangle::Row;

/// How much larger sources may be than the stretch says, where rows say what given numbers are. What a prior smooths away adds up along a
/// record, as what rows say of the numbers does: sources may be larger than for a whole record ([`LARGER`]).
const FREER: f64 = LARGER * LARGER;

impl Window {
    /// Gives the rows of a cell about the reference, each with its derivatives by given numbers. Priors are those of larger sources about the
    /// present state: they say nothing of the numbers, and let unknowns follow them.
    pub(in super::super) fn rows_of_cell(
        &self,
        cell: usize,
        events: &[&Event],
        given: &[usize],
        take: &mut dyn FnMut(Row<'_>, &[f64]),
    ) -> Result<(), Fault> {
        let schema = self.bound.problem.scene().schema;
        let place = [cell as f64 * self.grid.width];
        for (at, _) in self.equations.iter().filter(|_| self.grid.has_equation(cell)) {
            let mut group = Group::new(&schema.groups[*at], self.kernels[*at], &self.heads, &place, &[]);
            group.begin_at(&place, self.grid.left());
            self.rows_by(((*at, &group), &[]), cell, given, take)?;
        }
        for at in 0..schema.groups.len() {
            let own: Vec<&Event> = events.iter().filter(|event| event.group == at).copied().collect();
            if !own.is_empty() {
                self.rows_by(((at, &self.group_of(at, &own)), &own), cell, given, take)?;
            }
        }
        let about: Vec<f64> = self.reference.iter().zip(&self.theta).map(|(about, own)| about - own).collect();
        let none = vec![0.0; given.len()];
        self.priors((cell, cell + 1), FREER, &about, &mut |_, row| take(row, &none));
        Ok(())
    }

    /// Gives the rows of a group on a cell.
    fn rows_by(
        &self,
        (group, events): ((usize, &Group), &[&Event]),
        cell: usize,
        given: &[usize],
        take: &mut dyn FnMut(Row<'_>, &[f64]),
    ) -> Result<(), Fault> {
        let mut scalars = self.weights.scalars.clone();
        let mut with = |slot: usize, share: f64| {
            let own = std::mem::replace(&mut scalars[slot], self.weights.scalars[slot] * (1.0 + share));
            let found = group.1.evaluate(&self.heads, &self.theta, &scalars, None);
            scalars[slot] = own;
            found
        };
        let changed: Vec<_> = given.iter().map(|&slot| (with(slot, SMALL), with(slot, -SMALL))).collect();
        let places: Vec<(usize, usize)> = (0..group.1.len()).map(|p| (p, cell)).collect();
        let mut by = vec![0.0; given.len()];
        self.rows_of(group, &places, events, &mut |asked| {
            for (by, (more, less)) in by.iter_mut().zip(&changed) {
                let row = |found: &crate::splines::group::Evaluated| found.row(asked.number, asked.p);
                *by = asked.factor * slope((row(more), row(less)));
            }
            take(asked.row, &by);
        })
    }
}
