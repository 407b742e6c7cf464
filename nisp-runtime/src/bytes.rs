//! The layout of what is kept in files: named texts, vectors and counters between a heading and a checksum.
//!
//! All numbers are little-endian and take eight bytes. Texts and lists are preceded by their length. What was cut or changed
//! is noticed by its checksum.

use std::fmt::Write;

use crate::solve::state::State;

/// Bytes under a heading.
pub(crate) struct Writer(Vec<u8>);

impl Writer {
    pub(crate) fn new(heading: &[u8]) -> Self {
        Self(heading.to_vec())
    }

    pub(crate) fn number(&mut self, x: u64) {
        self.0.extend(x.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        self.0.extend(text.as_bytes());
    }

    /// The number of texts, and each with its name.
    pub(crate) fn texts(&mut self, texts: &[(String, String)]) {
        self.number(texts.len() as u64);
        for (name, text) in texts {
            self.text(name);
            self.text(text);
        }
    }

    /// The method's name, the number of vectors and each with its name, length and numbers, the number of counters and each
    /// with its name and value.
    pub(crate) fn state(&mut self, state: &State) {
        self.text(&state.method);
        self.number(state.vectors.len() as u64);
        for (name, vector) in &state.vectors {
            self.text(name);
            self.number(vector.len() as u64);
            vector.iter().for_each(|x| self.number(x.to_bits()));
        }
        self.number(state.counters.len() as u64);
        for (name, count) in &state.counters {
            self.text(name);
            self.number(*count);
        }
    }

    /// All of it with its checksum behind.
    pub(crate) fn sealed(mut self) -> Vec<u8> {
        let sum = checksum(&self.0);
        self.number(sum);
        self.0
    }
}

/// What is left to read; nothing is given where it ends too early.
pub(crate) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// What stands between a heading and the checksum; nothing if these do not fit.
    pub(crate) fn of(bytes: &'a [u8], heading: &[u8]) -> Option<Self> {
        let (content, sum) = bytes.split_last_chunk::<8>()?;
        let inner = content.strip_prefix(heading)?;
        (checksum(content) == u64::from_le_bytes(*sum)).then_some(Self(inner))
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn number(&mut self) -> Option<u64> {
        let (bytes, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(u64::from_le_bytes(*bytes))
    }

    fn text(&mut self) -> Option<String> {
        let len = usize::try_from(self.number()?).ok()?;
        let (text, rest) = self.0.split_at_checked(len)?;
        self.0 = rest;
        String::from_utf8(text.to_vec()).ok()
    }

    pub(crate) fn texts(&mut self) -> Option<Vec<(String, String)>> {
        (0..self.number()?).map(|_| Some((self.text()?, self.text()?))).collect()
    }

    pub(crate) fn state(&mut self) -> Option<State> {
        let mut state = State::new(self.text()?);
        for _ in 0..self.number()? {
            let (name, len) = (self.text()?, self.number()?);
            // A length that the bytes cannot hold ends the reading before it takes memory.
            let vector: Option<Vec<f64>> = (0..len).map(|_| Some(f64::from_bits(self.number()?))).collect();
            state.vectors.push((name, vector?));
        }
        for _ in 0..self.number()? {
            state.counters.push((self.text()?, self.number()?));
        }
        Some(state)
    }
}

/// Differs for any two contents of the same length that differ in one byte, and else by chance with all but certainty.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Fnv::new();
    hash.add(bytes);
    hash.0
}

/// FNV-1a with 64 bits (Fowler, Noll and Vo): the same on every machine and in every version.
pub(crate) struct Fnv(u64);

impl Fnv {
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(crate) fn value(&self) -> u64 {
        self.0
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_published_one() {
        // From the authors' list of test vectors.
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
