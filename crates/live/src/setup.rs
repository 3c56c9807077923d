//! What a loop is made of, as numbers: what a record begins with, and a replay is built from.

use forcefeel_model::cancellation::{CANCELLATION_NUMBERS, Cancellation};
use forcefeel_model::compensator::{Compensator, Displacement};
use forcefeel_model::control::Control;
use forcefeel_model::controller::{MOST_UNDER_WAY, Timing};
use forcefeel_model::curve::Curve;
use forcefeel_model::drive::Kind;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Machine, Shared};
use forcefeel_model::observer::{Estimate, MOST_STATES, NUMBERS, Observer};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::transducers::SENSORS;
use forcefeel_model::with_drive;
use forcefeel_solve::law::Law;

/// A loader, its law, and when the controller acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Values of the parameter table.
    pub values: [f64; COUNT],
    /// Gains, and the load cell's scale.
    pub gains: Compensator<f64>,
    /// A law with an observer, in place of gains.
    pub observer: Option<[f64; NUMBERS]>,
    /// Step of a simulated machine in s.
    pub step_s: f64,
    /// Steps in a period and in its delay.
    pub timing: Timing,
    /// Knots and coefficients of the feel's spring.
    pub curve: Option<(Vec<f64>, Vec<[f64; 4]>)>,
    /// The same of the factor on the spring over the dynamic pressure in Pa.
    pub factor: Option<(Vec<f64>, Vec<[f64; 4]>)>,
    /// Whether an aircraft simulator is listened to.
    pub host: bool,
    /// Which springs and dampings that it asks for are rendered, by rising spring rate; where there are none, all that are positive.
    pub rendered: Vec<Rendered>,
    /// Whether what is not rendered is softened to the nearest that is, instead of refused.
    pub softens: bool,
    /// What the host's flaps move the neutral by, in rad/rad.
    pub flap_trim: f64,
    /// What the controller adds to its command.
    pub cancellation: Option<[f64; CANCELLATION_NUMBERS]>,
    /// Where it begins; from the first sample if nothing is known.
    pub beginning: Option<Beginning>,
    /// Whether the supervisor looks on; without it the law drives from the first sample to the last.
    pub supervised: bool,
}

/// What damping a spring rate needs and takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rendered {
    /// Spring rate of the whole feel in N m/rad.
    pub spring: f64,
    /// Least and most damping in N m s/rad.
    pub damping: [f64; 2],
}

/// Where a loop begins: what the sensors show at rest, how the feel stands, and the state of the law's observer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beginning {
    /// As in a sample.
    pub sensors: [f64; SENSORS],
    /// In the feel's own unit.
    pub delta: f64,
    /// Its rate.
    pub rate: f64,
    /// In the unit of `delta`.
    pub neutral: f64,
    /// In coordinates of the law's own.
    pub estimate: Estimate<f64>,
}

/// Numbers of a [`Beginning`].
const BEGINNING_NUMBERS: usize = SENSORS + 3 + MOST_STATES;

impl Setup {
    /// Period of the controller in s.
    pub fn period_s(&self) -> f64 {
        self.step_s * count(self.timing.period)
    }

    /// The loader's numbers.
    pub fn parameters(&self) -> Parameters<f64> {
        Parameters::from_values(&self.values)
    }

