//! The shape of the fleet's columns: vehicles live in blocks of [`LANES`] slots, one array per quantity.
//!
//! Loops over a block have a constant trip count, no branches and no aliasing between arrays, so that the compiler turns
//! them into vector code for whatever instruction set the machine has. Nothing in such a loop may call the platform's
//! maths library or fuse multiply-adds: both give other bits on other machines. The macro `vectorised!` compiles them.

use std::cell::Cell;

/// Slots of one block. A multiple of the widest vector (8 doubles).
pub const LANES: usize = 16;

/// One value per slot of a block.
pub type Lanes = [f64; LANES];

/// A flag per slot, 0.0 or 1.0, so that selecting by it stays in vector registers.
pub type Flags = [f64; LANES];

/// Vector instructions that the loops over lanes are compiled for. All give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every processor of the architecture has.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512.
    Avx512,
}

thread_local! {
    static IN_USE: Cell<Option<InstructionSet>> = const { Cell::new(None) };
}

impl InstructionSet {
    /// All sets, best first.
    const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Baseline];

    /// The sets that this machine has, best first.
    pub fn available() -> Vec<Self> {
        Self::ALL.into_iter().filter(|set| set.is_available()).collect()
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        use std::is_x86_feature_detected as has;
        match self {
            Self::Baseline => true,
            Self::Avx2 => has!("avx2") && has!("fma"),
            Self::Avx512 => has!("avx512f") && has!("avx512vl") && has!("avx512dq") && has!("avx512bw"),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Baseline
    }

    /// What this thread computes with: the best that there is, unless [`InstructionSet::during`] says otherwise.
    pub fn in_use() -> Self {
        let best = || Self::ALL.into_iter().find(|set| set.is_available()).unwrap_or(Self::Baseline);
        IN_USE.get().unwrap_or_else(best)
    }

    /// Does some work of this thread with this set, to measure or to compare; where the machine lacks it, with the
    /// baseline.
    pub fn during<R>(self, work: impl FnOnce() -> R) -> R {
        let before = IN_USE.replace(Some(self));
        let result = work();
        IN_USE.set(before);
        result
    }
}

/// Compiles a function of loops over lanes once for each [`InstructionSet`], all from the same source, and calls the one
/// [in use](InstructionSet::in_use).
macro_rules! vectorised {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $body:block) => {
        $(#[$doc])*
        $visibility fn $name($($argument: $type),*) {
            #[inline(always)]
            fn lanes($($argument: $type),*) $body

            fn baseline($($argument: $type),*) {
                lanes($($argument),*);
            }

            #[multiversion::multiversion(targets("x86_64+avx2+fma"))]
            fn avx2($($argument: $type),*) {
                // The version that the macro adds for other machines is not compiled a second time.
                multiversion::target::match_target! {
                    "x86_64+avx2+fma" => lanes($($argument),*),
                    _ => baseline($($argument),*),
                }
            }

            #[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw"))]
            fn avx512($($argument: $type),*) {
                multiversion::target::match_target! {
                    "x86_64+avx512f+avx512vl+avx512dq+avx512bw" => lanes($($argument),*),
                    _ => baseline($($argument),*),
                }
            }

            match $crate::lanes::InstructionSet::in_use() {
                $crate::lanes::InstructionSet::Baseline => baseline($($argument),*),
                $crate::lanes::InstructionSet::Avx2 => avx2($($argument),*),
                $crate::lanes::InstructionSet::Avx512 => avx512($($argument),*),
            }
        }
    };
}
pub(crate) use vectorised;
