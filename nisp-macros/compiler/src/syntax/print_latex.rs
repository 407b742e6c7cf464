//! An expression as LaTeX.

use super::print_text::{Binding, binding};
use super::tree::{Expr, ExprKind};

const GREEK: [&str; 34] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi",
    "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega",
];

/// Functions that LaTeX knows by a command of their own.
const COMMANDS: [&str; 12] = ["sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "ln", "min", "max", "det", "arcsin"];

/// Operators that stand in front of their argument.
const PREFIX: [(&str, &str); 6] = [
    ("grad", r"\nabla "),
    ("div", r"\nabla\cdot "),
    ("curl", r"\nabla\times "),
    ("laplacian", r"\nabla^{2} "),
    ("biharmonic", r"\nabla^{4} "),
    ("hessian", r"\nabla\nabla "),
];

/// Operators between two arguments.
const INFIX: [(&str, &str); 3] = [("dot", r" \cdot "), ("cross", r" \times "), ("outer", r" \otimes ")];

/// Operators around or behind their argument.
const AROUND: [(&str, &str, &str); 6] = [
    ("sqrt", r"\sqrt{", "}"),
    ("abs", r"\left|", r"\right|"),
    ("norm", r"\left\lVert ", r"\right\rVert "),
    ("integral", r"\int ", r"\,\mathrm{d}\Omega"),
    ("asin", r"\arcsin\left(", r"\right)"),
    ("acos", r"\arccos\left(", r"\right)"),
];

const BEHIND: [(&str, &str); 3] = [("transpose", r"^{\mathsf{T}}"), ("inverse", r"^{-1}"), ("partner", r"^{\ast}")];

/// The expression in LaTeX; with one coordinate only, derivatives are ordinary ones.
pub(crate) fn print_latex(expr: &Expr, ordinary: bool) -> String {
    Printer { dee: if ordinary { r"\mathrm{d}" } else { r"\partial" } }.print(expr)
}

/// A name: Greek letters by their commands, what follows an underscore and trailing digits as subscripts.
fn latex_name(name: &str) -> String {
    let (base, mut subscripts) = match name.split_once('_') {
        Some((base, rest)) if !base.is_empty() => (base, rest.split('_').map(letter).collect::<Vec<_>>()),
        _ => (name, Vec::new()),
    };
    let stem = base.trim_end_matches(|c: char| c.is_ascii_digit());
    if stem.len() < base.len() && !stem.is_empty() {
        subscripts.insert(0, base[stem.len()..].to_string());
    }
    let stem = letter(if stem.is_empty() { base } else { stem });
    if subscripts.is_empty() { stem } else { format!("{stem}_{{{}}}", subscripts.join(",")) }
}

fn letter(text: &str) -> String {
    if GREEK.contains(&text) {
        format!(r"\{text}")
    } else if text.chars().count() <= 1 {
        text.to_string()
    } else if text.chars().count() == 2 {
        // Subscripts such as `aa` are two indices, not a word.
        text.chars().map(String::from).collect::<Vec<_>>().join(" ")
    } else {
        format!(r"\mathrm{{{text}}}")
    }
}

struct Printer {
    dee: &'static str,
}

impl Printer {
    fn print(&self, expr: &Expr) -> String {
        match &expr.kind {
            ExprKind::Number(number, unit) => {
                let text = match number.text.split_once(['e', 'E']) {
                    Some((mantissa, power)) => format!(r"{mantissa} \cdot 10^{{{power}}}"),
                    None => number.text.clone(),
                };
                match unit {
                    Some(unit) => format!(r"{text}\,\mathrm{{{}}}", unit.text.replace(' ', r"\,").replace('%', r"\%")),
                    None => text,
                }
            }
            ExprKind::Name(name) if name == "I" => r"\mathbf{I}".into(),
            ExprKind::Name(name) => latex_name(name),
            ExprKind::Negate(inner) => format!("-{}", self.within(inner, Binding::Sign)),
            ExprKind::Sum(terms) => self.sum(terms),
            ExprKind::Product(factors) => self.product(factors),
            ExprKind::Power(base, exponent) => {
                let base = match &base.kind {
                    ExprKind::Call(..) => format!(r"\left({}\right)", self.print(base)),
                    _ => format!("{{{}}}", self.within(base, Binding::Atom)),
                };
                format!("{base}^{{{}}}", self.print(exponent))
            }
            ExprKind::Call(name, arguments) => self.call(&name.text, arguments),
            ExprKind::List(entries) => {
                let rows: Vec<String> = entries.iter().map(|entry| self.print(entry)).collect();
                format!(r"\begin{{pmatrix}} {} \end{{pmatrix}}", rows.join(r" \\ "))
            }
            ExprKind::Index(base, indices) => {
                format!("{{{}}}_{{{}}}", self.within(base, Binding::Atom), self.separated(indices))
            }
        }
    }

    fn within(&self, expr: &Expr, weakest: Binding) -> String {
        let text = self.print(expr);
        if binding(expr) >= weakest { text } else { format!(r"\left({text}\right)") }
    }

    fn separated(&self, entries: &[Expr]) -> String {
        entries.iter().map(|entry| self.print(entry)).collect::<Vec<_>>().join(", ")
    }

    fn sum(&self, terms: &[(bool, Expr)]) -> String {
        let mut text = String::new();
        for (index, (subtracted, term)) in terms.iter().enumerate() {
            text.push_str(if index == 0 {
                ""
            } else if *subtracted {
                " - "
            } else {
                " + "
            });
            text.push_str(&self.within(term, Binding::Product));
        }
        text
    }

    fn product(&self, factors: &[(bool, Expr)]) -> String {
        let side = |below: bool| -> Vec<&Expr> {
            factors.iter().filter(|(divided, _)| *divided == below).map(|(_, factor)| factor).collect()
        };
        let (above, below) = (side(false), side(true));
        if below.is_empty() {
            return self.juxtaposed(&above);
        }
        format!(r"\frac{{{}}}{{{}}}", self.juxtaposed(&above), self.juxtaposed(&below))
    }

    fn juxtaposed(&self, factors: &[&Expr]) -> String {
        if let [only] = factors {
            return self.print(only);
        }
        let mut text = String::new();
        for factor in factors {
            let next = self.within(factor, Binding::Sign);
            let close = if next.starts_with(|c: char| c.is_ascii_digit() || c == '-') { r" \cdot " } else { r" \, " };
            text.push_str(if text.is_empty() { "" } else { close });
            text.push_str(&next);
        }
        text
    }

    fn call(&self, name: &str, arguments: &[Expr]) -> String {
        if let ("d", [inner, by @ ..]) = (name, arguments) {
            return self.derivative(inner, by);
        }
        if let (Some((_, sign)), [inner]) = (PREFIX.iter().find(|(known, _)| *known == name), arguments) {
            return format!("{sign}{}", self.within(inner, Binding::Power));
        }
        if let (Some((_, sign)), [left, right]) = (INFIX.iter().find(|(known, _)| *known == name), arguments) {
            return format!("{}{sign}{}", self.within(left, Binding::Power), self.within(right, Binding::Power));
        }
        if let (Some((_, open, close)), [inner]) = (AROUND.iter().find(|(known, ..)| *known == name), arguments) {
            return format!("{open}{}{close}", self.print(inner));
        }
        if let (Some((_, sign)), [inner]) = (BEHIND.iter().find(|(known, _)| *known == name), arguments) {
            return format!("{{{}}}{sign}", self.within(inner, Binding::Atom));
        }
        let command = if COMMANDS.contains(&name) { format!(r"\{name}") } else { format!(r"\operatorname{{{name}}}") };
        format!(r"{command}\left({}\right)", self.separated(arguments))
    }

    /// `d(e, x, 2, y)` as one fraction; long expressions follow it in parentheses.
    fn derivative(&self, inner: &Expr, by: &[Expr]) -> String {
        let mut below: Vec<(String, u32)> = Vec::new();
        for argument in by {
            match (&argument.kind, below.last_mut()) {
                (ExprKind::Number(number, _), Some((_, count))) => *count = number.value as u32,
                _ => below.push((self.print(argument), 1)),
            }
        }
        let raise = |count: u32| if count == 1 { String::new() } else { format!("^{{{count}}}") };
        let total: u32 = below.iter().map(|(_, count)| *count).fold(0, u32::saturating_add);
        let dee = self.dee;
        let bottom: Vec<String> = below.iter().map(|(name, count)| format!("{dee} {name}{}", raise(*count))).collect();
        let (top, bottom) = (format!("{dee}{}", raise(total)), bottom.join(r" \, "));
        match inner.kind {
            ExprKind::Name(_) => format!(r"\frac{{{top} {}}}{{{bottom}}}", self.print(inner)),
            _ => format!(r"\frac{{{top}}}{{{bottom}}}\left({}\right)", self.print(inner)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::latex_name;

    #[test]
    fn names_are_set_as_physicists_write_them() {
        let set = |name| latex_name(name);
        assert_eq!(set("phi"), r"\phi");
        assert_eq!(set("m0"), "m_{0}");
        assert_eq!(set("N_alpha"), r"N_{\alpha}");
        assert_eq!(set("E_aa"), "E_{a a}");
        assert_eq!(set("gap"), r"\mathrm{gap}");
        assert_eq!(set("lambda0"), r"\lambda_{0}");
    }
}
