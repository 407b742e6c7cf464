//! Messages about names.

use super::super::{help, shorten};

fn meant(nearest: Option<&str>, otherwise: &str) -> String {
    nearest.map_or_else(|| otherwise.to_string(), |name| format!("did you mean `{name}`?"))
}

pub(crate) fn unknown_name(name: &str, nearest: Option<&str>) -> String {
    if let Some(field) = nearest.filter(|field| name.strip_prefix('d') == Some(field)) {
        let step = format!("a derivative is written `d({field}, t)`, with the coordinate behind the comma");
        return help(format!("`{}` is not declared", shorten(name)), step);
    }
    let step = meant(nearest, "declare it as a coordinate, field, source or parameter, or define it with `let`");
    help(format!("`{}` is not declared", shorten(name)), step)
}

/// Functions by the names that other languages have for them, and what to write instead.
const ELSEWHERE: [(&str, &str); 14] = [
    ("log", "ln(x)"),
    ("log10", "ln(x) / ln(10)"),
    ("log2", "ln(x) / ln(2)"),
    ("pow", "x^n"),
    ("power", "x^n"),
    ("square", "x^2"),
    ("cbrt", "x^(1/3)"),
    ("arcsin", "asin(x)"),
    ("arccos", "acos(x)"),
    ("arctan", "atan(x)"),
    ("sgn", "sign(x)"),
    ("diff", "d(u, x)"),
    ("grad2", "laplacian(u)"),
    ("laplace", "laplacian(u)"),
];

pub(crate) fn unknown_function(name: &str, nearest: Option<&str>, declared: bool) -> String {
    if declared {
        let message = format!("`{}` is not a function", shorten(name));
        return help(message, format!("write `{name} * (...)` to multiply"));
    }
    if let Some((_, here)) = ELSEWHERE.iter().find(|(there, _)| *there == name) {
        return help(format!("there is no function `{name}`"), format!("write `{here}`"));
    }
    let step = meant(
        nearest,
        "there are `sqrt`, `exp`, `ln`, `sin`, `tanh`, `abs` and their like, `d`, `grad`, `div`, `dot` and `norm`",
    );
    help(format!("there is no function `{}`", shorten(name)), step)
}

pub(crate) fn defined_later(name: &str) -> String {
    help(format!("`{name}` is defined further down"), "a definition sees those above it: move it up")
}

pub(crate) fn reserved_name(name: &str) -> String {
    format!("`{name}` is a word of the language, like `sin` and `grad`, and cannot be declared")
}

pub(crate) fn declared_twice(name: &str, noun: &str, parent: Option<&str>) -> String {
    match parent {
        Some(parent) => help(
            format!("`{}` is declared twice", shorten(name)),
            format!("it is already a component of the {noun} `{parent}`"),
        ),
        None => {
            help(format!("`{}` is declared twice", shorten(name)), format!("there is already a {noun} of that name"))
        }
    }
}

pub(crate) fn group_declared_twice(name: &str) -> String {
    help(format!("there are two groups `{}`", shorten(name)), "put all terms of a group into one block")
}

pub(crate) fn domain_declared_twice(name: &str) -> String {
    help(format!("there are two domains `{}`", shorten(name)), "give one of them another name")
}

pub(crate) fn no_domain(name: &str, nearest: Option<&str>) -> String {
    help(
        format!("there is no domain `{}`", shorten(name)),
        meant(nearest, "declare it: `domains: plate = disc(0, 0, 1);`"),
    )
}

pub(crate) fn no_ends(name: &str) -> String {
    help(
        format!("`{}` has no start and no end: its last region is no interval", shorten(name)),
        "write the interval of the last coordinate last: `domains: slab = disc(0, 0, 1) times 0 .. 5;`",
    )
}

pub(crate) fn domain_of_other_dimension(name: &str, coordinates: &str) -> String {
    help(
        format!("the regions of `{}` do not match the coordinates {coordinates}", shorten(name)),
        "a region for all coordinates, in their order: an interval takes one, a disc, an ellipse and a polygon two, a ball, \
         a cylinder and a solid three, a box one for each of its ranges",
    )
}

