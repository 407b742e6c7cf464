//! An inflated elliptical membrane, pressed by an unknown object (paper, section 4.4).

use nisp::scene_in_both_precisions as scene;

use crate::bodies;
use crate::entry::{Binding, Entry};

/// The membrane on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "membrane",
        about: "the contact pressure on an inflated membrane, or its modulus, from a point cloud",
        scenes: vec![
            scene::<membrane::contact::Scene>(),
            scene::<membrane::identify::Scene>(),
            scene::<membrane::contact_no_inplane::Scene>(),
            scene::<membrane::identify_no_inplane::Scene>(),
            scene::<membrane::contact_bending::Scene>(),
            scene::<membrane::identify_bending::Scene>(),
            scene::<membrane::identify_unknown_pressure::Scene>(),
        ],
        data: "data/membrane/y_shape_1.toml",
        sizes: bodies::SEMI_AXES,
        binding: Binding::Cloud(bodies::prepare_membrane),
    }
}

nisp::pde! {
    /// Von Karman's plate: small strains, finite slopes. A point at rest at `(alpha, beta, 0)` moves to
    /// `(alpha + u, beta + v, w)`; `f` is the contact pressure over the area at rest.
    pub mod membrane {
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
            /// contact pressure
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

        let D = E * t^3 / (12 * (1 - nu^2));
        let C = E * t / (1 - nu^2);
        let E_aa = d(u, alpha) + d(w, alpha)^2 / 2;
        let E_bb = d(v, beta) + d(w, beta)^2 / 2;
        let E_ab = (d(u, beta) + d(v, alpha) + d(w, alpha) * d(w, beta)) / 2;
        let N_a = C * (E_aa + nu * E_bb);
        let N_b = C * (E_bb + nu * E_aa);
        let N_ab = C * (1 - nu) * E_ab;
        let tension = N_a * d(w, alpha, 2) + 2 * N_ab * d(w, alpha, beta) + N_b * d(w, beta, 2);

        on interior {
            /// a membrane: bending matters within a quarter of a millimetre of rims, the length `sqrt(D / N)`
            balance: -tension == p - f;
            /// the plate, bending included
            bending: D * biharmonic(w) - tension == p - f;
            /// no friction: in-plane forces balance
            inplane_a: d(N_a, alpha) + d(N_ab, beta) == 0;
            inplane_b: d(N_ab, alpha) + d(N_b, beta) == 0;
        }
        on surface { cloud: chamfer [alpha + u, beta + v, w]; }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }

        /// The contact pressure, from a cloud of the pressed membrane.
        scene contact { without interior.bending; }
        /// Young's modulus, from a cloud of the inflated membrane that nothing touches.
        scene identify { f = 0; learn E; without interior.bending, rim.no_contact; }
        /// The contact pressure without in-plane equilibrium, as the paper has it: the cloud alone ties down `u` and `v`.
        scene contact_no_inplane { without interior.bending, interior.inplane_a, interior.inplane_b; }
        /// Young's modulus without in-plane equilibrium.
        scene identify_no_inplane {
            f = 0; learn E; without interior.bending, interior.inplane_a, interior.inplane_b, rim.no_contact;
        }
        /// The contact pressure of a membrane that resists bending: fourth derivatives.
        scene contact_bending { without interior.balance; }
        /// Young's modulus of a membrane that resists bending.
        scene identify_bending { f = 0; learn E; without interior.balance, rim.no_contact; }
        /// Young's modulus of a membrane whose gauge pressure nobody has measured: not enough to determine both.
        scene identify_unknown_pressure { f = 0; learn E, p; without interior.bending, rim.no_contact; }
    }
}
