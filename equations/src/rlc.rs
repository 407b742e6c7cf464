//! A circuit whose voltage answers a driving voltage and its rate (paper, section 4.2).

#![allow(deprecated, reason = "scene `free` leaves the source under a null space on purpose")]

use nisp::scene_in_both_precisions as scene;

use crate::entry::{Binding, Entry};
use crate::entry::{Given, Series};
use crate::rivals::{Rlc, System};

/// The circuit on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "rlc",
        about: "the voltage that drives a circuit, from the voltage that answers",
        scenes: vec![scene::<rlc::recover::Scene>(), scene::<rlc::free::Scene>()],
        data: "data/rlc/rlc_exponential.csv",
        sizes: &[],
        binding: Binding::Series(SERIES),
    }
}

const SERIES: Series = Series {
    data: include_bytes!("../../data/rlc/rlc_exponential.csv"),
    truth: include_bytes!("../../data/rlc/rlc_exponential.csv"),
    columns: &[("v", "v_V")],
    truths: &["data/rlc/rlc_exponential.csv"],
    every: 3,
    rival,
};

/// What classical rivals solve: they need the source at the start.
fn rival(scene: &str, given: Given<'_>) -> Option<Box<dyn System>> {
    let [damping, stiffness, rate_gain, gain, source_at_start] = ["a", "b", "c", "e", "f0"].map(given.parameter);
    let system = Rlc { damping, stiffness, rate_gain, gain, start: given.start, source_at_start };
    (scene == "recover").then(|| Box::new(system) as Box<dyn System>)
}

nisp::pde! {
    /// `v'' + a v' + b v = c f' + e f`: the driving voltage enters with its derivative, so that the data determine it only
    /// up to `exp(-e t / c)`; its value at the start settles the rest.
    pub mod rlc {
        coordinates:
            /// time
            t [s];
        fields:
            /// measured voltage
            v [V];
        sources:
            /// driving voltage
            f [V];
        parameters:
            /// damping
            a [1/s] = 7,
            /// stiffness
            b [1/s^2] = 10,
            /// weight of the driving voltage's rate
            c [1/s] = 1,
            /// weight of the driving voltage
            e [1/s^2] = 6,
            /// driving voltage at the start
            f0 [V] = 6;

        on circuit { balance: d(v, t, 2) + a * d(v, t) + b * v == c * d(f, t) + e * f; }
        on samples { observe v; }
        on start { known: f == f0; }

        /// The driving voltage, its value at the start being known.
        scene recover { }
        /// The driving voltage without any condition on it: determined up to `exp(-e t / c)`.
        scene free { without start.known; }
    }
}
