//! Points in pairs, whose equations read both.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod ring {
        units: off;
        coordinates: x, y;
        fields: u, v;
        parameters: k = 0.8;
        on inside { balance: laplacian(u) + k * v == sin(x); }
        on seam pairs {
            columns: jump;
            value: u == partner(u) + jump * v, v == k * partner(v);
            slope: d(u, x) == partner(d(u, x)) * partner(x);
        }
        scene wrap { learn k; }
    }
}

/// Points in pairs, whose equations read both.
pub struct Ring;

impl Model for Ring {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<ring::wrap::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let left: Vec<f64> = (0..23).flat_map(|i| [-1.0, i as f64 * 0.1]).collect();
        let right = left.chunks_exact(2).flat_map(|p| [1.0, p[1] + 0.05]).collect();
        let seam = Data { partners: right, columns: vec![wave(23, 0.4)], ..group("seam", left) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), seam]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        vec![T::of(0.8) * theta[0].exp()]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [u, v] = [0, 1].map(|head| at.heads[head].clone());
        if group == "inside" {
            return vec![u.laplacian(2).value() + at.learned[0] * v.value() - T::of(at.x[0].sin())];
        }
        let [u_far, v_far] = [0, 1].map(|head| at.partner[head].clone());
        vec![
            u.value() - u_far.value() - T::of(at.columns[0]) * v.value(),
            v.value() - at.learned[0] * v_far.value(),
            // Partners lie on the line x = 1.
            u.by(0).value() - u_far.by(0).value(),
        ]
    }
}
