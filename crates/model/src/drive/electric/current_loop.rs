//! Winding and current loop, with the limits of current and voltage.
//!
//! `u` voltage of a phase · `i` current · `e` its command · `R`, `L` winding · `K_e omega` back-EMF · `w_c` bandwidth · `a` change
//! of the resistance with the temperature · `T` temperature of the winding over that around · `h` step
//!
//! The loop is faster than a step: it is solved exactly, `i' = w_c (e - i)` under a command that changes evenly, or, where the voltage
//! is at its limit, `L i' = +-u_max - R i - K_e omega` at the motor's speed half-way. A voltage that comes to its limit, or from it,
//! inside a step is at the limit no longer than it slows the current: of the three the one in the middle.

use crate::Scalar;
use crate::effects::Effects;
use crate::parameters::Parameters;
use crate::run::StepFraction;

/// Winding and current loop in a run.
#[derive(Debug, Clone, Copy)]
pub struct Current<S> {
    /// `w_c` in rad/s.
    pub bandwidth: S,
    /// Largest current in A.
    limit: S,
    voltage_limit: S,
    resistance: S,
    temperature_coefficient: S,
    /// `w_c L`.
    gain: S,
    /// `K_e` in V s/rad.
    back_emf: S,
    /// `n`: electrical power per voltage and current.
    power_factor: S,
    /// `1 / L`.
    per_inductance: S,
    /// Warmth at which the current begins to be taken back, and one over the way from there to none.
    derating: [S; 2],
    lag: Lag<S>,
    step: S,
    per_step: S,
}

/// What the warmth of the winding makes of it, for a step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Warm<S> {
    /// Resistance of a phase in ohm.
    resistance: S,
    /// Largest current in A.
    limit: S,
}

/// `i' = w (e - i)` over a step.
#[derive(Debug, Clone, Copy)]
struct Lag<S> {
    /// What is left of `i - e` at the end; and half-way, where Simpson's rule then gives the mean.
    left: [S; 2],
    /// Per change of the command since the start: what has followed of it by the end; and half-way, likewise.
    followed: [S; 2],
}

impl<S: Scalar> Lag<S> {
    #[inline(always)]
    fn new(bandwidth: S, step: S) -> Self {
        let (one, z) = (step.constant(1.0), bandwidth * step);
        let end = z.decay();
        let mean = (one - end) / z;
        let followed = one - mean;
        let followed_mean = one.times(0.5) - followed / z;
        // Half-way the command has changed by half.
        let half = at_half(one.zero(), followed_mean, followed).times(2.0);
        Self { left: [end, at_half(one, mean, end)], followed: [followed, half] }
    }
}

/// The value half-way of which, with start and end, Simpson's rule makes the mean.
#[inline(always)]
fn at_half<S: Scalar>(start: S, mean: S, end: S) -> S {
    (mean.times(6.0) - start - end).times(0.25)
}

/// The current through one step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CurrentTrajectory<S> {
    /// What is asked of the winding at the start.
    required: S,
    /// Half-way under that, where Simpson's rule gives the mean.
    half: S,
    /// Mean rate up to the end.
    pub rate: S,
    /// As of the lag; nothing where the voltage is at its limit.
    followed: [S; 2],
}

impl<S: Scalar> CurrentTrajectory<S> {
    /// A current that stays.
    #[inline(always)]
    pub fn constant(i: S) -> Self {
        Self { required: i, half: i, rate: i.zero(), followed: [i.zero(); 2] }
    }

    /// Mean of the square from the current `start` on.
    #[inline(always)]
    pub fn mean_square(&self, start: S, end: S) -> S {
        (start * start + (self.half * self.half).times(4.0) + end * end).times(1.0 / 6.0)
    }
}

