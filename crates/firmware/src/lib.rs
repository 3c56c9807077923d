//! One axis on a target board: the law, the feel and the supervisor that the simulation and the live loop run, behind a C header.
//!
//! | file | is |
//! |---|---|
//! | [`axis`] | a period of an axis, for any number type: [`Control`](forcefeel_model::control::Control) under its supervisor |
//! | [`loader`] | what an axis is made of: the numbers that `forcefeel export --to firmware` writes |
//! | [`surface`] | what a reversible control's surface adds to the feel in flight |
//! | `c` | the functions of `forcefeel.h`, which the export writes |
//!
//! No allocation, no standard library, nothing that panics: the tests look for it in the linked program.
#![no_std]
#![deny(unsafe_code)]

pub mod axis;
#[cfg(feature = "alone")]
mod c;
pub mod loader;
pub mod surface;
