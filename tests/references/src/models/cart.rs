//! A pendulum on a cart, two equations of the second order that are linked.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod cart {
        units: off;
        coordinates: t;
        fields: q, psi;
        sources: f;
        parameters: m = 0.7, h = 0.4, g = 9.81;
        on motion {
            cart: m * d(q, t, 2) - h * (d(psi, t, 2) * cos(psi) - d(psi, t)^2 * sin(psi)) == f;
            link: h * d(psi, t, 2) - m * d(q, t, 2) * cos(psi) == h * g * sin(psi);
        }
        on samples { columns: late; observe q, psi; observe later: q + psi ~ late; }
        scene recover { }
    }
}

/// A pendulum on a cart, two equations of the second order that are linked.
pub struct Cart;

impl Model for Cart {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<cart::recover::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let columns = vec![wave(37, 0.3), wave(37, 0.2), wave(37, 0.5)];
        vec![group("motion", scatter(101, 1, 0.5, 3.5)), Data { columns, ..group("samples", scatter(37, 1, 0.5, 3.5)) }]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [q, psi, f] = [0, 1, 2].map(|head| at.heads[head].value());
        if group == "samples" {
            // Columns in the scene's order: declared, then observed.
            return vec![q - T::of(at.columns[1]), psi - T::of(at.columns[2]), q + psi - T::of(at.columns[0])];
        }
        let [m, h, g] = [0.7, 0.4, 9.81].map(T::of);
        let (q_tt, psi_t, psi_tt) = (at.d(0, &[2]), at.d(1, &[1]), at.d(1, &[2]));
        vec![
            m * q_tt - h * (psi_tt * psi.cos() - psi_t * psi_t * psi.sin()) - f,
            h * psi_tt - m * q_tt * psi.cos() - h * g * psi.sin(),
        ]
    }
}
