//! An inflated rubber surface whose strains and slopes are large, pressed by an unknown object: a soft-bubble sensor.

use nisp::scene;

use crate::bodies;
use crate::entry::{Binding, Entry};

/// The bubble on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "bubble",
        about: "the contact pressure on a soft bubble with large strains, or its modulus, from a point cloud",
        scenes: vec![
            scene::<bubble::contact::Scene>(),
            scene::<bubble::identify::Scene>(),
            scene::<bubble::contact_rubber::Scene>(),
            scene::<bubble::identify_rubber::Scene>(),
            scene::<bubble::calibrate::Scene>(),
            scene::<bubble::calibrate_rubber::Scene>(),
        ],
        data: "data/membrane_large/large_sphere_d35.toml",
        sizes: bodies::SEMI_AXES,
        binding: Binding::Cloud(bodies::prepare_bubble),
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
            p [Pa],
            /// stretch that the membrane has at rest over its rim
            stretch > 0 = 1,
            /// semi-axis along `alpha` over the one that was given
            widen_a in 0.5 .. 2 = 1,
            /// semi-axis along `beta` over the one that was given
            widen_b in 0.5 .. 2 = 1,
            /// where the rim's middle is in the cloud's frame, along x
            shift_x [mm] = 0,
            /// the same along y
            shift_y [mm] = 0,
            /// the same along z
            shift_z [mm] = 0,
            /// turn of the rim in the cloud's frame, about x first
            turn_x [rad] = 0,
            /// then about y
            turn_y [rad] = 0,
            /// then about z
            turn_z [rad] = 0;

        // Slopes of the place on the surface, and the metric: over the rim that was given, widened.
        let x_a = 1 + d(u, alpha) / widen_a;
        let y_a = d(v, alpha) / widen_a;
        let z_a = d(w, alpha) / widen_a;
        let x_b = d(u, beta) / widen_b;
        let y_b = 1 + d(v, beta) / widen_b;
        let z_b = d(w, beta) / widen_b;
        let C_aa = stretch^2 * (x_a^2 + y_a^2 + z_a^2);
        let C_bb = stretch^2 * (x_b^2 + y_b^2 + z_b^2);
        let C_ab = stretch^2 * (x_a * x_b + y_a * y_b + z_a * z_b);
        // The normal, as long as the deformed area over that at rest.
        let n_x = y_a * z_b - z_a * y_b;
        let n_y = z_a * x_b - x_a * z_b;
        let n_z = x_a * y_b - y_a * x_b;

        on interior {
            // The linear law in Green's strains (St. Venant-Kirchhoff): second Piola-Kirchhoff forces.
            let stiffness = E * t / (1 - nu^2) / 2;
            let S_aa = stiffness * (C_aa - 1 + nu * (C_bb - 1));
            let S_bb = stiffness * (C_bb - 1 + nu * (C_aa - 1));
            let S_ab = stiffness * (1 - nu) * C_ab;
            balance_x: d(S_aa * x_a + S_ab * x_b, alpha) / widen_a + d(S_ab * x_a + S_bb * x_b, beta) / widen_b
                + (p - f) * n_x == 0;
            balance_y: d(S_aa * y_a + S_ab * y_b, alpha) / widen_a + d(S_ab * y_a + S_bb * y_b, beta) / widen_b
                + (p - f) * n_y == 0;
            balance_z: d(S_aa * z_a + S_ab * z_b, alpha) / widen_a + d(S_ab * z_a + S_bb * z_b, beta) / widen_b
                + (p - f) * n_z == 0;
            // Incompressible rubber (neo-Hooke), whose thickness shrinks as its area grows.
            let shear = E * t / 3;
            let det = C_aa * C_bb - C_ab^2;
            let R_aa = shear * (1 - C_bb / det^2);
            let R_bb = shear * (1 - C_aa / det^2);
            let R_ab = shear * C_ab / det^2;
            rubber_x: d(R_aa * x_a + R_ab * x_b, alpha) / widen_a + d(R_ab * x_a + R_bb * x_b, beta) / widen_b
                + (p - f) * n_x == 0;
            rubber_y: d(R_aa * y_a + R_ab * y_b, alpha) / widen_a + d(R_ab * y_a + R_bb * y_b, beta) / widen_b
                + (p - f) * n_y == 0;
            rubber_z: d(R_aa * z_a + R_ab * z_b, alpha) / widen_a + d(R_ab * z_a + R_bb * z_b, beta) / widen_b
                + (p - f) * n_z == 0;
        }
        on surface {
            // The place on the surface, in the cloud's frame.
            let x = widen_a * alpha + u;
            let y = widen_b * beta + v;
            let y_x = y * cos(turn_x) - w * sin(turn_x);
            let z_x = y * sin(turn_x) + w * cos(turn_x);
            let x_y = x * cos(turn_y) + z_x * sin(turn_y);
            let z_y = z_x * cos(turn_y) - x * sin(turn_y);
            let x_c = x_y * cos(turn_z) - y_x * sin(turn_z) + shift_x;
            let y_c = x_y * sin(turn_z) + y_x * cos(turn_z) + shift_y;
            let z_c = z_y + shift_z;
            cloud: chamfer [x_c, y_c, z_c];
            free: chamfer [x_c, y_c, z_c] within 1 [mm];
        }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }

        /// The contact pressure, from a cloud of the pressed bubble.
        scene contact {
            without interior.rubber_x; without interior.rubber_y; without interior.rubber_z; without surface.free;
        }
        /// Young's modulus, from a cloud of the inflated bubble that nothing touches.
        scene identify {
            f = 0;
            learn E;
            without interior.rubber_x; without interior.rubber_y; without interior.rubber_z; without surface.free;
            without rim.no_contact;
        }
        /// The contact pressure on rubber (neo-Hookean, incompressible).
        scene contact_rubber {
            without interior.balance_x; without interior.balance_y; without interior.balance_z; without surface.free;
        }
        /// Young's modulus of rubber (neo-Hookean, incompressible).
        scene identify_rubber {
            f = 0;
            learn E;
            without interior.balance_x; without interior.balance_y; without interior.balance_z; without surface.free;
            without rim.no_contact;
        }
        /// Modulus, stretch at rest, semi-axes and pose of the rim, from clouds of the inflated bubble that nothing touches.
        scene calibrate {
            f = 0;
            learn E, stretch within 0.1, widen_a within 0.03, widen_b within 0.03, shift_x within 2, shift_y within 2, shift_z within 2,
                turn_x within 0.03, turn_y within 0.03, turn_z within 0.03;
            without interior.rubber_x; without interior.rubber_y; without interior.rubber_z; without surface.cloud;
            without rim.no_contact;
        }
        /// Modulus, stretch at rest, semi-axes and pose of the rim of a bubble of rubber (neo-Hookean, incompressible).
        scene calibrate_rubber {
            f = 0;
            learn E, stretch within 0.1, widen_a within 0.03, widen_b within 0.03, shift_x within 2, shift_y within 2, shift_z within 2,
                turn_x within 0.03, turn_y within 0.03, turn_z within 0.03;
            without interior.balance_x; without interior.balance_y; without interior.balance_z; without surface.cloud;
            without rim.no_contact;
        }
    }
}
