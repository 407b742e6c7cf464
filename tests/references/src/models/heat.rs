//! A conductivity that goes with the temperature, a robust loss, a learned factor.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod heat {
        units: off;
        coordinates: x, t;
        fields: T;
        sources: q;
        parameters: k = 0.7;
        on inside { balance: d(T, t) == d(k * d(T, x) * (1 + T^2), x) + q; }
        on probes { observe T with welsch(0.8) weight 2; }
        on whole { energy: integral(T * q) == 1.5 * k; }
        scene recover { learn k; }
    }
}

/// A conductivity that goes with the temperature, a robust loss, a learned factor.
pub struct Heat;

impl Model for Heat {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<heat::recover::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let probes = group("probes", scatter(31, 2, 0.0, 1.0));
        let whole = group("whole", scatter(40, 2, 0.0, 1.0));
        vec![
            group("inside", scatter(60, 2, 0.0, 1.0)),
            Data { columns: vec![wave(31, 0.9)], ..probes },
            Data { weights: vec![0.025; 40], ..whole },
        ]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        vec![T::of(0.7) * theta[0].exp()]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let (temperature, q) = (at.heads[0].clone(), at.heads[1].value());
        match group {
            "probes" => vec![temperature.value() - T::of(at.columns[0])],
            "whole" => vec![temperature.value() * q],
            _ => {
                let slope = temperature.by(0);
                let rising = temperature.clone() * temperature.clone();
                let flux = (slope * rising.shift(T::of(1.0))).scale(at.learned[0]);
                vec![temperature.by(1).value() - flux.by(0).value() - q]
            }
        }
    }
    fn target<T: Number>(&self, _: usize, learned: &[T]) -> T {
        T::of(1.5) * learned[0]
    }
}
