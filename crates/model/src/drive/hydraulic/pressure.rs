//! Load pressure in balance: eqs. (1) or (4), (5) and (9) on the time scale of everything but the oil.
//!
//! `z = x_p + kappa p` piston displacement with the oil uncompressed, `kappa = V_E / (4 beta A)` · `I = c kappa p` impulse that the
//! link's damper takes with the oil · `w = x_b' + b I` velocity of the base with that impulse given back, `b` its acceleration
//! per newton of the link · `q_i` no-load flow · `s` sign of `q_i` · `a`, `d` see below
//!
//! The piston has no mass, so the oil pushes it against the link's damper with a pole near -3e4 rad/s, thousands of times faster than
//! the feel. Eq. (5) is `A z' = q` exactly, and eq. (9) is exactly
//!
//! `A p + I' = k (z - kappa p - alpha x_b) + c (q / A - alpha x_b')`
//!
//! `I'` is what makes the pole. Whatever the link's force accelerates gains `A p = (A p + I') - I'`, so a velocity with `I`
//! given back never sees `I'`; and where `A p` stands alone, leaving `I'` out is an error of the pole's time constant squared.
//! What is left is one equation for `p` without a time derivative, `a p = d + (c / A) q(p)`, which is solved in closed form. The
//! pressure is behind this slaved value `p_s` by the pole's time constant: `T p' = p_s - p`, `T = c kappa / a_eff` with
//! `a_eff = a - (c / A) dq / dp`. A sensor and the law see `p`; the motions see `p_s` and are put right as above.
//!
//! Dry friction `F_seal` of the piston's seals stands between oil and link, `A p = F_c + sigma F_seal`, so a load cell in the linkage does
//! not show it. A piston without mass has the velocity of the flow, and the friction acts back on it by the valve alone:
//! `q = q_0 - s_q sigma F_seal / a_eff`, `s_q = -dq / dp`. Where that stops it, `sigma = q_0 a_eff / (s_q F_seal)` holds it; else
//! `sigma = sgn q`. An orifice that hardly yields would make `sigma` jump, so it rises evenly up to `CREEP`.

use crate::Scalar;
use crate::effects::Effects;
use crate::parameters::{Parameters, Valve};

/// Velocity of the piston in m/s at which the friction of its seals is whole: 0.1 mm/s, a column of the elevator that takes four minutes
/// over 10 deg.
const CREEP: f64 = 1e-4;

/// Coefficients of the balance.
#[derive(Debug, Clone, Copy)]
pub struct Balance<S> {
    /// `kappa` in m/Pa.
    pub compressibility: S,
    /// `c kappa` in N s/Pa.
    pub impulse: S,
    /// `A` in m².
    pub area: S,
    /// `alpha`.
    pub ratio: S,
    /// Half of the link's free play in m.
    pub half_play: S,
    /// `1 / k` in m/N.
    pub per_stiffness: S,
    /// `1 / A` in 1/m².
    per_area: S,
    /// `c kappa / A` in s: `T` of a valve that lets nothing by.
    time: S,
    stiffness: S,
    damping_per_area: S,
    supply_pressure: S,
    pressure_gain: S,
    relief_pressure: S,
    relief_gain: S,
    /// `c C_relief / A`.
    relief_slope: S,
    /// `F_seal`.
    seals: S,
    /// Flow of a piston at `CREEP`.
    creep: S,
    moving: Side<S>,
    stuck: Side<S>,
}

/// The link's side of the balance: what depends on whether the base moves.
#[derive(Debug, Clone, Copy)]
pub struct Side<S> {
    /// `c alpha` while the base moves, zero while it sticks.
    base: S,
    closed: Gains<S>,
    relieved: Gains<S>,
}

/// `a` of `a p = d + (c / A) q(p)` in the forms that the solutions ask for.
#[derive(Debug, Clone, Copy)]
struct Gains<S> {
    /// `1 / (a p_s)`.
    per_supply: S,
    /// `c / (2 A a p_s)`.
    orifice: S,
    /// `1 / (a + c C_p / A)`.
    linear: S,
    /// `A / a`.
    area: S,
}

impl<S: Scalar> Gains<S> {
    #[inline(always)]
    fn new(a: S, area: S, damping_per_area: S, valve: &Valve<S>) -> Self {
        let one = a.constant(1.0);
        let per_supply = one / (a * valve.supply_pressure);
        let linear = one / (a + damping_per_area * valve.pressure_gain);
        Self { per_supply, orifice: damping_per_area.times(0.5) * per_supply, linear, area: area / a }
    }

