//! When the supervisor had to act in a record, and what it never may do.
//!
//! Each condition is looked for in the whole record, row by row, from the definitions of the table of safety functions; nothing here is
//! shared with the supervisor but the limits. What the machine really did stands in the record beside what the sensors showed.

use crate::case::Case;
use crate::fault::{Fault, Kind};
use crate::run::{Moving, Row, safe_from};
use forcefeel_model::supervisor::{Function, Limits, SupervisorState};
use forcefeel_model::transducers::SENSORS;

/// What came of a case.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// Which of the loaders.
    pub loader: usize,
    /// Kinds of its faults, by their place.
    pub kinds: [usize; 2],
    /// Sample at which the supervisor had to have stopped the loader at the latest.
    pub due: Option<usize>,
    /// Function for which.
    pub due_to: Option<Function>,
    /// Sample at which it did.
    pub stopped: Option<usize>,
    /// Sample at which the loader was safe.
    pub safe: Option<usize>,
    /// State when the first fault came.
    pub state: SupervisorState,
    /// What went wrong.
    pub wrong: Violation,
    /// Energy given to the hand from the fault on until the loader is safe, in J; and its bound.
    pub energy: [f64; 2],
    /// Most energy in J that the hand is given from the fault on, or from any moment after it, beyond what the feel gives: until the loader is
    /// safe, or to the end.
    pub excess: f64,
    /// Time in s for which the drive's force at the grip is above the largest legal one by a half, without a pause, where the hand pushes with
    /// less and no end stop carries it.
    pub above: f64,
    /// Largest force of the drive at the grip from the fault on, in N, where no end stop carries it.
    pub force: f64,
    /// What the supervisor names as the cause.
    pub cause: Option<Function>,
}

/// What went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each may go wrong by itself")]
pub struct Violation {
    /// Stopped too late or not at all.
    pub late: bool,
    /// Safe too late or not at all.
    pub unsafe_: bool,
    /// A command beyond the limit.
    pub beyond: bool,
    /// A command that changed too fast.
    pub fast: bool,
    /// A command or a share that is no number.
    pub not_a_number: bool,
    /// More energy to the hand than the bound.
    pub energy: bool,
    /// Stopped without a fault.
    pub false_alarm: bool,
    /// The default feel did not come, or a silent host stopped the loader.
    pub host: bool,
}

impl Violation {
    /// As bits, in that order.
    pub fn bits(self) -> u32 {
        let all = [
            self.late,
            self.unsafe_,
            self.beyond,
            self.fast,
            self.not_a_number,
            self.energy,
            self.false_alarm,
            self.host,
        ];
        all.iter().enumerate().fold(0, |bits, (k, &wrong)| bits | u32::from(wrong) << k)
    }
}

/// Samples by which the supervisor may be sooner than what the machine really did is plain in its readings.
const SOONER: usize = 5;

/// Relative, of sums in another order.
const ROUNDING: f64 = 1e-9;

/// Multiple of the largest legal force that no fault may keep up.
const ABOVE_LEGAL: f64 = 1.5;

