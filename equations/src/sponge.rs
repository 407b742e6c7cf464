//! A soft cube on unknown terrain: linear elasticity with contact (paper, section 4.3).

use nisp::scene_in_both_precisions as scene;

use crate::bodies;
use crate::entry::{Binding, Entry};

/// The sponge on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "sponge",
        about: "the contact pressure on a soft cube pressed on unknown terrain, from a point cloud and a wrench",
        scenes: vec![
            scene::<sponge::unknown_terrain::Scene>(),
            scene::<sponge::known_terrain::Scene>(),
            scene::<sponge::displacement::Scene>(),
        ],
        data: "data/sponge/plane_1.toml",
        sizes: bodies::SIDE,
        binding: Binding::Cloud(bodies::prepare_sponge),
    }
}

nisp::pde! {
    /// A cube held at its top face. The contact pressure `f` presses along the terrain's normal, as terrain without friction does:
    /// where it touches, that is the normal of the deformed face. Pressure `q` is a field of its own, so that nothing locks as `nu`
    /// approaches one half: `q / lambda` stays finite.
    pub mod sponge {
        coordinates:
            /// place at rest
            x [m],
            /// place at rest
            y [m],
            /// place at rest, upwards; 0 at the top face
            z [m];
        fields:
            /// displacement
            u: vector [mm],
            /// pressure in the sponge, `-lambda tr(eps)`
            q [Pa];
        sources:
            /// contact pressure
            f [Pa] >= 0;
        parameters:
            /// Young's modulus
            E [Pa] > 0 = 1.1e4,
            /// Poisson's ratio
            nu in 0 .. 0.5 = 0.1,
            /// density
            rho [kg/m^3] >= 0 = 35,
            /// gravity
            g: vector [m/s^2] = [0, 0, -9.81],
            /// force of the terrain on the sponge
            force: vector [N],
            /// torque of the terrain on the sponge about the origin, with arms at rest
            torque: vector [N m];

        let mu = E / (2 * (1 + nu));
        // 1 / lambda, which vanishes at nu = 1/2
        let compliance = (1 + nu) * (1 - 2 * nu) / (E * nu);
        let eps = sym(grad(u));
        let sigma = 2 * mu * eps - q * I;
        let sigma_of_u = 2 * mu * eps + tr(eps) / compliance * I;

        on volume {
            balance: div(sigma) + rho * g == 0;
            /// equilibrium in displacements alone
            balance_of_u: div(sigma_of_u) + rho * g == 0;
            /// the sponge's volume answers its pressure
            volume_change: tr(eps) + compliance * q == 0;
        }
        on bottom {
            columns:
                /// outward normal at rest
                n: vector [1],
                /// the terrain's normal, out of it
                m: vector [1],
                /// distance of the terrain at rest, along `m`
                clearance [m];
            // The normal of the deformed face, into the sponge.
            let across = cross(d([x, y, z] + u, x), d([x, y, z] + u, y));
            let inwards = across / sqrt(dot(across, across));
            traction: sigma * n == f * inwards;
            traction_of_u: sigma_of_u * n == f * inwards;
            contact: 0 <= f _|_ clearance + dot(m, u) >= 0;
            force_balance: integral(f * inwards) == force;
            torque_balance: integral(cross([x, y, z], f * inwards)) == torque;
        }
        /// nothing touches them
        on sides {
            columns:
                /// outward normal at rest
                n: vector [1];
            free: sigma * n == 0;
            free_of_u: sigma_of_u * n == 0;
        }
        on surface { cloud: chamfer [x, y, z] + u; }
        on top { held: u == 0; }

        /// The contact pressure on unknown terrain, from a cloud of the sides and the wrist's wrench.
        scene unknown_terrain {
            without bottom.contact, volume.balance_of_u, bottom.traction_of_u, sides.free_of_u;
        }
        /// The contact pressure on known terrain: it presses or stands off, never both.
        scene known_terrain { without volume.balance_of_u, bottom.traction_of_u, sides.free_of_u; }
        /// As `unknown_terrain`, in displacements alone: a field less, and locking as `nu` approaches one half.
        scene displacement {
            q = 0;
            without bottom.contact, volume.balance, volume.volume_change, bottom.traction, sides.free;
        }
    }
}