    /// The law.
    pub fn law(&self) -> Law<'_> {
        self.observer.as_ref().map_or(Law::Fixed(self.gains), |one| Law::Observers(core::slice::from_ref(one)))
    }

    /// What controller and simulated machine share.
    pub fn shared(&self) -> Shared {
        let law = self.law();
        let effects = Effects {
            feedback: law.feeds_back(),
            observer: self.observer.is_some(),
            known_friction: law.knows_friction(),
            contact_law: law.knows_contact(),
            ..Effects::of(&self.values)
        };
        Shared {
            effects,
            step_s: self.step_s,
            timing: Some(self.timing),
            curve: self.curve.as_ref().and_then(|(knots, coefficients)| Curve::new(knots, coefficients)),
            cancellation: self.cancellation.as_ref().map(Cancellation::from_numbers),
        }
    }

    /// The machine, ready to run.
    pub fn machine<K: Kind>(&self) -> Machine<f64, K::Of<f64>> {
        let machine = Machine::new(&self.parameters(), self.gains, &self.shared());
        self.observer.as_ref().map_or(machine, |numbers| machine.with_observer(Observer::from_numbers(numbers)))
    }

    /// The controller's own share of it.
    pub fn control(&self) -> Control<f64> {
        with_drive!(self.drive(), K => *self.machine::<K>().control())
    }

    /// What the sensors show where the column rests: [`Machine::sensors_at_rest`].
    pub fn at_rest(&self) -> [[f64; SENSORS]; 2] {
        with_drive!(self.drive(), K => self.machine::<K>().sensors_at_rest(&self.shared().effects))
    }

    /// What drives it.
    pub fn drive(&self) -> DriveKind {
        DriveKind::of(&self.values)
    }

    /// Named lists of numbers that make it out.
    pub fn numbers(&self) -> Vec<(&'static str, Vec<f64>)> {
        let Compensator { gains, load_cell_arm, displacement } = &self.gains;
        let volts = f64::from(u8::from(*displacement == Displacement::Volts));
        let mut lists = vec![
            ("values", self.values.to_vec()),
            ("gains", gains.iter().chain([load_cell_arm, &volts]).copied().collect()),
            ("timing", vec![self.step_s, count(self.timing.period), count(self.timing.delay)]),
            ("supervised", vec![f64::from(u8::from(self.supervised))]),
        ];
        lists.extend(self.observer.map(|numbers| ("observer", numbers.to_vec())));
        lists.extend(self.cancellation.map(|numbers| ("cancellation", numbers.to_vec())));
        if let Some((knots, coefficients)) = &self.curve {
            lists.push(("curve_knots", knots.clone()));
            lists.push(("curve_coefficients", coefficients.as_flattened().to_vec()));
        }
        if let Some((knots, coefficients)) = &self.factor {
            lists.push(("factor_knots", knots.clone()));
            lists.push(("factor_coefficients", coefficients.as_flattened().to_vec()));
        }
        if self.host {
            let rows = self.rendered.iter().flat_map(|of| [of.spring, of.damping[0], of.damping[1]]);
            lists.push(("listens", rows.collect()));
            lists.push(("flap_trim", vec![self.flap_trim]));
            lists.extend(self.softens.then(|| ("softens", vec![1.0])));
        }
        if let Some(Beginning { sensors, delta, rate, neutral, estimate }) = self.beginning {
            lists.push(("beginning", [sensors.as_slice(), &[delta, rate, neutral], &estimate].concat()));
        }
        lists
    }

    /// The setup that named lists make out, if they make one.
    pub fn of(lists: &[(String, Vec<f64>)]) -> Option<Self> {
        let list = |name: &str| lists.iter().find(|(its, _)| its == name).map(|(_, numbers)| numbers.as_slice());
        let (gains, law) = list("gains")?.split_first_chunk::<7>()?;
        let &[load_cell_arm, volts] = law else { return None };
        let displacement = if volts == 0.0 { Displacement::Radians } else { Displacement::Volts };
        let &[step_s, period, delay] = list("timing")? else { return None };
        let timing = Timing { period: whole(period)?, delay: whole(delay)? };
        if timing.period == 0 || timing.delay >= MOST_UNDER_WAY * timing.period {
            return None;
        }
        let curve = |knots: &str, coefficients: &str| {
            Some((list(knots)?.to_vec(), list(coefficients)?.as_chunks::<4>().0.to_vec()))
        };
        let beginning = match list("beginning") {
            Some(numbers) => {
                let numbers: &[f64; BEGINNING_NUMBERS] = numbers.try_into().ok()?;
                let (&sensors, rest) = numbers.split_first_chunk::<SENSORS>()?;
                let (&[delta, rate, neutral], estimate) = rest.split_first_chunk::<3>()?;
                Some(Beginning { sensors, delta, rate, neutral, estimate: estimate.try_into().ok()? })
            }
            None => None,
        };
        Some(Self {
            values: list("values")?.try_into().ok()?,
            gains: Compensator { gains: *gains, load_cell_arm, displacement },
            observer: list("observer").map(TryInto::try_into).transpose().ok()?,
            step_s,
            timing,
            curve: curve("curve_knots", "curve_coefficients"),
            factor: curve("factor_knots", "factor_coefficients"),
            host: list("listens").is_some(),
            rendered: rows_of(list("listens").unwrap_or(&[])),
            softens: list("softens").is_some(),
            flap_trim: list("flap_trim").map_or(Some(0.0), |one| one.first().copied())?,
            cancellation: list("cancellation").map(TryInto::try_into).transpose().ok()?,
            beginning,
            supervised: list("supervised")? != [0.0],
        })
    }
}

/// Rows of spring rate, least and most damping.
pub fn rows_of(numbers: &[f64]) -> Vec<Rendered> {
    let rows = numbers.as_chunks::<3>().0.iter();
    rows.map(|&[spring, least, most]| Rendered { spring, damping: [least, most] }).collect()
}

#[expect(clippy::cast_precision_loss, reason = "a number of steps in a period, far below 2^52")]
fn count(steps: usize) -> f64 {
    steps as f64
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
fn whole(number: f64) -> Option<usize> {
    (number.fract() == 0.0 && (0.0..1e6).contains(&number)).then_some(number as usize)
}
