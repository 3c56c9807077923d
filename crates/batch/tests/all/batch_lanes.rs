//! Every part of a step in vector lanes against plain double precision, bit for bit, over random numbers.

use crate::draws::Draws;
use fearless_simd::Level;
use forcefeel_model::Scalar;
use forcefeel_model::contact::{Stops, since_touch};
use forcefeel_model::contact_law::{ContactLaw, ContactState};
use forcefeel_model::controller::Converters;
use forcefeel_model::curve::Curve;
use forcefeel_model::drive::hydraulic::pressure::Balance;
use forcefeel_model::drive::hydraulic::valve::ValveMotion;
use forcefeel_model::dry_friction::DryFriction;
use forcefeel_model::effects::Effects;
use forcefeel_model::memory::MemoryVisitor;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::transducers::{SensorReading, Transducers};
use forcefeel_simulate::pair::Pair;
use forcefeel_solve::lanes::{FourLanes, Lanes};
use forcefeel_solve::wide::Wide;

/// A part of the step: numbers in, numbers out.
trait Part {
    /// Numbers that it takes, and the size of each.
    const SIZES: &'static [f64];
    fn results<S: Scalar>(x: &[S]) -> Vec<S>;
}

/// A mask as a number.
fn number<S: Scalar>(mask: S::Mask, like: S) -> S {
    S::select(mask, like.constant(1.0), like.zero())
}

/// Parameters whose numbers all depend on `x`, so that they differ from lane to lane.
fn parameters<S: Scalar>(x: S) -> Parameters<S> {
    let (share, values) = (x.times(1e-1) + x.constant(1.0), Parameters::with_every_row().values());
    Parameters::from_values(&core::array::from_fn::<_, COUNT, _>(|k| share.times(values[k])))
}

fn effects() -> Effects {
    Effects::of(&Parameters::with_every_row().values())
}

struct Operations;
impl Part for Operations {
    const SIZES: &'static [f64] = &[3.0, 3.0];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let (a, b) = (x[0], x[1]);
        let comparisons =
            [number(a.less(b), a), number(!a.less(b) | b.less(a), a), number(a.less(b) & a.less(a.zero()), a)];
        let chosen = [a.min(b), a.max(b), a.times_sign(b), a.within(b.abs()), S::select(a.less(b), a, b), -a];
        let functions = [
            a.abs().sqrt(),
            a.times(7.0).round(),
            a.sin(),
            a.abs().decay(),
            a.quantized([b, b.constant(1.0) / b]),
            a / b,
        ];
        [comparisons.as_slice(), &chosen, &functions].concat()
    }
}

struct Contact;
impl Part for Contact {
    const SIZES: &'static [f64] = &[0.4, 0.4, 5.0, 1.0];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let one = x[0].constant(1.0);
        let stops = Stops {
            low: one.times(-0.1),
            high: one.times(0.12),
            stiffness: x[3].abs().times(1e4),
            damping: one.times(9.0),
        };
        let push = stops.push((x[0], x[1]), x[2], one.times(1e-3), one.times(0.7));
        let (time, at_touch) = since_touch(stops.touch(x[1]), (x[1] - stops.high, x[1] - x[0]), x[2], one.times(1e-3));
        vec![push.velocity, push.displacement, stops.force(x[0], (x[1], x[2])), time, at_touch]
    }
}

struct Friction;
impl Part for Friction {
    const SIZES: &'static [f64] = &[1.0, 4.0, 1.0, 4.0, 1.0];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let one = x[0].constant(1.0);
        let friction = DryFriction::new(x[4].max(x[4].zero()), one.times(1.5), one);
        // Half of the draws rest.
        let v = S::select(x[0].less(one.zero()), one.zero(), x[0]);
        let grip = friction.grip(v, x[1]);
        let found =
            friction.settled(&grip, S::select(grip.stuck, one.zero(), x[2]), x[3], (one.times(1e-3), one.times(1e3)));
        let masks = [number(grip.stuck, one), number(found.settled, one)];
        let numbers = [grip.drag, friction.from_rest(x[1]), found.velocity, found.displacement];
        [masks.as_slice(), &numbers].concat()
    }
}

