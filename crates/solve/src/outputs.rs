//! What a run gives over time: one table, of whose places everything else is told.

macro_rules! outputs {
    ($( $(#[doc = $doc:literal])+ $Output:ident: $name:literal, $unit:literal; )*) => {
        /// An output of a run; `as usize` it is its place in [`OUTPUTS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Output { $( $(#[doc = $doc])+ $Output, )* }

        /// Name of each output and its SI unit; `feel_position` is in the unit of the law's displacement.
        pub const OUTPUTS: &[(&str, &str)] = &[ $( ($name, $unit), )* ];

        const ALL: [Output; OUTPUTS.len()] = [ $( Output::$Output, )* ];
    };
}

outputs! {
    /// Angle of the column.
    ColumnAngle: "column_angle", "rad";
    /// Its rate.
    ColumnVelocity: "column_velocity", "rad/s";
    /// Programmed displacement.
    FeelPosition: "feel_position", "";
    /// Its rate.
    FeelVelocity: "feel_velocity", "";
    /// Displacement of the piston.
    PistonPosition: "piston_position", "m";
    /// Force of the load cell.
    LoadCellForce: "load_cell_force", "N";
    /// Load pressure.
    LoadPressure: "load_pressure", "Pa";
    /// Flow that moves piston and oil.
    ActuatorFlow: "actuator_flow", "m^3/s";
    /// Current of the valve.
    ValveCurrent: "valve_current", "A";
    /// The pilot's force.
    PilotForce: "pilot_force", "N";
}

impl Output {
    /// The output at a place of [`OUTPUTS`].
    ///
    /// # Panics
    /// If there is no such place.
    #[inline(always)]
    pub const fn at(place: usize) -> Self {
        ALL[place]
    }
}
