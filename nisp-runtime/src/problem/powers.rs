//! How the natural sizes of equations follow learned scalars.
//!
//! An equation says what its terms amount to together, beside how large they are: `E u'' = p` is met to a hundredth of its
//! size whatever `E` and `p` are. Were rows divided by a size that stays, smaller and smaller `E` and `p` would meet it
//! better and better where data leave both open. So the size goes with powers of the learned scalars, those that it has
//! where learning starts; together they are its degree in what is learned, exactly, where scalars scale together.

use super::probe::Data;
use super::scale::scales;
use crate::engine::{Learned, Powers};
use crate::kernel::SceneRef;
use crate::network::Inputs;
use crate::schema::{Loss, Term, TermKind};

/// Change of a scalar, relative to it, that sizes are compared over.
const STEP: f64 = 1e-4;

/// Powers below which a size goes with nothing but rounding.
const NONE: f64 = 1e-6;

/// Powers by group and term.
pub(super) fn powers(
    scene: &SceneRef,
    scalars: &[f64],
    data: Data<'_>,
    inputs: Inputs,
    learned: &[Learned],
) -> Vec<Vec<Powers>> {
    let sizes = |learned: &Learned, factor: f64| {
        let mut scalars = scalars.to_vec();
        scalars[learned.slot] *= factor;
        scales(scene, &mut scalars, data, inputs).sizes
    };
    let pairs: Vec<_> = learned
        .iter()
        .map(|learned| learned.map.is_positive().then(|| [1.0 + STEP, 1.0 - STEP].map(|factor| sizes(learned, factor))))
        .collect();
    let power = |group: usize, term: usize, pair: &Option<[Vec<Vec<f64>>; 2]>| {
        let Some(pair) = pair else { return 0.0 };
        let [above, below] = pair.each_ref().map(|sizes| sizes[group][term]);
        let power = (above / below).ln() / (2.0 * STEP.atanh());
        if power.is_finite() && power.abs() > NONE { power } else { 0.0 }
    };
    let of_term = |group: usize, term: usize| -> Powers {
        let powers: Vec<f64> = pairs.iter().map(|pair| power(group, term, pair)).collect();
        let goes = follows(&scene.schema.groups[group].terms[term]) && powers.iter().any(|power| *power != 0.0);
        if goes { powers.into() } else { Powers::default() }
    };
    let groups = scene.schema.groups.iter().enumerate();
    groups.map(|(group, schema)| (0..schema.terms.len()).map(|term| of_term(group, term)).collect()).collect()
}

/// True for equations without a tolerance of their own. A robust loss judges distances by a size that stays.
fn follows(term: &Term) -> bool {
    let equation = matches!(term.kind, TermKind::Residual | TermKind::Integral);
    equation && term.within.is_none() && term.loss == Loss::Square
}
