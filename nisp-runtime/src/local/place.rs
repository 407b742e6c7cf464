//! Where a run on a lattice stands, and that as plain numbers.

use super::METHOD;
use super::surface::Feet;
use crate::solve::fault::Fault;
use crate::solve::state;

/// An iterate: coefficients, parameters of learned scalars, and the noise of the clouds.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) theta: Vec<f64>,
    pub(super) learned: Vec<f64>,
    pub(super) noise: f64,
    /// The noise in other directions than a cloud's view, as a share of that along it.
    pub(super) across: f64,
    /// Numbers of the clouds that the answer has used up: the trace of its influence matrix.
    pub(super) used: f64,
    /// Stiffness against the next step.
    pub(super) damping: f64,
    /// The least sum of squares in this phase; what a step may lead up to is measured by it.
    pub(super) lowest: f64,
    /// Which coefficients the next step may move.
    pub(super) free: Vec<bool>,
}

impl State {
    /// The state that lies at `share` of the way to `other`.
    pub(super) fn towards(&self, other: &State, share: f64) -> State {
        let between = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
        State {
            theta: between(&self.theta, &other.theta),
            learned: between(&self.learned, &other.learned),
            ..self.clone()
        }
    }
}

/// Everything that the next step follows from.
pub(crate) struct Place {
    pub(super) state: State,
    /// Steps on this lattice before.
    pub(super) step: u64,
    /// Steps of the schedule that are left out.
    pub(super) skipped: u64,
    /// Feet of the surfaces.
    pub(super) feet: Vec<Feet>,
}

impl Place {
    /// As plain numbers, with the number of the lattice and of the steps on lattices before.
    pub(super) fn save(&self, before: u64, lattice: u64) -> state::State {
        let mut saved = state::State::new(METHOD)
            .with("theta", &self.state.theta)
            .with("learned", &self.state.learned)
            .with(
                "noise",
                &[self.state.noise, self.state.across, self.state.used, self.state.damping, self.state.lowest],
            )
            .with("free", &self.state.free.iter().map(|free| f64::from(u8::from(*free))).collect::<Vec<f64>>())
            .with_counter("lattice", lattice)
            .with_counter("before", before)
            .with_counter("step", self.step)
            .with_counter("iterations", before + self.step);
        for (at, feet) in self.feet.iter().enumerate() {
            let nearest: Vec<f64> = feet.nearest.iter().map(|&n| n as f64).collect();
            saved = saved.with(&format!("feet {at}"), &feet.feet).with(&format!("nearest {at}"), &nearest);
        }
        saved
    }

    /// Takes over what [`Place::save`] gave, on a lattice of the same size.
    pub(super) fn restore(&mut self, saved: &state::State) -> Result<(), Fault> {
        let State { theta, learned, noise, across, used, damping, lowest, free } = &mut self.state;
        *theta = saved.sized("theta", theta.len())?;
        *learned = saved.sized("learned", learned.len())?;
        [*noise, *across, *used, *damping, *lowest] = saved.scalars("noise")?;
        let marks: Vec<f64> = saved.sized("free", free.len())?;
        *free = marks.iter().map(|&mark| mark != 0.0).collect();
        self.step = saved.counter("step")?;
        for (at, feet) in self.feet.iter_mut().enumerate() {
            let nearest: Vec<f64> = saved.sized(&format!("nearest {at}"), feet.nearest.len())?;
            feet.feet = saved.vector(&format!("feet {at}"))?.to_vec();
            feet.nearest = nearest.iter().map(|&n| n as usize).collect();
        }
        Ok(())
    }
}
