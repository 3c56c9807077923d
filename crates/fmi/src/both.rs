//! What FMI 2.0 and 3.0 have in common: functions that differ in their name, and access to variables.

use crate::component::{Component, Status, free, keep, read, restore, size, with, write};
use crate::raw;
use core::ffi::c_int;
use forcefeel_fmu::instance::Instance;
use forcefeel_fmu::instance_state::InstanceState;

/// Functions of both, each with its name in FMI 2.0 and in 3.0.
macro_rules! both {
    ($( fn $two:ident, $three:ident($($name:ident: $type:ty),*) $(-> $gives:ty)? $body:block )*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $two($($name: $type),*) $(-> $gives)? $body

        #[unsafe(no_mangle)]
        extern "C" fn $three($($name: $type),*) $(-> $gives)? $body
    )* };
}

both! {
    fn fmi2FreeInstance, fmi3FreeInstance(component: *mut Component) {
        raw::take_back(component);
    }

    fn fmi2ExitInitializationMode, fmi3ExitInitializationMode(component: *mut Component) -> Status {
        with(component, Instance::start)
    }

    fn fmi2Terminate, fmi3Terminate(component: *mut Component) -> Status {
        with(component, |_| Ok(()))
    }

    fn fmi2Reset, fmi3Reset(component: *mut Component) -> Status {
        with(component, |instance| {
            instance.reset();
            Ok(())
        })
    }

    fn fmi2GetFMUstate, fmi3GetFMUState(component: *mut Component, state: *mut *mut InstanceState) -> Status {
        keep(component, state)
    }

    fn fmi2SetFMUstate, fmi3SetFMUState(component: *mut Component, state: *const InstanceState) -> Status {
        restore(component, state)
    }

    fn fmi2FreeFMUstate, fmi3FreeFMUState(component: *mut Component, state: *mut *mut InstanceState) -> Status {
        free(component, state)
    }

    fn fmi2SerializedFMUstateSize, fmi3SerializedFMUStateSize(
        component: *mut Component, state: *const InstanceState, bytes: *mut usize
    ) -> Status {
        size(component, state, bytes)
    }

    fn fmi2SerializeFMUstate, fmi3SerializeFMUState(
        component: *mut Component, state: *const InstanceState, bytes: *mut u8, count: usize
    ) -> Status {
        write(component, state, (bytes, count))
    }

    fn fmi2DeSerializeFMUstate, fmi3DeserializeFMUState(
        component: *mut Component, bytes: *const u8, count: usize, state: *mut *mut InstanceState
    ) -> Status {
        read(component, (bytes, count), state)
    }
}

/// Functions that get and set variables of a type: their names, the number of values where FMI states it apart from that of the references, the
/// type, and how a number becomes one of it and back.
macro_rules! variables {
    ($( $get:ident, $set:ident($($length:ident)?): $type:ty, $to:expr, $from:expr; )*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $get(
            component: *mut Component, of: *const u32, count: usize, values: *mut $type $(, $length: usize)?
        ) -> Status {
            let [.., length] = [count $(, $length)?];
            crate::component::get(component, (of, count), (values, length), $to)
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(
            component: *mut Component, of: *const u32, count: usize, values: *const $type $(, $length: usize)?
        ) -> Status {
            let [.., length] = [count $(, $length)?];
            crate::component::set(component, (of, count), (values, length), $from)
        }
    )* };
}

/// Switches messages on and off; there are messages of errors alone, and those are always given.
macro_rules! debug_logging {
    ($name:ident: $boolean:ty) => {
        #[unsafe(no_mangle)]
        extern "C" fn $name(
            component: *mut Component,
            _on: $boolean,
            _count: usize,
            _categories: *const *const c_char,
        ) -> Status {
            with(component, |_| Ok(()))
        }
    };
}

/// Derivatives of outputs along inputs; FMI 3.0 states the lengths of seed and sensitivity.
macro_rules! directional_derivative {
    ($name:ident($($seed_count:ident, $sensitivity_count:ident)?)) => {
        #[unsafe(no_mangle)]
        extern "C" fn $name(
            component: *mut Component,
            unknowns: *const u32,
            unknown_count: usize,
            knowns: *const u32,
            known_count: usize,
            seed: *const f64,
            $($seed_count: usize,)?
            sensitivity: *mut f64
            $(, $sensitivity_count: usize)?
        ) -> Status {
            let [.., seed_length] = [known_count $(, $seed_count)?];
            let [.., sensitivity_length] = [unknown_count $(, $sensitivity_count)?];
            let (unknowns, knowns) = ((unknowns, unknown_count), (knowns, known_count));
            let (seed, sensitivity) = ((seed, seed_length), (sensitivity, sensitivity_length));
            crate::component::derivative(component, unknowns, knowns, seed, sensitivity)
        }
    };
}

pub(crate) use {debug_logging, directional_derivative, variables};

/// A number as it is.
pub fn itself(value: f64) -> f64 {
    value
}

/// A whole number.
#[expect(clippy::cast_possible_truncation, reason = "whole numbers are set within the range of the type")]
pub fn whole(value: f64) -> c_int {
    value as c_int
}
