nisp::pde! {
    mod erratum_h7_without_l1 {
        coordinates: t [s];
        fields: q [m], psi [rad], phi [rad];
        parameters: m1 [kg], m2 [kg], l1 [m], l2 [m], g [m/s^2];
        let h2 = l1 * (m1 + m2);
        let h4 = l1^2 * (m1 + m2);
        let h5 = l1 * l2 * m2;
        let h7 = g * (m1 + m2);
        on motion {
            link1: h2 * d(q, t, 2) * cos(psi) + h4 * d(psi, t, 2)
                + h5 * (d(phi, t, 2) * cos(psi - phi) + d(phi, t)^2 * sin(psi - phi)) - h7 * sin(psi) == 0;
        }
        on samples { observe q, psi, phi; }
    }
}

fn main() {}
