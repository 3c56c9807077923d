//! Matrices of the linear models and of periods, and their slopes: how they change with a parameter, exactly.
//!
//! `x' = A x + B u`, `y = C x + D u`, or `x+ = M x + B u` from one period of a digital controller to the next · `u = [e_T, F_p]` test
//! signal and pilot force · `y` the channels of a bench · `theta` a parameter
//!
//! The models are linear in state and input, so column `j` of `A` is the derivative at the unit vector `e_j`; with a parameter that
//! is a dual number it carries `dA/dtheta`. A period is not written as matrices, so its columns are slopes already: there the
//! slope of the slope comes from dual numbers of dual numbers: a machine on these takes the compiler long, so they have a crate of their own.
#![forbid(unsafe_code)]

use forcefeel_model::dual::Dual;
use forcefeel_model::loader::{Compliant, OnBench, Rigid, System};
use forcefeel_model::machine::period::PERIOD_STATES;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_slopes::along;
use forcefeel_slopes::sampled_loops::{ByTestSignal, COLUMNS, INPUTS, PeriodMatrix, Rows, SampledLoops, kept};
use forcefeel_solve::StateSpace;
use forcefeel_solve::law::Law;
use nalgebra::DMatrix;

/// A period of a digital controller: its matrix, the channels at its start, and both under a test signal at the amplifier.
type Period = ((PeriodMatrix<Dual>, Rows<Dual>), ByTestSignal<Dual>);

/// How the link between piston and column is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linkage {
    /// It does not stretch, eq. (15).
    Rigid,
    /// It does, eq. (17).
    Compliant,
}

/// A linear model on a bench and its slopes.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// The model.
    pub model: StateSpace,
    /// Its derivative with respect to each parameter that was asked for.
    pub along: Vec<StateSpace>,
}

impl Slopes {
    /// Of `columns`, which makes a model from dual parameters, along the parameters at `keys`.
    fn of(values: &[f64; COUNT], keys: &[usize], columns: impl Fn(&Parameters<Dual>) -> [StateSpace; 2]) -> Self {
        let [model, _] = columns(&along(values, None));
        let along = keys.iter().map(|&key| columns(&along(values, Some(key)))[1].clone()).collect();
        Self { model, along }
    }
}

/// The loader on a bench in continuous time, under a law for one run.
pub fn linear(values: &[f64; COUNT], keys: &[usize], linkage: Linkage, law: &Law<'_>) -> Slopes {
    Slopes::of(values, keys, |&parameters| {
        let compensator = law.compensator(&parameters, |of| Dual::constant(of(0)));
        match linkage {
            Linkage::Rigid => columns(&OnBench(Rigid { parameters, compensator })),
            Linkage::Compliant => columns(&OnBench(Compliant { parameters, compensator })),
        }
    })
}

/// Values and slopes of the matrices of a linear system.
fn columns<const X: usize, const U: usize, const Y: usize>(system: &impl System<Dual, X, U, Y>) -> [StateSpace; 2] {
    let zero = StateSpace {
        a: DMatrix::zeros(X, X),
        b: DMatrix::zeros(X, U),
        c: DMatrix::zeros(Y, X),
        d: DMatrix::zeros(Y, U),
    };
    let mut models = [zero.clone(), zero];
    let (no_x, no_u) = ([Dual::constant(0.0); X], [Dual::constant(0.0); U]);
    for j in 0..X {
        let mut x = no_x;
        x[j] = Dual::constant(1.0);
        put(&mut models, |m| &mut m.a, j, &system.derivative(&x, &no_u));
        put(&mut models, |m| &mut m.c, j, &system.outputs(&x, &no_u));
    }
    for j in 0..U {
        let mut u = no_u;
        u[j] = Dual::constant(1.0);
        put(&mut models, |m| &mut m.b, j, &system.derivative(&no_x, &u));
        put(&mut models, |m| &mut m.d, j, &system.outputs(&no_x, &u));
    }
    models
}

fn put([value, slope]: &mut [StateSpace; 2], of: fn(&mut StateSpace) -> &mut DMatrix<f64>, j: usize, column: &[Dual]) {
    for (k, number) in column.iter().enumerate() {
        of(value)[(k, j)] = number.value;
        of(slope)[(k, j)] = number.slope;
    }
}

/// The matrix of a period of one of `loops`.
pub fn period(loops: &SampledLoops<'_>, run: usize) -> PeriodMatrix {
    loops.matrix_of(run, &along(&loops.values[run], None)).0.map(|row| row.map(|number| number.value))
}

/// The first of `loops` on a bench, from one period to the next: `a` is `M`, over the states that count. Columns of `b` and `d`:
/// command signal, pilot force, and the test signal at the amplifier, one for each step of a period in `b` and one in `d`.
pub fn sampled(loops: &SampledLoops<'_>, keys: &[usize]) -> Slopes {
    let values = &loops.values[0];
    let of = |key: Option<usize>| {
        let parameters = along(values, key);
        (loops.matrix_of(0, &parameters), loops.by_test_signal(0, &parameters))
    };
    let model = of(None);
    let slopes: Vec<_> = keys.iter().map(|&key| of(Some(key))).collect();
    // A state counts where anything depends on it, or begins to when a parameter moves.
    let parts = || slopes.iter().map(|((matrix, _), _)| matrix.map(|row| row.map(|number| number.slope)));
    let matrices: Vec<_> =
        core::iter::once(model.0.0.map(|row| row.map(|number| number.value))).chain(parts()).collect();
    let in_rows = |rows: &[[Dual; COLUMNS]], state: usize| rows.iter().any(|row| row[state] != Dual::constant(0.0));
    let seen = |state| in_rows(&model.0.1, state) || slopes.iter().any(|((_, rows), _)| in_rows(rows, state));
    let states = kept(&matrices, seen);
    let space = |((matrix, rows), by): &Period, part: fn(&Dual) -> f64| {
        let into = |i: usize, j: usize| match j.checked_sub(INPUTS) {
            None => matrix[states[i]][PERIOD_STATES + j],
            Some(step) => by.next[step][states[i]],
        };
        let through = |i: usize, j: usize| if j < INPUTS { rows[i][PERIOD_STATES + j] } else { by.now[i] };
        StateSpace {
            a: DMatrix::from_fn(states.len(), states.len(), |i, j| part(&matrix[states[i]][states[j]])),
            b: DMatrix::from_fn(states.len(), INPUTS + by.next.len(), |i, j| part(&into(i, j))),
            c: DMatrix::from_fn(rows.len(), states.len(), |i, j| part(&rows[i][states[j]])),
            d: DMatrix::from_fn(rows.len(), INPUTS + 1, |i, j| part(&through(i, j))),
        }
    };
    Slopes {
        model: space(&model, |number| number.value),
        along: slopes.iter().map(|slope| space(slope, |number| number.slope)).collect(),
    }
}
