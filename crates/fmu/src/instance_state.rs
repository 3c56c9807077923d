//! What makes out an instance, as numbers: kept, taken back, written down.

use crate::feel::{Feel, Programmed};
use crate::resources::Resources;
use crate::step_state::StepState;
use crate::variables::{MOST_INPUTS, OPTIONS, Variables};
use forcefeel_model::drive::electric::Electric;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::host::packet::crc32;
use forcefeel_model::parameters::COUNT;
use serde::{Deserialize, Serialize};

/// What makes out an instance: a plain copy, with nothing but numbers in it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct InstanceState {
    pub(crate) values: Vec<f64>,
    pub(crate) options: [f64; OPTIONS.len()],
    pub(crate) inputs: [f64; MOST_INPUTS],
    pub(crate) start_s: f64,
    /// Whether initialization is over.
    pub(crate) started: bool,
    /// The clock of the law ticks now, and what follows is not settled yet.
    pub(crate) ticks: bool,
    /// The sample of this instant was taken when the clock ticked; the step from here on takes it no more.
    pub(crate) sampled: bool,
    pub(crate) feel: Feel,
    pub(crate) step_state: Option<AnyStepState>,
    /// The last communication step, for derivatives.
    pub(crate) before: Option<StepRestorePoint>,
}

/// Where a communication step began, and what was given for it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StepRestorePoint {
    pub feel: Feel,
    pub step_state: AnyStepState,
    pub inputs: [f64; MOST_INPUTS],
    pub steps: usize,
}

/// The state of a step of a loader with either drive.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum AnyStepState {
    Hydraulic(Box<StepState<f64, Hydraulic<f64>>>),
    Electric(Box<StepState<f64, Electric<f64>>>),
}

impl InstanceState {
    /// Before anything is set.
    pub(crate) fn new(resources: &Resources, variables: &Variables) -> Self {
        let values = resources.setup.values.to_vec();
        let mut inputs = [0.0; MOST_INPUTS];
        for (input, signal) in inputs.iter_mut().zip(&variables.inputs) {
            *input = signal.start;
        }
        Self {
            feel: Feel::new(Programmed { values: values.clone(), setting: 0 }),
            values,
            options: OPTIONS.map(|option| option.start),
            inputs,
            start_s: 0.0,
            started: false,
            ticks: false,
            sampled: false,
            step_state: None,
            before: None,
        }
    }

    /// The bytes that make it out, and their check sum together with the token of its FMU.
    ///
    /// # Errors
    /// If memory is short.
    pub fn bytes(&self, token: &str) -> Result<Vec<u8>, String> {
        let mut bytes = postcard::to_stdvec(self).map_err(|error| error.to_string())?;
        let sum = check_sum(&bytes, token);
        bytes.extend(sum);
        Ok(bytes)
    }

    /// What these bytes make out.
    ///
    /// # Errors
    /// If they are not those of a state of the FMU with this token, each as it was written.
    pub fn of(bytes: &[u8], token: &str) -> Result<Self, String> {
        let whole = bytes.split_last_chunk().filter(|(numbers, sum)| check_sum(numbers, token) == **sum);
        let (numbers, _) = whole.ok_or_else(|| "state: is damaged, or that of another FMU".to_string())?;
        let kept: Self = postcard::from_bytes(numbers).map_err(|error| format!("state: {error}"))?;
        let feels = [Some(&kept.feel.now), Some(kept.feel.wanted())];
        let whole = kept.values.len() == COUNT && feels.into_iter().flatten().all(|feel| feel.values.len() == COUNT);
        whole.then_some(kept).ok_or_else(|| "state: expected the numbers of a loader".to_string())
    }
}

fn check_sum(numbers: &[u8], token: &str) -> [u8; 4] {
    crc32(&[numbers, token.as_bytes()].concat()).to_le_bytes()
}
