//! Inputs of a loader in a step.

/// One row an input: its name, and what it is where nothing is done.
macro_rules! inputs {
    ($( $(#[doc = $doc:literal])+ $name:ident: $none:literal; )*) => {
        /// Inputs at the start and at the end of one step; between, they change evenly.
        #[derive(Debug, Clone, Copy)]
        pub struct Inputs { $( $(#[doc = $doc])+ pub $name: [f64; 2], )* }

        impl Inputs {
            /// Nothing at all, the spring as it is.
            pub const NONE: Self = Self { $( $name: [$none; 2], )* };

            /// The names of the inputs.
            pub const NAMES: &[&str] = &[ $( stringify!($name), )* ];

            /// Where the input of this name stands, if there is one.
            pub fn place(name: &str) -> Option<fn(&mut Self) -> &mut [f64; 2]> {
                match name {
                    $( stringify!($name) => Some(|inputs| &mut inputs.$name), )*
                    _ => None,
                }
            }

            /// The inputs as they stand at the end of the step, and stay.
            #[inline(always)]
            pub fn end(&self) -> Self {
                let stay = |[_, end]: [f64; 2]| [end, end];
                Self { $( $name: stay(self.$name), )* }
            }
        }
    };
}

inputs! {
    /// Pilot force in N.
    force: 0.0;
    /// Commanded neutral in rad.
    trim: 0.0;
    /// Factor on the feel's spring.
    stiffness_factor: 1.0;
    /// The stick shaker's swing, -1 to 1.
    shaker: 0.0;
    /// Force at the grip in N that the programmed feel meets beside the hand's: of an autopilot, a pusher, a load factor.
    added_force: 0.0;
    /// Spring rate in N m/rad about an angle of zero that the programmed feel meets beside its own: of a hinge moment.
    added_stiffness: 0.0;
    /// Damping in N m s/rad likewise.
    added_damping: 0.0;
    /// Share of the next feel, while the feel is being changed.
    fade: 0.0;
    /// Test signal at the amplifier's input in V.
    test_signal: 0.0;
    /// What is added to the law's command in V: a digital controller adds what it finds at a sample, and sends it on with the command.
    command_signal: 0.0;
    /// Torque in N m on the column beside the hand's, inboard of a sensor at the grip: of a link to another column.
    link_torque: 0.0;
}

/// When within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepFraction {
    /// At its start.
    Start,
    /// Half-way.
    Half,
    /// At its end.
    End,
}

impl StepFraction {
    #[inline(always)]
    pub(crate) fn of(self, [start, end]: [f64; 2]) -> f64 {
        match self {
            Self::Start => start,
            Self::Half => 0.5 * (start + end),
            Self::End => end,
        }
    }
}
