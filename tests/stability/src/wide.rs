//! Twice the precision, for what the reference computes with.

use crate::double_double::{Dd, exponential};
use nisp_references::number::Number;

impl Number for Dd {
    fn of(x: f64) -> Self {
        x.into()
    }
    fn value(self) -> f64 {
        self.hi
    }
    /// In plain precision: nothing that is compared here calls it.
    fn chain(self, value: f64, _: f64) -> Self {
        value.into()
    }
    fn exp(self) -> Self {
        exponential(self).0
    }
    fn tanh(self) -> Self {
        let less_one = exponential(Dd::from(-2.0) * self.abs()).1;
        let t = -less_one / (less_one + Dd::from(2.0));
        if self.hi < 0.0 { -t } else { t }
    }
}
