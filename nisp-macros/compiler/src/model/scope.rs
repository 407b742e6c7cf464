//! What names mean.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Span;

use super::value::Value;
use crate::error::{Checked, Errors, catalogue};
use crate::syntax::Name;

/// What a name was declared as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    Coordinate,
    Field,
    Source,
    Parameter,
    Constant,
    Column,
    Definition,
}

impl Meaning {
    /// As a message calls it.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Meaning::Coordinate => "coordinate",
            Meaning::Field => "field",
            Meaning::Source => "source",
            Meaning::Parameter => "parameter",
            Meaning::Constant => "constant",
            Meaning::Column => "column",
            Meaning::Definition => "definition",
        }
    }
}

/// A declared name.
#[derive(Clone, Debug)]
pub(super) struct Symbol {
    pub(super) meaning: Meaning,
    /// None if its definition was wrong: using it is no further mistake.
    pub(super) value: Option<Value>,
    pub(super) span: Span,
    /// Its number among the module's coordinates, fields or parameters; the first one of a vector.
    pub(super) index: usize,
    /// For a component `u_x`: the vector's name.
    pub(super) parent: Option<String>,
    pub(super) used: bool,
}

/// All names of a module, and those of the group at hand.
#[derive(Debug, Default)]
pub(super) struct Scope {
    module: BTreeMap<String, Symbol>,
    group: Option<BTreeMap<String, Symbol>>,
    /// Names in statements that could not be read.
    pub(super) broken: BTreeSet<String>,
    /// Definitions further down, to tell "not yet" from "never".
    pub(super) later: BTreeSet<String>,
}

impl Scope {
    /// Adds a name, unless it is taken: then that is reported, at the second one.
    pub(super) fn declare(&mut self, name: &Name, symbol: Symbol, errors: &mut Errors) -> Checked<()> {
        if name.text == "pi" {
            self.broken.insert(name.text.clone());
            return Err(errors.report(name.span, catalogue::reserved_name(&name.text)));
        }
        if let Some(first) = self.find(&name.text) {
            let message = catalogue::declared_twice(&name.text, first.meaning.noun(), first.parent.as_deref());
            return Err(errors.report(name.span, message));
        }
        self.later.remove(&name.text);
        self.group.as_mut().unwrap_or(&mut self.module).insert(name.text.clone(), symbol);
        Ok(())
    }

    /// Looks a name up without counting it as used.
    pub(super) fn find(&self, name: &str) -> Option<&Symbol> {
        self.group.as_ref().and_then(|group| group.get(name)).or_else(|| self.module.get(name))
    }

    /// Counts a name as used.
    pub(super) fn mark_used(&mut self, name: &str) {
        let group = self.group.as_mut().and_then(|group| group.get_mut(name));
        let Some(symbol) = group.or_else(|| self.module.get_mut(name)) else { return };
        symbol.used = true;
        if let Some(parent) = symbol.parent.clone() {
            self.mark_used(&parent);
        }
    }

    /// Opens the names of a group.
    pub(super) fn enter_group(&mut self) {
        self.group = Some(BTreeMap::new());
    }

    /// Closes them and hands them back.
    pub(super) fn leave_group(&mut self) -> BTreeMap<String, Symbol> {
        self.group.take().unwrap_or_default()
    }

    /// All names that can be used here.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.group.iter().flatten().chain(&self.module).map(|(name, _)| name.as_str())
    }

    /// The module's names, in alphabetical order.
    pub(super) fn module_symbols(&self) -> impl Iterator<Item = (&String, &Symbol)> {
        self.module.iter()
    }
}
