//! How many operations a step takes: the benchmark's share of the machine's peak is reckoned from these.

use core::cell::Cell;
use core::ops::{Add, Div, Mul, Neg, Sub};
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot, State};
use forcefeel_model::parameters::Parameters;
use forcefeel_simulate::run::{Middles, Record, run};
use forcefeel_solve::start::Start;

thread_local! {
    /// Sums and products, divisions and roots, and all that a floating-point unit does beside them.
    static COUNTS: Cell<[u64; 3]> = const { Cell::new([0; 3]) };
}

fn count(kind: usize) {
    COUNTS.with(|counts| {
        let mut now = counts.get();
        now[kind] += 1;
        counts.set(now);
    });
}

#[derive(Debug, Clone, Copy)]
struct Counted(f64);

macro_rules! operator {
    ($Trait:ident, $method:ident, $kind:expr) => {
        impl $Trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count($kind);
                Self($Trait::$method(self.0, other.0))
            }
        }
    };
}

operator!(Add, add, 0);
operator!(Sub, sub, 0);
operator!(Mul, mul, 0);
operator!(Div, div, 1);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        count(2);
        Self(-self.0)
    }
}

impl Scalar for Counted {
    type Mask = bool;
    fn constant(self, value: f64) -> Self {
        Self(value)
    }
    fn sqrt(self) -> Self {
        count(1);
        Self(self.0.sqrt())
    }
    fn abs(self) -> Self {
        count(2);
        Self(self.0.abs())
    }
    fn round(self) -> Self {
        count(2);
        Self(Scalar::round(self.0))
    }
    fn min(self, other: Self) -> Self {
        count(2);
        Self(Scalar::min(self.0, other.0))
    }
    fn max(self, other: Self) -> Self {
        count(2);
        Self(Scalar::max(self.0, other.0))
    }
    fn times_sign(self, other: Self) -> Self {
        count(2);
        Self(Scalar::times_sign(self.0, other.0))
    }
    fn less(self, other: Self) -> bool {
        count(2);
        self.0 < other.0
    }
    fn any(mask: bool) -> bool {
        mask
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        count(2);
        if mask { yes } else { no }
    }
    fn slope_times(self, by: Self) -> Self {
        self * by
    }
    fn slope_over(self, by: Self) -> Self {
        self / by
    }
}

/// Looks on and does nothing.
struct Nothing;

impl Record<Counted, Hydraulic<Counted>> for Nothing {
    fn middles(&self) -> Middles {
        Middles::None
    }
    fn see(&mut self, _: usize, _: &Snapshot<Counted>) {}
    fn see_base(&mut self, _: Counted) {}
}

/// The case of `benchmarks/simulation.py`: orifice, current limit, dry friction, stops.
fn counts(steps: usize) -> [u64; 3] {
    let mut loader = Parameters::elevator();
    (loader.valve.orifice, loader.amplifier.current_limit, loader.column.coulomb_friction) = (1.0, 8e-4, 13.3);
    (loader.column.stop_low, loader.column.stop_high) = (-0.35, 0.35);
    let values = loader.values();
    let effects = Effects { feedback: false, surroundings: false, test_signal: false, ..Effects::of(&values) };
    let shared = Shared { effects, step_s: 2e-3, timing: None, curve: None, cancellation: None };
    let parameters = Parameters::from_values(&values.map(Counted));
    let mut machine = Machine::new(&parameters, Compensator::original(&parameters), &shared);
    let push = Inputs { force: [427.0; 2], ..Inputs::NONE };
    COUNTS.set([0; 3]);
    let normal = || unreachable!("no sensor has noise");
    let inputs = vec![push; steps];
    let beginning = Start::Under(0.0).of(&machine, &shared, &inputs);
    run(
        &mut machine,
        &shared,
        &beginning,
        &inputs,
        &[],
        (|_, _: &Inputs, _: &Machine<_, Hydraulic<_>>, _: &State<_, Hydraulic<_>>| None, normal),
        &mut Nothing,
    );
    COUNTS.get()
}

#[test]
fn a_step_of_the_benchmark_takes_so_many_operations() {
    let (short, long) = (counts(500), counts(1500));
    let per_step = [0, 1, 2].map(|kind| (long[kind] - short[kind]) / 1000);
    // `OPERATIONS` of benchmarks/simulation.py; what a lane that meets a stop takes more comes on top.
    assert_eq!(per_step, [510, 10, 176]);
}
