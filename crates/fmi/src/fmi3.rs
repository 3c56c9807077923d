//! FMI 3.0 for co-simulation.

use crate::both::{debug_logging, directional_derivative, itself, variables, whole};
use crate::component::{Component, Log, Status, cannot, instantiate, needed, none_of_type, with};
use crate::raw::{self, Logger3};
use core::ffi::{c_char, c_void};
use forcefeel_fmu::instance::Instance;
use forcefeel_fmu::variables::CLOCK;
use std::path::Path;

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

debug_logging!(fmi3SetDebugLogging: bool);

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    logger: Option<Logger3>,
    _update: *const c_void,
) -> *mut Component {
    instantiate(Log::Three(logger, environment), raw::text(resources).map(Path::new), raw::text(token))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _environment: *mut c_void,
    _logger: Option<Logger3>,
) -> *mut Component {
    core::ptr::null_mut()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _environment: *mut c_void,
    _logger: Option<Logger3>,
    _clock_update: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> *mut Component {
    core::ptr::null_mut()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterInitializationMode(
    component: *mut Component,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    with(component, |instance| instance.start_at(start))
}

variables! {
    fmi3GetFloat64, fmi3SetFloat64(value_count): f64, itself, itself;
    fmi3GetInt32, fmi3SetInt32(value_count): i32, whole, f64::from;
    fmi3GetBoolean, fmi3SetBoolean(value_count): bool, |value| value != 0.0, |value| f64::from(u8::from(value));
}

/// Types of which there are no variables.
macro_rules! no_variables {
    ($( $get:ident, $set:ident: $type:ty, $name:literal; )*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $get(it: *mut Component, _: *const u32, count: usize, _: *mut $type, _: usize) -> Status {
            none_of_type(it, count, $name)
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(it: *mut Component, _: *const u32, count: usize, _: *const $type, _: usize) -> Status {
            none_of_type(it, count, $name)
        }
    )* };
}

no_variables! {
    fmi3GetFloat32, fmi3SetFloat32: f32, "Float32";
    fmi3GetInt8, fmi3SetInt8: i8, "Int8";
    fmi3GetUInt8, fmi3SetUInt8: u8, "UInt8";
    fmi3GetInt16, fmi3SetInt16: i16, "Int16";
    fmi3GetUInt16, fmi3SetUInt16: u16, "UInt16";
    fmi3GetUInt32, fmi3SetUInt32: u32, "UInt32";
    fmi3GetInt64, fmi3SetInt64: i64, "Int64";
    fmi3GetUInt64, fmi3SetUInt64: u64, "UInt64";
    fmi3GetString, fmi3SetString: *const c_char, "String";
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetBinary(
    component: *mut Component,
    _: *const u32,
    count: usize,
    _: *mut usize,
    _: *mut *const u8,
    _: usize,
) -> Status {
    none_of_type(component, count, "Binary")
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetBinary(
    component: *mut Component,
    _: *const u32,
    count: usize,
    _: *const usize,
    _: *const *const u8,
    _: usize,
) -> Status {
    none_of_type(component, count, "Binary")
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetClock(component: *mut Component, of: *const u32, count: usize, values: *mut bool) -> Status {
    with(component, |instance| {
        clocks(needed(raw::list(of, count))?)?;
        needed(raw::list_mut(values, count))?.fill(instance.ticks());
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetClock(component: *mut Component, of: *const u32, count: usize, values: *const bool) -> Status {
    with(component, |instance| {
        clocks(needed(raw::list(of, count))?)?;
        let ticks = needed(raw::list(values, count))?.contains(&true);
        if ticks { instance.tick() } else { Ok(()) }
    })
}

/// Refuses what is no clock.
fn clocks(references: &[u32]) -> Result<(), String> {
    let other = references.iter().find(|&&reference| reference != CLOCK);
    other.map_or(Ok(()), |other| Err(format!("{other}: is the reference of no clock")))
}

/// Only an FMU with a clock has an event mode.
fn with_clock(component: *mut Component, what: impl FnOnce(&mut Instance) -> Result<(), String>) -> Status {
    with(component, |instance| {
        if instance.has_clock() {
            what(instance)
        } else {
            Err("event mode: is not offered, as the description says".to_string())
        }
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterEventMode(component: *mut Component) -> Status {
    with_clock(component, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterStepMode(component: *mut Component) -> Status {
    with_clock(component, Instance::settle)
}

#[unsafe(no_mangle)]
extern "C" fn fmi3UpdateDiscreteStates(
    component: *mut Component,
    again: *mut bool,
    terminate: *mut bool,
    nominals: *mut bool,
    values: *mut bool,
    next: *mut bool,
    next_time: *mut f64,
) -> Status {
    with_clock(component, |instance| {
        instance.settle()?;
        for flag in [again, terminate, nominals, values, next] {
            *needed(raw::of_mut(flag))? = false;
        }
        *needed(raw::of_mut(next_time))? = instance.time();
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetIntervalDecimal(
    component: *mut Component,
    of: *const u32,
    count: usize,
    intervals: *mut f64,
    qualifiers: *mut i32,
) -> Status {
    with_clock(component, |instance| {
        clocks(needed(raw::list(of, count))?)?;
        needed(raw::list_mut(intervals, count))?.fill(instance.step_s());
        needed(raw::list_mut(qualifiers, count))?.fill(UNCHANGED);
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetShiftDecimal(component: *mut Component, of: *const u32, count: usize, shifts: *mut f64) -> Status {
    with_clock(component, |_| {
        clocks(needed(raw::list(of, count))?)?;
        needed(raw::list_mut(shifts, count))?.fill(0.0);
        Ok(())
    })
}

/// Of the interval of a clock.
const UNCHANGED: i32 = 1;

#[unsafe(no_mangle)]
extern "C" fn fmi3GetNumberOfVariableDependencies(component: *mut Component, _: u32, _: *mut usize) -> Status {
    cannot(component, "dependencies element by element")
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVariableDependencies(
    component: *mut Component,
    _: u32,
    _: *mut usize,
    _: *mut u32,
    _: *mut usize,
    _: *mut i32,
    _: usize,
) -> Status {
    cannot(component, "dependencies element by element")
}

directional_derivative!(fmi3GetDirectionalDerivative(seed_count, sensitivity_count));

#[unsafe(no_mangle)]
extern "C" fn fmi3GetAdjointDerivative(
    component: *mut Component,
    _: *const u32,
    _: usize,
    _: *const u32,
    _: usize,
    _: *const f64,
    _: usize,
    _: *mut f64,
    _: usize,
) -> Status {
    cannot(component, "an adjoint derivative")
}

/// What is for model exchange, scheduled execution and configuration mode.
macro_rules! not_offered {
    ($what:literal: $( $name:ident($($type:ty),*); )*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $name(component: *mut Component $(, _: $type)*) -> Status {
            cannot(component, $what)
        }
    )* };
}

not_offered! { "configuration mode":
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
}

not_offered! { "an evaluation of discrete states":
    fmi3EvaluateDiscreteStates();
}

not_offered! { "scheduled execution":
    fmi3ActivateModelPartition(u32, f64);
}

not_offered! { "model exchange":
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
}

not_offered! { "a clock whose interval can be set, or is a fraction":
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut i32);
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(*const u32, usize, *const f64);
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
    fmi3SetShiftDecimal(*const u32, usize, *const f64);
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetOutputDerivatives(
    component: *mut Component,
    _: *const u32,
    _: usize,
    _: *const i32,
    _: *mut f64,
    _: usize,
) -> Status {
    cannot(component, "derivatives of outputs in time")
}

#[unsafe(no_mangle)]
extern "C" fn fmi3DoStep(
    component: *mut Component,
    at: f64,
    by: f64,
    _keeps_no_state_before: bool,
    event: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> Status {
    with(component, |instance| {
        for flag in [event, terminate, early] {
            *needed(raw::of_mut(flag))? = false;
        }
        let last = needed(raw::of_mut(last))?;
        *last = instance.time();
        instance.step(at, by)?;
        *last = instance.time();
        Ok(())
    })
}
