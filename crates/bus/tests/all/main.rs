//! Codecs, nodes and lines of buses.

mod damaged;
mod ethercat;
mod moteus;
mod scale;
mod terminals;
mod wire;
