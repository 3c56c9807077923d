//! FMI 2.0 for co-simulation.

use crate::both::{debug_logging, directional_derivative, itself, variables, whole};
use crate::component::{Component, DISCARD, Log, Status, c_text, cannot, instantiate, needed, none_of_type, with};
use crate::raw::{self, Logger2};
use core::ffi::{c_char, c_int, c_void};
use forcefeel_fmu::uri::path_of_uri;

/// A yes or a no of FMI 2.0.
type Boolean = c_int;

/// What an importer is called back by.
#[repr(C)]
pub struct Callbacks {
    logger: Option<Logger2>,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

/// The kind of FMU that is offered.
const CO_SIMULATION: c_int = 1;

/// What a status is asked for: the time up to which it went well, whether it ended by itself.
const LAST_TIME: c_int = 2;
const TERMINATED: c_int = 3;

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

debug_logging!(fmi2SetDebugLogging: Boolean);

#[unsafe(no_mangle)]
extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: Boolean,
    _logging: Boolean,
) -> *mut Component {
    let (logger, environment) =
        raw::of(callbacks).map_or((None, core::ptr::null_mut()), |given| (given.logger, given.environment));
    if kind != CO_SIMULATION {
        return core::ptr::null_mut();
    }
    let log = Log::Two(logger, environment, c_text(raw::text(name).unwrap_or_default()));
    instantiate(log, raw::text(resources).map(path_of_uri).as_deref(), raw::text(guid))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetupExperiment(
    component: *mut Component,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start: f64,
    _stop_defined: Boolean,
    _stop: f64,
) -> Status {
    with(component, |instance| instance.start_at(start))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2EnterInitializationMode(component: *mut Component) -> Status {
    with(component, |_| Ok(()))
}

variables! {
    fmi2GetReal, fmi2SetReal(): f64, itself, itself;
    fmi2GetInteger, fmi2SetInteger(): c_int, whole, f64::from;
    fmi2GetBoolean, fmi2SetBoolean(): Boolean, |value| Boolean::from(value != 0.0), |value| f64::from(u8::from(value != 0));
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetString(component: *mut Component, _: *const u32, count: usize, _: *mut *const c_char) -> Status {
    none_of_type(component, count, "String")
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetString(component: *mut Component, _: *const u32, count: usize, _: *const *const c_char) -> Status {
    none_of_type(component, count, "String")
}

directional_derivative!(fmi2GetDirectionalDerivative());

#[unsafe(no_mangle)]
extern "C" fn fmi2SetRealInputDerivatives(
    component: *mut Component,
    _: *const u32,
    _: usize,
    _: *const c_int,
    _: *const f64,
) -> Status {
    cannot(component, "interpolation of inputs")
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetRealOutputDerivatives(
    component: *mut Component,
    _: *const u32,
    _: usize,
    _: *const c_int,
    _: *mut f64,
) -> Status {
    cannot(component, "derivatives of outputs in time")
}

#[unsafe(no_mangle)]
extern "C" fn fmi2DoStep(component: *mut Component, at: f64, by: f64, _keeps_no_state_before: Boolean) -> Status {
    with(component, |instance| instance.step(at, by))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2CancelStep(component: *mut Component) -> Status {
    cannot(component, "a step that is under way")
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetStatus(_: *mut Component, _: c_int, _: *mut Status) -> Status {
    DISCARD
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetRealStatus(component: *mut Component, of: c_int, value: *mut f64) -> Status {
    if of != LAST_TIME {
        return DISCARD;
    }
    with(component, |instance| {
        *needed(raw::of_mut(value))? = instance.time();
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetIntegerStatus(_: *mut Component, _: c_int, _: *mut c_int) -> Status {
    DISCARD
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetBooleanStatus(component: *mut Component, of: c_int, value: *mut Boolean) -> Status {
    if of != TERMINATED {
        return DISCARD;
    }
    with(component, |_| {
        *needed(raw::of_mut(value))? = 0;
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetStringStatus(_: *mut Component, _: c_int, _: *mut *const c_char) -> Status {
    DISCARD
}
