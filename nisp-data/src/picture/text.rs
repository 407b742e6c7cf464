//! Numbers and labels: Greek names, raised and lowered parts, and an estimate of how wide they are.

/// Two decimals are finer than any screen.
pub(super) fn num(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// `&`, `<` and friends.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A run of text at one height: 0 on the line, 1 raised, -1 lowered.
fn runs(content: &str) -> Vec<(i8, String)> {
    let mut out: Vec<(i8, String)> = vec![(0, String::new())];
    let mut rest = content;
    while let Some(mark) = rest.chars().next() {
        let shift = match mark {
            '^' => 1,
            '_' => -1,
            _ => 0,
        };
        let braced = rest[mark.len_utf8()..].strip_prefix('{').and_then(|inner| inner.split_once('}'));
        match (shift, braced) {
            (1 | -1, Some((inner, after))) => {
                out.push((shift, inner.to_string()));
                out.push((0, String::new()));
                rest = after;
            }
            _ => {
                if let Some((_, last)) = out.last_mut() {
                    last.push(mark);
                }
                rest = &rest[mark.len_utf8()..];
            }
        }
    }
    out.retain(|(_, run)| !run.is_empty());
    out
}

/// SVG spans for a label of the given type size.
pub(super) fn spans(content: &str, size: f64) -> String {
    let mut out = String::new();
    let mut level = 0.0;
    for (shift, run) in runs(content) {
        // Browsers disagree about `baseline-shift`; moving by hand works everywhere.
        let wanted = size * [0.2, 0.0, -0.36][usize::from((shift + 1).unsigned_abs())];
        let step = num(wanted - level);
        let run = escape(&run);
        match shift {
            0 if step == "0" => out.push_str(&run),
            0 => out.push_str(&format!("<tspan dy=\"{step}\">{run}</tspan>")),
            _ => {
                let small = num(0.72 * size);
                out.push_str(&format!("<tspan dy=\"{step}\" font-size=\"{small}\">{run}</tspan>"));
            }
        }
        level = wanted;
    }
    out
}

/// About how wide a label is: the widest of the usual sans-serif faces, so that layouts hold in all of them.
pub(super) fn width(content: &str, size: f64) -> f64 {
    let em = |letter: char| match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | '(' | ')' | '[' | ']' | '/' | 't' | 'f'
        | 'r' => 0.36,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '±' | '−' | '×' | '+' | '=' => 0.9,
        'A'..='Z' => 0.7,
        _ => 0.62,
    };
    let run_width = |(shift, run): (i8, String)| {
        let scale = if shift == 0 { 1.0 } else { 0.72 };
        run.chars().map(em).sum::<f64>() * scale
    };
    runs(content).into_iter().map(run_width).sum::<f64>() * size
}

/// `psi` as ψ, `sigma_xx` as σ with a lowered xx.
pub(super) fn symbol(name: &str) -> String {
    let (head, tail) = match name.split_once('_') {
        Some((head, tail)) if !head.is_empty() && !tail.is_empty() => (head, Some(tail)),
        _ => (name, None),
    };
    let head = greek(head);
    tail.map_or(head.to_string(), |tail| format!("{head}_{{{}}}", tail.replace('_', ",")))
}

fn greek(name: &str) -> &str {
    const LETTERS: [(&str, &str); 25] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("delta", "δ"),
        ("epsilon", "ε"),
        ("eps", "ε"),
        ("zeta", "ζ"),
        ("eta", "η"),
        ("theta", "θ"),
        ("kappa", "κ"),
        ("lambda", "λ"),
        ("mu", "μ"),
        ("nu", "ν"),
        ("xi", "ξ"),
        ("pi", "π"),
        ("rho", "ρ"),
        ("sigma", "σ"),
        ("tau", "τ"),
        ("phi", "φ"),
        ("chi", "χ"),
        ("psi", "ψ"),
        ("omega", "ω"),
        ("Phi", "Φ"),
        ("Psi", "Ψ"),
        ("Omega", "Ω"),
    ];
    LETTERS.iter().find(|(word, _)| *word == name).map_or(name, |(_, letter)| letter)
}

/// `m/s^2` with a raised 2.
pub(super) fn unit(unit: &str) -> String {
    let mut out = String::new();
    let mut letters = unit.chars().peekable();
    while let Some(letter) = letters.next() {
        if letter != '^' {
            out.push(letter);
            continue;
        }
        out.push_str("^{");
        while let Some(&digit) = letters.peek() {
            if !(digit.is_ascii_digit() || matches!(digit, '-' | '+' | '.')) {
                break;
            }
            out.push(if digit == '-' { '−' } else { digit });
            letters.next();
        }
        out.push('}');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_set_as_in_a_paper() {
        assert_eq!(symbol("psi"), "ψ");
        assert_eq!(symbol("sigma_xx"), "σ_{xx}");
        assert_eq!(unit("kg m^-3"), "kg m^{−3}");
        assert_eq!(spans("a<b", 10.0), "a&lt;b");
        assert_eq!(
            spans("m^{2} x_{i}", 10.0),
            "m<tspan dy=\"-3.6\" font-size=\"7.2\">2</tspan><tspan dy=\"3.6\"> x</tspan>\
             <tspan dy=\"2\" font-size=\"7.2\">i</tspan>"
        );
        assert!(width("m^{2}", 10.0) < width("m2", 10.0));
    }
}
