//! Fields and sources of some of the coordinates.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod partial {
        units: off;
        coordinates: x, t;
        fields: u, a(x);
        sources: r(t), c;
        on inside { balance: d(u, t) + d(a, t) == d(a * d(u, x), x) + r * c + d(r, t); }
        on seam pairs { both: a == r * partner(a) + partner(r * u); }
        on probes { observe u; }
        scene solve { }
    }
}

/// Fields and sources of some of the coordinates.
pub struct Partial;

impl Model for Partial {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<partial::solve::Scene>()
    }
    fn held(&self, head: usize) -> &'static [usize] {
        [&[] as &[usize], &[1], &[0], &[]][head]
    }
    fn groups(&self) -> Vec<Data> {
        let seam = Data { partners: scatter(17, 2, -0.8, 0.9), ..group("seam", scatter(17, 2, -1.0, 1.5)) };
        let probes = Data { columns: vec![wave(25, 0.6)], ..group("probes", scatter(25, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), seam, probes]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [u, a, r, c] = [0, 1, 2, 3].map(|head| at.heads[head].clone());
        match group {
            "probes" => vec![u.value() - T::of(at.columns[0])],
            "seam" => {
                let [far_u, far_a, far_r] = [0, 1, 2].map(|head| at.partner[head].value());
                vec![a.value() - r.value() * far_a - far_r * far_u]
            }
            // The product rule, by hand: `a` has no derivative by time.
            _ => {
                let flux = a.by(0).value() * u.by(0).value() + a.value() * at.d(0, &[2, 0]);
                vec![u.by(1).value() - flux - r.value() * c.value() - r.by(1).value()]
            }
        }
    }
}
