//! Functions: elementary ones of pure numbers, those that respect units, and tensor algebra.

use super::build;
use super::elaborate::Elaborator;
use super::value::{Dim, Reads, Value};
use super::{Function, tensor};
use crate::error::{Checked, Place, catalogue};
use crate::rational::ratio;
use crate::syntax::{Expr, Name};

/// Functions from pure numbers to pure numbers.
const PURE: [(&str, Function); 11] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
];

/// Differential operators over the spatial coordinates.
const ANALYSIS: [&str; 6] = ["grad", "div", "curl", "laplacian", "biharmonic", "hessian"];

/// All other functions, with the number of their arguments.
const OTHERS: [(&str, usize); 15] = [
    ("sqrt", 1),
    ("abs", 1),
    ("sign", 1),
    ("min", 2),
    ("max", 2),
    ("partner", 1),
    ("dot", 2),
    ("cross", 2),
    ("outer", 2),
    ("tr", 1),
    ("sym", 1),
    ("det", 1),
    ("norm", 1),
    ("transpose", 1),
    ("inverse", 1),
];

impl Elaborator<'_> {
    pub(super) fn call(&mut self, name: &Name, arguments: &[Expr], place: Place) -> Checked<Value> {
        if name.text == "d" {
            return self.derivative(arguments, place);
        }
        if name.text == "integral" {
            return Err(self.errors.report(place, catalogue::integral_within()));
        }
        let pure = PURE.iter().find(|(known, _)| *known == name.text).map(|(_, function)| *function);
        let analysis = ANALYSIS.contains(&name.text.as_str());
        let expected = if pure.is_some() || analysis {
            1
        } else if let Some((_, count)) = OTHERS.iter().find(|(known, _)| *known == name.text) {
            *count
        } else {
            return Err(self.unknown_function(name));
        };
        if arguments.len() != expected {
            let message = catalogue::wrong_arguments(&name.text, &catalogue::count(expected), arguments.len());
            return Err(self.errors.report(place, message));
        }
        let first = &arguments[0];
        if let Some(function) = pure {
            let argument = self.pure(first, &format!("the argument of `{}`", name.text))?;
            let dim = if self.units_checked { Dim::none() } else { Dim::Unknown };
            return Ok(Value::scalar(build::call(function, &argument), dim));
        }
        if analysis {
            self.doubt_time(&name.text, place);
            return self.vector_analysis(&name.text, first, place);
        }
        match name.text.as_str() {
            "sqrt" => self.square_root(first, place),
            "abs" => {
                let (scalar, dim) = self.scalar(first, "the argument of `abs`")?;
                Ok(Value::scalar(build::call(Function::Abs, &scalar), dim))
            }
            "sign" => {
                let (scalar, _) = self.scalar(first, "the argument of `sign`")?;
                let dim = if self.units_checked { Dim::none() } else { Dim::Unknown };
                Ok(Value::scalar(build::call(Function::Sign, &scalar), dim))
            }
            "min" | "max" => self.extremum(&name.text, arguments),
            "partner" => self.at_partner(first, place),
            _ => self.tensor_function(&name.text, arguments),
        }
    }

    /// Without units nothing tells time from space but its declaration.
    fn doubt_time(&mut self, operator: &str, place: Place) {
        if self.units_checked || self.spatial.len() < 2 {
            return;
        }
        let names = self.spatial.iter().map(|&at| &self.coordinates[at].name.text);
        let Some(time) = names.into_iter().find(|name| matches!(name.as_str(), "t" | "time")).cloned() else { return };
        let message = catalogue::operator_over_time(operator, &time);
        if self.warnings.iter().all(|(other, _)| *other != message) {
            self.warnings.push((message, place.start));
        }
    }

    fn unknown_function(&mut self, name: &Name) -> crate::error::Reported {
        let known = PURE.iter().map(|(known, _)| *known).chain(ANALYSIS).chain(OTHERS.iter().map(|(known, _)| *known));
        let nearest = catalogue::nearest(&name.text, known.chain(["integral"]));
        let declared = self.scope.find(&name.text).is_some();
        self.errors.report(name.span, catalogue::unknown_function(&name.text, nearest, declared))
    }

    fn square_root(&mut self, argument: &Expr, place: Place) -> Checked<Value> {
        let (scalar, dim) = self.scalar(argument, "the argument of `sqrt`")?;
        let dim = match dim {
            Dim::Known(dimension) => match dimension.power(ratio(1, 2)) {
                Some(root) => Dim::Known(root),
                None => return Err(self.errors.report(place, catalogue::absurd_unit())),
            },
            other => other,
        };
        Ok(Value::scalar(build::call(Function::Sqrt, &scalar), dim))
    }

    fn extremum(&mut self, name: &str, arguments: &[Expr]) -> Checked<Value> {
        let what = format!("an argument of `{name}`");
        let scalars: Vec<Checked<_>> = arguments.iter().map(|argument| self.scalar(argument, &what)).collect();
        let scalars: Vec<_> = scalars.into_iter().collect::<Checked<_>>()?;
        let parts: Vec<(&Expr, &Dim)> = arguments.iter().zip(scalars.iter().map(|(_, dim)| dim)).collect();
        let dim = self.agree(&parts, &format!("arguments of `{name}`"));
        let (a, b) = (&scalars[0].0, &scalars[1].0);
        Ok(Value::scalar(if name == "min" { build::minimum(a, b) } else { build::maximum(a, b) }, dim))
    }

    fn at_partner(&mut self, argument: &Expr, place: Place) -> Checked<Value> {
        if !self.paired {
            return Err(self.errors.report(place, catalogue::partner_without_pairs()));
        }
        let value = self.value(argument)?;
        if value.reads().any(Reads::PARTNER) {
            return Err(self.errors.report(place, catalogue::partner_of_partner()));
        }
        if value.reads().any(Reads::COLUMN) {
            return Err(self.errors.report(place, catalogue::partner_of_column()));
        }
        Ok(value.map(value.dim.clone(), build::partner))
    }

    fn tensor_function(&mut self, name: &str, arguments: &[Expr]) -> Checked<Value> {
        let values = self.all(arguments)?;
        let result = match values.as_slice() {
            [a, b] => tensor::of_two(name, a, b),
            [a] => tensor::of_one(name, a),
            _ => None,
        };
        let Some(mut result) = result else {
            let texts: Vec<String> = values.iter().map(|value| value.extent.to_string()).collect();
            let place = arguments[0].place.to(arguments[arguments.len() - 1].place);
            return Err(self.errors.report(place, catalogue::wrong_shapes(name, &texts.join(" and "))));
        };
        if !self.units_checked {
            result.dim = Dim::Unknown;
        }
        Ok(result)
    }
}
