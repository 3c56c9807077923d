//! The library inside an FMU: the C interfaces of FMI 2.0 and 3.0 for co-simulation. One file serves every FMU of forcefeel.
//!
//! | what | file |
//! |---|---|
//! | FMI 2.0, FMI 3.0: what an importer calls | [`fmi2`], [`fmi3`] |
//! | what both have in common | [`both`] |
//! | an instance with the importer's logger; whatever goes wrong becomes a status | [`component`] |
//! | pointers of C: all code of the project that is unsafe for an importer's sake | [`raw`] |
#![allow(non_snake_case, reason = "FMI names its functions so")]

mod both;
mod component;
mod fmi2;
mod fmi3;
mod raw;