struct Pressure;
impl Part for Pressure {
    const SIZES: &'static [f64] = &[1.0, 0.01, 1e-3, 1.0, 0.01, 1.0, 1e6];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let p = parameters(x[0]);
        let balance = Balance::new(&p, x[0].constant(8e-3));
        let state = [x[1], x[2], x[3], x[4], x[5]];
        let stuck = x[3].less(x[3].zero());
        let mut found = Vec::new();
        for (orifice, relief, backlash) in
            [(false, false, false), (true, false, false), (true, true, false), (false, true, true), (true, true, true)]
        {
            let effects = Effects { orifice, relief, backlash, ..effects() };
            let side = balance.side(&effects, stuck);
            let touches = balance.touch(balance.stretch(x[1], x[4]));
            let oil = balance.solve(&effects, &side, touches, state);
            let yielding = balance.yielding(&effects, &side, x[2], &oil);
            let lag = balance.lagging(&yielding, x[6]);
            let rates = [x[5], x[6], x[1], x[3], x[4]];
            let rate = balance.slaved_rate(&side, &yielding, (x[2], &oil), &rates);
            let step = (x[0].constant(1e-4), x[0].constant(1e4));
            let behind = balance.behind(&yielding, &oil, (x[4], x[3], rate), step);
            found.extend([oil.pressure, oil.flow, oil.opening, behind.pressure, behind.flow]);
            found.extend([lag.piston, lag.pressure, balance.leakage(&effects, x[6])]);
        }
        found.extend([balance.piston(x[1], x[6]), balance.stretch_at_rest(x[6])]);
        found
    }
}

struct Sensors;
impl Part for Sensors {
    const SIZES: &'static [f64] = &[1.0, 1.0, 1.0, 1.0, 1.0, 1e-3];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let sensors = Transducers::new(&parameters(x[0]), 1e-3);
        let before = SensorReading { measured: [x[1], x[2], x[3], x[4]], shown: [x[2], x[3], x[4], x[1]] };
        let now = [x[4], x[1], x[0], x[2]];
        let others = [sensors.load_cell_share(x[5].abs()), sensors.column_rate(x[1], x[2], x[3])];
        let shown = [sensors.after_half(&before, now), sensors.after_whole(&before, now, x[4])];
        [shown.as_flattened(), &sensors.sample(now, [x[2], x[3], x[4], x[1]]), &others].concat()
    }
}

struct Controller;
impl Part for Controller {
    const SIZES: &'static [f64] = &[1.0, 3e3, 0.1, 20.0];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let converters = Converters::new(&parameters(x[0]));
        let (force, piston) = converters.read(x[1], x[2]);
        vec![force, piston, converters.write(x[3]), converters.within_range(x[3])]
    }
}

struct Valve;
impl Part for Valve {
    const SIZES: &'static [f64] = &[1.0, 30.0, 1e-3, 0.1];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let (valve, effects) = (ValveMotion::new(&parameters(x[0]), true), effects());
        let i = valve.current(&effects, x[1]);
        vec![i, valve.flow_acceleration(&effects, x[2], x[3], i), valve.flow_jump(&effects, i, x[0])]
    }
}

struct Spring;
impl Part for Spring {
    const SIZES: &'static [f64] = &[2.0];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let pieces = [[0.3, -0.2, 1.0, -2.0], [-0.1, 0.4, 0.7, -0.6], [0.2, 0.0, 1.1, 0.1]];
        vec![Curve::new(&[-1.0, -0.2, 0.4, 1.1], &pieces).expect("a curve").at(x[0])]
    }
}

/// The numbers of a memory.
struct Numbers<S>(Vec<S>);

