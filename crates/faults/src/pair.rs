//! A case of two loaders on a link: faults on one side, another hand on the other.

use crate::case::{Case, HARDEST};
use crate::fault::{Fault, Kind as FaultKind};
use crate::oracle::{Outcome, judge};
use crate::run::{LawOf, Loaders, Loop, Moving, Record, Side};
use forcefeel_model::drive::Kind;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::linked_feels::LinkedFeels;
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::shaft::Shaft;
use forcefeel_model::supervisor::Limits;
use forcefeel_model::with_drive;

/// A link of two loaders.
#[derive(Debug, Clone, Copy)]
pub struct Joint {
    /// Places of its loaders.
    pub between: [usize; 2],
    /// Its values, in the order of the table of links.
    pub values: [f64; LINK_ROWS],
    /// Periods of delay of an electronic link; nothing of a shaft.
    pub delay: Option<usize>,
    /// Whether it stays open once it has given way.
    pub uncouples: bool,
}

/// What came of a case, side by side.
#[derive(Debug, Clone, Copy)]
pub struct PairOutcome {
    /// Which of the links.
    pub joint: usize,
    /// Side with the faults.
    pub faulty: usize,
    /// What came of each side.
    pub sides: [Outcome; 2],
    /// Largest force of the link at the grip of the other side from the fault on, in N, and its largest step in a period.
    pub force: [f64; 2],
}

/// The case of a number with so many faults, 0 to 2; nothing where a loader cannot be supervised.
pub fn outcome(joints: &[Joint], loaders: Loaders<'_>, (seed, number): (u64, u64), faults: u8) -> Option<PairOutcome> {
    let count = u64::try_from(joints.len()).ok()?;
    let index = usize::try_from(number / 2 % count).ok()?;
    let (faulty, joint) = (usize::try_from(number % 2).ok()?, &joints[index]);
    let cases = drawn(joint, loaders.values, (seed, number / 2 / count * 2 + number % 2), (faulty, faults))?;
    let of = |side: usize| loaders.observers.map(|laws| &laws[joint.between[side]]);
    let on_shaft = joint.delay.is_none();
    let records = go_through(joint, [begun(&cases[0], of(0), on_shaft)?, begun(&cases[1], of(1), on_shaft)?])?;
    let from = cases[faulty].onset().unwrap_or(0);
    let sides = [0, 1].map(|side| {
        let Record { limits, moving, rows } = &records[side];
        let mut outcome = Outcome { loader: joint.between[side], ..judge(&cases[side], limits, moving, rows) };
        // Over a shaft a fault shakes the other column too: its supervisor may be the first to stop it, for what its own sensors show then.
        let shaken = on_shaft && side != faulty && !cases[faulty].is_bridged(&records[faulty].limits);
        outcome.wrong.false_alarm &= !(shaken && outcome.stopped.is_some_and(|at| at >= from));
        outcome
    });
    let other = &records[1 - faulty];
    let of_link: Vec<f64> =
        other.rows[from..].iter().map(|row| (row.shaft + row.link) / other.limits.grip_arm).collect();
    let largest = of_link.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
    let step = of_link.windows(2).fold(0.0, |most: f64, two| most.max((two[1] - two[0]).abs()));
    Some(PairOutcome { joint: index, faulty, sides, force: [largest, step] })
}

/// A case for each side, both from the same angle.
fn drawn(
    joint: &Joint,
    values: &[[f64; COUNT]],
    (seed, number): (u64, u64),
    (faulty, faults): (usize, u8),
) -> Option<[Case; 2]> {
    let none = Fault { kind: FaultKind::None, from: 0, sensor: 0, direction: 1.0, size: 0.0 };
    let mut cases = [0, 1].map(|side| {
        let of = &values[joint.between[side]..=joint.between[side]];
        // What a hand does is drawn by the number: each with each on the two sides.
        let drawn = if side == faulty { (seed, number) } else { (seed.wrapping_add(1), number + number / 5) };
        match faults {
            0 if side == faulty => Case::legal(of, drawn).in_environment(),
            0 => Case::legal(of, drawn),
            _ if side == faulty => Case::drawn(of, drawn, faults > 1).in_environment(),
            _ => Case { faults: [none; 2], ..Case::drawn(of, drawn, false) },
        }
    });
    let Case { angle, samples, .. } = cases[faulty];
    let other = &mut cases[1 - faulty];
    (other.angle, other.samples) = (angle, samples);
    if faults == 0 {
        for case in &mut cases {
            // The other pilot may hold the column off the stop that would take what the drive cannot.
            let (parameters, kind) = (Parameters::from_values(&case.values), DriveKind::of(&case.values));
            let limits = Limits::new(&parameters, kind, parameters.controller.period).ok()?;
            let most = HARDEST * Moving::of(&parameters, kind, &limits).holds() / parameters.column.grip_arm;
            case.hand.force = case.hand.force.clamp(-most, most);
        }
    }
    Some(cases)
}

fn begun<'a>(case: &'a Case, law: LawOf<'_>, on_shaft: bool) -> Option<Box<dyn Side + 'a>> {
    let kind = DriveKind::of(&case.values);
    with_drive!(kind, K => of_drive::<K>(case, law, kind, on_shaft))
}

fn of_drive<'a, K: Kind>(case: &'a Case, law: LawOf<'_>, kind: DriveKind, on_shaft: bool) -> Option<Box<dyn Side + 'a>>
where
    K::Of<f64>: 'a,
{
    Some(Box::new(Loop::<K::Of<f64>>::new(case, law, kind, on_shaft)?))
}

/// Both loops in turn, as a cockpit runs them: an electronic link opens where a side is stopped, a shaft takes the other side with it.
fn go_through(joint: &Joint, mut sides: [Box<dyn Side + '_>; 2]) -> Option<[Record; 2]> {
    let mut feels = joint.delay.map(|delay| LinkedFeels::new(&joint.values, |value| value, delay, joint.uncouples));
    let h = sides[0].step_s();
    let mut shaft = Shaft::new(&joint.values, joint.uncouples, [sides[0].angle(), sides[1].angle()]);
    shaft.open = feels.is_some();
    loop {
        if sides[0].at_sample() {
            if sides[0].done() {
                return Some(sides.map(|mut side| side.record()));
            }
            let given = feels.as_mut().map_or([[0.0; 2]; 2], |feels| {
                let given = feels.sampled(&sides[0].times(), &[sides[0].linked(), sides[1].linked()]);
                [0, 1].map(|side: usize| [given.torques[side], given.damping[side]])
            });
            let stopped = [sides[0].stopped(), sides[1].stopped()];
            for (side, given) in given.into_iter().enumerate() {
                sides[side].link(given, feels.is_none() && stopped[1 - side] && !stopped[side]);
            }
        }
        let [on_first, on_second] = shaft.on_each();
        sides[0].arrive(on_first)?;
        sides[1].arrive(on_second)?;
        for side in &mut sides {
            side.set_out();
        }
        let [first, second] = &mut sides;
        shaft.step(h, |on_each| [first.advance(on_each[0]), second.advance(on_each[1])]);
    }
}
