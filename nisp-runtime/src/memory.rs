//! Whether there is memory for what is about to be allocated: where there is none the system ends the program without a word.

use std::fs::read_to_string;

use thiserror::Error;

/// Something that would take more memory than there is.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{what} would take about {} of memory, and {} are free; {instead}", Bytes(*needed), Bytes(*free))]
pub struct Exceeded {
    /// What would take it.
    pub what: String,
    /// Bytes that it would take.
    pub needed: f64,
    /// Bytes that are free.
    pub free: f64,
    /// What to do.
    pub instead: &'static str,
}

/// Checks that there is memory for so many bytes, as far as the system says how much there is.
///
/// # Errors
/// There is less.
pub(crate) fn require(needed: f64, what: impl FnOnce() -> String, instead: &'static str) -> Result<(), Exceeded> {
    match free() {
        Some(free) if needed > free => Err(Exceeded { what: what(), needed, free, instead }),
        _ => Ok(()),
    }
}

/// Bytes that may still be allocated: of the machine, and of the container that the program runs in. Linux says so.
fn free() -> Option<f64> {
    let machine = read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
    let number = |name: &str| read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?.trim().parse::<f64>().ok();
    // Without a limit it is a word.
    let container = number("memory.max").zip(number("memory.current")).map(|(most, used)| (most - used).max(0.0));
    [machine, container].into_iter().flatten().reduce(f64::min)
}

/// Bytes that the system says are available.
fn available(meminfo: &str) -> Option<f64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok().map(|kibibytes| 1024.0 * kibibytes)
}

/// Bytes as people read them.
struct Bytes(f64);

impl std::fmt::Display for Bytes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            small if small < 1e9 => write!(f, "{:.0} MB", small / 1e6),
            large => write!(f, "{:.1} GB", large / 1e9),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_available_is_read() {
        let text = "MemTotal:       24601600 kB\nMemFree:          123 kB\nMemAvailable:   19922944 kB\n";
        assert_eq!(available(text), Some(19_922_944.0 * 1024.0));
        assert_eq!(available("MemTotal: 5 kB\n"), None);
    }

    /// No machine has an exabyte; the message says how much is wanted and what to do.
    #[test]
    fn too_much_is_refused_with_a_remedy() {
        assert_eq!(require(1.0, || "one byte".into(), "take less"), Ok(()));
        let Some(free) = free() else { return };
        let refused = require(1e18, || "an exabyte".into(), "take less").unwrap_err();
        assert!((refused.free / free - 1.0).abs() < 0.5, "{refused:?}");
        let words = Exceeded { free: 5e8, ..refused }.to_string();
        assert_eq!(words, "an exabyte would take about 1000000000.0 GB of memory, and 500 MB are free; take less");
    }
}
