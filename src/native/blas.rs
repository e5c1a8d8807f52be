//! The kernels that OpenBLAS computes with.
//!
//! OpenBLAS chooses them by the model number of the processor when it is loaded. Debian's version, 0.3.21, takes a
//! processor that is newer than itself for one of 2004 (`Prescott`, SSE3), and AMD's with AVX-512 for one without.
//! `OPENBLAS_CORETYPE` overrules it, but only before the library is loaded. So the program starts itself once more.

use std::env;
use std::ffi::CStr;
use std::os::unix::process::CommandExt;
use std::process::Command;

use squeal_sys as sys;

use crate::{Error, Result};

/// What overrules the choice of OpenBLAS.
const CORE_TYPE: &str = "OPENBLAS_CORETYPE";
/// Kernels with AVX2, and with AVX-512.
const WITH_AVX2: [&str; 2] = ["haswell", "zen"];
const WITH_AVX512: [&str; 3] = ["skylakex", "cooperlake", "sapphirerapids"];

/// Vector instructions of a processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Vectors {
    /// At most AVX.
    Short,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 F, BW, DQ and VL.
    Avx512,
}

/// Starts the program once more where OpenBLAS has chosen kernels for an older processor, with others; does not come
/// back then. The user's own `OPENBLAS_CORETYPE` is kept. Call it before MPI starts.
pub fn restart_with_fitting_kernels() {
    if env::var_os(CORE_TYPE).is_some() {
        return;
    }
    let better = kernels().and_then(|chosen| better_kernels(&chosen, vectors()));
    if let (Some(better), Ok(program)) = (better, env::current_exe()) {
        let mut arguments = env::args_os();
        let name = arguments.next().unwrap_or_default();
        // It returns where the program cannot be started, which then goes on as it is.
        let _ = Command::new(program).arg0(name).args(arguments).env(CORE_TYPE, better).exec();
    }
}

/// Has BLAS take its buffer. OpenBLAS asks for it when it is first needed, and where there is no memory it asks for
/// ever.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub(in crate::native) fn take_buffer() -> Result<()> {
    // SAFETY: the shim computes with memory of its own.
    match unsafe { sys::squeal_take_blas_buffer() } {
        0 => Err(Error::OutOfMemory { what: "BLAS needs 160 MB of address space".into(), needed_mb: Some(160.0) }),
        _ => Ok(()),
    }
}

/// The name of the kernels that OpenBLAS has chosen; none of another BLAS.
fn kernels() -> Option<String> {
    // SAFETY: the shim gives a text that lives as long as the process, or null.
    let name = unsafe { sys::squeal_blas_kernels() };
    // SAFETY: as above.
    (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) }.to_string_lossy().into_owned())
}

/// Kernels for longer vectors than those chosen have, where the processor has these.
fn better_kernels(chosen: &str, processor: Vectors) -> Option<&'static str> {
    let is_one_of = |known: &[&str]| known.iter().any(|name| name.eq_ignore_ascii_case(chosen));
    let own = match () {
        () if is_one_of(&WITH_AVX512) => Vectors::Avx512,
        () if is_one_of(&WITH_AVX2) => Vectors::Avx2,
        () => Vectors::Short,
    };
    match processor {
        _ if processor <= own => None,
        Vectors::Avx512 => Some("SkylakeX"),
        _ => Some("Haswell"),
    }
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> Vectors {
    let has_avx512 = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    match is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        true if has_avx512 => Vectors::Avx512,
        true => Vectors::Avx2,
        false => Vectors::Short,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn vectors() -> Vectors {
    Vectors::Short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_are_changed_for_longer_vectors_only() {
        assert_eq!(better_kernels("Prescott", Vectors::Avx512), Some("SkylakeX"));
        assert_eq!(better_kernels("Zen", Vectors::Avx512), Some("SkylakeX"));
        assert_eq!(better_kernels("Sandybridge", Vectors::Avx2), Some("Haswell"));
        for (chosen, processor) in [
            ("Haswell", Vectors::Avx2),
            ("Prescott", Vectors::Short),
            ("SkylakeX", Vectors::Avx512),
            ("SAPPHIRERAPIDS", Vectors::Avx512),
            ("Cooperlake", Vectors::Avx2),
        ] {
            assert_eq!(better_kernels(chosen, processor), None, "{chosen}");
        }
    }
}
