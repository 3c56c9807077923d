//! The variables of an instance: what may be set to what and when, and what they are.

use crate::feel::{Feel, count};
use crate::instance::Instance;
use crate::step_state::Given;
use crate::variables::{
    INPUTS, Kind, MOST_INPUTS, OPTIONS, OPTIONS_FROM, OUTPUTS, PARAMETERS, SETTING, Signal, TIME, is_switch,
    is_tunable, range, within,
};
use forcefeel_model::parameters::{COUNT, TABLE};
use forcefeel_model::surface::{FLIGHT, FlightState};

/// Rows of I, B and G.
const FEEL: [(&str, &str); 3] = [("feel", "inertia"), ("feel", "damping"), ("feel", "stiffness")];

impl Instance {
    /// Sets a variable.
    ///
    /// # Errors
    /// If it is none, may not be set now, or not to that value.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        let started = self.kept.started;
        if let Some(place) = self.input(reference) {
            let Signal { name, unit, range: (low, high), .. } = self.variables.inputs[place];
            if !within((low, high), value) {
                return Err(format!("{name}: expected a number from {low} to {high} {unit}, got {value}"));
            }
            self.kept.inputs[place] = value;
        } else if let Some(place) = self.option(reference) {
            let option = &OPTIONS[place];
            let most = if place == SETTING { count(self.resources.settings.len()) } else { option.range.1 };
            let (low, high) = (option.range.0, most);
            if !within((low, high), value) || (option.whole && value.fract() != 0.0) {
                let what = if option.whole { "a whole number" } else { "a number" };
                return Err(format!(
                    "{}: expected {what} from {low} to {high} {}, got {value}",
                    option.name, option.unit
                ));
            }
            if started && !option.tunable {
                return Err(format!("{}: is fixed once the FMU is initialized", option.name));
            }
            self.kept.options[place] = value;
            if place == SETTING {
                self.take_setting(value);
            }
        } else if let Some(place) = self.row(reference) {
            let row = &TABLE[place];
            let (low, high) = range(row);
            if !within((low, high), value) || (is_switch(row) && value.fract() != 0.0) {
                let (part, name, unit) = (row.part, row.name, row.unit.si);
                return Err(format!("{part}.{name}: expected {low} to {high} {unit}, got {value}"));
            }
            if !started {
                self.kept.values[place] = value;
                self.kept.feel.now.values[place] = value;
            } else if is_tunable(row) {
                let mut wanted = self.kept.feel.wanted().clone();
                wanted.values[place] = value;
                self.kept.feel.ask(wanted);
            } else {
                return Err(format!("{}.{}: is fixed once the FMU is initialized", row.part, row.name));
            }
        } else {
            return Err(format!("{reference}: is the reference of no variable that can be set"));
        }
        if !started {
            self.run = None;
        }
        self.seen = None;
        Ok(())
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// If it is none, or the run cannot begin with what was set.
    pub fn get(&mut self, reference: u32) -> Result<f64, String> {
        if reference == TIME {
            return Ok(self.time());
        }
        if let Some(place) = self.input(reference) {
            return Ok(self.kept.inputs[place]);
        }
        if let Some(place) = self.option(reference) {
            return Ok(self.kept.options[place]);
        }
        if let Some(place) = self.row(reference) {
            let of_feel = TABLE[place].part == "feel";
            let values = if of_feel { &self.kept.feel.wanted().values } else { &self.kept.values };
            return Ok(values[place]);
        }
        let Some(place) = self.output(reference) else {
            return Err(format!("{reference}: is the reference of no variable"));
        };
        Ok(self.seen()?[place])
    }

    /// The place of an input of this reference.
    pub(crate) fn input(&self, reference: u32) -> Option<usize> {
        place(reference, INPUTS, self.variables.inputs.len())
    }

    /// The place of an output of this reference.
    pub(crate) fn output(&self, reference: u32) -> Option<usize> {
        place(reference, OUTPUTS, self.variables.outputs)
    }

    /// The name of an input.
    pub(crate) fn input_name(&self, place: usize) -> &'static str {
        self.variables.inputs[place].name
    }

    fn option(&self, reference: u32) -> Option<usize> {
        place(reference, OPTIONS_FROM, OPTIONS.len()).filter(|place| self.variables.options.contains(place))
    }

    fn row(&self, reference: u32) -> Option<usize> {
        place(reference, PARAMETERS, COUNT).filter(|place| self.variables.rows.contains(place))
    }

    /// The feel of a setting, and its law.
    fn take_setting(&mut self, number: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let setting = (number as usize).saturating_sub(1);
        let Some(its) = self.resources.settings.get(setting) else { return };
        let mut wanted = self.kept.feel.wanted().clone();
        wanted.setting = setting;
        for (row, value) in TABLE.iter().zip(&mut wanted.values) {
            if let Some(k) = FEEL.iter().position(|&it| it == (row.part, row.name)) {
                *value = its.feel[k];
            }
        }
        if self.kept.started {
            self.kept.feel.ask(wanted);
        } else {
            self.kept.values.clone_from(&wanted.values);
            self.kept.feel = Feel::new(wanted);
        }
    }

    /// What an importer gave, for a kind of FMU.
    pub(crate) fn given(&self, inputs: &[f64; MOST_INPUTS]) -> Given<f64> {
        let [first, second, third, fourth, ..] = *inputs;
        let none = Given {
            pilot_force: 0.0,
            force_slope: 0.0,
            command: 0.0,
            sensed: [0.0; 4],
            trim: 0.0,
            stiffness_factor: 1.0,
            shaker: 0.0,
            flight: FlightState::from_numbers([0.0; FLIGHT.len()]),
        };
        let flight = |first: usize| FlightState::from_numbers(core::array::from_fn(|k| inputs[first + k]));
        match self.resources.kind {
            Kind::Loader => Given {
                pilot_force: first,
                trim: second,
                stiffness_factor: third,
                shaker: fourth,
                flight: flight(4),
                ..none
            },
            Kind::Machine => Given { pilot_force: first, command: second, ..none },
            Kind::Law => Given {
                sensed: [first, second, third, fourth],
                trim: inputs[4],
                stiffness_factor: inputs[5],
                shaker: inputs[6],
                flight: flight(7),
                ..none
            },
        }
    }
}

fn place(reference: u32, from: u32, length: usize) -> Option<usize> {
    reference.checked_sub(from).map(|place| place as usize).filter(|&place| place < length)
}
