//! Von Karman's plate: three fields, products of their derivatives.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod karman {
        units: off;
        coordinates: a, b;
        fields: u, v, w;
        sources: f;
        parameters: D = 0.3, C = 1.4, nu = 0.4, p = 2;
        let E_aa = d(u, a) + d(w, a)^2 / 2;
        let E_bb = d(v, b) + d(w, b)^2 / 2;
        let E_ab = (d(u, b) + d(v, a) + d(w, a) * d(w, b)) / 2;
        let N_a = C * (E_aa + nu * E_bb);
        let N_b = C * (E_bb + nu * E_aa);
        let N_ab = C * (1 - nu) * E_ab;
        on interior {
            balance: D * biharmonic(w)
                - (N_a * d(w, a, 2) + 2 * N_ab * d(w, a, b) + N_b * d(w, b, 2)) == p - f;
            inplane_a: d(N_a, a) + d(N_ab, b) == 0;
            inplane_b: d(N_ab, a) + d(N_b, b) == 0;
        }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }
        scene contact { }
    }
}

/// Von Karman's plate: three fields, products of their derivatives.
pub struct Karman;

impl Model for Karman {
    const ORDER: usize = 4;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<karman::contact::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        vec![group("interior", scatter(70, 2, -1.0, 1.5)), group("rim", scatter(19, 2, -1.0, 1.5))]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        if group == "rim" {
            return at.heads.iter().map(|head| head.value()).collect();
        }
        let [d, c, nu] = [0.3, 1.4, 0.4].map(T::of);
        let [u, v, w, f] = [0, 1, 2, 3].map(|head| at.heads[head].clone());
        let half = T::of(0.5);
        let e_aa = u.by(0) + (w.by(0) * w.by(0)).scale(half);
        let e_bb = v.by(1) + (w.by(1) * w.by(1)).scale(half);
        let e_ab = (u.by(1) + v.by(0) + w.by(0) * w.by(1)).scale(half);
        let n_a = (e_aa.clone() + e_bb.clone().scale(nu)).scale(c);
        let n_b = (e_bb + e_aa.scale(nu)).scale(c);
        let n_ab = e_ab.scale(c * (T::of(1.0) - nu));
        let tension = n_a.value() * at.d(2, &[2, 0])
            + T::of(2.0) * n_ab.value() * at.d(2, &[1, 1])
            + n_b.value() * at.d(2, &[0, 2]);
        vec![
            d * w.laplacian(2).laplacian(2).value() - tension - T::of(2.0) + f.value(),
            n_a.by(0).value() + n_ab.by(1).value(),
            n_ab.by(0).value() + n_b.by(1).value(),
        ]
    }
}