impl<S: Scalar> MemoryVisitor<S> for Numbers<S> {
    fn number(&mut self, _: &'static str, number: &mut S) {
        self.0.push(*number);
    }
    fn flag(&mut self, _: &'static str, _: &mut S::Mask) {}
}

/// A push that stays for long, then blows and swings: samples in which nothing begins, and those in which lanes differ.
struct ContactNoticed;
impl Part for ContactNoticed {
    const SIZES: &'static [f64] = &[20.0, 30.0, 0.01, 0.02];
    fn results<S: Scalar>(x: &[S]) -> Vec<S> {
        let mut numbers = [0.15, 890.0, 0.0, 555.0, 3.6, 3.4, 5.3, 3180.0, 0.1, 0.0087, 0.0175].into_iter();
        let law = ContactLaw::take(|| x[0].constant(numbers.next().expect("a number of the law")));
        let period = [1e-3, 1e3].map(|number| x[0].constant(number));
        let mut state = ContactState::free(x[0].zero(), x[2]);
        let mut begun = x[0].zero();
        for k in 0..120_u32 {
            let swing = if k < 40 { 0.0 } else { 1.0 - f64::from(k % 20) / 10.0 };
            let (torque, column) = (x[0] + x[1].times(swing), x[2] + x[3].times(swing));
            let (now, begins) = law.noticed((torque, None), ([column, x[2], -x[3]], None, true), state, period);
            (state, begun) = (now, begun + number(begins, x[0]));
        }
        let mut found = Numbers(vec![begun]);
        state.visit(&mut found);
        found.0
    }
}

/// Asserts that each lane has the bits of the same numbers alone.
fn compare<P: Part, T: Wide>(token: T::Token) {
    let mut draws = Draws::new(1);
    // Some numbers are exactly zero.
    let mut draw = || if draws.bits().is_multiple_of(61) { 0.0 } else { draws.uniform() };
    for _ in 0..400 {
        let drawn: Vec<Vec<f64>> = P::SIZES.iter().map(|size| (0..T::RUNS).map(|_| size * draw()).collect()).collect();
        let wide: Vec<T> = drawn.iter().map(|numbers| T::gather(token, |lane| numbers[lane])).collect();
        let mut lanes = vec![Vec::new(); T::RUNS];
        for value in P::results(&wide) {
            value.scatter(|lane, value| lanes[lane].push(value));
        }
        for (lane, found) in lanes.iter().enumerate() {
            let alone: Vec<f64> = P::results(&drawn.iter().map(|numbers| numbers[lane]).collect::<Vec<_>>());
            for (k, (found, alone)) in found.iter().zip(&alone).enumerate() {
                // No number is no number, whatever its payload.
                let same = found.to_bits() == alone.to_bits() || (found.is_nan() && alone.is_nan());
                assert!(same, "result {k}, lane {lane} of {drawn:?}: {found:e} beside {alone:e}");
            }
        }
    }
}

/// The same on every kind of lanes that this machine has.
fn on_all<P: Part>() {
    let level = Level::new();
    let mut kinds = 0;
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = level.as_avx512() {
            compare::<P, Lanes<_>>(simd);
            compare::<P, Pair<Lanes<_>>>(simd);
            kinds += 1;
        }
        if let Some(simd) = level.as_avx2() {
            compare::<P, FourLanes<_>>(simd);
            compare::<P, Pair<Lanes<_>>>(simd);
            kinds += 1;
        }
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.as_neon() {
        compare::<P, FourLanes<_>>(simd);
        compare::<P, Pair<Lanes<_>>>(simd);
        kinds += 1;
    }
    if kinds == 0 {
        compare::<P, f64>(()); // a machine without lanes runs every run alone
    }
}

/// A test of each part.
macro_rules! parts {
    ($( $name:ident: $part:ident, )*) => { $(
        #[test]
        fn $name() {
            on_all::<$part>();
        }
    )* };
}

parts! {
    operations: Operations,
    contact: Contact,
    contact_noticed: ContactNoticed,
    dry_friction: Friction,
    load_pressure: Pressure,
    sensors: Sensors,
    converters: Controller,
    valve: Valve,
    curve: Spring,
}
