//! An inflated rubber surface whose strains and slopes are large, pressed by an unknown object: a soft-bubble sensor.

use nisp::scene_in_both_precisions as scene;

use crate::catalogue::{Binding, Entry};
use crate::contact;

/// The bubble on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "bubble",
        about: "the contact pressure on a soft bubble with large strains, or its modulus, from a point cloud",
        scenes: vec![
            scene::<bubble::contact::Scene>(),
            scene::<bubble::identify::Scene>(),
        ],
        data: "data/membrane_large/large_sphere_d35.toml",
        binding: Binding::Cloud(contact::prepare_bubble),
    }
}

nisp::pde! {
    /// A membrane in space with full Green strains. A point at rest at `(alpha, beta, 0)` moves to
    /// `(alpha + u, beta + v, w)`. The gas and what touches the bubble press along its deformed normal; both pressures
    /// are per deformed area.
    pub mod bubble {
        coordinates:
            /// place at rest, along the long axis
            alpha [m],
            /// place at rest, along the short axis
            beta [m];
        fields:
            /// displacement along `alpha`
            u [mm],
            /// displacement along `beta`
            v [mm],
            /// height
            w [mm];
        sources:
            /// contact pressure over the deformed area
            f [Pa] >= 0;
        parameters:
            /// Young's modulus
            E [Pa] in 1e4 .. 1e7 = 341260,
            /// Poisson's ratio
            nu in 0 .. 0.5 = 0.5,
            /// thickness
            t [mm] > 0 = 0.45,
            /// gauge pressure
            p [Pa];

        let C = E * t / (1 - nu^2);
        let x_a = 1 + d(u, alpha);
        let y_a = d(v, alpha);
        let z_a = d(w, alpha);
        let x_b = d(u, beta);
        let y_b = 1 + d(v, beta);
        let z_b = d(w, beta);
        let E_aa = (x_a^2 + y_a^2 + z_a^2 - 1) / 2;
        let E_bb = (x_b^2 + y_b^2 + z_b^2 - 1) / 2;
        let E_ab = (x_a * x_b + y_a * y_b + z_a * z_b) / 2;
        let S_aa = C * (E_aa + nu * E_bb);
        let S_bb = C * (E_bb + nu * E_aa);
        let S_ab = C * (1 - nu) * E_ab;
        let n_x = y_a * z_b - z_a * y_b;
        let n_y = z_a * x_b - x_a * z_b;
        let n_z = x_a * y_b - y_a * x_b;

        on interior {
            balance_x: d(S_aa * x_a + S_ab * x_b, alpha) + d(S_ab * x_a + S_bb * x_b, beta) + (p - f) * n_x == 0;
            balance_y: d(S_aa * y_a + S_ab * y_b, alpha) + d(S_ab * y_a + S_bb * y_b, beta) + (p - f) * n_y == 0;
            balance_z: d(S_aa * z_a + S_ab * z_b, alpha) + d(S_ab * z_a + S_bb * z_b, beta) + (p - f) * n_z == 0;
        }
        on surface { cloud: chamfer [alpha + u, beta + v, w]; }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }

        /// The contact pressure, from a cloud of the pressed bubble.
        scene contact { }
        /// Young's modulus, from a cloud of the inflated bubble that nothing touches.
        scene identify { f = 0; learn E; without rim.no_contact; }
    }
}
