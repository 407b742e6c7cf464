//! The equations by name, and how a user's request becomes a bound problem.
//!
//! A new equation is one new file with its `pde!` and its entry, and one line in [`catalogue`].

use crate::entry::{Binding, Entry};
use crate::error::PrepareError;
use crate::prepared::Prepared;
use crate::request::{Request, Wanted};
use crate::tables;
#[cfg(feature = "shipped")]
use crate::{bubble, membrane, pendulum, plate, rlc, sponge};

/// The equations that are shipped.
#[cfg(feature = "shipped")]
// Inlined, the scenes would have every crate that asks compile all kernels again.
#[inline(never)]
pub fn catalogue() -> [Entry; 6] {
    [pendulum::entry(), rlc::entry(), plate::entry(), membrane::entry(), bubble::entry(), sponge::entry()]
}

impl Entry {
    /// Reads what is asked for and binds a scene to it.
    ///
    /// # Errors
    /// A file, a column, a scene or a parameter that does not fit.
    pub fn prepare(&self, request: &Request) -> Result<Prepared, PrepareError> {
        if !matches!(self.binding, Binding::Cloud(_)) {
            self.refuse_clouds(request)?;
        }
        if let (Some(wanted), false) = (&request.wanted, matches!(self.binding, Binding::Tables(_))) {
            let option = if matches!(wanted, Wanted::At(_)) { "at" } else { "grid" };
            let instead = "its answer is written where it was measured, or over its own domain";
            return Err(PrepareError::Option { entry: self.name, option, instead });
        }
        match &self.binding {
            Binding::Series(series) => series.prepare(self, request),
            Binding::Tables(folder) => tables::prepare(self, folder, request),
            Binding::Own(prepare) | Binding::Cloud(prepare) => prepare(self, request),
        }
    }

    /// Options that are about clouds.
    fn refuse_clouds(&self, request: &Request) -> Result<(), PrepareError> {
        let given = [
            ("sample", request.sample.is_some()),
            ("cloud", request.cloud.is_some()),
            ("unit", request.view.unit.is_some() && !self.sees()),
            ("camera", request.view.camera.is_some() && !self.sees()),
            ("calibration", request.calibration.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                let instead = "give its file with --data, and parameters with --set";
                Err(PrepareError::Option { entry: self.name, option, instead })
            }
            None => Ok(()),
        }
    }
}
