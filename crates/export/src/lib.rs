//! A law, its feel and its supervisor as C99, from the very lines of the model.
//!
//! The model is generic over its number type. [`trace::Trace`] is one that does not compute: it writes down each operation that it is asked
//! for. [`controller`] lets it through the one function that simulation and real-time loop run in a period, and so gets every operation of
//! that period in its order, and nothing else. [`emit`] writes them as C. No equation stands here.
//!
//! | file | is |
//! |---|---|
//! | [`trace`] | the number that writes down, and what it folds |
//! | [`controller`] | the period and the start at rest, for any number type: traced, and run for reference |
//! | [`dots`] | rows of a matrix found again among the operations, so that they become a loop over data |
//! | [`blocks`] | where each operation is done: always, or in a branch |
//! | [`operands`] | what each is made of as C writes it |
//! | [`body`] | the statements of a program |
//! | [`statement`] | a statement of C, before it is known in which function it stands |
//! | [`stores`] | where states are loaded and stored |
//! | [`functions`] | a long period cut into functions |
//! | [`writer`] | numbers, tables and functions that all of them share |
//! | [`axis`] | law and feel under their supervisor, whose decisions are taken both ways |
//! | [`pair`] | two controllers and the electronic link between them |
//! | [`emit`] | the parts of the files: functions, states, a setting's numbers |
#![forbid(unsafe_code)]

pub mod axis;
pub mod blocks;
pub mod body;
pub mod controller;
pub mod dots;
pub mod emit;
pub mod functions;
pub mod operands;
pub mod pair;
pub mod statement;
pub mod stores;
pub mod trace;
pub mod writer;
