//! An equation under its name, and how its scenes are bound to data.

use std::path::Path;
use std::time::Duration;

use nisp::SceneRef;
use nisp::schema::TermKind;
use nisp_data::nearest_name;

use crate::error::PrepareError;
use crate::prepared::Prepared;
use crate::request::Request;
use crate::rivals::System;

/// An equation and how it is bound to data.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Its scenes; the first is the default.
    pub scenes: Vec<SceneRef>,
    /// Path of the example's data in the repository; empty if there are none.
    pub data: &'static str,
    /// Sizes of the body, for `--set`.
    pub sizes: &'static [Size],
    /// How it is bound.
    pub binding: Binding,
}

/// A length of a body, which no equation names: in metres.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Its name for `--set`.
    pub name: &'static str,
    /// Its value where nobody says otherwise.
    pub usual: f64,
    /// What it is.
    pub about: &'static str,
}

/// How an entry's scenes are bound to what a user asks for.
#[derive(Clone, Copy, Debug)]
pub enum Binding {
    /// To tables over time, one of which is shipped.
    Series(Series),
    /// To tables of its user's own. Files that the equation names are looked for from this folder.
    Tables(&'static Path),
    /// In a way of its own.
    Own(fn(&Entry, &Request) -> Result<Prepared, PrepareError>),
    /// To a point cloud.
    Cloud(fn(&Entry, &Request) -> Result<Prepared, PrepareError>),
}

/// What is given besides measurements.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    /// First time of the measurements.
    pub(crate) start: f64,
    /// A parameter's value in its declared unit.
    pub(crate) parameter: &'a dyn Fn(&str) -> f64,
}

/// A scene over time: its example, its truths and its rivals.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    /// The example's measurements.
    pub(crate) data: &'static [u8],
    /// The example's truth.
    pub(crate) truth: &'static [u8],
    /// Columns of the example: name and header.
    pub columns: &'static [(&'static str, &'static str)],
    /// Paths of truths in the repository, from which fresh noisy copies can be made.
    pub truths: &'static [&'static str],
    /// Rows of a truth for each measurement.
    pub every: usize,
    /// The system that classical rivals solve for a scene of this name, where they know how.
    pub(crate) rival: fn(&str, Given<'_>) -> Option<Box<dyn System>>,
}

impl Entry {
    /// An equation of a user's own, bound to tables; nothing if it has no scene.
    pub fn own(scenes: Vec<SceneRef>) -> Option<Self> {
        let schema = scenes.first()?.schema;
        let about = schema.docs.lines().next().unwrap_or_default();
        Some(Self { name: schema.module, about, scenes, data: "", sizes: &[], binding: Binding::Tables(Path::new("")) })
    }

    /// The scene of a name, or the default.
    ///
    /// # Errors
    /// No such scene.
    pub fn scene(&self, name: Option<&str>) -> Result<SceneRef, PrepareError> {
        let Some(name) = name else { return Ok(self.scenes[0]) };
        self.scenes.iter().find(|scene| scene.schema.name == name).copied().ok_or_else(|| {
            let have: Vec<_> = self.scenes.iter().map(|scene| scene.schema.name).collect();
            PrepareError::Scene { entry: self.name, scene: name.into(), hint: hint(name, &have), have: have.join(", ") }
        })
    }

    /// The time within which its answers are usually there.
    pub fn usual_budget(&self) -> Duration {
        Duration::from_secs(if self.sees() { 30 } else { 10 })
    }

    /// How its scenes over time are bound to tables, if that is what they are.
    pub fn series(&self) -> Option<&Series> {
        match &self.binding {
            Binding::Series(series) => Some(series),
            Binding::Tables(_) | Binding::Own(_) | Binding::Cloud(_) => None,
        }
    }

    /// True if one of its scenes is compared with a cloud.
    pub(crate) fn sees(&self) -> bool {
        let terms = self.scenes.iter().flat_map(|scene| scene.schema.groups).flat_map(|group| group.terms);
        terms.into_iter().any(|term| matches!(term.kind, TermKind::Chamfer { .. }))
    }
}

pub(crate) fn hint(name: &str, have: &[&str]) -> String {
    nearest_name(name, have.iter().copied()).map_or_else(String::new, |near| format!(", did you mean `{near}`?"))
}
