//! The whole loader in time: one step of plant, controller and feel.
//!
//! `z` piston displacement with the oil uncompressed · `p` load pressure, slaved · `q_i`, `q_i'` no-load flow and its rate ·
//! `x_b`, `v` base and its velocity · `delta`, `delta'` programmed displacement and its rate · `I` impulse of the link's damper ·
//! `w = v + b I`, `u = delta' - (r / I_feel) I` the velocities that do not see the oil's pole, see `pressure.rs` · `h` step
//!
//! One step is the classical Runge-Kutta step of fourth order on `z, q_i, q_i', x_b, w` and, under the analog law, `delta, u`, with the
//! load pressure solved at every stage: fixed cost, no iteration, and no step so long that the oil makes it unstable. Dry
//! friction holds its direction through a step; what it did inside the last step is settled at the start of the next. So do
//! stops and the link's play hold their touch, and what touched inside a step is made good at its end, see `machine/touch.rs`.

mod digital;
mod feel;
pub mod period;
mod rest;
mod slow;
mod touch;

pub use digital::Memory;
pub use rest::{REST_NUMBERS, Rest, SEARCH_RAD};

use crate::Scalar;
use crate::column_motion::ColumnMotion;
use crate::compensator::Compensator;
use crate::controller::{Converters, Timing};
use crate::curve::Curve;
use crate::dry_friction::Grip;
use crate::effects::Effects;
use crate::feel_law::FeelLaw;
use crate::observer::Observer;
use crate::parameters::Parameters;
use crate::pressure::{Balance, Flow, Side, Yielding};
use crate::transducers::{SENSORS, Seen, Transducers};
use crate::valve_motion::ValveMotion;
use slow::Slow;

/// What all runs of a batch share.
#[derive(Debug, Clone)]
pub struct Shared {
    /// Effects in play.
    pub effects: Effects,
    /// Length of a step in s.
    pub step_s: f64,
    /// When a digital controller acts; an analog law otherwise.
    pub timing: Option<Timing>,
    /// Force over angle of the feel, in place of its straight spring.
    pub curve: Option<Curve>,
}

/// Inputs at the start and at the end of one step; between, they change evenly.
#[derive(Debug, Clone, Copy)]
pub struct Inputs {
    /// Pilot force in N.
    pub force: [f64; 2],
    /// Commanded neutral in rad.
    pub trim: [f64; 2],
    /// Factor on the feel's spring.
    pub stiffness_factor: [f64; 2],
    /// The stick shaker's swing, -1 to 1.
    pub shaker: [f64; 2],
    /// Share of the next feel, while the feel is being changed.
    pub fade: [f64; 2],
    /// Test signal at the amplifier's input in V.
    pub test_signal: [f64; 2],
    /// What is added to the law's command in V: a digital controller adds what it finds at a sample, and sends it on with the command.
    pub command_signal: [f64; 2],
}

impl Inputs {
    /// Nothing at all, the spring as it is.
    pub const NONE: Self = Self {
        force: [0.0; 2],
        trim: [0.0; 2],
        stiffness_factor: [1.0; 2],
        shaker: [0.0; 2],
        fade: [0.0; 2],
        test_signal: [0.0; 2],
        command_signal: [0.0; 2],
    };

    /// The inputs as they stand at the end of the step, and stay.
    #[inline(always)]
    pub fn end(&self) -> Self {
        let stay = |[_, end]: [f64; 2]| [end, end];
        Self {
            force: stay(self.force),
            trim: stay(self.trim),
            stiffness_factor: stay(self.stiffness_factor),
            shaker: stay(self.shaker),
            fade: stay(self.fade),
            test_signal: stay(self.test_signal),
            command_signal: stay(self.command_signal),
        }
    }
}

/// One loader, ready to run: its coefficients worked out.
#[derive(Debug, Clone, Copy)]
pub struct Machine<S> {
    law: Compensator<S>,
    observer: Observer<S>,
    next_observer: Observer<S>,
    valve: ValveMotion<S>,
    balance: Balance<S>,
    column: ColumnMotion<S>,
    feel: FeelLaw<S>,
    next_feel: FeelLaw<S>,
    transducers: Transducers<S>,
    converters: Converters<S>,
    /// `b c kappa`: velocity of the base per pressure that the damper's impulse is worth.
    base_impulse: S,
    /// `r c kappa / I`: the same for the feel.
    feel_impulse: S,
    /// `A` where the feel computer hears the load cell directly, zero where the load cell is sampled or lags.
    direct: S,
    force_scale: S,
    per_base: S,
    per_area: S,
    step: S,
    per_step: S,
}

