//! Robust losses: the words that may follow `with`.
//!
//! What a loss is, is the runtime's matter: the compiler knows their names alone and passes the threshold on.

/// By the word after `with`, the variant of the runtime's `schema::Loss`.
const LOSSES: [(&str, &str); 3] = [("huber", "Huber"), ("welsch", "Welsch"), ("tukey", "Tukey")];

/// A robust loss of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robust {
    /// Variant of the runtime's `schema::Loss`.
    pub variant: &'static str,
    /// From where on a misfit counts less, in units of the row's natural size.
    pub threshold: f64,
}

/// The variant of a loss, by its word.
pub(crate) fn variant(word: &str) -> Option<&'static str> {
    LOSSES.iter().find(|(known, _)| *known == word).map(|(_, variant)| *variant)
}

/// All words, as the user writes them: `` `huber(threshold)` ``.
pub(crate) fn words() -> Vec<String> {
    LOSSES.iter().map(|(word, _)| format!("`{word}(threshold)`")).collect()
}
