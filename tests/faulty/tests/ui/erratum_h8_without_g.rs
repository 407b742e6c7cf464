nisp::pde! {
    mod erratum_h8_without_g {
        coordinates: t [s];
        fields: q [m], psi [rad], phi [rad];
        parameters: m2 [kg], l1 [m], l2 [m];
        let h3 = l2 * m2;
        let h5 = l1 * l2 * m2;
        let h6 = l2^2 * m2;
        let h8 = l2 * m2;
        on motion {
            link2: h3 * d(q, t, 2) * cos(phi) + h5 * (d(psi, t, 2) * cos(psi - phi) - d(psi, t)^2 * sin(psi - phi))
                + h6 * d(phi, t, 2) - h8 * sin(phi) == 0;
        }
        on samples { observe q, psi, phi; }
    }
}

fn main() {}
