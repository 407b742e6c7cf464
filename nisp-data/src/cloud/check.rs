//! Is this cloud of this domain, and in metres? A cloud in millimetres would otherwise fit nothing, quietly.

use std::fmt::Write;
use std::str::FromStr;

use nisp_units::frame::{File, Number, Scale, Si};

use super::Cloud;
use crate::DataError;

/// Share of points at either end of an axis that may be outliers.
const OUTLIERS: f64 = 0.02;
/// Extents (cloud over domain) that pass: parts may be missing, and a surface may bulge.
const PLAUSIBLE: std::ops::Range<f64> = 0.02..20.0;
/// How well a unit must explain the ratio to be suggested.
const EXPLAINED: std::ops::Range<f64> = 0.1..4.0;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metres.
    Metre,
    /// Centimetres.
    Centimetre,
    /// Millimetres.
    Millimetre,
    /// Micrometres.
    Micrometre,
    /// Inches.
    Inch,
}

impl LengthUnit {
    const ALL: [LengthUnit; 5] =
        [LengthUnit::Millimetre, LengthUnit::Centimetre, LengthUnit::Micrometre, LengthUnit::Inch, LengthUnit::Metre];

    /// From coordinates in this unit to metres.
    pub fn metres(self) -> Scale<File, Si> {
        Scale::new(match self {
            LengthUnit::Metre => 1.0,
            LengthUnit::Centimetre => 1e-2,
            LengthUnit::Millimetre => 1e-3,
            LengthUnit::Micrometre => 1e-6,
            LengthUnit::Inch => 0.0254,
        })
    }

    /// As it is written: `m`, `cm`, `mm`, `um`, `in`.
    pub fn symbol(self) -> &'static str {
        self.names().0
    }

    fn names(self) -> (&'static str, &'static str) {
        match self {
            LengthUnit::Metre => ("m", "metres"),
            LengthUnit::Centimetre => ("cm", "centimetres"),
            LengthUnit::Millimetre => ("mm", "millimetres"),
            LengthUnit::Micrometre => ("um", "micrometres"),
            LengthUnit::Inch => ("in", "inches"),
        }
    }
}

impl FromStr for LengthUnit {
    type Err = DataError;

    fn from_str(text: &str) -> Result<LengthUnit, DataError> {
        let found = LengthUnit::ALL.into_iter().find(|unit| unit.names().0 == text || unit.names().1 == text);
        found.ok_or_else(|| DataError::invalid(format!("`{text}` is no unit of length; write m, cm, mm, um or in")))
    }
}

impl Cloud {
    /// Takes the points into metres, from `unit` where the file does not say it. What the file says goes first, with a warning.
    pub fn take_into_metres(&mut self, unit: LengthUnit) {
        if self.is_in_metres {
            let symbol = unit.symbol();
            self.warnings.push(format!("the file says its own unit, so that --unit {symbol} is not used"));
            return;
        }
        self.points.iter_mut().flatten().for_each(|x| *x = unit.metres().of(Number::file(*x)).as_si());
        self.is_in_metres = true;
    }

    /// Lower and upper corner, without the outermost points (which may be outliers).
    pub fn robust_bounds(&self) -> ([f64; 3], [f64; 3]) {
        let mut corners = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let mut values: Vec<f64> = self.points.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            let cut = (OUTLIERS * values.len() as f64) as usize;
            corners.0[axis] = values.get(cut).copied().unwrap_or(0.0);
            corners.1[axis] = values.iter().rev().nth(cut).copied().unwrap_or(0.0);
        }
        corners
    }

    /// The share of the points that lie in a box.
    pub fn share_within(&self, low: [f64; 3], high: [f64; 3]) -> f64 {
        let inside = |point: &&[f64; 3]| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&point[axis]));
        self.points.iter().filter(inside).count() as f64 / self.points.len().max(1) as f64
    }

    /// Compares the cloud with the box around the domain that it should lie on, over the axes they share.
    ///
    /// Says which unit the cloud is probably in, or that it lies elsewhere.
    pub fn require_near(&self, low: &[f64], high: &[f64]) -> Result<(), DataError> {
        let (from, to) = self.robust_bounds();
        let axes = low.len().min(3);
        let size = |low: &[f64], high: &[f64]| low.iter().zip(high).take(axes).map(|(a, b)| b - a).fold(0.0, f64::max);
        let (cloud, domain) = (size(&from, &to), size(low, high));
        let ratio = cloud / domain;
        let unit = LengthUnit::ALL.into_iter().find(|unit| EXPLAINED.contains(&(ratio * unit.metres().factor())));
        if !PLAUSIBLE.contains(&ratio) {
            let spans = format!("the cloud spans {} m; the domain {} m", extents(&from, &to), extents(low, high));
            return Err(DataError::invalid(match unit {
                Some(unit) if ratio > 1.0 => {
                    let (short, long) = unit.names();
                    format!("{spans}: is the cloud in {long}? give --unit {short}")
                }
                _ => format!("{spans}: is it a cloud of another object?"),
            }));
        }
        let apart = |axis: usize| from[axis] > high[axis] + domain || to[axis] < low[axis] - domain;
        if (0..axes).any(apart) {
            let what = format!(
                "the cloud lies around {} m, the domain around {} m: is it in another frame?",
                middles(&from, &to),
                middles(low, high)
            );
            return Err(DataError::invalid(what));
        }
        Ok(())
    }
}

fn extents(low: &[f64], high: &[f64]) -> String {
    join(low.iter().zip(high).map(|(a, b)| b - a), " x ")
}

fn middles(low: &[f64], high: &[f64]) -> String {
    format!("({})", join(low.iter().zip(high).map(|(a, b)| 0.5 * (a + b)), ", "))
}

/// Numbers to two digits.
fn join(values: impl Iterator<Item = f64>, between: &str) -> String {
    let mut out = String::new();
    for value in values {
        if !out.is_empty() {
            out.push_str(between);
        }
        let digits = if value == 0.0 { 0.0 } else { 1.0 - value.abs().log10().floor() };
        let grid = 10f64.powi(digits.clamp(-300.0, 300.0) as i32);
        let _ = write!(out, "{}", (value * grid).round() / grid);
    }
    out
}
