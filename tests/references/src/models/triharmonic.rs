//! Derivatives of the sixth order, pairs of points, an integral.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter};
use crate::dense_jet::Jet;
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod triharmonic {
        units: off;
        coordinates: x, y;
        fields: w;
        on inside { balance: laplacian(laplacian(laplacian(w))) == sin(x); }
        on rim { held: w == 0; slope: d(w, x) == 0; bent: laplacian(w) == 0; }
        on seam pairs { kink: d(laplacian(laplacian(w)), x) == partner(d(laplacian(laplacian(w)), x)); }
        on whole { flux: integral(laplacian(laplacian(laplacian(w)))) == 1; }
        scene solve { }
    }
}

/// Derivatives of the sixth order, pairs of points, an integral.
pub struct Triharmonic;

impl Model for Triharmonic {
    const ORDER: usize = 6;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<triharmonic::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let seam = Data { partners: scatter(15, 2, -0.9, 0.8), ..group("seam", scatter(15, 2, -1.0, 1.0)) };
        let whole = Data { weights: vec![0.05; 20], ..group("whole", scatter(20, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(45, 2, -1.0, 1.0)), group("rim", scatter(9, 2, -1.0, 1.0)), seam, whole]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let w = &at.heads[0];
        let fifth = |w: &Jet<'_, T>| w.laplacian(2).laplacian(2).by(0).value();
        let sixth = w.laplacian(2).laplacian(2).laplacian(2).value();
        match group {
            "rim" => vec![w.value(), w.by(0).value(), w.laplacian(2).value()],
            "seam" => vec![fifth(w) - fifth(&at.partner[0])],
            "whole" => vec![sixth],
            _ => vec![sixth - T::of(at.x[0].sin())],
        }
    }
    fn target<T: Number>(&self, _: usize, _: &[T]) -> T {
        T::of(1.0)
    }
}
