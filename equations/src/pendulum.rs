//! Double pendulum on a cart, pushed by an unknown force (paper, section 4.1, with its errata corrected).

use nisp::scene_in_both_precisions as scene;

use crate::entry::{Binding, Entry};
use crate::entry::{Given, Series};
use crate::rivals::{Pendulum, System};

/// The pendulum on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "pendulum",
        about: "the force on a cart with two links, from noisy positions and angles",
        scenes: vec![scene::<pendulum::recover::Scene>()],
        data: "data/pendulum/run_07_obs.csv",
        sizes: &[],
        binding: Binding::Series(SERIES),
    }
}

const SERIES: Series = Series {
    data: include_bytes!("../../data/pendulum/run_07_obs.csv"),
    truth: include_bytes!("../../data/pendulum/run_07_truth.csv"),
    columns: &[("q", "q_m_sigma0.01"), ("psi", "psi_rad_sigma0.01"), ("phi", "phi_rad_sigma0.01")],
    truths: &[
        "data/pendulum/run_01_truth.csv",
        "data/pendulum/run_03_truth.csv",
        "data/pendulum/run_05_truth.csv",
        "data/pendulum/run_07_truth.csv",
        "data/pendulum/run_09_truth.csv",
        "data/pendulum/run_11_truth.csv",
        "data/pendulum/run_13_truth.csv",
        "data/pendulum/run_15_truth.csv",
        "data/pendulum/run_17_truth.csv",
        "data/pendulum/run_19_truth.csv",
        "data/pendulum/run_21_truth.csv",
        "data/pendulum/run_23_truth.csv",
    ],
    every: 4,
    rival,
};

/// What classical rivals solve.
fn rival(_scene: &str, given: Given<'_>) -> Option<Box<dyn System>> {
    let [m0, m1, m2, l1, l2, g] = ["m0", "m1", "m2", "l1", "l2", "g"].map(given.parameter);
    Some(Box::new(Pendulum { masses: [m0, m1, m2], lengths: [l1, l2], gravity: g }))
}

nisp::pde! {
    /// A cart with two links, balanced by an unknown force.
    ///
    /// Angles are measured from the upright, counterclockwise positive. The equations are Lagrange's, for point masses
    /// at the ends of massless links; the force acts on the cart.
    pub mod pendulum {
        coordinates:
            /// time
            t [s];
        fields:
            /// position of the cart
            q [m],
            /// angle of the first link
            psi [rad],
            /// angle of the second link
            phi [rad];
        sources:
            /// force on the cart
            f [N];
        parameters:
            /// mass of the cart
            m0 [kg] > 0 = 0.005,
            /// mass at the end of the first link
            m1 [kg] > 0 = 0.005,
            /// mass at the end of the second link
            m2 [kg] > 0 = 0.005,
            /// length of the first link
            l1 [m] > 0 = 0.5,
            /// length of the second link
            l2 [m] > 0 = 0.5,
            /// gravity
            g [m/s^2] = 9.81;

        let h1 = m0 + m1 + m2;
        let h2 = l1 * (m1 + m2);
        let h3 = l2 * m2;
        let h4 = l1^2 * (m1 + m2);
        let h5 = l1 * l2 * m2;
        let h6 = l2^2 * m2;
        let h7 = g * l1 * (m1 + m2);
        let h8 = g * l2 * m2;

        let dpsi = d(psi, t);
        let dphi = d(phi, t);

        on motion {
            cart: h1 * d(q, t, 2)
                - h2 * (d(psi, t, 2) * cos(psi) - dpsi^2 * sin(psi))
                - h3 * (d(phi, t, 2) * cos(phi) - dphi^2 * sin(phi)) == f;
            link_1: h4 * d(psi, t, 2) - h2 * d(q, t, 2) * cos(psi)
                + h5 * (d(phi, t, 2) * cos(psi - phi) + dphi^2 * sin(psi - phi)) == h7 * sin(psi);
            link_2: h6 * d(phi, t, 2) - h3 * d(q, t, 2) * cos(phi)
                + h5 * (d(psi, t, 2) * cos(psi - phi) - dpsi^2 * sin(psi - phi)) == h8 * sin(phi);
        }
        on samples { observe q, psi, phi; }

        /// The force from noisy positions and angles.
        scene recover { }
    }
}