/// State between two steps.
#[derive(Debug, Clone, Copy)]
pub struct State<S: Scalar> {
    slow: Slow<S>,
    column: Grip<S>,
    feel: Grip<S>,
    seen: Seen<S>,
    neutral: S,
    slider: S,
    /// Command that the amplifier holds under a digital controller.
    held: S,
    /// Pilot force at the end of the last step.
    pilot_force: S,
    /// Slaved load pressure at its start.
    pressure: S,
    /// By how much the load pressure was behind it.
    lag: S,
    /// Force of a hand that holds the grip until it lets go, in N.
    hand: S,
    /// What is added to the command that it holds, in V.
    test_signal: S,
    /// Share of the last step by which a force on the load cell came later than a straight line.
    late: S,
    /// Steps since the start.
    steps: usize,
}

/// What there is at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Now<S> {
    /// Displacement of the column's base in m.
    pub base: S,
    /// Its velocity in m/s.
    pub base_rate: S,
    /// Programmed displacement, in its unit.
    pub delta: S,
    /// Its rate.
    pub delta_rate: S,
    /// Piston displacement in m.
    pub piston: S,
    /// Force of the load cell in N.
    pub force: S,
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow that moves piston and oil, in m³/s.
    pub flow: S,
    /// Valve current in A.
    pub current: S,
    /// Pilot force in N.
    pub pilot_force: S,
    /// Pressure and flow in balance, which the motions see; those above are behind them by the oil's lag.
    slaved: Flow<S>,
}

/// What the start of a step leaves for the rest of it.
#[derive(Debug, Clone, Copy)]
pub struct Begun<S: Scalar> {
    /// What there is now.
    pub now: Now<S>,
    slow: Slow<S>,
    rates: Slow<S>,
    side: Side<S>,
}

/// When within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moment {
    Start,
    Half,
    End,
}

impl Moment {
    #[inline(always)]
    fn of(self, [start, end]: [f64; 2]) -> f64 {
        match self {
            Self::Start => start,
            Self::Half => 0.5 * (start + end),
            Self::End => end,
        }
    }
}

/// What a step needs at every stage.
struct Stage<'a, S: Scalar> {
    shared: &'a Shared,
    inputs: &'a Inputs,
    state: &'a State<S>,
    moment: Moment,
}

