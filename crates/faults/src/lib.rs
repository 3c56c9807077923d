//! Faults injected into supervised loaders, in virtual time.
//!
//! A case is a loader with its law, safety times drawn for it, a hand, and a fault or two at drawn moments; the nonlinear machine, the
//! digital controller and the supervisor go through it as a live loop would. What the supervisor had to do is worked out afterwards from
//! what was recorded, by [`oracle`], which shares no line with it.
//!
//! | part | file |
//! |---|---|
//! | the kinds of fault, and what each does to what is sampled or commanded | [`fault`] |
//! | a case, drawn from a seed | [`case`] |
//! | what holds or stops its column | `environment` |
//! | the loop in virtual time | [`run`](mod@run) |
//! | when the supervisor had to act, and what it never may do | [`oracle`] |
//! | two loaders on a link, faults on one side | [`pair`] |
//! | many cases over the cores | [`batch`] |
#![forbid(unsafe_code)]

pub mod batch;
pub mod case;
mod environment;
pub mod fault;
pub mod oracle;
pub mod pair;
pub mod run;
