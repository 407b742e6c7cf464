//! Where a solver stopped, as bytes that are read back whole or refused.
//!
//! Layout: [`MAGIC`]; the fingerprint of the problem; the state; the checksum of everything before (`crate::bytes`).

use std::fmt::Write;

use thiserror::Error;

use super::Settings;
use crate::bytes::{Fnv, Reader, Writer};
use crate::problem::Problem;
use crate::solve::state::State;

/// Begins every checkpoint; the number is that of the layout.
const MAGIC: &[u8] = b"nisp checkpoint 2\n";

/// The state of a solver and the problem it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Fingerprint of problem and settings.
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
    /// Steps that were taken.
    pub fn iterations(&self) -> u64 {
        self.state.counter("iterations").unwrap_or(0)
    }

    /// As bytes, for a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::new(MAGIC);
        writer.number(self.fingerprint);
        writer.state(&self.state);
        writer.sealed()
    }

    /// From the bytes of [`Checkpoint::to_bytes`].
    ///
    /// # Errors
    /// Bytes of something else, or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        if !bytes.starts_with(MAGIC) {
            return Err(CheckpointError::Foreign);
        }
        let mut reader = Reader::of(bytes, MAGIC).ok_or(CheckpointError::Damaged)?;
        let read = |reader: &mut Reader<'_>| Some(Self { fingerprint: reader.number()?, state: reader.state()? });
        read(&mut reader).filter(|_| reader.is_at_end()).ok_or(CheckpointError::Damaged)
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
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::checksum;

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
}
