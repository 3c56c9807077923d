//! Transmission between motor and linkage: gear, belt, capstan or ballscrew, and the link that it drives.
//!
//! `k_t`, `k` spring rates of transmission and link, `c` damping of the link · `alpha` linkage ratio · `b_t`, `b` free play of both ·
//! `eta` share of the motor's power that arrives, `eta_b` of the load's where that drives the motor
//!
//! Both springs carry the same force. Where the transmission's damping is to its spring as the link's is to its own, as of one
//! material, the two are one: `k' = k k_t / (k + k_t)`, `c' = c k' / k`.

use crate::Scalar;
use crate::drive::Link;
use crate::effects::Effects;
use crate::parameters::Parameters;

/// Link and transmission in series.
#[derive(Debug, Clone, Copy)]
pub struct Train<S> {
    /// Where it holds on to the column.
    pub link: Link<S>,
    /// `alpha c'`.
    pub base_damping: S,
    stiffness: S,
    damping: S,
    /// `1 / eta - 1` and `1 - eta_b`.
    losses: [S; 2],
}

impl<S: Scalar> Train<S> {
    /// The coefficients of a loader.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>) -> Self {
        let Parameters { linkage, transmission, .. } = parameters;
        let one = linkage.stiffness.constant(1.0);
        // 1 / k' = 1 / k + 1 / k_t; a rigid transmission has no second term
        let per_stiffness = one / linkage.stiffness + one / transmission.stiffness;
        let stiffness = one / per_stiffness;
        let damping = linkage.damping * stiffness / linkage.stiffness;
        let half_play = (linkage.backlash + transmission.backlash).times(0.5);
        Self {
            link: Link { ratio: linkage.ratio, half_play, per_stiffness },
            base_damping: linkage.ratio * damping,
            stiffness,
            damping,
            losses: [one / transmission.efficiency - one, one - transmission.backdriving_efficiency],
        }
    }

    /// Force on the link in N with the drive's end at `(x_m, x_m')`; `by_base`: what the base's velocity takes of it.
    #[inline(always)]
    pub fn force(&self, effects: &Effects, (x_m, v_m): (S, S), x_b: S, by_base: S) -> S {
        let stretch = x_m - self.link.ratio * x_b;
        let damped = self.damping * v_m - by_base;
        if !effects.backlash {
            return self.stiffness * stretch + damped;
        }
        // It pushes at one end of its play, pulls at the other, and does neither between.
        let half = self.link.half_play;
        let force = self.stiffness * (stretch - stretch.within(half)) + damped;
        let zero = stretch.zero();
        let no_play = !zero.less(half);
        let holds = no_play | (half.less(stretch.abs()) & zero.less(force * stretch));
        S::select(holds, force, zero)
    }

    /// Length by which the link is stretched at rest under a force, its play included.
    #[inline(always)]
    pub fn stretch_at_rest(&self, force: S) -> S {
        let play = S::select(force.zero().less(force.abs()), self.link.half_play.times_sign(force), force.zero());
        force * self.link.per_stiffness + play
    }

    /// Force that is lost in the transmission under the link's force, moving or about to move along `way`.
    #[inline(always)]
    pub fn lost(&self, force: S, way: S) -> S {
        // The motor drives: F / eta - F; the load does: F - eta_b F. Both against the motion.
        let [driving, driven] = self.losses;
        force.abs() * S::select(force.zero().less(force * way), driving, driven)
    }
}
