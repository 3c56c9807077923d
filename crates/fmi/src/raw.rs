//! Pointers of C. Whoever calls an FMU promises by FMI what is asked for here: that a pointer is null, or points to so many values that
//! live through the call, and that an instance or a state is one that this library gave, and has not freed. Null is looked after.

use core::ffi::{CStr, c_char, c_int, c_void};

/// The logger of FMI 2.0.
pub type Logger2 = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// The logger of FMI 3.0.
pub type Logger3 = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

/// What a pointer points to.
pub fn of<'a, T>(pointer: *const T) -> Option<&'a T> {
    // SAFETY: see the head of the file.
    unsafe { pointer.as_ref() }
}

/// What a pointer points to, to be changed.
pub fn of_mut<'a, T>(pointer: *mut T) -> Option<&'a mut T> {
    // SAFETY: see the head of the file.
    unsafe { pointer.as_mut() }
}

/// So many values.
pub fn list<'a, T>(pointer: *const T, length: usize) -> Option<&'a [T]> {
    if length == 0 {
        return Some(&[]);
    }
    // SAFETY: see the head of the file.
    (!pointer.is_null()).then(|| unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// So many values, to be changed.
pub fn list_mut<'a, T>(pointer: *mut T, length: usize) -> Option<&'a mut [T]> {
    if length == 0 {
        return Some(&mut []);
    }
    // SAFETY: see the head of the file.
    (!pointer.is_null()).then(|| unsafe { core::slice::from_raw_parts_mut(pointer, length) })
}

/// A text that ends with a zero.
pub fn text<'a>(pointer: *const c_char) -> Option<&'a str> {
    // SAFETY: see the head of the file.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) }).and_then(|text| text.to_str().ok())
}

/// Gives a value out of hand.
pub fn give<T>(value: T) -> *mut T {
    Box::into_raw(Box::new(value))
}

/// Takes back and frees what was given.
pub fn take_back<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: see the head of the file.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Calls a logger of FMI 2.0, whose message is a format.
pub fn log2(
    logger: Logger2,
    environment: *mut c_void,
    name: &CStr,
    status: c_int,
    (category, message): (&CStr, &CStr),
) {
    // SAFETY: the message holds no format but %%.
    unsafe { logger(environment, name.as_ptr(), status, category.as_ptr(), message.as_ptr()) }
}

/// Calls a logger of FMI 3.0.
pub fn log3(logger: Logger3, environment: *mut c_void, status: c_int, (category, message): (&CStr, &CStr)) {
    // SAFETY: the logger is the importer's own.
    unsafe { logger(environment, status, category.as_ptr(), message.as_ptr()) }
}