/// Judges a record.
pub fn judge(case: &Case, limits: &Limits, moving: &Moving, rows: &[Row]) -> Outcome {
    let onset = case.onset();
    let due = due(case, limits, rows);
    let stopped = rows.iter().position(|row| row.allowed.state == SupervisorState::Tripped);
    let safe = stopped.and_then(|from| safe_from(rows, from));
    let mut wrong = Violation::default();
    // A drive that has stopped carries out no command.
    let [force, speed, energy] = [Function::AbsoluteForce, Function::Speed, Function::Energy];
    let cutting = [Function::EmergencyStop, Function::DriveStopped, force, speed, energy];
    let cuts = |k: usize| cutting.iter().any(|&function| rows[k].allowed.acting.has(function));
    if let Some((function, by)) = due {
        wrong.late = stopped.is_none_or(|at| at > by);
        let stopping = if function == Function::EmergencyStop { 0 } else { limits.stop as usize - 1 };
        wrong.unsafe_ = safe.is_none_or(|at| at > by + stopping) && by + stopping < rows.len();
    }
    // Once safe, it stays so.
    wrong.unsafe_ |=
        safe.is_some_and(|at| rows[at..].iter().any(|row| row.allowed.command != 0.0 || row.allowed.enable));
    for (k, row) in rows.iter().enumerate() {
        let e = row.allowed.command;
        wrong.not_a_number |= !e.is_finite() || !row.allowed.share.is_finite() || !row.allowed.host_share.is_finite();
        wrong.beyond |= e.abs() > limits.command * (1.0 + ROUNDING);
        let most = limits.command_step.max(limits.stop_step) * (1.0 + 1e-3) + limits.command * ROUNDING;
        wrong.fast |= k > 0 && !cuts(k) && (e - rows[k - 1].allowed.command).abs() > most;
    }
    let kinds = case.faults.map(|fault| Kind::ALL.iter().position(|&kind| kind == fault.kind).unwrap_or(0));
    let only = |kind: Kind| case.faults.iter().all(|fault| fault.kind == kind || fault.kind == Kind::None);
    // Before there is power, one that is not bridged does no harm.
    let bridged = case.is_bridged(limits) && onset.is_none_or(|from| rows[from].allowed.enable);
    // Beside what is due within a few samples, which the supervisor may see first.
    wrong.false_alarm = bridged && stopped.is_some_and(|at| due.is_none_or(|(_, by)| by > at + SOONER));
    let swings = rows.iter().any(|row| row.allowed.tripped.has(Function::Swing));
    wrong.false_alarm |= onset.is_none() && swings;
    if only(Kind::HostSilent) && onset.is_some() {
        wrong.false_alarm |= stopped.is_some() && due.is_none();
        let by = onset.unwrap_or(0) + limits.host as usize + samples(1.0 / limits.host_step) + 1;
        wrong.host = rows.get(by).is_some_and(|row| row.allowed.host_share > 0.0);
    }
    let from = onset.unwrap_or(0).min(rows.len() - 1);
    let until = safe.unwrap_or(from).max(from);
    #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
    let time = (until - from + 2) as f64 * limits.period;
    // The row that stands for a sample is from before its step: one more on both sides.
    let given = rows[until].given - rows[from].given;
    // The drive is faster than the column by what stretches the link.
    let drive_rate = |two: &[Row]| {
        let stretched = (two[1].force - two[0].force) * limits.link[0] / (limits.lever * limits.period);
        two[1].rate.abs() + stretched.abs()
    };
    let fastest = rows[from..=until].windows(2).map(drive_rate).fold(rows[from].rate.abs(), f64::max);
    let bound = rows[from].stored + moving.power(fastest) * time;
    wrong.energy = given > bound;
    let by_hand = case.faults.iter().any(|fault| fault.kind.is_of_hand());
    let [low, high] = limits.stops;
    let stopped_by = |row: &Row| row.angle <= low || row.angle >= high;
    let grip = |row: &Row| if stopped_by(row) { 0.0 } else { (row.force * limits.lever / limits.grip_arm).abs() };
    let most = ABOVE_LEGAL * limits.absolute_force;
    let (mut run, mut longest) = (0_u32, 0_u32);
    for row in &rows[from..] {
        run = if grip(row) > most && row.hand.abs() < limits.absolute_force { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    Outcome {
        loader: case.loader,
        kinds,
        due: due.map(|(_, by)| by),
        due_to: due.map(|(function, _)| function),
        stopped,
        safe,
        state: rows[from].allowed.state,
        wrong,
        energy: [given, bound],
        excess: excess(case, limits, by_hand, &rows[from..=safe.map_or(rows.len() - 1, |at| at.max(from))]),
        above: f64::from(longest) * limits.period,
        force: rows[from..].iter().map(grip).fold(0.0, f64::max),
        cause: rows.last().and_then(|row| row.allowed.cause),
    }
}

/// Most energy to the hand beyond what the feel gives it; of a hand that is the fault, what it put in itself is left out.
fn excess(case: &Case, limits: &Limits, by_hand: bool, rows: &[Row]) -> f64 {
    let (mut sum, mut most) = (0.0_f64, 0.0_f64);
    for two in rows.windows(2) {
        let row = &two[0];
        let of_feel = -(row.hand + case.felt(row.arm)) * limits.grip_arm * row.input.feel_rate * limits.period;
        let of_feel = if row.allowed.follows && of_feel.is_finite() { of_feel.max(0.0) } else { 0.0 };
        sum += two[1].given - row.given - of_feel;
        sum = if by_hand { sum } else { sum.max(0.0) };
        most = most.max(sum);
    }
    most
}

/// The first sample at which some function had to have stopped the loader.
fn due(case: &Case, limits: &Limits, rows: &[Row]) -> Option<(Function, usize)> {
    let mut first: Option<(Function, usize)> = None;
    let mut see = |function: Function, at: Option<usize>| {
        if let Some(at) = at
            && first.is_none_or(|(_, before)| at < before)
        {
            first = Some((function, at));
        }
    };
    // Off there is nothing to stop: only from the second sample on is the loader on, and it does not start while something is wrong.
    let on = |k: usize| k > 0 && !matches!(rows[k - 1].allowed.state, SupervisorState::Off);
    let run_of = |function: Function, holds: &dyn Fn(usize) -> bool| {
        let needed = function.samples(limits) as usize;
        (0..rows.len()).find(|&k| on(k) && k + 1 >= needed && (k + 1 - needed..=k).all(holds))
    };
    let received = |k: usize| rows[k].input.missed == 0 && rows[k].input.delay <= limits.late;
    let sensed = |k: usize| received(k) && rows[k].input.sensed.iter().all(|value| value.is_finite());
    // What is watched are the readings that the law is given, too.
    let grip = |k: usize| used(&rows[k])[0] * limits.lever / limits.grip_arm;
    let angle = |k: usize| used(&rows[k])[2] / limits.base_arm;
    see(Function::EmergencyStop, run_of(Function::EmergencyStop, &|k| rows[k].input.emergency_stop));
    see(Function::OtherAxis, run_of(Function::OtherAxis, &|k| rows[k].input.other_axis));
    see(Function::DriveFault, run_of(Function::DriveFault, &|k| rows[k].input.drive_fault));
    // It is enabled before it is initialized, and no further unless it acts.
    let waits = |k: usize| matches!(rows[k].allowed.state, SupervisorState::Initializing);
    let idle = |k: usize| k > 0 && rows[k - 1].allowed.enable && !rows[k].input.drive_acts;
    see(Function::DriveNotReady, run_of(Function::DriveNotReady, &|k| idle(k) && waits(k - 1)));
    see(Function::DriveStopped, run_of(Function::DriveStopped, &|k| idle(k) && received(k) && !waits(k - 1)));
    see(
        Function::NotANumber,
        run_of(Function::NotANumber, &|k| {
            let input = &rows[k].input;
            (received(k) && !sensed(k)) || !input.command.is_finite() || !input.feel_acceleration.is_finite()
        }),
    );
    see(
        Function::OutOfRange,
        run_of(Function::OutOfRange, &|k| {
            let [force, position, base, _] = rows[k].input.sensed;
            let beyond =
                [force, position, base / limits.base_arm].iter().zip(limits.range).any(|(x, most)| x.abs() > most);
            sensed(k) && beyond
        }),
    );
    see(Function::ColumnAngle, jumped(case, limits));
    see(Function::Silence, run_of(Function::Silence, &|k| rows[k].input.missed > 0));
    // Counted from the start on.
    see(Function::Late, run_of(Function::Late, &|k| on(k) && rows[k].input.delay > limits.late));
    see(Function::Overrun, run_of(Function::Overrun, &|k| rows[k].input.late > 0));
    let runs = |k: usize| sensed(k) && on(k);
    see(
        Function::AbsoluteForce,
        run_of(Function::AbsoluteForce, &|k| runs(k) && grip(k).abs() > limits.absolute_force),
    );
    see(Function::Force, run_of(Function::Force, &|k| runs(k) && grip(k).abs() > limits.force_limit));
    see(
        Function::Travel,
        run_of(Function::Travel, &|k| runs(k) && (angle(k) < limits.travel[0] || angle(k) > limits.travel[1])),
    );
    see(
        Function::Speed,
        run_of(Function::Speed, &|k| {
            // In both of two samples, the same way, and so in each of the last two.
            let moved = |k: usize| angle(k) - angle(k - 1);
            let fast = |k: usize| moved(k).abs() > limits.speed_step * (1.0 + ROUNDING);
            runs(k) && k > 2 && runs(k - 1) && runs(k - 2) && fast(k) && fast(k - 1) && moved(k) * moved(k - 1) > 0.0
        }),
    );
    see(
        Function::Saturation,
        run_of(Function::Saturation, &|k| {
            // The command of the sample before, at the whole limit and so at any.
            k > 1 && rows[k - 1].allowed.follows && on(k - 1) && rows[k - 1].allowed.command.abs() >= limits.command
        }),
    );
    see(
        Function::Disagreement,
        run_of(Function::Disagreement, &|k| k > 1 && runs(k) && runs(k - 1) && disagree(limits, rows, k)),
    );
    see(Function::Stuck, stuck(case, limits, rows));
    see(Function::Stuck, grip_stuck(case, limits, rows));
    see(
        Function::Runaway,
        run_of(Function::Runaway, &|k| {
            // As the machine really moves, and clear of the border by a half.
            let Row { rate, force, hand, shaft, input, allowed, .. } = rows[k];
            let (power, feel) = (force * limits.lever * rate, limits.inertia * input.feel_acceleration * rate);
            runs(k)
                && allowed.follows
                && hand == 0.0
                && shaft == 0.0
                && limits.light_feel * feel < -1.5 * limits.runaway_power
                && power > 0.25 * feel
                && (rows[k].input.sensed[0] - force).abs() < limits.hand_torque / limits.lever * 0.1
                && steady(limits, rows, k)
        }),
    );
    first
}

/// The column's own equation leaves little for a hand to have done: what friction and stops do is taken for one.
fn steady(limits: &Limits, rows: &[Row], k: usize) -> bool {
    k > 0 && {
        let acceleration = (rows[k].rate - rows[k - 1].rate) / limits.period;
        (limits.inertia * acceleration - rows[k].force * limits.lever).abs() < 0.3 * limits.hand_torque
    }
}

/// Where one sensor alone jumps, by clearly more than it may, while the loader has been watched for long.
fn jumped(case: &Case, limits: &Limits) -> Option<usize> {
    let single = case.faults.iter().filter(|fault| fault.kind != Kind::None).count() == 1;
    let fault = case.faults.iter().find(|fault| fault.kind == Kind::Jump && single)?;
    (fault.from > WATCHED).then_some(fault.from + limits.bridge as usize)
}

/// Samples after which the supervisor has watched for long.
const WATCHED: usize = 120;

/// The readings of a sample that were used.
fn used(row: &Row) -> [f64; SENSORS] {
    row.used.unwrap_or(row.input.sensed)
}

/// Eq. (9) with what the sensors show, in newtons in place of meters.
fn disagree(limits: &Limits, rows: &[Row], k: usize) -> bool {
    let [per_stiffness, half_play, damping_time] = limits.link;
    let stretch = |k: usize| used(&rows[k])[1] - used(&rows[k])[2] / limits.base_arm * limits.lever;
    let rate = (stretch(k) - stretch(k - 1)) / limits.period;
    let of_link = (stretch(k) + damping_time * rate) / per_stiffness;
    let allowed = (half_play + limits.agreement_m) / per_stiffness;
    (of_link - used(&rows[k])[0]).abs() > allowed * (1.0 + 1e-6)
}

/// A sensor that was made to stick, once the machine has moved on by clearly more than it may.
fn stuck(case: &Case, limits: &Limits, rows: &[Row]) -> Option<usize> {
    let single = case.faults.iter().filter(|fault| fault.kind != Kind::None).count() == 1;
    let fault = case.faults.iter().find(|fault| fault.kind == Kind::Stuck && single)?;
    let from = fault.from + limits.stuck as usize;
    let [per_stiffness, half_play, _] = limits.link;
    // None of the readings is a prediction.
    let read =
        |k: usize| rows[k].used.is_some_and(|used| (0..3).all(|j| (used[j] - rows[k].input.sensed[j]).abs() <= 0.0));
    let apart = |k: usize| {
        let input = |k: usize| used(&rows[k]);
        let expected = |k: usize| match fault.sensor {
            0 => input(k)[1] - input(k)[2] / limits.base_arm * limits.lever,
            1 => input(k)[2] / limits.base_arm * limits.lever + input(k)[0] * per_stiffness,
            _ => input(k)[1] - input(k)[0] * per_stiffness,
        };
        let started = |k: usize| !matches!(rows[k].allowed.state, SupervisorState::Off);
        // What a new start, or the last change of the sensor, begins from is no later than the fault.
        fault.from > 2
            && started(fault.from - 1)
            && read(fault.from)
            && read(k)
            && (expected(k) - expected(fault.from)).abs() > 2.0 * (2.0 * half_play + limits.agreement_m)
    };
    (from..rows.len()).find(|&k| (k - limits.bridge as usize..=k).all(apart))
}

/// A force sensor at the grip that was made to stick, once the hand's force is apart from all that it was while the reading came to rest,
/// by thrice the allowed change, for as long as the supervisor looks on.
fn grip_stuck(case: &Case, limits: &Limits, rows: &[Row]) -> Option<usize> {
    let single = case.faults.iter().filter(|fault| fault.kind != Kind::None).count() == 1;
    let sticks = |fault: &&Fault| matches!(fault.kind, Kind::GripStuck | Kind::GripNoisy);
    let fault = case.faults.iter().find(|fault| sticks(fault) && single && limits.grip_sensor)?;
    // Until the estimate and the lagged reading have settled, and then as long as the reading has to rest.
    let settles = samples(2.0 * SETTLES_S / limits.period) + limits.grip_stuck as usize;
    let from = fault.from.max(WATCHED) + settles;
    let free = |row: &Row| row.angle > limits.stops[0] && row.angle < limits.stops[1];
    // At a stop the hand is not known, and so not what the reading came to rest under.
    let started = fault.from > 2
        && !matches!(rows[fault.from - 1].allowed.state, SupervisorState::Off)
        && rows[fault.from..=from].iter().all(free);
    let at_grip = |row: &Row| row.hand + row.arm;
    // A reading that follows a slow hand rests too: what it came to rest under may be from before the fault.
    let hands = || rows[fault.from.saturating_sub(limits.stuck as usize)..=from].iter().map(at_grip);
    let (low, high) = (hands().fold(f64::INFINITY, f64::min), hands().fold(f64::NEG_INFINITY, f64::max));
    let most = 3.0 * limits.grip_apart / limits.grip_arm;
    let apart = |row: &Row| free(row) && (at_grip(row) > high + most || at_grip(row) < low - most);
    let lasts = 2 * limits.grip_stuck as usize + settles;
    (from + lasts..rows.len()).find(|&k| started && rows[k - lasts..=k].iter().all(apart))
}

/// Time in s after which the estimate of a hand's torque has come to it within a thirtieth.
const SETTLES_S: f64 = 0.02;

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number above zero")]
fn samples(number: f64) -> usize {
    number.ceil() as usize
}
