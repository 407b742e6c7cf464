//! Which instruction set to use.

use std::sync::OnceLock;

/// An instruction set that this machine has: there is no safe way to make any other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Isa(pub(super) Level);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Level {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "aarch64")]
    Neon,
    Scalar,
}

impl Isa {
    /// Plain code without vector instructions of our own: runs everywhere.
    pub const SCALAR: Isa = Isa(Level::Scalar);

    /// The best instruction set of this machine, or the one that the environment variable `NISP_ISA` names (`avx512`,
    /// `avx2`, `neon`, `scalar`) if the machine has it. Determined once per process.
    pub fn detect() -> Isa {
        static DETECTED: OnceLock<Isa> = OnceLock::new();
        *DETECTED.get_or_init(|| {
            let wanted = std::env::var("NISP_ISA").ok().and_then(|name| Isa::from_name(&name));
            wanted.unwrap_or_else(|| Isa::available().next().unwrap_or(Isa::SCALAR))
        })
    }

    /// Every instruction set that this machine has, best first; [`Isa::SCALAR`] is always among them.
    pub fn available() -> impl Iterator<Item = Isa> {
        Level::ALL.iter().filter(|level| level.present()).map(|&level| Isa(level))
    }

    /// The instruction set of this name (see [`Isa::name`]), if this machine has it.
    pub fn from_name(name: &str) -> Option<Isa> {
        Isa::available().find(|isa| isa.name() == name)
    }

    /// `avx512`, `avx2`, `neon` or `scalar`.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "avx2",
            #[cfg(target_arch = "aarch64")]
            Level::Neon => "neon",
            Level::Scalar => "scalar",
        }
    }
}

impl Level {
    const ALL: &[Level] = &[
        #[cfg(target_arch = "x86_64")]
        Level::Avx512,
        #[cfg(target_arch = "x86_64")]
        Level::Avx2,
        #[cfg(target_arch = "aarch64")]
        Level::Neon,
        Level::Scalar,
    ];

    fn present(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => {
                Level::Avx2.present()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "aarch64")]
            Level::Neon => std::arch::is_aarch64_feature_detected!("neon"),
            Level::Scalar => true,
        }
    }
}
