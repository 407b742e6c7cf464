//! What is emitted: the same for the same input, in functions that rustc can chew.

use syn::{Block, Expr, ImplItem, Item, Stmt};

/// rustc slows down, and overflows its stack in debug builds, on functions far beyond this.
const MOST_STATEMENTS: usize = 500;

/// Everything of sixth order in three coordinates: rules of thousands of operations.
const LARGE: &str = "mod large {
    units: off;
    coordinates: x, y, z;
    fields: w;
    on inside { balance: laplacian(laplacian(laplacian(w))) + d(w, x, 3, y, 3) + d(w, y, 3, z, 3) + d(w, x, 2, z, 4) == 1; }
    on rim { held: w == 0; }
    scene solve { }
}";

fn programs() -> Vec<(String, String)> {
    let folder = format!("{}/tests/fixtures/good", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let read = |path: std::path::PathBuf| (path.display().to_string(), std::fs::read_to_string(&path).unwrap());
    files.map(read).chain([(String::from("large"), String::from(LARGE))]).collect()
}

fn emitted(program: &str) -> String {
    nisp_compiler::compile(program.parse().unwrap()).to_string()
}

/// The statements of every function in an item.
fn statements(item: &Item, found: &mut Vec<(String, usize)>) {
    match item {
        Item::Mod(module) => module.content.iter().flat_map(|(_, items)| items).for_each(|i| statements(i, found)),
        Item::Fn(function) => body(&function.sig.ident.to_string(), &function.block, found),
        Item::Impl(implementation) => {
            for item in &implementation.items {
                if let ImplItem::Fn(function) = item {
                    body(&function.sig.ident.to_string(), &function.block, found);
                }
            }
        }
        _ => {}
    }
}

fn body(name: &str, block: &Block, found: &mut Vec<(String, usize)>) {
    let count = count(block, found);
    found.push((name.into(), count));
}

/// Statements of a block and of the blocks in it; functions in it count by themselves.
fn count(block: &Block, found: &mut Vec<(String, usize)>) -> usize {
    let mut sum = 0;
    for statement in &block.stmts {
        sum += 1;
        match statement {
            Stmt::Item(item) => statements(item, found),
            Stmt::Expr(Expr::Block(inner), _) => sum += count(&inner.block, found),
            _ => {}
        }
    }
    sum
}

#[test]
fn no_function_is_long() {
    let mut longest = 0;
    for (name, program) in programs() {
        let file: syn::File = syn::parse_str(&emitted(&program)).unwrap();
        let mut found = Vec::new();
        file.items.iter().for_each(|item| statements(item, &mut found));
        assert!(found.iter().any(|(function, _)| function == "residual"), "{name}: no programs");
        for (function, count) in found {
            assert!(count < MOST_STATEMENTS, "{name}: {function} has {count} statements");
            longest = longest.max(count);
        }
    }
    // The bound is put to the test: some function had to be cut.
    assert!(longest > MOST_STATEMENTS / 2, "{longest}");
}

#[test]
fn the_same_input_gives_the_same_code() {
    for (name, program) in programs() {
        assert_eq!(emitted(&program), emitted(&program), "{name}");
    }
}

/// Doc comments in what is emitted, as text.
fn documentation(program: &str) -> String {
    fn lines(items: &[Item], found: &mut String) {
        let add = |attributes: &[syn::Attribute], found: &mut String| {
            for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("doc")) {
                if let syn::Meta::NameValue(syn::MetaNameValue { value: Expr::Lit(text), .. }) = &attribute.meta
                    && let syn::Lit::Str(text) = &text.lit
                {
                    found.push_str(&text.value());
                    found.push('\n');
                }
            }
        };
        for item in items {
            match item {
                Item::Mod(module) => {
                    add(&module.attrs, found);
                    module.content.iter().for_each(|(_, items)| lines(items, found));
                }
                Item::Struct(item) => item.fields.iter().for_each(|field| add(&field.attrs, found)),
                Item::Const(item) => add(&item.attrs, found),
                _ => {}
            }
        }
    }
    let mut found = String::new();
    lines(&syn::parse_str::<syn::File>(&emitted(program)).unwrap().items, &mut found);
    found
}

#[test]
fn documentation_reads_like_a_paper() {
    let text = documentation(
        "mod bar {
            coordinates: x [mm], y [mm];
            fields: u: vector [mm], /** temperature */ T [K] in 200 .. 400;
            parameters: E [GPa] in 1 .. 300 = 210 within 5, g: vector [m/s^2] = [0, -9.81];
            constants: width [mm] = 2 * 23;
            let eps = sym(grad(u));
            on inside { let grown = E * tr(eps); balance: div(eps) == g * T / (width * 1 [m K/s^2]); heat: grown == 0; }
            on edge { columns: n: vector, air [K]; flux: dot(grad(T), n) == (T - air) / width; clamp: u == 0; }
            scene solve { learn E; }
        }",
    );
    for line in [
        r" - `u` \[mm\], a vector of 2: `u_x`; `u_y`",
        r" - `T` \[K\] temperature, 200 to 400",
        r" - `E` \[GPa\], 1 to 300, 210 unless given",
        r" - `g` \[m/s^2\], a vector of 2: `g_x`, 0 unless given; `g_y`, -9.81 unless given",
        r" - `width` = `2 * 23` \[mm\]",
        r" - `eps` = `sym(grad(u))` \[1\], a 2 x 2 matrix",
        r" - `grown` = `E * tr(eps)` \[Pa\], on `inside`",
        r" - on `edge`, `flux`: `dot(grad(T), n) == (T - air) / width` \[K/m\]",
        r" \[1\]; 2 numbers for each point, point by point.",
        r" \[K\]; one number for each point.",
        r" \[GPa\]; learned, believed to be this give or take 5 GPa",
        r" `eps = sym(grad(u))`, as LaTeX.",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n\n{text}");
    }
}