    #[inline(always)]
    fn select(mask: S::Mask, yes: &Self, no: &Self) -> Self {
        Self {
            per_supply: S::select(mask, yes.per_supply, no.per_supply),
            orifice: S::select(mask, yes.orifice, no.orifice),
            linear: S::select(mask, yes.linear, no.linear),
            area: S::select(mask, yes.area, no.area),
        }
    }
}

/// The second order of the slaving. Where the pressure enters elsewhere than as the link's force, the lag behind its slaved value
/// adds up to something proportional to the change of pressure.
#[derive(Debug, Clone, Copy)]
pub struct Lagging<S> {
    /// Flow that the valve let by meanwhile, over the piston's area, in m.
    pub piston: S,
    /// Pressure whose impulse the link took meanwhile, in Pa.
    pub pressure: S,
}

/// Pressure and flow, in balance or behind it.
#[derive(Debug, Clone, Copy)]
pub struct Flow<S> {
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow `A z'` in m³/s that moves piston and oil: through the valve, less what the relief valve lets by.
    pub flow: S,
    /// Flow through the valve per no-load flow.
    pub opening: S,
    /// Pressure in Pa that the seals take of it.
    pub seals: S,
}

/// How the slaved pressure answers to its change: `a_eff` as shares.
#[derive(Debug, Clone, Copy)]
pub struct PressureSensitivity<S> {
    /// `A / a_eff`.
    kept: S,
    /// `(c / A) s_q / a_eff`, with `s_q = -dq / dp` through valve and relief.
    share: S,
}

