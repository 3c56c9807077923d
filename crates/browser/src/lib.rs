//! A loader live in a browser: the steps of a simulation, and what the rules say of a release, behind C functions for WebAssembly.
//!
//! The page writes numbers into [`forcefeel_room`] and reads numbers there; nothing else crosses. `docs/demo/loader.js` is that page.

#![expect(unsafe_code, reason = "names for the page, and its memory")]

mod loader;
mod release;

use forcefeel_model::parameters::Parameters;
use forcefeel_solve::outputs::OUTPUTS;
use loader::{Loader, Setup};
use release::Rule;

/// Room for so many numbers, for as long as the page is there.
#[unsafe(no_mangle)]
pub extern "C" fn forcefeel_room(numbers: usize) -> *mut f64 {
    vec![0.0; numbers].leak().as_mut_ptr()
}

/// A loader in equilibrium.
#[unsafe(no_mangle)]
pub extern "C" fn forcefeel_loader(setup: &Setup) -> Box<Loader> {
    Box::new(Loader::new(setup))
}

/// Forgets a loader.
#[unsafe(no_mangle)]
pub extern "C" fn forcefeel_forget(loader: Box<Loader>) {
    drop(loader);
}

/// Holds the grip at this angle in rad; lets go of it where it is not a number.
#[unsafe(no_mangle)]
pub extern "C" fn forcefeel_hold(loader: &mut Loader, angle: f64) {
    loader.hand.take_to((!angle.is_nan()).then_some(angle));
}

/// Adds a force in N and a spring rate in N m/rad to the feel, from the next step on.
#[unsafe(no_mangle)]
pub extern "C" fn forcefeel_add(loader: &mut Loader, force: f64, stiffness: f64) {
    loader.added = [force, stiffness];
}

/// Takes steps: at the start of each the [`OUTPUTS`] of a simulation, a row a step.
///
/// # Safety
/// There is room for so many rows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn forcefeel_run(loader: &mut Loader, steps: usize, rows: *mut [f64; OUTPUTS.len()]) {
    // SAFETY: as above.
    let rows = unsafe { core::slice::from_raw_parts_mut(rows, steps) };
    rows.fill_with(|| loader.step());
}

/// The programmed feel's release at the angle at which a loader is held, a sample every `step_s`.
///
/// # Safety
/// There is room for so many samples.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn forcefeel_ideal(setup: &Setup, step_s: f64, samples: usize, angles: *mut f64) {
    // SAFETY: as above.
    let angles = unsafe { core::slice::from_raw_parts_mut(angles, samples) };
    release::ideal(&Parameters::from_values(&setup.values).feel, setup.held_rad, step_s, angles);
}

/// The verdict on a release beside the programmed feel's: place of the first quantity by which it fails or -1, and margin.
///
/// # Safety
/// There are so many samples of both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn forcefeel_judge(
    rule: &Rule,
    step_s: f64,
    samples: usize,
    angles: *const f64,
    ideal: *const f64,
    verdict: &mut [f64; 2],
) {
    // SAFETY: as above.
    let [angles, ideal] = [angles, ideal].map(|angles| unsafe { core::slice::from_raw_parts(angles, samples) });
    let outcome = rule.judge(angles, ideal, step_s);
    #[expect(clippy::cast_precision_loss, reason = "a place in a short list")]
    let first = outcome.first_failing.map_or(-1.0, |place| place as f64);
    *verdict = [first, outcome.margin];
}
