//! Files that are read, and must not be written over.

use std::path::Path;

use crate::args::{EvalOptions, Options};

impl Options {
    /// Every file that the command line names to be read.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let named = [&self.sample, &self.calibration, &self.at, &self.camera, &self.truth, &self.config];
        let data = self.data.iter().map(|(_, path)| path);
        let all = data.chain(named.into_iter().flatten()).map(|path| path.as_path());
        all.chain([Path::new(&self.equation)]).collect()
    }
}

impl EvalOptions {
    /// Every file that the command line names to be read.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        self.place.at.iter().chain([&self.answer]).map(|path| path.as_path()).collect()
    }
}

/// Makes sure that a file to be written is none of those that are read.
///
/// # Errors
/// It is one of them.
pub(crate) fn spare(inputs: &[&Path], written: &Path) -> Result<(), String> {
    let Ok(own) = written.canonicalize() else { return Ok(()) };
    let is_own = |input: &&&Path| input.canonicalize().is_ok_and(|input| input == own);
    match inputs.iter().find(is_own) {
        Some(input) => Err(format!(
            "{} is read here, and results would be written over it: give another --out, or move the file",
            input.display()
        )),
        None => Ok(()),
    }
}
