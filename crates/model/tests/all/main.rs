//! The model.

mod contact;
mod contact_law;
mod controller;
mod draws;
mod dry_friction;
mod dual;
mod grip_sensor;
mod host;
mod known_friction;
mod link;
mod loader;
mod machine;
mod mechanics;
mod modifiers;
mod near;
mod numbers;
mod observer;
mod parameters;
mod period;
mod pressure;
mod servo;
mod supervisor;
mod surface;
mod transducers;
