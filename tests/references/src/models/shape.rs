//! A surface and its cloud.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod shape {
        units: off;
        coordinates: a, b;
        fields: u, w;
        on patch {
            cloud: symmetric chamfer [a + u, b + u * w, w] with huber(0.3) weight 2;
            flat: laplacian(w) == 0;
        }
        on line { cloud: chamfer [a + w, u] with tukey(0.9); }
        scene fit { }
    }
}

/// A surface and its cloud.
pub struct Shape;

impl Model for Shape {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<shape::fit::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        // More and fewer points than the surfaces have, some far away.
        vec![
            Data { cloud: scatter(130, 3, -0.6, 1.7), ..group("patch", scatter(48, 2, 0.0, 1.0)) },
            Data { cloud: scatter(9, 2, 0.0, 1.2), ..group("line", scatter(21, 2, 0.0, 1.0)) },
        ]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [a, b] = [0, 1].map(|i| T::of(at.x[i]));
        let [u, w] = [0, 1].map(|head| at.heads[head].value());
        match group {
            "line" => vec![a + w, u],
            _ => vec![a + u, b + u * w, w, at.heads[1].laplacian(2).value()],
        }
    }
}
