//! The paper's scenes at the paper's sizes, on points that fill their domains evenly.

// In some scenes, which are timed and not solved, nothing is measured; the macro warns of that.
#![allow(deprecated)]

use nisp::{Points, Problem, SceneRef, scene_in_both_precisions as scene};

use crate::support::{group, scatter};

nisp::pde! {
    /// A cart with two links (paper, section 4.1).
    pub mod pendulum {
        coordinates: t [s];
        fields: q [m], psi [rad], phi [rad];
        sources: f [N];
        parameters: m0 [kg] = 0.005, m1 [kg] = 0.005, m2 [kg] = 0.005, l1 [m] = 0.5, l2 [m] = 0.5, g [m/s^2] = 9.81;
        let h1 = m0 + m1 + m2;
        let h2 = l1 * (m1 + m2);
        let h3 = l2 * m2;
        let h4 = l1^2 * (m1 + m2);
        let h5 = l1 * l2 * m2;
        let h6 = l2^2 * m2;
        let h7 = g * l1 * (m1 + m2);
        let h8 = g * l2 * m2;
        on motion {
            cart: h1 * d(q, t, 2)
                - h2 * (d(psi, t, 2) * cos(psi) - d(psi, t)^2 * sin(psi))
                - h3 * (d(phi, t, 2) * cos(phi) - d(phi, t)^2 * sin(phi)) == f;
            link_1: h4 * d(psi, t, 2) - h2 * d(q, t, 2) * cos(psi)
                + h5 * (d(phi, t, 2) * cos(psi - phi) + d(phi, t)^2 * sin(psi - phi)) == h7 * sin(psi);
            link_2: h6 * d(phi, t, 2) - h3 * d(q, t, 2) * cos(phi)
                + h5 * (d(psi, t, 2) * cos(psi - phi) - d(psi, t)^2 * sin(psi - phi)) == h8 * sin(phi);
        }
        on samples { observe q, psi, phi; }
        scene recover { }
    }
}

nisp::pde! {
    /// Soft Bubble membrane (paper, section 4.4).
    pub mod membrane {
        coordinates: alpha [m], beta [m];
        fields: u [m], v [m], w [m];
        sources: f [Pa] >= 0;
        parameters: E [Pa] = 341260, nu = 0.5, t [m] = 4.5e-4, p [Pa] = 5670;
        let D = E * t^3 / (12 * (1 - nu^2));
        let C = E * t / (1 - nu^2);
        let E_aa = d(u, alpha) + d(w, alpha)^2 / 2;
        let E_bb = d(v, beta) + d(w, beta)^2 / 2;
        let E_ab = (d(u, beta) + d(v, alpha) + d(w, alpha) * d(w, beta)) / 2;
        let N_a = C * (E_aa + nu * E_bb);
        let N_b = C * (E_bb + nu * E_aa);
        let N_ab = C * (1 - nu) * E_ab;
        on interior {
            balance: D * biharmonic(w)
                - (N_a * d(w, alpha, 2) + 2 * N_ab * d(w, alpha, beta) + N_b * d(w, beta, 2)) == p - f;
            inplane_a: d(N_a, alpha) + d(N_ab, beta) == 0;
            inplane_b: d(N_ab, alpha) + d(N_b, beta) == 0;
            cloud: chamfer [alpha + u, beta + v, w];
        }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }
        /// As the paper trains it.
        scene contact { }
        /// Its equations and conditions alone.
        scene equations { without interior.cloud; }
    }
}

nisp::pde! {
    /// A sponge on unknown terrain (paper, section 4.3).
    pub mod sponge {
        coordinates: x [m], y [m], z [m];
        fields: u: vector [m];
        sources: f [Pa] >= 0;
        parameters: E [Pa] = 1.1e4, nu = 0.1, rho [kg/m^3] = 20, g: vector [m/s^2] = [0, 0, -9.81];
        let mu = E / (2 * (1 + nu));
        let lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
        let eps = sym(grad(u));
        let sigma = lambda * tr(eps) * I + 2 * mu * eps;
        on volume { balance: div(sigma) + rho * g == 0; }
        on surface { columns: n: vector; traction: sigma * n == -f * n; cloud: chamfer [x + u_x, y + u_y, z + u_z]; }
        on top { held: u == 0; }
        scene contact { }
    }
}

