//! Small equations that nothing was tuned to, one a file: each with its truth, its measurements and its cases.

mod advection;
mod beam;
mod cooling;
mod duffing;
mod heat;
mod logistic;
mod lorenz;
mod oscillator;
mod poisson;
mod prey;
mod rate;
mod reaction;
mod swing;

use super::experiment::Subject;

/// All of them.
pub(super) fn subjects() -> Vec<Subject> {
    vec![
        duffing::subject(),
        oscillator::subject(),
        swing::subject(),
        lorenz::subject(),
        reaction::subject(),
        logistic::subject(),
        prey::subject(),
        cooling::subject(),
        rate::subject(),
        beam::subject(),
        heat::subject(),
        advection::subject(),
        poisson::subject(),
    ]
}
