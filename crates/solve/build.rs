//! For which vector instructions runs are compiled: those of the machine that builds, which then has to compile each step once. What is
//! built for others, on another kind of machine or under the feature `every-machine`, has them all.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(avx512, avx2)");
    let for_others = var("CARGO_FEATURE_EVERY_MACHINE").is_ok() || var("HOST") != var("TARGET");
    let [avx512, avx2] = if for_others { [true, true] } else { on_this_machine() };
    for (compiled, name) in [(avx512, "avx512"), (avx2, "avx2")] {
        if compiled {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

/// Whether runs would go on AVX-512, or on AVX2 as the widest.
#[cfg(target_arch = "x86_64")]
fn on_this_machine() -> [bool; 2] {
    use std::arch::is_x86_feature_detected as has;
    let avx512 = has!("avx512f") && has!("avx512bitalg") && has!("avx512vbmi2") && has!("gfni") && has!("vaes");
    [avx512, !avx512]
}

#[cfg(not(target_arch = "x86_64"))]
fn on_this_machine() -> [bool; 2] {
    [false, false]
}
