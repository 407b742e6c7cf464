//! The look of every figure, in one place. Lengths are SVG user units; a figure is [`WIDTH`] wide.

/// Width of a figure. At half of it, text is still 8 units high.
pub(super) const WIDTH: f64 = 760.0;
/// Type sizes.
pub(super) const TITLE: f64 = 19.0;
pub(super) const LABEL: f64 = 17.0;
pub(super) const TICK: f64 = 15.0;
/// Space around and between things.
pub(super) const MARGIN: f64 = 14.0;
pub(super) const GAP: f64 = 8.0;
/// Length of a tick mark.
pub(super) const TICK_LENGTH: f64 = 5.0;

/// Common sans-serif faces; the first one present is taken.
pub(super) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

pub(super) const INK: &str = "#1f2328";
/// Text of the second rank, and levels to compare with.
pub(super) const QUIET: &str = "#57606a";
pub(super) const FAINT: &str = "#e4e7eb";
pub(super) const FRAME: &str = "#8b949e";

/// What was measured, what is true, what was estimated: the same colours in every figure.
pub(super) const MEASURED: &str = "#9aa2ab";
pub(super) const TRUTH: &str = "#1f2328";
pub(super) const ESTIMATE: &str = "#0072b2";

/// How much of a band is seen through what lies behind it.
pub(super) const BAND_OPACITY: f64 = 0.22;

/// Okabe and Ito's palette (distinct for colour-blind readers), estimate's blue first and a violet for its yellow.
pub(super) const PALETTE: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b4fa0"];
