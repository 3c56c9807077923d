//! Loaders held where the feel asks for more than the drive gives, under a law with an observer.
//!
//! `e` command as the amplifier answers it · `y` what is sampled · `xi` state of the law · `T` torque that it receives · `delta`, `delta'`
//! the feel · `x` how far the command is beyond its limit, as a displacement, and `a_w` how fast the feel gives way by it
//!
//! The state that a law settles at by itself, `xi = R [y; delta]`, is that of the command that it asks for. At a limit it is told
//! another, and a law that integrates, told of thousands of amperes that no amplifier gave, drives the column to the other stop. Held for long it
//! knows what it was told:
//!
//! | | |
//! |---|---|
//! | `e = +-e_max` | command: the limit that the one asked for is beyond |
//! | `p(e)` | effort of the drive under it, and so the link's stretch and `y` |
//! | `xi = A xi + B [y; e]` | law |
//! | `c [xi; y; delta; delta'] - e = c_delta x` | excess |
//! | `delta' = 2 a_w x`, `T - B delta' - S(delta) = I a_w^2 x` | feel: what carries it on and what it gives way by are level |

use super::{Equilibrium, Machine, Shared};
use crate::Scalar;
use crate::bisect::bisect;
use crate::drive::Drive;
use crate::effects::Effects;
use crate::feel::FeelConditions;
use crate::law_vector::quotient;
use crate::run::SEARCH_RAD;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// The loader held as in `equilibrium`, its law told of the command that the amplifier answers; `equilibrium` where it answers all of it, or
    /// where no state of the law is at rest so: told of the limit it must ask for that or more.
    pub(super) fn told_of_its_limit(
        &self,
        shared: &Shared,
        equilibrium: Equilibrium<S>,
        stiffness_factor: S,
    ) -> Equilibrium<S> {
        let (effects, zero) = (&shared.effects, equilibrium.command.zero());
        let e = self.control.converters.within_range(equilibrium.command);
        let cut = zero.less((equilibrium.command - e).abs());
        if !S::any(cut) {
            return equilibrium;
        }
        let Equilibrium { base, neutral, .. } = equilibrium;
        let (position, effort) = self.under_command(effects, base, e);
        let y = self.sampled_at_rest(effects, base, position, effort);
        let added = shared.cancellation.map_or(zero, |known| known.command(y[1], zero, zero));
        let law = &self.control.observer;
        let estimate = law.initial_estimate(&y, e - added);
        let output = |feel: [S; 2]| {
            let output = law.output(&estimate, &y, feel, None);
            if effects.surroundings { self.control.trimmed(output, neutral, 0.0) } else { output }
        };
        let feel = &self.control.feel;
        let period = self.step.constant(shared.period_s());
        let [further, faster] = self.control.given_way([law.per_delta(), law.per_rate()], period);
        // Where the command is the limit and no more.
        let asks_for_all = quotient(e - added - output([zero, zero]).command, law.per_delta());
        let center = self.control.delta_at(base) - asks_for_all;
        let reach = feel.per_angle.times(SEARCH_RAD);
        let (delta, delta_rate) = bisect((center - reach, center + reach), (zero, zero), |excess| {
            // What a period adds and the end of it takes: half of it is there half-way.
            let [gained, quicker] = [further * excess, faster * excess];
            let rate = gained / period - quicker.times(0.5);
            let delta = asks_for_all + excess - quotient(law.per_rate(), law.per_delta()) * rate;
            let middle = (delta + gained.times(0.5), gained / period);
            let conditions = FeelConditions::at_rest(neutral, stiffness_factor, middle.0);
            let torque = output([delta, rate]).torque;
            let acceleration = feel.acceleration(effects, shared.curve.as_ref(), middle, torque, &conditions);
            (quicker - acceleration * period, (delta, rate))
        });
        // At a hard stop nothing carries it on.
        let stopped = if effects.feel_limits { feel.between_stops(delta) } else { delta };
        let delta_rate = S::select(zero.less((delta - stopped).abs()), zero, delta_rate);
        let delta = stopped;
        let command = output([delta, delta_rate]).command + added;
        let asks = cut & !((command - e) * e).less(zero);
        let pilot_force = self.holding_force(effects, base, effort);
        Equilibrium { base, position, delta, neutral, effort, delta_rate, command, estimate, pilot_force }
            .or(&equilibrium, asks)
    }

    /// Position and effort of the drive at rest under a command, the column held at a base.
    fn under_command(&self, effects: &Effects, base: S, e: S) -> (S, S) {
        let link = self.drive.link();
        let rigid = link.ratio * base;
        // The link stretches by no more than the travel that is looked at.
        let travel = (link.ratio / self.per_base()).times(SEARCH_RAD);
        let reach = self.drive.effort_of_stretch(rigid.abs() + travel);
        bisect((-reach, reach), (rigid, base.zero()), |effort| {
            let at = (rigid + self.drive.stretch_at_rest(effort), effort);
            (self.drive.residual(effects, e, at), at)
        })
    }
}