impl<S: Scalar> Machine<S> {
    /// The loader with these parameters under this law, in steps of `shared.step_s`.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, law: Compensator<S>, shared: &Shared) -> Self {
        let column = ColumnMotion::new(parameters);
        let balance = Balance::new(parameters, column.per_link_force);
        let feel = FeelLaw::new(parameters, &law);
        let one = parameters.column.inertia.constant(1.0);
        // A sampled load cell, or one with a lag, keeps the oil's pole from the feel computer.
        let direct = !parameters.load_cell.bandwidth.less(one / one.zero());
        let arm = if shared.timing.is_none() { law.load_cell_arm } else { one.zero() };
        let heard = S::select(direct, arm, one.zero());
        let observer = Observer::none(one);
        Self {
            law,
            observer,
            next_observer: observer,
            valve: ValveMotion::new(parameters, shared.effects.orifice),
            balance,
            column,
            feel,
            next_feel: feel,
            transducers: Transducers::new(parameters, shared.step_s),
            converters: Converters::new(parameters),
            base_impulse: column.per_link_force * balance.impulse,
            feel_impulse: heard * feel.per_torque * balance.impulse,
            direct: if shared.timing.is_none() { S::select(direct, balance.area, one.zero()) } else { one.zero() },
            force_scale: one,
            per_base: parameters.column.angle(one),
            per_area: one / balance.area,
            step: one.constant(shared.step_s),
            per_step: one.constant(1.0 / shared.step_s),
        }
    }

    /// The same loader with the pilot's force multiplied.
    #[inline(always)]
    pub fn with_force_scale(self, force_scale: S) -> Self {
        Self { force_scale, ..self }
    }

    /// The same loader under a sampled law with an observer; the gains of its law are not used.
    #[inline(always)]
    pub fn with_observer(self, observer: Observer<S>) -> Self {
        Self { observer, next_observer: observer, ..self }
    }

    /// The start of a step: settles what friction did in the last one, samples if it is time to, and looks.
    ///
    /// `normal` gives a standard normal number for each sensor when a sample is taken.
    #[inline(always)]
    pub fn begin(
        &self,
        shared: &Shared,
        state: &mut State<S>,
        memory: &mut Memory<S>,
        inputs: &Inputs,
        normal: impl FnOnce() -> [S; SENSORS],
    ) -> Begun<S> {
        let effects = &shared.effects;
        let side = if effects.column_friction {
            self.balance.side(effects, state.column.stuck)
        } else {
            self.balance.moving()
        };
        let force = self.pilot_force(state, inputs, Moment::Start);
        let mut now = self.look(effects, &side, &state.slow, state, (force, force.zero()));
        if state.steps > 0 {
            let yielding = self.balance.yielding(effects, &side, state.slow.plant[1], &now.slaved);
            self.catch_up(effects, &yielding, state, &mut now);
            self.follow(effects, &side, &yielding, state, &mut now);
        }
        if effects.lags || shared.timing.is_some() {
            let measured = Self::measured(&now);
            let shown = self.transducers.after_whole(&state.seen, measured, state.late);
            state.seen = Seen { measured, shown };
        }
        if let Some(timing) = shared.timing {
            self.control(shared, timing, (state, memory), inputs, &now, normal);
        }
        let stage = Stage { shared, inputs, state, moment: Moment::Start };
        if effects.feel_limits && shared.timing.is_none() {
            let limited = self.feel.held_within((now.delta, now.delta_rate), (now.delta, now.delta_rate));
            (now.delta, now.delta_rate) = limited;
        }
        let mut rates = self.rates(&stage, &state.slow, &mut now);
        let side = self.settle(shared, state, inputs, &mut now, &mut rates, side);
        Begun { now, slow: state.slow, rates, side }
    }

    /// Displacement of the base half-way between the starts of two steps.
    #[inline(always)]
    pub fn middle_base(&self, before: &Begun<S>, after: &Begun<S>) -> S {
        let (a, b) = (&before.now, &after.now);
        slow::cubic((a.base, a.base_rate), (b.base, b.base_rate), self.step.times(0.125))
    }

    /// What there was half-way between the starts of two steps: of the third order where nothing was switched between them.
    #[inline(always)]
    pub fn middle(&self, shared: &Shared, inputs: &Inputs, before: &Begun<S>, after: &Begun<S>) -> Now<S> {
        let (a, b) = (&before.now, &after.now);
        let eighth = self.step.times(0.125);
        // The rate of the same cubic.
        let rate = |x_0: S, x_1: S, rate_0: S, rate_1: S| {
            ((x_1 - x_0) * self.per_step).times(1.5) - (rate_0 + rate_1).times(0.25)
        };
        let slow = Slow::middle((&before.slow, &before.rates), (&after.slow, &after.rates), self.step);
        let touches = self.link_touches(&before.slow) | self.link_touches(&after.slow);
        let slaved = self.balance.solve(&shared.effects, &before.side, touches, slow.plant);
        // The lag itself changes so little over a step that a straight line will do.
        let between = |lag: &dyn Fn(&Now<S>) -> S| (lag(a) + lag(b)).times(0.5);
        let pressure = slaved.pressure + between(&|now| now.pressure - now.slaved.pressure);
        let digital = shared.timing.is_some();
        let force = Moment::Half.of(inputs.force) - inputs.force[0];
        Now {
            base: self.middle_base(before, after),
            base_rate: rate(a.base, b.base, a.base_rate, b.base_rate),
            delta: if digital {
                a.delta
            } else {
                slow::cubic((a.delta, a.delta_rate), (b.delta, b.delta_rate), eighth)
            },
            delta_rate: if digital { a.delta_rate } else { rate(a.delta, b.delta, a.delta_rate, b.delta_rate) },
            piston: self.balance.piston(slow.plant[0], pressure),
            force: self.balance.area * pressure,
            pressure,
            flow: slaved.flow + between(&|now| now.flow - now.slaved.flow),
            current: if digital { a.current } else { (a.current + b.current).times(0.5) },
            pilot_force: a.pilot_force + self.force(force),
            slaved,
        }
    }

    /// The rest of a step.
    #[inline(always)]
    pub fn advance(&self, shared: &Shared, state: &mut State<S>, inputs: &Inputs, begun: &Begun<S>) {
        let analog = shared.timing.is_none();
        let (h, half) = (self.step, self.step.times(0.5));
        let start = state.slow;
        let k_1 = begun.rates;
        let k_2 = self.stage(shared, state, inputs, begun, &start.moved(&k_1, half, analog), Moment::Half);
        let k_3 = self.stage(shared, state, inputs, begun, &start.moved(&k_2, half, analog), Moment::Half);
        let k_4 = self.stage(shared, state, inputs, begun, &start.moved(&k_3, h, analog), Moment::End);
        let total = Slow::weighted(&[k_1, k_2, k_3, k_4]);
        state.slow = start.moved(&total, self.step.times(1.0 / 6.0), analog);
        self.touch(shared, state, inputs, &start, begun);
        if analog {
            state.slider = self.dragged(&shared.effects, state);
            if shared.effects.surroundings {
                state.neutral = self.feel.trimmed(state.neutral, h.constant(inputs.trim[1]), h);
            }
        }
        state.pilot_force = self.pilot_force(state, inputs, Moment::End);
        state.steps += 1;
    }

    #[inline(always)]
    fn stage(
        &self,
        shared: &Shared,
        state: &State<S>,
        inputs: &Inputs,
        begun: &Begun<S>,
        slow: &Slow<S>,
        moment: Moment,
    ) -> Slow<S> {
        // The lag hardly changes in a step.
        let force = self.pilot_force(state, inputs, moment);
        let mut now = self.look(&shared.effects, &begun.side, slow, state, (force, -state.lag));
        if shared.effects.feel_limits && shared.timing.is_none() {
            let before = (begun.now.delta, begun.now.delta_rate);
            (now.delta, now.delta_rate) = self.feel.held_within(before, (now.delta, now.delta_rate));
        }
        let stage = Stage { shared, inputs, state, moment };
        let mut rates = self.rates(&stage, slow, &mut now);
        Self::resist(&shared.effects, state, &mut rates);
        rates
    }

    /// The pilot's force in N where the inputs give `force`.
    #[inline(always)]
    pub fn force(&self, force: f64) -> S {
        self.force_scale.times(force)
    }

    #[inline(always)]
    fn pilot_force(&self, state: &State<S>, inputs: &Inputs, moment: Moment) -> S {
        self.force(moment.of(inputs.force)) + state.hand
    }

    /// A hand holds the grip with the force of `rest`.
    pub fn hold(state: &mut State<S>, rest: &Rest<S>) {
        state.hand = rest.pilot_force;
    }

    /// The hand lets go.
    pub fn let_go(state: &mut State<S>) {
        state.hand = state.hand.zero();
    }

    /// What follows from the slow states: pressure and flow in balance, velocities and forces, and what sensors measure of a pressure
    /// that is off its balance by `lag`.
    #[inline(always)]
    fn look(
        &self,
        effects: &Effects,
        side: &Side<S>,
        slow: &Slow<S>,
        state: &State<S>,
        (pilot_force, lag): (S, S),
    ) -> Now<S> {
        let [z, _, _, x_b, w] = slow.plant;
        let [delta, u] = slow.feel;
        let slaved = self.balance.solve(effects, side, self.link_touches(&state.slow), slow.plant);
        let p = slaved.pressure;
        let moving = w - self.base_impulse * p;
        let base_rate = if effects.column_friction { S::select(state.column.stuck, w.zero(), moving) } else { moving };
        let delta_rate = if effects.sampled {
            u
        } else {
            let rate = u + self.feel_impulse * p;
            if effects.feel_friction { S::select(state.feel.stuck, u.zero(), rate) } else { rate }
        };
        let pressure = p + lag;
        Now {
            base: x_b,
            base_rate,
            delta,
            delta_rate,
            piston: self.balance.piston(z, pressure),
            force: self.balance.area * pressure,
            pressure,
            flow: slaved.flow,
            current: p.zero(),
            pilot_force,
            slaved,
        }
    }

    /// Pressure and flow as far as they have come behind their balance up to the start of a step.
    #[inline(always)]
    fn follow(
        &self,
        effects: &Effects,
        side: &Side<S>,
        yielding: &Yielding<S>,
        state: &mut State<S>,
        now: &mut Now<S>,
    ) {
        let [z, q_i, q_i_rate, x_b, _] = state.slow.plant;
        // Up to here there was the force of before.
        let mut accelerated = self.pull(effects, (x_b, x_b), &Now { pilot_force: state.pilot_force, ..*now });
        if effects.column_friction {
            accelerated = accelerated + state.column.drag;
        }
        let rates = [now.slaved.flow * self.per_area, q_i_rate, q_i.zero(), now.base_rate, accelerated];
        let rate = self.balance.slaved_rate(side, yielding, (q_i, &now.slaved), &rates);
        let slaved = now.slaved.pressure;
        let mut change = slaved - state.pressure;
        if effects.backlash {
            // Where the link met the end of its play the pressure came with a jump, which is no rate.
            change = S::select(self.balance.holds(state.pressure), change, rate * self.step);
        }
        let change = (state.lag, change, rate);
        let mut oil = self.balance.behind(yielding, &now.slaved, change, (self.step, self.per_step));
        if effects.backlash {
            let holds = self.balance.holds(slaved);
            oil.pressure = S::select(holds, oil.pressure, slaved);
            oil.flow = S::select(holds, oil.flow, now.slaved.flow);
        }
        (now.pressure, now.flow) = (oil.pressure, oil.flow);
        (now.piston, now.force) = (self.balance.piston(z, oil.pressure), self.balance.area * oil.pressure);
        (state.pressure, state.lag) = (slaved, slaved - oil.pressure);
    }

    /// Acceleration of the base, dry friction left out, that begins its step at `start`.
    #[inline(always)]
    fn pull(&self, effects: &Effects, (start, x_b): (S, S), now: &Now<S>) -> S {
        self.column.per_link_force * self.balance.area * now.slaved.pressure
            + self.column.per_pilot_force * now.pilot_force
            + self.column.loads(effects, start, x_b, now.base_rate)
    }

    /// Whether the link is beyond its play at the start of the step.
    #[inline(always)]
    fn link_touches(&self, start: &Slow<S>) -> S::Mask {
        self.balance.touch(self.balance.stretch(start.plant[0], start.plant[3]))
    }

    #[inline(always)]
    fn measured(now: &Now<S>) -> [S; SENSORS] {
        [now.force, now.piston, now.base]
    }

    /// Makes good what the pressure's lag behind its slaved value did in the last step.
    #[inline(always)]
    fn catch_up(&self, effects: &Effects, yielding: &Yielding<S>, state: &mut State<S>, now: &mut Now<S>) {
        let lagging = self.balance.lagging(yielding, now.slaved.pressure - state.pressure);
        let (base, feel) = (self.base_impulse * lagging.pressure, -self.feel_impulse * lagging.pressure);
        state.slow.plant[0] = state.slow.plant[0] + lagging.piston;
        state.slow.plant[4] = state.slow.plant[4] + base;
        state.slow.feel[1] = state.slow.feel[1] + feel;
        let unless = |mask: S::Mask, value: S, by: S| S::select(mask, value, value + by);
        now.base_rate = if effects.column_friction {
            unless(state.column.stuck, now.base_rate, base)
        } else {
            now.base_rate + base
        };
        now.delta_rate =
            if effects.feel_friction { unless(state.feel.stuck, now.delta_rate, feel) } else { now.delta_rate + feel };
    }

    /// What the sensors show under the analog law.
    #[inline(always)]
    fn shown(&self, stage: &Stage<'_, S>, now: &Now<S>) -> ([S; SENSORS], S) {
        let effects = &stage.shared.effects;
        let mut shown = Self::measured(now);
        let mut base_rate = now.base_rate;
        if effects.lags {
            shown = match stage.moment {
                Moment::Start => stage.state.seen.shown,
                Moment::Half => self.transducers.after_half(&stage.state.seen, shown),
                Moment::End => self.transducers.after_whole(&stage.state.seen, shown, now.base.zero()),
            };
            base_rate = self.transducers.column_rate(now.base, base_rate, shown[2]);
        }
        if effects.offsets {
            let offset = &self.transducers.offset;
            shown = [shown[0] + offset[0], shown[1] + offset[1], shown[2] + offset[2]];
        }
        (shown, base_rate)
    }

    /// Time derivatives, dry friction left out.
    #[inline(always)]
    fn rates(&self, stage: &Stage<'_, S>, slow: &Slow<S>, now: &mut Now<S>) -> Slow<S> {
        let effects = &stage.shared.effects;
        let [_, q_i, q_i_rate, x_b, _] = slow.plant;
        let mut feel = slow.feel;
        let mut e = if stage.shared.timing.is_some() {
            stage.state.held + stage.state.test_signal
        } else {
            let ([force, piston, base], base_rate) = self.shown(stage, now);
            let around = self.around(effects, stage.state, stage.inputs, stage.moment);
            let torque = self.heard_torque(force, now);
            let fade = stage.moment.of(stage.inputs.fade);
            let computer = self.feel_computer(stage.shared, fade);
            feel = [now.delta_rate, computer.acceleration((now.delta, now.delta_rate), torque, &around)];
            let x = [piston, force / self.balance.area, now.delta, now.delta_rate, base, base_rate, now.pilot_force];
            let e = self.law.command(&x);
            if effects.test_signal { e + e.constant(stage.moment.of(stage.inputs.command_signal)) } else { e }
        };
        if effects.test_signal {
            e = e + e.constant(stage.moment.of(stage.inputs.test_signal));
        }
        now.current = self.valve.current(effects, e);
        let flow_acceleration = self.valve.flow_acceleration(effects, q_i, q_i_rate, now.current);
        let pull = self.pull(effects, (stage.state.slow.plant[3], x_b), now);
        Slow { plant: [now.slaved.flow * self.per_area, q_i_rate, flow_acceleration, now.base_rate, pull], feel }
    }

    /// Torque that an analog feel computer hears where the load cell shows `force`: where it hears it directly, it is a motion like
    /// the column's, whose `u` knows of the lag.
    #[inline(always)]
    fn heard_torque(&self, force: S, now: &Now<S>) -> S {
        self.law.feel_torque(force + self.direct * (now.slaved.pressure - now.pressure))
    }

    /// Dry friction at the start of a step: first what it did inside the last step, then what it does in this one.
    #[inline(always)]
    fn settle(
        &self,
        shared: &Shared,
        state: &mut State<S>,
        inputs: &Inputs,
        now: &mut Now<S>,
        rates: &mut Slow<S>,
        side: Side<S>,
    ) -> Side<S> {
        let effects = &shared.effects;
        let mut side = side;
        if effects.column_friction {
            let friction = &self.column.friction;
            let (v, pull) = (now.base_rate, rates.plant[4]);
            // What the force jumped between the steps did not pull in the last one.
            let jump = self.column.per_pilot_force * (now.pilot_force - state.pilot_force);
            let found = friction.settled(&state.column, v, pull - jump, (self.step, self.per_step));
            state.column = friction.grip(found.velocity, pull);
            state.slow.plant[3] = state.slow.plant[3] + found.displacement;
            let w = found.velocity + self.base_impulse * now.slaved.pressure;
            state.slow.plant[4] = S::select(found.settled, w, state.slow.plant[4]);
            now.base = state.slow.plant[3];
            now.base_rate = found.velocity;
            rates.plant[3] = found.velocity;
            side = self.balance.side(effects, state.column.stuck);
        }
        if effects.feel_friction && shared.timing.is_none() {
            let (rate, pull) = (now.delta_rate, rates.feel[1]);
            let friction = self.feel_computer(shared, inputs.fade[0]).friction();
            let found = friction.settled(&state.feel, rate, pull, (self.step, self.per_step));
            state.feel = friction.grip(found.velocity, pull);
            state.slow.feel[0] = state.slow.feel[0] + found.displacement;
            let u = found.velocity - self.feel_impulse * now.slaved.pressure;
            state.slow.feel[1] = S::select(found.settled, u, state.slow.feel[1]);
            now.delta = state.slow.feel[0];
            now.delta_rate = found.velocity;
            rates.feel[0] = found.velocity;
        }
        Self::resist(effects, state, rates);
        side
    }

    /// Adds dry friction to the rates.
    #[inline(always)]
    fn resist(effects: &Effects, state: &State<S>, rates: &mut Slow<S>) {
        if effects.column_friction {
            let pull = rates.plant[4] + state.column.drag;
            rates.plant[4] = S::select(state.column.stuck, pull.zero(), pull);
        }
        if effects.feel_friction && !effects.sampled {
            let pull = rates.feel[1] + state.feel.drag;
            rates.feel[1] = S::select(state.feel.stuck, pull.zero(), pull);
        }
    }

    /// Programmed angle in rad per programmed displacement.
    #[inline(always)]
    pub fn per_delta(&self) -> S {
        self.step.constant(1.0) / self.feel.per_angle
    }

    /// Column angle in rad per displacement of the base in m.
    #[inline(always)]
    pub fn per_base(&self) -> S {
        self.per_base
    }
}