/// Regions as they are written.
const REGIONS: [(&str, &str); 10] = [
    ("interval", "`0 .. 2`, the lower end first"),
    ("box", "`box(0 .. 2, 0 .. 1)`, a range for each coordinate, lower ends first"),
    ("disc", "`disc(x, y, radius)`, the radius above zero"),
    ("ellipse", "`ellipse(x, y, a, b)`, half axes above zero"),
    ("polygon", "`polygon([0, 0], [1, 0], [0, 1])`, three corners or more, or `polygon(\"FILE.csv\")`"),
    ("ball", "`ball(x, y, z, radius)`, the radius above zero"),
    ("cylinder", "`cylinder(x, y, radius, 0 .. 1)`, the radius above zero, the lower end first"),
    ("solid", "`solid(\"FILE.stl\" [mm])`"),
    ("union", "`a plus b`, with regions for both"),
    ("difference", "`a minus b`, with regions for both"),
];

/// Regions by other names.
const REGIONS_ELSEWHERE: [(&str, &str); 16] = [
    ("line", "interval"),
    ("segment", "interval"),
    ("range", "interval"),
    ("rect", "box"),
    ("rectangle", "box"),
    ("square", "box"),
    ("cube", "box"),
    ("cuboid", "box"),
    ("circle", "disc"),
    ("disk", "disc"),
    ("oval", "ellipse"),
    ("triangle", "polygon"),
    ("sphere", "ball"),
    ("tube", "cylinder"),
    ("mesh", "solid"),
    ("stl", "solid"),
];

/// True for a word that names a region, whether one is written so or not.
pub(crate) fn names_region(word: &str) -> bool {
    REGIONS.iter().chain(&REGIONS_ELSEWHERE).any(|(name, _)| *name == word)
}

/// A region that is not written as those of its name are.
pub(crate) fn no_such_region(word: &str) -> String {
    let here = REGIONS_ELSEWHERE.iter().find(|(there, _)| *there == word).map_or(word, |(_, here)| *here);
    match REGIONS.iter().find(|(name, _)| *name == here) {
        Some((name, usage)) => {
            let article = if name.starts_with(['a', 'e', 'i']) { "an" } else { "a" };
            help(format!("this is not how {article} {name} is written"), format!("write {usage}"))
        }
        None => no_region(),
    }
}

pub(crate) fn no_region() -> String {
    let usages: Vec<&str> = REGIONS.iter().map(|(_, usage)| *usage).collect();
    help("this is no region", format!("write {}", usages.join("; ")))
}

pub(crate) fn regions_joined_by(operator: &str) -> String {
    let word = if operator == "+" { "plus" } else { "minus" };
    help(format!("regions are not joined by `{operator}`"), format!("write `{word}`"))
}

pub(crate) fn region_without_name() -> String {
    help(
        "a group lies in a domain that has a name",
        "declare it, `domains: rod = 0 .. 1;`, and write `on inside in rod`",
    )
}

pub(crate) fn regions_of_two_dimensions() -> String {
    help("`plus` and `minus` stand between regions of the same coordinates", "write `times` for a product of others")
}

pub(crate) fn region_of_two_units() -> String {
    help(
        "this region wants coordinates of one unit",
        "declare them in the same unit, or write a product of regions: `disc(0, 0, 1) times 0 .. 5`",
    )
}

pub(crate) fn depends_on_no_coordinate(name: &str) -> String {
    help(
        format!("`{}` depends on no coordinate", shorten(name)),
        "declare it under `parameters` and find it with `learn` in a scene, or name coordinates: `q(x)`",
    )
}

pub(crate) fn groups_alike(name: &str, other: &str, data: &str) -> String {
    help(
        format!("`{}` and `{}` differ too little", shorten(name), shorten(other)),
        format!(
            "what belongs to their points would be called `{}` for both: give one of them another name",
            shorten(data)
        ),
    )
}

