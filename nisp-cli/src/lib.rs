//! What the programs `nisp` and `nisp-lab` share: their words, their signals, the kinds of their options, and how an answer is
//! compared with a truth.

pub mod interrupt;
pub mod options;
pub mod score;
pub mod terminal;

/// The entry of a name.
///
/// # Errors
/// There is none; what to type instead.
pub fn entry(name: &str) -> Result<nisp_equations::Entry, String> {
    let entries = nisp_equations::catalogue();
    let names = entries.each_ref().map(|entry| entry.name);
    entries.into_iter().find(|entry| entry.name == name).ok_or_else(|| {
        let near = nisp_data::nearest_name(name, names);
        let hint = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
        format!("there is no `{name}`{hint}; `nisp list` shows what there is: {}", names.join(", "))
    })
}

/// As many threads as the machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
