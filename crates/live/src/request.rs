//! What is asked of a running loop. Requests go through a ring, by value, and into the record with the cycle that took them.

use forcefeel_model::host::FromHost;
use forcefeel_model::host::packet::HOST_NUMBERS;
pub use forcefeel_model::modifiers::FeelModifiers;
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::COUNT;

/// A request.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a ring holds values: nothing is to be freed in the loop")]
pub enum LoopRequest {
    /// Another feel, and the law that goes with it.
    Feel(FeelRequest),
    /// Where trim, dynamic pressure and shaker are to go.
    FeelModifiers(FeelModifiers),
    /// The feel is to come.
    On,
    /// Power without feel.
    Passive,
    /// No power.
    Off,
    /// What is latched is to be cleared.
    Acknowledge,
    /// Stop, now.
    Stop,
    /// Another axis of the cockpit stopped, and this one stops with it.
    OtherAxis,
    /// The electronic link of this axis is to hold, or to open.
    Link(bool),
    /// The priority button of this axis is pressed, or let go.
    Priority(bool),
    /// What an aircraft simulator sent.
    Host(FromHost),
}

/// Another feel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeelRequest {
    /// Values of the parameter table, of which those of the feel count.
    pub values: [f64; COUNT],
    /// The law with an observer that goes with it; the one of before if there is none.
    pub observer: Option<[f64; NUMBERS]>,
    /// Cycles over which it is faded in, one at least.
    pub cycles: u32,
}

impl LoopRequest {
    /// The request as a name and numbers.
    pub fn numbers(&self) -> (&'static str, Vec<f64>) {
        match self {
            Self::Feel(FeelRequest { values, observer, cycles }) => {
                let law = observer.iter().flatten();
                ("feel", [f64::from(*cycles)].iter().chain(values).chain(law).copied().collect())
            }
            Self::FeelModifiers(FeelModifiers { trim_rad, stiffness_factor, shaker }) => {
                ("around", vec![*trim_rad, *stiffness_factor, *shaker])
            }
            Self::On => ("on", vec![]),
            Self::Passive => ("passive", vec![]),
            Self::Off => ("off", vec![]),
            Self::Acknowledge => ("acknowledge", vec![]),
            Self::Stop => ("stop", vec![]),
            Self::OtherAxis => ("other_axis", vec![]),
            Self::Priority(pressed) => ("priority", vec![f64::from(u8::from(*pressed))]),
            Self::Link(holds) => ("link", vec![f64::from(u8::from(*holds))]),
            Self::Host(FromHost { sequence, switches, numbers }) => {
                let head = [f64::from(*sequence), f64::from(*switches)];
                ("host", head.into_iter().chain(numbers.map(f64::from)).collect())
            }
        }
    }

    /// The request that a name and numbers make out, if they make one.
    pub fn of(name: &str, numbers: &[f64]) -> Option<Self> {
        Some(match (name, numbers) {
            ("feel", [cycles, rest @ ..]) => {
                let (values, law) = rest.split_first_chunk::<COUNT>()?;
                let observer = if law.is_empty() { None } else { Some(law.try_into().ok()?) };
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was a u32")]
                let cycles = *cycles as u32;
                Self::Feel(FeelRequest { values: *values, observer, cycles })
            }
            ("around", &[trim_rad, stiffness_factor, shaker]) => {
                Self::FeelModifiers(FeelModifiers { trim_rad, stiffness_factor, shaker })
            }
            ("on", []) => Self::On,
            ("passive", []) => Self::Passive,
            ("off", []) => Self::Off,
            ("acknowledge", []) => Self::Acknowledge,
            ("stop", []) => Self::Stop,
            ("other_axis", []) => Self::OtherAxis,
            ("priority", &[pressed]) => Self::Priority(pressed != 0.0),
            ("link", &[holds]) => Self::Link(holds != 0.0),
            ("host", [sequence, switches, numbers @ ..]) => {
                let numbers: &[f64; HOST_NUMBERS] = numbers.try_into().ok()?;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "they were numbers of 32 bits"
                )]
                let packet = FromHost {
                    sequence: *sequence as u32,
                    switches: *switches as u32,
                    numbers: numbers.map(|number| number as f32),
                };
                Self::Host(packet)
            }
            _ => return None,
        })
    }
}
