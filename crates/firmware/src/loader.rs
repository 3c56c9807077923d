//! What an axis is made of, as C lays it out.

use forcefeel_model::Scalar;
use forcefeel_model::cancellation::{CANCELLATION_NUMBERS, Cancellation};
use forcefeel_model::compensator::Compensator;
use forcefeel_model::control::Control;
use forcefeel_model::controller::Timing;
use forcefeel_model::curve::{Curve, MOST_POINTS};
use forcefeel_model::drive::Kind;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Machine, Shared};
use forcefeel_model::modifiers::ModifierRates;
use forcefeel_model::observer::{NUMBERS, Observer, SAMPLED, knows_contact, knows_friction};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::with_drive;

/// One setting of the feel.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Setting {
    /// Values of the parameter table.
    pub values: [f64; COUNT],
    /// The law's numbers.
    pub law: [f64; NUMBERS],
}

/// A loader with its law; all numbers in double precision, whatever the board computes in.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Loader {
    /// Period in s.
    pub period_s: f64,
    /// What the sensors show at rest with the column at zero and at `elsewhere_rad`.
    pub at_rest: [[f64; SAMPLED]; 2],
    /// Numbers of what is added to the command, if `cancels` is not zero.
    pub cancellation: [f64; CANCELLATION_NUMBERS],
    /// Knots of the feel's curve, of which there are `points`; a straight spring has none.
    pub knots: [f64; MOST_POINTS],
    /// Coefficients of the pieces between them.
    pub coefficients: [[f64; 4]; MOST_POINTS - 1],
    /// How many knots.
    pub points: u32,
    /// Whether something is added to the command.
    pub cancels: u32,
}

impl Loader {
    /// What the period shares; the effects of all settings are in play.
    pub fn shared(&self, settings: &[Setting]) -> Shared {
        let effects =
            settings.iter().map(|setting| Effects::of(&setting.values)).reduce(Effects::or).unwrap_or_default();
        let points = self.points as usize;
        let pieces = self.coefficients.get(..points.saturating_sub(1));
        Shared {
            effects: Effects {
                observer: true,
                known_friction: settings.iter().any(|setting| knows_friction(&setting.law)),
                contact_law: settings.iter().any(|setting| knows_contact(&setting.law)),
                surroundings: true,
                test_signal: false,
                ..effects
            },
            step_s: self.period_s,
            timing: Some(Timing { period: 1, delay: 0 }),
            curve: self.knots.get(..points).zip(pieces).and_then(|(knots, pieces)| Curve::new(knots, pieces)),
            cancellation: (self.cancels != 0).then(|| Cancellation::from_numbers(&self.cancellation)),
        }
    }
}

impl Setting {
    /// Its parameters.
    pub fn parameters<S: Scalar>(&self, like: S) -> Parameters<S> {
        Parameters::from_values(&self.values.map(|value| like.constant(value)))
    }

    /// Its law.
    pub fn law<S: Scalar>(&self, like: S) -> Observer<S> {
        Observer::from_numbers(&self.law.map(|value| like.constant(value)))
    }

    /// Law, feel and converters.
    pub fn control<S: Scalar>(&self, shared: &Shared, like: S) -> Control<S> {
        with_drive!(self.drive(), K => self.control_of::<S, K>(shared, like))
    }

    /// How evenly what is set around the feel comes, with this period in s.
    pub fn pace<S: Scalar>(&self, period: S) -> ModifierRates<S> {
        let feel = self.parameters(period).feel;
        ModifierRates { trim_rate: feel.trim_rate, shaker_frequency: feel.shaker_frequency, period }
    }

    /// What drives it.
    pub fn drive(&self) -> DriveKind {
        DriveKind::of(&self.values)
    }

    fn control_of<S: Scalar, K: Kind>(&self, shared: &Shared, like: S) -> Control<S> {
        let parameters = self.parameters(like);
        let gains = Compensator::state_feedback(&parameters, [like.zero(); 7]);
        *Machine::<S, K::Of<S>>::new(&parameters, gains, shared).with_observer(self.law(like)).control()
    }
}
