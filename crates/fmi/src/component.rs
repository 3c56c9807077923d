//! An instance with the importer's logger. Whatever goes wrong is told to that logger and becomes a status; nothing else leaves.

use crate::raw::{self, Logger2, Logger3};
use core::ffi::{CStr, c_int, c_void};
use forcefeel_fmu::instance::Instance;
use forcefeel_fmu::instance_state::InstanceState;
use forcefeel_fmu::resources::Resources;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// A status of FMI 2.0 and 3.0.
pub type Status = c_int;
/// All is well.
pub const OK: Status = 0;
/// What was asked for does not apply.
pub const DISCARD: Status = 2;
/// It failed.
pub const ERROR: Status = 3;

/// The category of every message.
const CATEGORY: &CStr = c"logStatusError";

/// Whom messages go to.
pub enum Log {
    /// An importer of FMI 2.0: its logger, its environment, the name of the instance.
    Two(Option<Logger2>, *mut c_void, CString),
    /// An importer of FMI 3.0.
    Three(Option<Logger3>, *mut c_void),
}

impl Log {
    /// Tells what went wrong.
    fn error(&self, message: &str) {
        match self {
            Self::Two(Some(logger), environment, name) => {
                // A message of FMI 2.0 is a format of printf, in which #r1# is a variable.
                let message = c_text(&message.replace('%', "%%").replace('#', "##"));
                raw::log2(*logger, *environment, name, ERROR, (CATEGORY, &message));
            }
            Self::Three(Some(logger), environment) => {
                raw::log3(*logger, *environment, ERROR, (CATEGORY, &c_text(message)));
            }
            Self::Two(None, ..) | Self::Three(None, _) => {}
        }
    }
}

/// A text for C.
pub fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// What an importer holds.
pub struct Component {
    instance: Instance,
    log: Log,
}

/// A new instance, or null.
pub fn instantiate(log: Log, resources: Option<&Path>, token: Option<&str>) -> *mut Component {
    let created = catch_unwind(AssertUnwindSafe(|| {
        let folder = resources.ok_or("expected the place of the resources, got none")?;
        Instance::new(Resources::read(folder)?, token.ok_or("expected the token of the description, got none")?)
    }));
    match created.unwrap_or_else(|_| Err(FAULT.to_string())) {
        Ok(instance) => raw::give(Component { instance, log }),
        Err(message) => {
            log.error(&message);
            core::ptr::null_mut()
        }
    }
}

/// What an importer is told of an error that should not be.
const FAULT: &str = "an error of the library itself; please report it";

/// Does something with an instance.
pub fn with(component: *mut Component, what: impl FnOnce(&mut Instance) -> Result<(), String>) -> Status {
    let Some(Component { instance, log }) = raw::of_mut(component) else { return ERROR };
    let done = catch_unwind(AssertUnwindSafe(|| what(instance)));
    match done.unwrap_or_else(|_| Err(FAULT.to_string())) {
        Ok(()) => OK,
        Err(message) => {
            log.error(&message);
            ERROR
        }
    }
}

/// A pointer that must not be null.
pub fn needed<T>(given: Option<T>) -> Result<T, String> {
    given.ok_or_else(|| "expected a pointer, got null".to_string())
}

/// Gets variables, each number turned into what the importer takes.
pub fn get<T>(
    component: *mut Component,
    references: (*const u32, usize),
    values: (*mut T, usize),
    turned: impl Fn(f64) -> T,
) -> Status {
    with(component, |instance| {
        let references = needed(raw::list(references.0, references.1))?;
        let values = needed(raw::list_mut(values.0, values.1))?;
        same_length(references.len(), values.len())?;
        for (&reference, value) in references.iter().zip(values) {
            *value = turned(instance.get(reference)?);
        }
        Ok(())
    })
}

