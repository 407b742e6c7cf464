//! The error catalogue and the collector.
