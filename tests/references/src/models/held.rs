//! A field that is what it has to be on a boundary.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod held {
        units: off;
        coordinates: x, y;
        fields: w;
        sources: s;
        hard w = x * y by 1 - x^2 - y^2;
        on inside { balance: laplacian(w) == s; }
        on samples { observe w; }
        scene solve { }
    }
}

/// A field that is what it has to be on a boundary.
pub struct Held;

impl Model for Held {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<held::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let samples = Data { columns: vec![wave(25, 0.6)], ..group("samples", scatter(25, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), samples]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [x, y] = [0, 1].map(|i| T::of(at.x[i]));
        let distance = T::of(1.0) - x * x - y * y;
        let inner = &at.heads[0];
        if group == "samples" {
            return vec![x * y + distance * inner.value() - T::of(at.columns[0])];
        }
        // The product rule, by hand; x y is harmonic.
        let along = x * inner.by(0).value() + y * inner.by(1).value();
        let laplacian = distance * inner.laplacian(2).value() - T::of(4.0) * (along + inner.value());
        vec![laplacian - at.heads[1].value()]
    }
}
