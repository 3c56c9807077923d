//! The functions that C calls.
#![expect(unsafe_code, reason = "names for C, its arrays, and memory that C keeps")]

use crate::axis::{Axis, Input, Output};
use crate::loader::{Loader, Setting};
use crate::surface::{FLOWN, hinge_moment};
use core::mem::MaybeUninit;

#[cfg(not(feature = "single"))]
type Real = f64;
#[cfg(feature = "single")]
type Real = f32;

/// What a call came to: `forcefeel_status` of the header.
const OK: u32 = 0;
const NOT_READY: u32 = 1;
const BAD_INPUT: u32 = 2;

/// Says that an axis has been initialized: C's memory is zero before, or anything at all.
const READY: u32 = 0x0F0_CEFE;

/// `forcefeel_axis` of the header.
#[repr(C)]
pub struct Place {
    ready: u32,
    axis: MaybeUninit<Axis<Real>>,
}

/// Makes an axis, which is off. `size` is C's `sizeof(forcefeel_axis)`.
#[unsafe(no_mangle)]
extern "C" fn forcefeel_init(
    place: Option<&mut MaybeUninit<Place>>,
    size: usize,
    loader: Option<&Loader>,
    settings: *const Setting,
    count: u32,
) -> u32 {
    let (Some(place), Some(loader), false) = (place, loader, settings.is_null()) else { return BAD_INPUT };
    if size < size_of::<Place>() {
        return BAD_INPUT;
    }
    // SAFETY: the header asks for an array of so many settings.
    let settings = unsafe { core::slice::from_raw_parts(settings, count as usize) };
    match Axis::new(loader, settings, 0.0) {
        Some(axis) => {
            place.write(Place { ready: READY, axis: MaybeUninit::new(axis) });
            OK
        }
        None => BAD_INPUT,
    }
}

/// A period. Unless it is `OK`, the command is zero and the drive has no power.
#[unsafe(no_mangle)]
extern "C" fn forcefeel_step(
    place: Option<&mut Place>,
    settings: *const Setting,
    count: u32,
    given: Option<&Input<Real>>,
    output: Option<&mut Output<Real>>,
) -> u32 {
    let (Some(given), Some(output), false) = (given, output, settings.is_null()) else { return BAD_INPUT };
    *output = Output {
        command: 0.0,
        torque: 0.0,
        feel: [0.0; 2],
        enable: 0,
        state: 0,
        acting: 0,
        tripped: 0,
        host_share: 0.0,
    };
    let Some(place) = place.filter(|place| place.ready == READY) else { return NOT_READY };
    // SAFETY: it was written together with the mark.
    let axis = unsafe { place.axis.assume_init_mut() };
    // SAFETY: the header asks for the array that was given to `forcefeel_init`.
    let settings = unsafe { core::slice::from_raw_parts(settings, count as usize) };
    match axis.step(settings, given) {
        Some(found) => {
            *output = found;
            OK
        }
        None => BAD_INPUT,
    }
}

/// What the surface of a setting adds in a flight: force, spring and damping. Unless it is `OK`, all three are zero.
#[unsafe(no_mangle)]
extern "C" fn forcefeel_hinge_moment(
    setting: Option<&Setting>,
    flown: Option<&[Real; FLOWN]>,
    output: Option<&mut [Real; 3]>,
) -> u32 {
    let Some(output) = output else { return BAD_INPUT };
    let added = setting.zip(flown).and_then(|(setting, flown)| hinge_moment(setting, flown));
    *output = added.unwrap_or_default();
    if added.is_some() { OK } else { BAD_INPUT }
}

/// Nothing panics: the tests show that the linked program has no way here. A library without one does not compile.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
