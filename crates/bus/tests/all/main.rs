//! Codecs, nodes and lines of buses.

mod damaged;
mod moteus;
mod scale;
