//! The processor this build was made for, and the one it runs on.

use crate::error::{Error, Result};

/// The instruction sets that the build uses beyond the baseline of its architecture, of those that matter.
pub fn built_for() -> Vec<&'static str> {
    let features = [
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("bmi2", cfg!(target_feature = "bmi2")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    features.into_iter().filter(|(_, used)| *used).map(|(name, _)| name).collect()
}

/// What this processor lacks of what the build uses.
///
/// The standard library's own test is no use here: it answers yes to whatever the build was compiled for.
#[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
fn missing() -> Vec<&'static str> {
    let cpuid = raw_cpuid::CpuId::new();
    let basic = cpuid.get_feature_info();
    let extended = cpuid.get_extended_feature_info();
    let has = |name: &str| match name {
        "fma" => basic.as_ref().is_some_and(|info| info.has_fma()),
        "avx2" => extended.as_ref().is_some_and(|info| info.has_avx2()),
        "bmi2" => extended.as_ref().is_some_and(|info| info.has_bmi2()),
        "avx512f" => extended.as_ref().is_some_and(|info| info.has_avx512f()),
        _ => true,
    };
    built_for().into_iter().filter(|name| !has(name)).collect()
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "x86")))]
fn missing() -> Vec<&'static str> {
    Vec::new()
}

/// What a build that leaves the processor's means unused should know; `None` if there is nothing to say.
///
/// The kernels work on eight numbers at a time. Without AVX2 these are two halves, and without FMA a product and a sum
/// are rounded twice.
pub fn advice() -> Option<&'static str> {
    cfg!(all(target_arch = "x86_64", not(all(target_feature = "avx2", target_feature = "fma")))).then_some(
        "this build does not use AVX2 and FMA and takes up to twice as long as it could: rebuild it with \
         RUSTFLAGS=\"-Ctarget-cpu=x86-64-v3\"",
    )
}

/// Refuses to run on a processor that lacks what the build uses: the alternative is a crash in the middle.
///
/// # Errors
/// If it does.
pub fn check() -> Result<()> {
    let missing = missing();
    if missing.is_empty() {
        return Ok(());
    }
    Err(Error::failure(
        "fogbow",
        format!("was built for a processor with {}, which this one lacks", missing.join(", ")),
        "rebuild it without them: RUSTFLAGS=\"-Ctarget-cpu=x86-64\" cargo build --release",
    ))
}
