//! The physics of a control loading system, written once.
//!
//! One file per part of figure 1 of the 1974 report (NASA Langley, "Analysis and Compensation of an Aircraft Simulator
//! Control Loading System With Compliant Linkage"):
//!
//! | part | file | equations |
//! |---|---|---|
//! | servo amplifier | [`drive::hydraulic`] | (13), right-hand factor |
//! | control valve | [`drive::hydraulic`] | (1)-(4) |
//! | actuator | [`drive::hydraulic`] | (5) |
//! | linkage, rigid and compliant | [`linkage`] | (8)-(10) |
//! | load cell | [`load_cell`] | (12), right-hand side |
//! | control column | [`column`] | (6), (7), (16), (18) |
//! | feel computer | [`feel`] | (11), (12) |
//! | position feedback | [`potentiometer`] | (13), second term |
//! | control law | [`compensator`] | (13), (20) |
//! | the parts put together | [`loader`] | (15), (17), (19) |
//!
//! The same machine in time, with what the linear models leave out:
//!
//! | part | file |
//! |---|---|
//! | one step of the whole | [`machine`] |
//! | load pressure, slaved | [`drive::hydraulic`] |
//! | valve with its limits | [`drive::hydraulic`] |
//! | column with friction, gravity, stops, arm | [`column`] |
//! | dry friction, stops | [`dry_friction`], [`contact`] |
//! | feel with all that is nonlinear, its force curve | [`feel`], [`curve`] |
//! | sensors | [`transducers`], [`grip_sensor`] |
//! | digital controller: its period from sample to command; when it acts, its converters | [`control`], [`controller`] |
//! | its law with an observer, the friction that it knows, and contact | [`observer`], [`known_friction`], [`contact_law`] |
//! | between which values a law takes its inputs | [`law_inputs`] |
//! | what it adds against a known disturbance of the drive | [`cancellation`] |
//! | what a person sets around the feel, and how evenly it comes | [`modifiers`] |
//! | which of these are in play | [`effects`] |
//! | what a bench measures of it | [`channels`] |
//! | a hand at the grip of a simulated loader | [`hand`] |
//! | what keeps a live loader safe; law and feel under it | [`supervisor`], [`supervised_law`] |
//! | counts, states and decisions of a number type, for it; one axis in a period | [`logic`], [`axis`] |
//! | what an aircraft simulator sends and gets | [`host`] |
//! | hinge moment of a reversible control | [`surface`] |
//! | link between two pilots' controls; as a shaft, between two feels | [`link`], [`shaft`], [`linked_feels`] |
//!
//! Every equation is generic over [`Scalar`]: `f64`, `f32` or the dual numbers of [`dual`] that give exact Jacobians.
//! No allocation, no input or output, no standard library.
#![no_std]
#![forbid(unsafe_code)]

pub mod axis;
mod bisect;
pub mod cancellation;
pub mod channels;
pub mod column;
pub mod compensator;
pub mod contact;
pub mod contact_law;
pub mod control;
pub mod controller;
pub mod curve;
pub mod drive;
pub mod dry_friction;
pub mod dual;
pub mod effects;
pub mod electronic_link;
pub mod feel;
pub mod feel_computer;
pub mod feel_parts;
pub mod grip_sensor;
pub mod hand;
pub mod host;
pub mod known_friction;
pub mod law_inputs;
pub mod law_vector;
pub mod link;
pub mod linkage;
pub mod linked_feels;
pub mod load_cell;
pub mod loader;
pub mod logic;
pub mod machine;
pub mod memory;
pub mod modifiers;
pub mod named;
pub mod observer;
pub mod parameters;
pub mod potentiometer;
pub mod run;
pub mod scalar;
pub mod shaft;
pub mod supervised_law;
pub mod supervisor;
pub mod surface;
pub mod transducers;
pub mod units;

pub use logic::Logic;
pub use scalar::Scalar;