impl<S: Scalar> Balance<S> {
    /// The balance of a loader whose base gains `b` m/s² per newton of the link's force.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, b: S) -> Self {
        let Parameters { actuator, linkage, valve, .. } = parameters;
        let one = b.constant(1.0);
        // (V_E / 4 beta) p' = q at standstill                                                              eq. (5)
        let compressibility = one / (actuator.pressure_rate(one, one.zero()) * actuator.area);
        let impulse = linkage.damping * compressibility;
        let held = actuator.area + linkage.stiffness * compressibility;
        let moving = held - linkage.damping * linkage.ratio * b * impulse;
        let damping_per_area = linkage.damping / actuator.area;
        let relief_slope = damping_per_area * actuator.relief_gain;
        let gains = |a: S| Gains::new(a, actuator.area, damping_per_area, valve);
        let side = |a: S, base: S| Side { base, closed: gains(a), relieved: gains(a + relief_slope) };
        Self {
            compressibility,
            impulse,
            area: actuator.area,
            ratio: linkage.ratio,
            half_play: linkage.backlash.times(0.5),
            per_stiffness: one / linkage.stiffness,
            per_area: one / actuator.area,
            time: impulse / actuator.area,
            stiffness: linkage.stiffness,
            damping_per_area,
            supply_pressure: valve.supply_pressure,
            pressure_gain: valve.pressure_gain,
            relief_pressure: actuator.relief_pressure,
            relief_gain: actuator.relief_gain,
            relief_slope,
            seals: actuator.seal_friction,
            creep: actuator.swept(one.constant(CREEP)),
            moving: side(moving, linkage.damping * linkage.ratio),
            stuck: side(held, one.zero()),
        }
    }

    /// The side where some bases are stuck.
    #[inline(always)]
    pub fn side(&self, effects: &Effects, stuck: S::Mask) -> Side<S> {
        let (yes, no) = (&self.stuck, &self.moving);
        Side {
            base: S::select(stuck, yes.base, no.base),
            closed: Gains::select(stuck, &yes.closed, &no.closed),
            relieved: if effects.relief { Gains::select(stuck, &yes.relieved, &no.relieved) } else { no.relieved },
        }
    }

    /// The side where every base moves.
    #[inline(always)]
    pub fn moving(&self) -> Side<S> {
        self.moving
    }

    /// Stretch of the link in m, its play included.
    #[inline(always)]
    pub fn stretch(&self, z: S, x_b: S) -> S {
        z - self.ratio * x_b
    }

    /// Whether the link is beyond its play.
    #[inline(always)]
    pub fn touch(&self, stretch: S) -> S::Mask {
        self.half_play.less(stretch.abs()) | self.without_play()
    }

    #[inline(always)]
    fn without_play(&self) -> S::Mask {
        !self.half_play.zero().less(self.half_play)
    }

    /// Pressure and flow at `z`, no-load flow `q_i`, base `x_b`, and `w` (of no account where the base is stuck).
    ///
    /// `touches`: where the link may push or pull at all.
    #[inline(always)]
    pub fn solve(&self, effects: &Effects, side: &Side<S>, touches: S::Mask, [z, q_i, _, x_b, w]: [S; 5]) -> Flow<S> {
        let linked = self.linked(effects, side, z, q_i, x_b, w);
        if !effects.backlash {
            return linked;
        }
        // The link pushes at one end of its play, pulls at the other, and does neither between.
        let (zero, stretch) = (z.zero(), self.stretch(z, x_b));
        let holds = self.half_play.less(stretch.abs()) & zero.less((linked.pressure - linked.seals) * stretch);
        let holds = touches & (holds | self.without_play());
        // A piston that hangs in the play is left its seals' friction.
        let only = |value: S| S::select(holds, value, zero);
        let (pressure, seals) = (only(linked.pressure), only(linked.seals));
        Flow { pressure, flow: S::select(holds, linked.flow, q_i), seals, ..linked }
    }

    /// The same for a link at the end of its play that is nearer.
    #[inline(always)]
    pub fn linked(&self, effects: &Effects, side: &Side<S>, z: S, q_i: S, x_b: S, w: S) -> Flow<S> {
        let mut stretch = self.stretch(z, x_b);
        if effects.backlash {
            stretch = stretch - self.half_play.times_sign(stretch);
        }
        let pull = self.stiffness * stretch - side.base * w;
        let free = self.against(effects, side, pull, q_i);
        if !effects.seals {
            return free;
        }
        let yields = self.yielding(effects, side, q_i, &free).share / self.damping_per_area * self.seals;
        let rub = self.seals * (free.flow / (yields + self.creep)).within(pull.constant(1.0));
        Flow { seals: rub * self.per_area, ..self.against(effects, side, pull + rub, q_i) }
    }

    /// `a p = d + (c / A) q(p)` for the given `d`.
    #[inline(always)]
    fn against(&self, effects: &Effects, side: &Side<S>, d: S, q_i: S) -> Flow<S> {
        let valve = |gains: &Gains<S>, d: S| {
            if effects.orifice { self.orifice(gains, d, q_i) } else { self.linear(gains, d, q_i) }
        };
        let closed = valve(&side.closed, d);
        if !effects.relief {
            return closed;
        }
        // Above p_relief: q - C_relief (p - p_relief) in place of q, so a grows by c C_relief / A and d along with it.
        let limit = self.relief_pressure.times_sign(closed.pressure);
        let over = self.relief_pressure.less(closed.pressure.abs());
        let open = valve(&side.relieved, d + S::select(over, self.relief_slope * limit, d.zero()));
        let escaping = self.relief_gain * (open.pressure - limit);
        Flow {
            pressure: S::select(over, open.pressure, closed.pressure),
            flow: S::select(over, open.flow - escaping, closed.flow),
            opening: S::select(over, open.opening, closed.opening),
            ..closed
        }
    }

    /// With eq. (1): `p = s p_s (1 - y |y|)`, `q = q_i y`.
    #[inline(always)]
    fn orifice(&self, gains: &Gains<S>, d: S, q_i: S) -> Flow<S> {
        let one = d.constant(1.0);
        // y |y| + 2 g y = r,  r = 1 - s d / (a p_s),  g = (c / A) |q_i| / (2 a p_s)
        let r = one - (d * gains.per_supply).times_sign(q_i);
        let g = q_i.abs() * gains.orifice;
        let y = ((g * g + r.abs()).sqrt() - g).times_sign(r);
        let pressure = (self.supply_pressure * (one - y * y.abs())).times_sign(q_i);
        Flow { pressure, flow: q_i * y, opening: y, seals: y.zero() }
    }

    /// With eq. (4): `q = q_i - C_p p`.
    #[inline(always)]
    fn linear(&self, gains: &Gains<S>, d: S, q_i: S) -> Flow<S> {
        let pressure = (d + self.damping_per_area * q_i) * gains.linear;
        Flow { pressure, flow: q_i - self.pressure_gain * pressure, opening: d.constant(1.0), seals: d.zero() }
    }

    /// How the slaved pressure yields.
    #[inline(always)]
    pub fn yielding(
        &self,
        effects: &Effects,
        side: &Side<S>,
        q_i: S,
        quasi_steady: &Flow<S>,
    ) -> PressureSensitivity<S> {
        let one = q_i.constant(1.0);
        let over = quasi_steady.pressure - quasi_steady.pressure.within(self.relief_pressure);
        let open = one.zero().less(over.abs());
        let gains = if effects.relief { Gains::select(open, &side.relieved, &side.closed) } else { side.closed };
        let mut share = if effects.orifice {
            let through = if effects.relief { quasi_steady.flow + self.relief_gain * over } else { quasi_steady.flow };
            let slope = q_i.abs() * gains.orifice * q_i.abs();
            slope / (through.abs() + slope).max(one.constant(f64::MIN_POSITIVE))
        } else {
            self.damping_per_area * self.pressure_gain * gains.linear
        };
        let kept = (one - share) * gains.area;
        if effects.relief {
            share = S::select(open, one - kept / side.closed.area, share);
        }
        PressureSensitivity { kept, share }
    }

    /// What the lag `p - p_s = -T p_s'` adds up to over a change of pressure: see [`Lagging`].
    #[inline(always)]
    pub fn lagging(&self, &PressureSensitivity { kept, share }: &PressureSensitivity<S>, change: S) -> Lagging<S> {
        Lagging { piston: self.compressibility * share * change, pressure: (change.constant(1.0) - kept) * change }
    }

    /// Rate `p_s'` of the slaved pressure where `z, q_i, q_i', x_b, w` change at the `rates`.
    #[inline(always)]
    pub fn slaved_rate(
        &self,
        side: &Side<S>,
        yielding: &PressureSensitivity<S>,
        (q_i, quasi_steady): (S, &Flow<S>),
        &[z_rate, q_i_rate, _, x_b_rate, w_rate]: &[S; 5],
    ) -> S {
        // a_eff p_s' = k (z' - alpha x_b') - c alpha w' + (c / A) (q / q_i) q_i'
        let link = self.stiffness * (z_rate - self.ratio * x_b_rate) - side.base * w_rate;
        // Where nothing flows yet, the side to which the valve will open is not known.
        let one = q_i.constant(1.0);
        let opening = S::select(q_i.zero().less(q_i.abs()), quasi_steady.opening, one);
        (link + self.damping_per_area * opening * q_i_rate) * yielding.kept * self.per_area
    }

    /// Whether there is a link for the slaved pressure to push on: within the play there is none, and no pressure.
    #[inline(always)]
    pub fn holds(&self, quasi_steady: S) -> S::Mask {
        quasi_steady.zero().less(quasi_steady.abs()) | self.without_play()
    }

    /// Pressure and flow at the end of a step `h`, behind the slaved ones by a lag `L`, `L' = p_s' - L / T`, that was `before` at its
    /// start, while the slaved pressure changed by `change`, at its end at the rate `rate`. Exact where that rate ran straight, but
    /// for a decay `exp(-h / T)` of third order in place of the exponential.
    #[inline(always)]
    pub fn behind(
        &self,
        &PressureSensitivity { kept, share }: &PressureSensitivity<S>,
        quasi_steady: &Flow<S>,
        (before, change, rate): (S, S, S),
        (h, per_h): (S, S),
    ) -> Flow<S> {
        let t = kept * self.time;
        let mean = change * per_h;
        let bend = (rate - mean) * per_h.times(2.0) * t; // T p_s''
        let (at_start, at_end) = (mean.times(2.0) - rate - bend, rate - bend);
        // exp(-h / T) = T^3 / (T^3 + h T^2 + h^2 T / 2 + h^3 / 6)
        let whole = ((t + h) * t + (h * h).times(0.5)) * t + (h * h * h).times(1.0 / 6.0);
        let per_time = at_end + (before - t * at_start) * (t * t / whole); // L / T
        Flow {
            pressure: quasi_steady.pressure - t * per_time,
            // What the valve lets by the more: s_q L
            flow: quasi_steady.flow + self.area * self.compressibility * share * per_time,
            ..*quasi_steady
        }
    }

    /// Length by which the link is stretched, less its play, at rest under the pressure `p`.
    #[inline(always)]
    pub fn stretch_at_rest(&self, p: S) -> S {
        let play = S::select(p.zero().less(p.abs()), self.half_play.times_sign(p), p.zero());
        // A p = k (x_p - alpha x_b -+ b / 2)                                                          eq. (9) at rest
        self.area * p / self.stiffness + play
    }

    /// No-load flow that stands against the pressure `p` at rest.
    #[inline(always)]
    pub fn leakage(&self, effects: &Effects, p: S) -> S {
        let relieved = self.relief_gain * (p - p.within(self.relief_pressure));
        if effects.orifice {
            // q = q_i sqrt(1 - |p| / p_s) with q_i of the sign of p; beyond p_s, an enormous flow               eq. (1)
            let share = p.constant(1.0) - p.abs() / self.supply_pressure;
            S::select(p.zero().less(relieved.abs()), relieved / share.max(p.constant(1e-12)).sqrt(), p.zero())
        } else {
            self.pressure_gain * p + relieved // eq. (4)
        }
    }

    /// Piston displacement in m.
    #[inline(always)]
    pub fn piston(&self, z: S, p: S) -> S {
        z - self.compressibility * p
    }
}
