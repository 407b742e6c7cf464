//! Poisson's equation, and conditions in domains of every kind.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    pub mod poisson {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: s;
        domains:
            square = box(-1 .. 1, -1 .. 1), round = disc(0, 0, 2), three = polygon([0, 0], [1, 0], [0, 1]),
            strip = 0 .. 1 times -1 .. 3, holed = box(0 .. 2, 0 .. 2) plus disc(2, 1, 1) minus polygon("hole.csv");
        on inside in square { balance: laplacian(u) == s; }
        on rim boundary of round { held: u == x * y; }
        on corner in three { held: u == 1 within 5; }
        on early start of strip { held: u == 2 within 5; }
        on late end of strip { held: u == 3 within 5; }
        on around boundary of holed with 500 points { held: u == 4 within 5; }
        scene solve { only inside.balance, rim.held; }
        scene everywhere { }
    }
}

/// Poisson's equation, and conditions in domains of every kind.
pub struct Poisson;

impl Model for Poisson {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<poisson::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        vec![group("inside", scatter(75, 2, -2.0, 3.0)), group("rim", scatter(22, 2, -2.0, 3.0))]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        match group {
            "rim" => vec![at.heads[0].value() - T::of(at.x[0] * at.x[1])],
            _ => vec![at.heads[0].laplacian(2).value() - at.heads[1].value()],
        }
    }
}