/// Sets variables, each turned into a number.
pub fn set<T: Copy>(
    component: *mut Component,
    references: (*const u32, usize),
    values: (*const T, usize),
    turned: impl Fn(T) -> f64,
) -> Status {
    with(component, |instance| {
        let references = needed(raw::list(references.0, references.1))?;
        let values = needed(raw::list(values.0, values.1))?;
        same_length(references.len(), values.len())?;
        references.iter().zip(values).try_for_each(|(&reference, &value)| instance.set(reference, turned(value)))
    })
}

/// Variables of a type that no FMU of forcefeel has.
pub fn none_of_type(component: *mut Component, length: usize, name: &str) -> Status {
    with(component, |_| if length == 0 { Ok(()) } else { Err(format!("there is no variable of type {name}")) })
}

/// What no FMU of forcefeel can.
pub fn cannot(component: *mut Component, what: &str) -> Status {
    with(component, |_| Err(format!("{what}: is not offered, as the description says")))
}

/// How many values there are for so many references.
pub fn same_length(references: usize, values: usize) -> Result<(), String> {
    if references == values { Ok(()) } else { Err(format!("expected {references} values, got {values}")) }
}

/// Keeps the state, in the place of the one there or in a new one.
pub fn keep(component: *mut Component, state: *mut *mut InstanceState) -> Status {
    with(component, |instance| {
        let place = needed(raw::of_mut(state))?;
        match raw::of_mut(*place) {
            Some(kept) => kept.clone_from(instance.kept()),
            None => *place = raw::give(instance.kept().clone()),
        }
        Ok(())
    })
}

/// Takes a state back.
pub fn restore(component: *mut Component, state: *const InstanceState) -> Status {
    with(component, |instance| {
        instance.restore(needed(raw::of(state))?);
        Ok(())
    })
}

/// Frees a state.
pub fn free(component: *mut Component, state: *mut *mut InstanceState) -> Status {
    with(component, |_| {
        if let Some(place) = raw::of_mut(state) {
            raw::take_back(*place);
            *place = core::ptr::null_mut();
        }
        Ok(())
    })
}

/// How many bytes a state has.
pub fn size(component: *mut Component, state: *const InstanceState, size: *mut usize) -> Status {
    with(component, |instance| {
        *needed(raw::of_mut(size))? = needed(raw::of(state))?.bytes(instance.token())?.len();
        Ok(())
    })
}

/// The bytes of a state.
pub fn write(component: *mut Component, state: *const InstanceState, bytes: (*mut u8, usize)) -> Status {
    with(component, |instance| {
        let written = needed(raw::of(state))?.bytes(instance.token())?;
        let into = needed(raw::list_mut(bytes.0, bytes.1))?;
        let room = into.get_mut(..written.len());
        room.ok_or_else(|| format!("state: expected room for {} bytes", written.len()))?.copy_from_slice(&written);
        Ok(())
    })
}

/// A state from bytes.
pub fn read(component: *mut Component, bytes: (*const u8, usize), state: *mut *mut InstanceState) -> Status {
    with(component, |instance| {
        let kept = InstanceState::of(needed(raw::list(bytes.0, bytes.1))?, instance.token())?;
        *needed(raw::of_mut(state))? = raw::give(kept);
        Ok(())
    })
}

/// Derivatives of outputs along inputs.
pub fn derivative(
    component: *mut Component,
    unknowns: (*const u32, usize),
    knowns: (*const u32, usize),
    seed: (*const f64, usize),
    sensitivity: (*mut f64, usize),
) -> Status {
    with(component, |instance| {
        let (unknowns, knowns) = (raw::list(unknowns.0, unknowns.1), raw::list(knowns.0, knowns.1));
        let (unknowns, knowns) = (needed(unknowns)?, needed(knowns)?);
        let (seed, sensitivity) =
            (needed(raw::list(seed.0, seed.1))?, needed(raw::list_mut(sensitivity.0, sensitivity.1))?);
        same_length(knowns.len(), seed.len())?;
        same_length(unknowns.len(), sensitivity.len())?;
        sensitivity.copy_from_slice(&instance.derivative(unknowns, knowns, seed)?);
        Ok(())
    })
}
