//! A circuit whose voltage answers a driving voltage and its rate (paper, section 4.2).

#![allow(deprecated, reason = "scene `free` leaves the source under a null space on purpose")]

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
