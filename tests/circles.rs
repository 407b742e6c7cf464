//! Modules of every crate import each other without circles: whoever reads one has to know only what lies below it.
//!
//! The sources are read as tokens. A path that begins with `crate`, `super` or `self` is an edge between the two modules at
//! which the importing and the imported one part ways; what stands under `#[cfg(test)]` does not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A module by the names on the way to it from its crate's root, which has none.
type Module = Vec<String>;

/// What each module imports.
type Imports = BTreeMap<Module, BTreeSet<Module>>;

#[test]
fn modules_import_each_other_without_circles() {
    let crates = crates(Path::new(env!("CARGO_MANIFEST_DIR")));
    assert!(crates.len() > 8, "the workspace has more crates than {crates:?}");
    let circles: Vec<String> = crates.iter().flat_map(|folder| circles(folder)).collect();
    assert!(circles.is_empty(), "modules that import each other:\n{}", circles.join("\n"));
}

#[test]
fn a_circle_is_found_at_any_depth() {
    let files = [
        (vec!["a"], "use crate::b::{self, c::Deep}; use std::fmt;"),
        (vec!["b"], "#[cfg(test)] mod tests { use crate::a; }"),
        (vec!["b", "c"], "use super::d::Two; fn f() -> crate::b::c::One {}"),
        (vec!["b", "d"], "use super::{c, Other};"),
    ];
    let modules = files.map(|(module, text)| {
        (module.into_iter().map(String::from).collect::<Module>(), text.parse::<TokenStream>().unwrap())
    });
    let imports = imports(&modules);
    let of = |path: &[&str]| path.iter().map(|name| name.to_string()).collect::<Module>();
    assert_eq!(imports[&of(&["a"])], BTreeSet::from([of(&["b"])]));
    assert_eq!(circle(&imports), Some(vec![of(&["b", "c"]), of(&["b", "d"])]));
}

/// Folders of the workspace that hold a crate.
fn crates(folder: &Path) -> Vec<PathBuf> {
    let own = folder.join("Cargo.toml").is_file() && folder.join("src").is_dir();
    let inner = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let inner = inner.filter(|entry| entry.file_type().unwrap().is_dir() && entry.file_name() != "target");
    let inner = inner.filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'));
    own.then(|| folder.to_path_buf()).into_iter().chain(inner.flat_map(|entry| crates(&entry.path()))).collect()
}

/// Circles of a crate in words: each without an import of those before, so that all are named at once.
fn circles(folder: &Path) -> Vec<String> {
    let mut modules = Vec::new();
    read(&folder.join("src"), &[], &mut modules);
    let mut imports = imports(&modules);
    let mut found = Vec::new();
    while let Some(circle) = circle(&imports) {
        let names = circle.iter().map(|module| module.join("::")).collect::<Vec<_>>().join(" -> ");
        found.push(format!("{}: {names}", folder.display()));
        imports.get_mut(&circle[circle.len() - 1]).unwrap().remove(&circle[0]);
    }
    found
}

/// The modules below a folder of sources.
fn read(folder: &Path, here: &[String], modules: &mut Vec<(Module, TokenStream)>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let inner: Module = here.iter().cloned().chain([name.clone()]).collect();
        if path.is_dir() {
            if name != "bin" {
                read(&path, &inner, modules);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let is_root = ["mod", "lib", "main"].contains(&name.as_str());
            let text = std::fs::read_to_string(&path).unwrap();
            let tokens = text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            modules.push((if is_root { here.to_vec() } else { inner }, tokens));
        }
    }
}

/// What modules import, as edges between siblings.
fn imports(modules: &[(Module, TokenStream)]) -> Imports {
    let known: BTreeSet<&[String]> = modules.iter().map(|(module, _)| module.as_slice()).collect();
    let mut imports = Imports::new();
    for (here, tokens) in modules {
        let mut paths = Vec::new();
        find(&tokens.clone().into_iter().collect::<Vec<_>>(), here, &mut paths);
        for path in paths {
            let length = (0..=path.len()).rev().find(|&length| known.contains(&path[..length])).unwrap_or(0);
            let common = here.iter().zip(&path[..length]).take_while(|(a, b)| a == b).count();
            if common < here.len() && common < length {
                let from = imports.entry(here[..=common].to_vec()).or_default();
                from.insert(path[..=common].to_vec());
            }
        }
    }
    imports
}

/// The paths that tokens of a module name, from the crate's root.
fn find(tokens: &[TokenTree], here: &[String], paths: &mut Vec<Module>) {
    let mut at = 0;
    while at < tokens.len() {
        let base = match tokens[at].to_string().as_str() {
            "crate" => Some(Vec::new()),
            "super" => Some(here[..here.len().saturating_sub(1)].to_vec()),
            "self" => Some(here.to_vec()),
            _ => None,
        };
        match (&tokens[at], base) {
            (_, Some(base)) if is_colons(tokens, at + 1) => at = follow(tokens, at + 3, base, paths),
            (TokenTree::Punct(hash), _) if hash.as_char() == '#' && is_test(tokens.get(at + 1)) => {
                // The item that the attribute belongs to ends with a semicolon or a body.
                let ends = |token: &TokenTree| match token {
                    TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
                    token => token.to_string() == ";",
                };
                at = tokens[at..].iter().position(ends).map_or(tokens.len(), |length| at + length + 1);
            }
            (TokenTree::Group(group), _) => {
                find(&group.stream().into_iter().collect::<Vec<_>>(), here, paths);
                at += 1;
            }
            _ => at += 1,
        }
    }
}

/// Follows a path or a tree of paths from `at` on, and gives where it ends.
fn follow(tokens: &[TokenTree], mut at: usize, mut path: Module, paths: &mut Vec<Module>) -> usize {
    loop {
        match tokens.get(at) {
            Some(TokenTree::Ident(name)) if name == "super" => {
                path.pop();
            }
            Some(TokenTree::Ident(name)) if name != "self" => path.push(name.to_string()),
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                for one in inner.split(|token| token.to_string() == ",").filter(|one| !one.is_empty()) {
                    follow(one, 0, path.clone(), paths);
                }
                return at + 1;
            }
            _ => {}
        }
        if !is_colons(tokens, at + 1) {
            paths.push(path);
            return at + 1;
        }
        at += 3;
    }
}

fn is_colons(tokens: &[TokenTree], at: usize) -> bool {
    [at, at + 1].iter().all(|&at| tokens.get(at).is_some_and(|token| token.to_string() == ":"))
}

fn is_test(attribute: Option<&TokenTree>) -> bool {
    attribute.is_some_and(|attribute| attribute.to_string().replace(' ', "") == "[cfg(test)]")
}

/// The modules of a circle, if there is one, in the order in which they import each other.
fn circle(imports: &Imports) -> Option<Vec<Module>> {
    fn visit(
        module: &Module,
        imports: &Imports,
        way: &mut Vec<Module>,
        done: &mut BTreeSet<Module>,
    ) -> Option<Vec<Module>> {
        if let Some(at) = way.iter().position(|other| other == module) {
            return Some(way[at..].to_vec());
        }
        if !done.insert(module.clone()) {
            return None;
        }
        way.push(module.clone());
        let found = imports.get(module).into_iter().flatten().find_map(|next| visit(next, imports, way, done));
        way.pop();
        found
    }
    let mut done = BTreeSet::new();
    imports.keys().find_map(|module| visit(module, imports, &mut Vec::new(), &mut done))
}
