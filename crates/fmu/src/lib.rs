//! A loader with its law, the law alone or the machine alone, as a functional mock-up unit has it.
//!
//! The steps are those of a simulation: `Machine::begin` and `advance`, `Control::command`. So an importer that keeps to their grid gets
//! a simulation's bits. What an importer needs of C is in `forcefeel-fmi`; here everything is safe, and nothing panics.
//!
//! | question | file |
//! |---|---|
//! | which variables there are | [`variables`] |
//! | what an FMU's resources hold, and where they lie | [`resources`], [`uri`] |
//! | what an importer does with an instance; its variables | [`instance`], `values` |
//! | its state, derivatives | [`instance_state`], [`derivatives`] |
//! | a step of each kind of FMU, what is seen of it | `step_state` |
//! | changes of the feel while it runs | `feel` |
#![forbid(unsafe_code)]

pub mod derivatives;
mod feel;
pub mod instance;
pub mod instance_state;
pub mod resources;
mod step_state;
pub mod uri;
mod values;
pub mod variables;
