//! What the numbers of a point are: coordinates in space, or the components of a curve or surface that a scene has names for.

use std::path::Path;

use crate::DataError;

/// The names of a point's numbers, in their order; in space if there are none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Components<'a>(&'a [String]);

impl<'a> Components<'a> {
    /// Points in space.
    pub(crate) const IN_SPACE: Components<'static> = Components(&[]);

    /// Points with named components.
    pub(crate) fn named(names: &'a [String]) -> Self {
        Self(names)
    }

    /// Numbers of a point.
    pub(crate) fn count(self) -> usize {
        if self.0.is_empty() { 3 } else { self.0.len() }
    }

    /// The names.
    pub(crate) fn names(self) -> impl Iterator<Item = &'a str> {
        let named = self.0.iter().map(String::as_str);
        named.chain(["x", "y", "z"].into_iter().filter(move |_| self.0.is_empty()))
    }

    /// The names as people write them: `x` and `w`.
    pub(crate) fn said(self) -> String {
        let names: Vec<String> = self.names().map(|name| format!("`{name}`")).collect();
        let (last, others) =
            names.split_last().map_or((String::new(), &[][..]), |(last, others)| (last.clone(), others));
        if others.is_empty() { last } else { format!("{} and {last}", others.join(", ")) }
    }

    /// Refuses points of more numbers than are kept, whatever the file is.
    pub(crate) fn refuse_many(self, path: &Path) -> Result<(), DataError> {
        let what = format!("points of {} numbers are not read from files; three are the most", self.count());
        if self.count() > 3 { Err(DataError::file(path, what)) } else { Ok(()) }
    }

    /// Refuses a file of points in space where points have other components.
    pub(crate) fn refuse_space(self, path: &Path) -> Result<(), DataError> {
        let what = format!(
            "holds x, y and z, where the points are {}: give a table or an array of these columns",
            self.said()
        );
        if self.count() == 3 { Ok(()) } else { Err(DataError::file(path, what)) }
    }

    /// Refuses rows of so many numbers without names: more than three in space are colours and the like, and others are not known
    /// to be the ones that are meant.
    pub(crate) fn refuse_width(self, path: &Path, width: usize) -> Result<(), DataError> {
        let is_fitting = width == self.count() || self.count() == 3 && width > 3;
        let what = format!(
            "has {width} numbers in a row, where {} are needed; give these alone, or a table with these headers",
            self.said()
        );
        if is_fitting { Ok(()) } else { Err(DataError::file(path, what)) }
    }
}
