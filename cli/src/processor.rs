//! Instructions that the processor must have.

use std::arch::x86_64::{__cpuid, __cpuid_count};

/// Refuses a processor without the instructions that this program is compiled for: it would end at the first of them without a word.
///
/// # Errors
/// The missing instructions, and how to build a program that does not need them.
// Asked of the processor itself: `is_x86_feature_detected!` takes what the compiler may assume for the answer.
#[inline(never)]
pub(crate) fn check() -> Result<(), String> {
    let extended = if __cpuid(0).eax >= 7 { __cpuid_count(7, 0).ebx } else { 0 };
    supports(__cpuid(1).ecx, extended)
}

/// Checks for FMA (bit 12 of ECX of CPUID leaf 1) and AVX2 (bit 5 of EBX of leaf 7) (Intel SDM, volume 2A, CPUID).
fn supports(leaf_1_ecx: u32, leaf_7_ebx: u32) -> Result<(), String> {
    let missing: Vec<_> = [("FMA", leaf_1_ecx & 1 << 12 != 0), ("AVX2", leaf_7_ebx & 1 << 5 != 0)]
        .into_iter()
        .filter_map(|(name, present)| (!present).then_some(name))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!(
        "this processor has no {}, which this build requires; RUSTFLAGS=\"-C target-cpu=x86-64\" cargo build \
         --release builds a portable version with the same results at a twelfth of the speed",
        missing.join(" and no ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_are_refused_by_their_missing_features() {
        assert_eq!(supports(1 << 12, 1 << 5), Ok(()));
        assert!(supports(!(1 << 12), !0).unwrap_err().starts_with("this processor has no FMA, "));
        assert!(supports(!0, !(1 << 5)).unwrap_err().starts_with("this processor has no AVX2, "));
        assert!(supports(0, 0).unwrap_err().starts_with("this processor has no FMA and no AVX2, "));
    }

    #[test]
    fn the_processor_of_this_test_is_accepted() {
        assert_eq!(check(), Ok(()));
    }
}
