//! What an FMU's resources hold: a line of text each, a name and its numbers, the shortest digits that read back to the bit.

use crate::variables::Kind;
use forcefeel_live::setup::Setup;
use forcefeel_model::observer::NUMBERS;
use std::path::Path;

/// The file within the resources.
pub const FILE: &str = "loader.txt";

/// Name of the line that holds the token by which a description knows its resources.
const TOKEN: &str = "token";
/// Name of the line that holds the kind.
const KIND: &str = "kind";

/// I, B and G of a setting, in SI units, and the law that goes with them.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// I, B, G.
    pub feel: [f64; 3],
    /// The law.
    pub observer: [f64; NUMBERS],
}

/// A loader, its law and what of them is in the FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Resources {
    /// What the FMU holds.
    pub kind: Kind,
    /// What its description is told by.
    pub token: String,
    /// The loader under its first setting.
    pub setup: Setup,
    /// Its settings, one at least.
    pub settings: Vec<Setting>,
}

impl Resources {
    /// Reads the resources in a folder.
    ///
    /// # Errors
    /// If there are none, or they are not whole.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let path = folder.join(FILE);
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::of(&text).ok_or_else(|| format!("{}: is not what forcefeel export wrote", path.display()))
    }

    /// The resources of a text, if it holds them.
    pub fn of(text: &str) -> Option<Self> {
        let (mut kind, mut token, mut lists) = (None, None, Vec::new());
        for line in text.lines() {
            let (name, rest) = line.split_once(' ')?;
            match name {
                KIND => kind = Kind::NAMES.iter().find(|(its, _)| *its == rest).map(|(_, kind)| *kind),
                TOKEN => token = Some(rest.to_string()),
                _ => {
                    let numbers = rest.split(' ').map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?;
                    lists.push((name.to_string(), numbers));
                }
            }
        }
        let list = |name: &str| lists.iter().find(|(its, _)| its == name).map(|(_, numbers)| numbers.as_slice());
        let (feels, observers) = (list("feel")?.as_chunks::<3>(), list("observers")?.as_chunks::<NUMBERS>());
        if feels.0.is_empty() || feels.0.len() != observers.0.len() || !(feels.1.is_empty() && observers.1.is_empty()) {
            return None;
        }
        let of = |(&feel, &observer): (&[f64; 3], &[f64; NUMBERS])| Setting { feel, observer };
        let settings: Vec<Setting> = feels.0.iter().zip(observers.0).map(of).collect();
        let mut setup = Setup::of(&lists)?;
        setup.observer = settings.first().map(|setting| setting.observer);
        let sound = setup.step_s.is_finite() && setup.step_s > 0.0;
        sound.then_some(Self { kind: kind?, token: token?, setup, settings })
    }
}