pub(crate) fn scene_declared_twice(name: &str) -> String {
    format!("there are two scenes `{}`", shorten(name))
}

pub(crate) fn term_declared_twice(name: &str, group: &str) -> String {
    help(
        format!("there are two terms `{}` in `{group}`", shorten(name)),
        "several conditions can share a term: `clamp: u == 0, v == 0;`",
    )
}

pub(crate) fn ambiguous_suffix(name: &str, base: &str) -> String {
    help(
        format!("`{}` can be read as a derivative of `{base}` in several ways", shorten(name)),
        format!("write `d({base}, ...)`"),
    )
}

pub(crate) fn shadows_derivative(name: &str, base: &str) -> String {
    help(
        format!("`{name}` is this declaration, not a derivative of `{base}`"),
        format!("write `d({base}, ...)` where you mean the derivative"),
    )
}

pub(crate) fn not_a_coordinate(text: &str, known: &[&str]) -> String {
    let listed: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    let nearest = super::super::nearest(text, known.iter().copied());
    let step = meant(nearest, &format!("the coordinates are {}", listed.join(", ")));
    help(format!("`{}` is not a coordinate", shorten(text)), step)
}

pub(crate) fn depends_on_a_field(name: &str, field: &str) -> String {
    let (name, field) = (shorten(name), shorten(field));
    help(
        format!(
            "`{name}` depends on coordinates alone; an unknown function of the field `{field}` is not in the language"
        ),
        format!(
            "write a family of functions with learned parameters, as `let {name} = {name}0 + {name}1 * {field};` (docs/language.md has \
             the recipe), or declare `{name}` without `({field})` and plot it over `{field}` afterwards"
        ),
    )
}

pub(crate) fn not_a_field(name: &str, nearest: Option<&str>) -> String {
    help(format!("`{}` is not a field or source", shorten(name)), meant(nearest, "hard conditions are for those"))
}

pub(crate) fn unused(noun: &str, name: &str) -> String {
    format!("the {noun} `{}` is never used", shorten(name))
}

pub(crate) fn nothing_declared(what: &str, example: &str) -> String {
    help(format!("this module declares no {what}"), format!("for instance `{example}`"))
}

pub(crate) fn no_groups() -> String {
    help("this module asks nothing", "add a group of points: `on interior { balance: laplacian(u) == f; }`")
}

pub(crate) fn column_twice(name: &str) -> String {
    help(format!("there is already a column `{}` in this group", shorten(name)), "give one of them another name")
}

pub(crate) fn unknown_group(name: &str, nearest: Option<&str>) -> String {
    help(format!("there is no group `{}`", shorten(name)), meant(nearest, "groups are declared with `on name { ... }`"))
}

pub(crate) fn unknown_term(name: &str, group: &str, nearest: Option<&str>) -> String {
    let step = meant(nearest, "terms are named in their group: `name: a == b;`");
    help(format!("there is no term `{}` in `{group}`", shorten(name)), step)
}

pub(crate) fn cannot_learn(name: &str, noun: &str) -> String {
    let step = match noun {
        "field" | "source" => "fields and sources are always found; `learn` is for parameters",
        "constant" => "declare it under `parameters` instead",
        _ => "`learn` is for parameters",
    };
    help(format!("`{name}` is a {noun}, not a parameter"), step)
}

pub(crate) fn cannot_fix(name: &str, noun: &str) -> String {
    help(format!("`{name}` is a {noun} and cannot be fixed"), "scenes fix sources, fields and parameters")
}

pub(crate) fn learned_twice(name: &str) -> String {
    format!("`{name}` is learned twice in this scene")
}

pub(crate) fn learned_and_fixed(name: &str) -> String {
    format!("`{name}` is both fixed and learned in this scene")
}

pub(crate) fn fixed_twice(name: &str) -> String {
    format!("`{name}` is fixed twice in this scene")
}
