//! What there is to see of a cycle: one table of columns, which a history, a record and a replay share.

/// One row a column: what it is, and its name with its SI unit at the end.
macro_rules! columns {
    ($( $(#[doc = $doc:literal])+ $name:ident; )*) => {
        /// A cycle.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct Row { $( $(#[doc = $doc])+ pub $name: f64, )* }

        /// How many columns there are.
        pub const COLUMNS: usize = NAMES.len();

        /// The names of the columns.
        pub const NAMES: &[&str] = &[ $( stringify!($name), )* ];

        impl Row {
            /// The numbers of the row, in the order of [`NAMES`].
            pub fn numbers(&self) -> [f64; COLUMNS] {
                [ $( self.$name, )* ]
            }

            /// The row of these numbers.
            pub fn of(numbers: &[f64; COLUMNS]) -> Self {
                let &[ $( $name, )* ] = numbers;
                Self { $( $name, )* }
            }
        }
    };
}

columns! {
    /// Time since the start, in beats of the clock; those that were missed are among them.
    time_s;
    /// Cycles that were worked out before this one.
    cycle;
    /// Angle of the column.
    column_angle_rad;
    /// Pilot's force at the grip, not a number where nothing measures it.
    pilot_force_n;
    /// Load cell.
    load_cell_force_n;
    /// Position of the drive's end.
    drive_position_m;
    /// Displacement of the column's base, as sampled.
    column_base_m;
    /// Force sensor at the grip, zero where there is none.
    grip_force_n;
    /// Zero of that sensor, which the law's readings are without.
    grip_zero_n;
    /// Programmed angle.
    feel_angle_rad;
    /// Its rate.
    feel_rate_rad_per_s;
    /// Torque that the feel computer receives: of a law with an observer, its estimate of the pilot's.
    feel_torque_n_m;
    /// Trimmed neutral.
    neutral_rad;
    /// How far a change of the feel is.
    fade;
    /// Factor on the spring, of person and host together.
    spring_factor;
    /// Force at the grip that host and electronic link add to the feel.
    added_force_n;
    /// Spring that the host adds to the feel's, or the surface's hinge moment does, in N m/rad.
    added_stiffness_n_m_per_rad;
    /// Damping likewise, that of an electronic link included, in N m s/rad.
    added_damping_n_m_s_per_rad;
    /// Torque of electronic links on the programmed control, in N m.
    link_torque_n_m;
    /// Damping of those links, in N m s/rad.
    link_damping_n_m_s_per_rad;
    /// Share of the host's values; the default feel has the rest.
    host_share;
    /// What the law asks for: V at a valve's amplifier, A of a motor.
    law_command;
    /// What went out.
    command;
    /// Whether the drive was to be powered.
    enable;
    /// The supervisor's state, a place in its list.
    state;
    /// Safety functions that acted since they were acknowledged, a bit each.
    trips;
    /// Safety functions that act now.
    acting;
    /// Force of the hand, as the supervisor estimates it.
    hand_force_n;
    /// Whether a sample had come.
    sampled;
    /// Periods between it and the sample before it, by which velocities are worked out; not a number where none had come.
    periods;
    /// Cycles by which it was late, by the command that it answers; not a number where none had come.
    delay;
    /// Whether the emergency stop was pressed.
    emergency_stop;
    /// Number of what the drive complained of, in the table of faults; zero where all was well.
    drive_fault;
    /// Whether the drive carried out its commands; so where it does not tell.
    drive_acts;
    /// Beats that were missed before this cycle.
    missed;
    /// How late the thread woke.
    late_s;
    /// How long it worked, input and output included.
    work_s;
}
