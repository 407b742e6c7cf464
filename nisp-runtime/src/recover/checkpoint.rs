//! Where a solver stopped, as bytes that are read back whole or refused.
//!
//! Layout, all numbers little-endian: [`MAGIC`]; the fingerprint of the problem; the state, that is the method's name, the
//! number of vectors and each with its name, length and numbers, the number of counters and each with its name and value;
//! the checksum of everything before. Texts and lists are preceded by their length; integers take eight bytes.

use std::fmt::Write;

use thiserror::Error;

use super::Settings;
use crate::problem::Problem;
use crate::solve::state::State;

/// Begins every checkpoint; the number is that of the layout.
const MAGIC: &[u8] = b"nisp checkpoint 2\n";

/// The state of a solver and the problem it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Of problem and settings.
    pub(super) fingerprint: u64,
    pub(super) state: State,
}

/// Why there is nothing to go on from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CheckpointError {
    /// Points that are drawn anew are not part of a checkpoint.
    #[error("points that are drawn anew are not part of a checkpoint; go on without resampling, from the start")]
    Resampling,
    /// Bytes of something else, or of a version that is read no more.
    #[error("not a checkpoint of this version of nisp; start afresh")]
    Foreign,
    /// Bytes that were cut or changed.
    #[error("the checkpoint is damaged: its checksum does not fit; start afresh, or take another copy")]
    Damaged,
    /// A checkpoint of something else.
    #[error(
        "the checkpoint is of another problem: give the same scene, data, parameters, seed, precision, optimizer and network \
         as in the run that wrote it"
    )]
    Other,
}

impl Checkpoint {
    pub(super) fn new(problem: &Problem, settings: &Settings, state: State) -> Self {
        Self { fingerprint: fingerprint(problem, settings), state }
    }

    /// Steps that were taken.
    pub fn iterations(&self) -> u64 {
        self.state.counter("iterations").unwrap_or(0)
    }

    /// As bytes, for a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        let number = |bytes: &mut Vec<u8>, x: u64| bytes.extend(x.to_le_bytes());
        let text = |bytes: &mut Vec<u8>, text: &str| {
            number(bytes, text.len() as u64);
            bytes.extend(text.as_bytes());
        };
        number(&mut bytes, self.fingerprint);
        text(&mut bytes, &self.state.method);
        number(&mut bytes, self.state.vectors.len() as u64);
        for (name, vector) in &self.state.vectors {
            text(&mut bytes, name);
            number(&mut bytes, vector.len() as u64);
            vector.iter().for_each(|x| number(&mut bytes, x.to_bits()));
        }
        number(&mut bytes, self.state.counters.len() as u64);
        for (name, count) in &self.state.counters {
            text(&mut bytes, name);
            number(&mut bytes, *count);
        }
        let sum = checksum(&bytes);
        number(&mut bytes, sum);
        bytes
    }

    /// From the bytes of [`Checkpoint::to_bytes`].
    ///
    /// # Errors
    /// Bytes of something else, or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        if !bytes.starts_with(MAGIC) {
            return Err(CheckpointError::Foreign);
        }
        let (content, sum) = bytes.split_last_chunk::<8>().ok_or(CheckpointError::Damaged)?;
        if checksum(content) != u64::from_le_bytes(*sum) {
            return Err(CheckpointError::Damaged);
        }
        let mut reader = Reader(&content[MAGIC.len()..]);
        reader.checkpoint().filter(|_| reader.0.is_empty()).ok_or(CheckpointError::Damaged)
    }
}

/// What is left to read; nothing is given where it ends too early.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn checkpoint(&mut self) -> Option<Checkpoint> {
        let fingerprint = self.number()?;
        let mut state = State { method: self.text()?, ..State::default() };
        for _ in 0..self.number()? {
            let (name, len) = (self.text()?, self.number()?);
            // A length that the bytes cannot hold ends the reading before it takes memory.
            let vector: Option<Vec<f64>> = (0..len).map(|_| Some(f64::from_bits(self.number()?))).collect();
            state.vectors.push((name, vector?));
        }
        for _ in 0..self.number()? {
            state.counters.push((self.text()?, self.number()?));
        }
        Some(Checkpoint { fingerprint, state })
    }

    fn number(&mut self) -> Option<u64> {
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
}

/// A number that two problems share only if they have the same equations, data and settings. How long to run, and on how many
/// threads, is not among the settings, since no iterate depends on it.
pub(super) fn fingerprint(problem: &Problem, settings: &Settings) -> u64 {
    let mut hash = Fnv::new();
    let Settings { precision, optimizer, architecture, carrier, resampling, data_first, seed, .. } = settings;
    // The text of a float has all of its bits. Hashing cannot fail.
    let _ = write!(hash, "{:?}{problem:?}", problem.scene().schema);
    let _ = write!(hash, "{precision:?}{optimizer:?}{architecture:?}{carrier:?}{resampling:?}{data_first:?}{seed}");
    hash.0
}

/// Differs for any two contents of the same length that differ in one byte, and else by chance with all but certainty.
fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Fnv::new();
    hash.add(bytes);
    hash.0
}

/// FNV-1a with 64 bits (Fowler, Noll and Vo): the same on every machine and in every version.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
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

    fn checkpoint() -> Checkpoint {
        let state = State::new("lm").with("theta", &[0.1, -0.0, 5e-324]).with_counter("iterations", 7);
        Checkpoint { fingerprint: 42, state }
    }

    #[test]
    fn bytes_read_back_to_the_bit() {
        let read = Checkpoint::from_bytes(&checkpoint().to_bytes()).unwrap();
        assert_eq!(read, checkpoint());
        assert!(read.state.vectors[0].1[1].is_sign_negative());
        assert_eq!(read.iterations(), 7);
    }

    #[test]
    fn every_changed_byte_and_every_cut_is_noticed() {
        let good = checkpoint().to_bytes();
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 1 << (at % 8);
            assert!(Checkpoint::from_bytes(&bad).is_err(), "byte {at}");
            assert!(Checkpoint::from_bytes(&good[..at]).is_err(), "cut at {at}");
        }
        assert_eq!(Checkpoint::from_bytes(b"t_s,v_V\n"), Err(CheckpointError::Foreign));
        assert_eq!(Checkpoint::from_bytes(&[good, vec![0]].concat()), Err(CheckpointError::Damaged));
    }

    #[test]
    fn lengths_that_lie_take_no_memory() {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([42_u64, u64::MAX].map(u64::to_le_bytes).concat());
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        assert_eq!(Checkpoint::from_bytes(&bytes), Err(CheckpointError::Damaged));
    }

    #[test]
    fn the_checksum_is_the_published_one() {
        // From the authors' list of test vectors.
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
