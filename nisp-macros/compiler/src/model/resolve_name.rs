//! Names in expressions: declared ones, derivatives in suffix notation (`w_xx`), `pi` and `I`.

use std::f64::consts::PI;

use super::elaborate::Elaborator;
use super::scope::Meaning;
use super::value::{Dim, Value};
use super::{Coordinate, build};
use crate::error::{Checked, Place, Reported, catalogue};

/// What a suffix says.
enum Suffix {
    /// These coordinates, one after the other.
    Derivatives(Vec<usize>),
    /// It can be cut into coordinates in more than one way.
    Ambiguous,
}

impl Elaborator<'_> {
    pub(super) fn name(&mut self, name: &str, place: Place) -> Checked<Value> {
        if let Some(symbol) = self.scope.find(name) {
            let value = symbol.value.clone();
            self.scope.mark_used(name);
            return value.ok_or(Reported);
        }
        if self.scope.broken.contains(name) {
            return Err(Reported);
        }
        if name == "pi" {
            return Ok(Value::scalar(build::real(PI), if self.units_checked { Dim::none() } else { Dim::Unknown }));
        }
        if name == "I" && !self.spatial.is_empty() {
            let size = self.spatial.len();
            let dim = if self.units_checked { Dim::none() } else { Dim::Unknown };
            return Ok(Value::matrix(
                size,
                size,
                dim,
                |row, column| {
                    if row == column { build::one() } else { build::zero() }
                },
            ));
        }
        if let Some((base, suffix)) = self.split_suffix(name) {
            return match suffix {
                Suffix::Derivatives(by) => {
                    let value = self.name(&base, place)?;
                    by.into_iter().try_fold(value, |value, coordinate| self.differentiate(&value, coordinate, place))
                }
                Suffix::Ambiguous => Err(self.errors.report(place, catalogue::ambiguous_suffix(name, &base))),
            };
        }
        Err(self.unknown(name, place))
    }

    fn unknown(&mut self, name: &str, place: Place) -> Reported {
        if self.scope.later.contains(name) {
            return self.errors.report(place, catalogue::defined_later(name));
        }
        let special = ["pi"].into_iter().chain(self.scope.names());
        let nearest = catalogue::nearest(name, special).map(str::to_string);
        self.errors.report(place, catalogue::unknown_name(name, nearest.as_deref()))
    }

    /// What a name would mean as a derivative in suffix notation, if it can be read so in one way.
    pub(super) fn derivative_by_suffix(&self, name: &str) -> Option<(String, Vec<usize>)> {
        match self.split_suffix(name)? {
            (base, Suffix::Derivatives(by)) => Some((base, by)),
            (_, Suffix::Ambiguous) => None,
        }
    }

    /// Reads `w_xx` as a derivative of `w`, if `w` is a scalar that can depend on coordinates.
    fn split_suffix(&self, name: &str) -> Option<(String, Suffix)> {
        let cuts = name.char_indices().filter(|(_, character)| *character == '_').map(|(index, _)| index);
        cuts.collect::<Vec<_>>().into_iter().rev().find_map(|cut| {
            let (base, suffix) = (&name[..cut], &name[cut + 1..]);
            let broken = self.scope.broken.contains(base);
            let differentiable = broken
                || self.scope.find(base).is_some_and(|symbol| {
                    matches!(symbol.meaning, Meaning::Field | Meaning::Source | Meaning::Definition)
                        && symbol.value.as_ref().is_none_or(|value| value.as_scalar().is_some())
                });
            if !differentiable {
                return None;
            }
            Some((base.to_string(), cut_into_coordinates(suffix, &self.coordinates)?))
        })
    }
}

/// Counts the ways to spell a suffix with coordinates' names, underscores aside.
fn cut_into_coordinates(suffix: &str, coordinates: &[Coordinate]) -> Option<Suffix> {
    /// Nobody writes longer ones.
    const LONGEST: usize = 64;
    if suffix.len() > LONGEST {
        return None;
    }
    let mut ways = vec![0_u32; suffix.len() + 1];
    let mut last: Vec<Option<usize>> = vec![None; suffix.len() + 1];
    ways[0] = 1;
    for end in 1..=suffix.len() {
        let Some(head) = suffix.get(..end) else { continue };
        for (index, coordinate) in coordinates.iter().enumerate() {
            let Some(start) = head.strip_suffix(coordinate.name.text.as_str()).map(str::len) else { continue };
            if ways[start] > 0 {
                ways[end] = ways[end].saturating_add(ways[start]);
                last[end] = Some(index);
            }
        }
        // An underscore between two names may be written or not.
        if head.ends_with('_') && end > 1 && end < suffix.len() && ways[end] == 0 {
            ways[end] = ways[end - 1];
        }
    }
    match ways[suffix.len()] {
        0 => None,
        1 => {
            let (mut by, mut end) = (Vec::new(), suffix.len());
            while end > 0 {
                end -= match last[end] {
                    Some(index) => {
                        by.push(index);
                        coordinates[index].name.text.len()
                    }
                    None => 1,
                };
            }
            by.reverse();
            Some(Suffix::Derivatives(by))
        }
        _ => Some(Suffix::Ambiguous),
    }
}