nisp::pde! {
    /// A clamped plate (paper, section 4.5).
    pub mod plate {
        coordinates: x [m], y [m];
        fields: w [m];
        parameters: E [Pa] = 1e9, nu = 0.5, t [m] = 3e-4, p [Pa] = 2757;
        let D = E * t^3 / (12 * (1 - nu^2));
        on interior { balance: D * biharmonic(w) == p; }
        on rim { columns: n: vector; clamped: w == 0; slope: dot(grad(w), n) == 0; }
        scene bend { }
    }
}

/// A column of moderate numbers.
fn wave(count: usize, rate: f64) -> Vec<f64> {
    (0..count).map(|i| (i as f64 * rate).sin()).collect()
}

/// 800 residual points and 1000 measurements.
pub(crate) fn pendulum() -> Problem {
    let mut problem = Problem::new(scene::<pendulum::recover::Scene>());
    group(&mut problem, "motion", scatter(800, &[3.0]), vec![]);
    group(&mut problem, "samples", scatter(1000, &[3.0]), vec![wave(1000, 0.3), wave(1000, 0.2), wave(1000, 0.1)]);
    problem
}

/// 3000 points in the ellipse's box, 200 on the edge, and a cloud of 2000 points on a bulge over the box, none of which is
/// where a point of the surface is.
pub(crate) fn membrane() -> Problem {
    let mut problem = membrane_on(scene::<membrane::contact::Scene>(), 3000);
    let bulge = |at: &[f64; 2]| 0.02 * (at[0] * 26.0).sin() * (at[1] * 39.0).sin();
    let seen = scatter(2000, &[0.119, 0.079]).coordinates;
    let cloud = seen.as_chunks().0.iter().flat_map(|at: &[f64; 2]| [at[0], at[1], bulge(at)]).collect();
    problem.set_cloud("interior", "cloud", cloud).expect("a term of the scene");
    problem
}

/// Equations at `points` in the ellipse's box, and conditions at 200 on the edge.
pub(crate) fn membrane_equations(points: usize) -> Problem {
    membrane_on(scene::<membrane::equations::Scene>(), points)
}

fn membrane_on(scene: SceneRef, points: usize) -> Problem {
    let mut problem = Problem::new(scene);
    group(&mut problem, "interior", scatter(points, &[0.12, 0.08]), vec![]);
    group(&mut problem, "rim", scatter(200, &[0.12, 0.08]), vec![]);
    problem
}

/// 5000 points in the cube, 1500 for its surface, and a cloud of as many, none of which is where a point of the surface is.
pub(crate) fn sponge() -> Problem {
    let mut problem = Problem::new(scene::<sponge::contact::Scene>());
    group(&mut problem, "volume", scatter(5000, &[0.046; 3]), vec![]);
    let normals = vec![wave(1500, 0.3), wave(1500, 0.7), wave(1500, 1.1)];
    group(&mut problem, "surface", scatter(1500, &[0.046; 3]), normals);
    problem.set_cloud("surface", "cloud", scatter(1500, &[0.0455; 3]).coordinates).expect("a term of the scene");
    group(&mut problem, "top", Points::from(vec![0.01, 0.02, 0.046]), vec![]);
    problem
}

/// 10000 points in the disc's box, 1000 on its edge.
pub(crate) fn plate() -> Problem {
    let mut problem = Problem::new(scene::<plate::bend::Scene>());
    group(&mut problem, "interior", scatter(10_000, &[0.08, 0.08]), vec![]);
    group(&mut problem, "rim", scatter(1000, &[0.08, 0.08]), vec![wave(1000, 0.3), wave(1000, 1.7)]);
    problem
}