impl<S: Scalar> Current<S> {
    /// The coefficients of a loader in steps of `step_s` seconds.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, step_s: f64) -> Self {
        let Parameters { motor, winding, current_loop, thermal, .. } = parameters;
        let one = winding.inductance.constant(1.0);
        let step = one.constant(step_s);
        Self {
            bandwidth: current_loop.bandwidth,
            limit: current_loop.current_limit,
            voltage_limit: current_loop.voltage_limit,
            resistance: winding.resistance,
            temperature_coefficient: winding.temperature_coefficient,
            gain: winding.inductance * current_loop.bandwidth,
            back_emf: motor.back_emf(one),
            power_factor: motor.power_factor(),
            per_inductance: one / winding.inductance,
            derating: [thermal.derating_from - thermal.ambient, one / (thermal.winding_limit - thermal.derating_from)],
            lag: Lag::new(current_loop.bandwidth, step),
            step,
            per_step: one / step,
        }
    }

    /// The winding at a warmth.
    #[inline(always)]
    pub fn warm(&self, warmth: S) -> Warm<S> {
        let (one, [from, per_way]) = (warmth.constant(1.0), self.derating);
        let taken = ((warmth - from) * per_way).clamp(one.zero(), one);
        // Nothing is taken of a limit that is not there.
        let limit = S::select(one.zero().less(taken), self.limit * (one - taken), self.limit);
        // R (1 + a T)
        Warm { resistance: self.resistance * (one + self.temperature_coefficient * warmth), limit }
    }

    /// The current that is asked of the winding by the command.
    #[inline(always)]
    pub fn commanded(&self, effects: &Effects, warm: &Warm<S>, e: S) -> S {
        if effects.saturation { e.within(warm.limit) } else { e }
    }

    /// Voltage of a phase where `required` is asked of the winding at the current `i` and the speed `omega`.
    #[inline(always)]
    pub fn voltage(&self, effects: &Effects, warm: &Warm<S>, (i, omega): (S, S), required: S) -> S {
        let u = self.required_voltage(warm, (i, self.back_emf * omega), required);
        if effects.saturation { u.within(self.voltage_limit) } else { u }
    }

    /// What the winding takes at this current and speed, which the loop knows and adds, and what changes the current.
    #[inline(always)]
    fn required_voltage(&self, warm: &Warm<S>, (i, back_emf): (S, S), required: S) -> S {
        // R i + K_e omega + w_c L (e - i)
        warm.resistance * i + back_emf + self.gain * (required - i)
    }

    /// The current from `i` on through a step in which `required` stays asked of the winding, at the speed `omega` half-way.
    #[inline(always)]
    pub fn trajectory(
        &self,
        effects: &Effects,
        warm: &Warm<S>,
        (i, omega): (S, S),
        required: S,
    ) -> CurrentTrajectory<S> {
        let [left, left_half] = self.lag.left;
        let off = i - required;
        let (mut end, mut half) = (required + off * left, required + off * left_half);
        let mut followed = self.lag.followed;
        if effects.saturation {
            let back_emf = self.back_emf * omega;
            let most = self.required_voltage(warm, (i, back_emf), required).abs();
            let last = self.required_voltage(warm, (end, back_emf), required).abs();
            let limited = self.voltage_limit.less(most.max(last));
            if S::any(limited) {
                let (end_limited, half_limited) = self.limited(warm, (i, back_emf), (half, end));
                (end, half) = (S::select(limited, end_limited, end), S::select(limited, half_limited, half));
                followed = followed.map(|share| S::select(limited, share.zero(), share));
            }
        }
        CurrentTrajectory { required, half, rate: (end - i) * self.per_step, followed }
    }

    /// End and middle of a step of which the voltage is at its limit for a part at least; `free`: middle and end if it were not.
    #[inline(always)]
    fn limited(&self, warm: &Warm<S>, (i, back_emf): (S, S), (half, end): (S, S)) -> (S, S) {
        let one = i.constant(1.0);
        let resistance = warm.resistance;
        let z = resistance * self.per_inductance * self.step;
        let small = z.less(one.times(SMALL));
        let mean = S::select(small, one - z.times(0.5), (one - z.decay()) / z);
        let mean_of_mean = S::select(small, (one - z.times(1.0 / 3.0)).times(0.5), (one - mean) / z);
        let under = |u: S| {
            // L i' = u - R i - K_e omega
            let rise = (u - back_emf - resistance * i) * self.per_inductance * self.step;
            (i + rise * mean, i + rise * mean_of_mean)
        };
        let ((low, low_mean), (high, high_mean)) = (under(-self.voltage_limit), under(self.voltage_limit));
        let free_mean = (i + half.times(4.0) + end).times(1.0 / 6.0);
        let end = end.clamp(low, high);
        (end, at_half(i, free_mean.clamp(low_mean, high_mean), end))
    }

    /// Rate of a current that no limit holds.
    #[inline(always)]
    pub fn rate(&self, i: S, e: S) -> S {
        self.bandwidth * (e - i)
    }

    /// Current and its rate at a moment of a step that carries `i`, where `required` is asked of the winding. At the start the course is
    /// not known yet; `required` stands for its rate.
    #[inline(always)]
    pub fn at(&self, moment: StepFraction, trajectory: &CurrentTrajectory<S>, i: S, required: S) -> (S, S) {
        let change = required - trajectory.required;
        match moment {
            StepFraction::Start => (i, required),
            StepFraction::Half => (trajectory.half + trajectory.followed[1] * change, trajectory.rate),
            StepFraction::End => {
                let more = trajectory.followed[0] * change;
                // A step carries the sum of its rates, of which the last counts a sixth.
                (i + more, trajectory.rate + more.times(6.0) * self.per_step)
            }
        }
    }

    /// Heat in W of all phases at the current's mean square.
    #[inline(always)]
    pub fn heat(&self, warm: &Warm<S>, mean_square: S) -> S {
        // n R i^2
        self.power_factor * warm.resistance * mean_square
    }
}

/// Share of a winding's time constant below which a step is too short for `1 - exp(-z)`: the series is good to the square of it.
const SMALL: f64 = 1e-5;
