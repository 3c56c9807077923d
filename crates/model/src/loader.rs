//! The parts put together: the rigid model, eq. (15), the compliant model, eq. (17), the plant for design, eq. (19), and the
//! ideal feel that they all aim at.
//!
//! `x_p` piston displacement · `p` load pressure · `q_i` commanded flow · `delta` programmed displacement · `x_b` displacement
//! of the column's base · `theta` column angle · `F_p` pilot force · `e_T` test signal at the amplifier · `'` time derivative
//!
//! State order is the report's, so that the matrices can be laid beside the printed ones.

use crate::Scalar;
use crate::channels::{self, Bench};
use crate::compensator::Compensator;
use crate::parameters::Parameters;

/// A system of ordinary differential equations with `X` states, `U` inputs and `Y` outputs.
pub trait System<S, const X: usize, const U: usize, const Y: usize> {
    /// Time derivative of the state `x` under the input `u`.
    fn derivative(&self, x: &[S; X], u: &[S; U]) -> [S; X];
    /// Outputs.
    fn outputs(&self, x: &[S; X], u: &[S; U]) -> [S; Y];
}

/// Outputs of the two loader models:
/// `theta` (rad), `delta` (V or rad), `x_p` (m), `F_c` (N), `e_P` (V), `i` (A), `q` (m³/s).
pub const OUTPUTS: usize = 7;

/// Loader with a rigid link; states `x_p, x_p', p, q_i, q_i', delta, delta'`; inputs `F_p, e_T`.
#[derive(Debug, Clone, Copy)]
pub struct Rigid<S> {
    /// The loader's numbers.
    pub parameters: Parameters<S>,
    /// The law that drives the amplifier.
    pub compensator: Compensator<S>,
}

/// Loader with a compliant link; states `x_p, p, q_i, q_i', delta, delta', x_b, x_b'`; inputs `F_p, e_T`.
#[derive(Debug, Clone, Copy)]
pub struct Compliant<S> {
    /// The loader's numbers.
    pub parameters: Parameters<S>,
    /// The law that drives the amplifier.
    pub compensator: Compensator<S>,
}

/// A loader on a bench: its states, with the channels as outputs. The test signal comes first: inputs `e_T, F_p`.
#[derive(Debug, Clone, Copy)]
pub struct OnBench<M>(pub M);

/// Plant for the design of the compensation: valve dynamics neglected, load-cell loop open, `F_p` a constant state.
/// States `x_p, p, delta, delta', x_b, x_b', F_p`; input `e`; output `delta - theta`, the error of eq. (21).
#[derive(Debug, Clone, Copy)]
pub struct DesignPlant<S> {
    /// The loader's numbers.
    pub parameters: Parameters<S>,
    /// Torque that the feel computer sees per newton of pilot force, in m. `R_p` for the column's torque at rest.
    pub pilot_arm: S,
}

/// The feel that is programmed: eq. (11) driven by the pilot's torque. States `delta, delta'`; input `F_p`; output `theta`.
#[derive(Debug, Clone, Copy)]
pub struct IdealFeel<S> {
    /// The loader's numbers.
    pub parameters: Parameters<S>,
}

/// What the plant does at one instant, given the amplifier's input.
struct Servo<S> {
    current: S,
    flow: S,
    force: S,
}

impl<S: Scalar> Servo<S> {
    #[inline(always)]
    fn at(parameters: &Parameters<S>, e: S, q_i: S, p: S) -> Self {
        Self {
            current: parameters.amplifier.current(e),
            flow: parameters.valve.flow(q_i, p),
            force: parameters.actuator.force(p),
        }
    }
}

impl<S: Scalar> Rigid<S> {
    #[inline(always)]
    fn servo(&self, x: &[S; 7], u: &[S; 2]) -> Servo<S> {
        let &[x_p, x_p_rate, p, q_i, _, delta, delta_rate] = x;
        let &[pilot_force, test_signal] = u;
        let linkage = &self.parameters.linkage;
        let (x_b, x_b_rate) = (linkage.rigid_base(x_p), linkage.rigid_base(x_p_rate));
        let measured = [x_p, p, delta, delta_rate, x_b, x_b_rate, pilot_force];
        Servo::at(&self.parameters, self.compensator.command(&measured) + test_signal, q_i, p)
    }
}

impl<S: Scalar> System<S, 7, 2, OUTPUTS> for Rigid<S> {
    fn derivative(&self, x: &[S; 7], u: &[S; 2]) -> [S; 7] {
        let Parameters { valve, actuator, linkage, column, feel, .. } = &self.parameters;
        let &[_, x_p_rate, _, q_i, q_i_rate, delta, delta_rate] = x;
        let Servo { current, flow, force } = self.servo(x, u);
        [
            x_p_rate,
            // The link carries the base's acceleration to the piston.                                      eq. (8)
            linkage.rigid_piston(column.base_acceleration(linkage.base_force(force), u[0])),
            actuator.pressure_rate(flow, x_p_rate),
            q_i_rate,
            valve.flow_acceleration(q_i, q_i_rate, current),
            delta_rate,
            feel.acceleration(delta, delta_rate, self.compensator.feel_torque(force)),
        ]
    }

    fn outputs(&self, x: &[S; 7], u: &[S; 2]) -> [S; OUTPUTS] {
        let Parameters { linkage, column, potentiometer, .. } = &self.parameters;
        let Servo { current, flow, force } = self.servo(x, u);
        let theta = column.angle(linkage.rigid_base(x[0])); // eq. (16)
        [theta, x[5], x[0], force, potentiometer.signal(x[0]), current, flow]
    }
}

impl<S: Scalar> Compliant<S> {
    #[inline(always)]
    fn servo(&self, x: &[S; 8], u: &[S; 2]) -> Servo<S> {
        let &[x_p, p, q_i, _, delta, delta_rate, x_b, x_b_rate] = x;
        let &[pilot_force, test_signal] = u;
        let measured = [x_p, p, delta, delta_rate, x_b, x_b_rate, pilot_force];
        Servo::at(&self.parameters, self.compensator.command(&measured) + test_signal, q_i, p)
    }
}

impl<S: Scalar> System<S, 8, 2, OUTPUTS> for Compliant<S> {
    #[inline(always)]
    fn derivative(&self, x: &[S; 8], u: &[S; 2]) -> [S; 8] {
        let Parameters { valve, actuator, linkage, column, feel, .. } = &self.parameters;
        let &[x_p, _, q_i, q_i_rate, delta, delta_rate, x_b, x_b_rate] = x;
        let Servo { current, flow, force } = self.servo(x, u);
        let x_p_rate = linkage.piston_velocity(force, x_p, x_b, x_b_rate);
        [
            x_p_rate,
            actuator.pressure_rate(flow, x_p_rate),
            q_i_rate,
            valve.flow_acceleration(q_i, q_i_rate, current),
            delta_rate,
            feel.acceleration(delta, delta_rate, self.compensator.feel_torque(force)),
            x_b_rate,
            column.base_acceleration(linkage.base_force(force), u[0]),
        ]
    }

    #[inline(always)]
    fn outputs(&self, x: &[S; 8], u: &[S; 2]) -> [S; OUTPUTS] {
        let Servo { current, flow, force } = self.servo(x, u);
        let theta = self.parameters.column.angle(x[6]); // eq. (18)
        [theta, x[4], x[0], force, self.parameters.potentiometer.signal(x[0]), current, flow]
    }
}

impl<S: Scalar> System<S, 7, 2, { channels::COUNT }> for OnBench<Rigid<S>> {
    fn derivative(&self, x: &[S; 7], &[test_signal, pilot_force]: &[S; 2]) -> [S; 7] {
        self.0.derivative(x, &[pilot_force, test_signal])
    }

    fn outputs(&self, x: &[S; 7], &[test_signal, pilot_force]: &[S; 2]) -> [S; channels::COUNT] {
        let parameters = &self.0.parameters;
        let &[piston, piston_rate, pressure, ..] = x;
        let Servo { current, flow, force } = self.0.servo(x, &[pilot_force, test_signal]);
        let (base, base_rate) = (parameters.linkage.rigid_base(piston), parameters.linkage.rigid_base(piston_rate));
        Bench { base, base_rate, piston, force, pressure, flow, current }.channels(parameters)
    }
}

impl<S: Scalar> System<S, 8, 2, { channels::COUNT }> for OnBench<Compliant<S>> {
    fn derivative(&self, x: &[S; 8], &[test_signal, pilot_force]: &[S; 2]) -> [S; 8] {
        self.0.derivative(x, &[pilot_force, test_signal])
    }

    fn outputs(&self, x: &[S; 8], &[test_signal, pilot_force]: &[S; 2]) -> [S; channels::COUNT] {
        let &[piston, pressure, .., base, base_rate] = x;
        let Servo { current, flow, force } = self.0.servo(x, &[pilot_force, test_signal]);
        Bench { base, base_rate, piston, force, pressure, flow, current }.channels(&self.0.parameters)
    }
}

impl<S: Scalar> System<S, 7, 1, 1> for DesignPlant<S> {
    fn derivative(&self, x: &[S; 7], u: &[S; 1]) -> [S; 7] {
        let Parameters { amplifier, valve, actuator, linkage, column, feel, .. } = &self.parameters;
        let &[x_p, p, delta, delta_rate, x_b, x_b_rate, pilot_force] = x;
        let force = actuator.force(p);
        let flow = valve.flow(valve.commanded_flow(amplifier.current(u[0])), p);
        let x_p_rate = linkage.piston_velocity(force, x_p, x_b, x_b_rate);
        [
            x_p_rate,
            actuator.pressure_rate(flow, x_p_rate),
            delta_rate,
            feel.acceleration(delta, delta_rate, self.pilot_arm * pilot_force),
            x_b_rate,
            column.base_acceleration(linkage.base_force(force), pilot_force),
            pilot_force.zero(), // dF_p/dt = 0: a step of pilot force
        ]
    }

    fn outputs(&self, x: &[S; 7], _: &[S; 1]) -> [S; 1] {
        [x[2] - self.parameters.column.angle(x[4])]
    }
}

impl<S: Scalar> System<S, 2, 1, 1> for IdealFeel<S> {
    fn derivative(&self, x: &[S; 2], u: &[S; 1]) -> [S; 2] {
        let torque = self.parameters.column.pilot_torque(u[0]);
        [x[1], self.parameters.feel.acceleration(x[0], x[1], torque)]
    }

    fn outputs(&self, x: &[S; 2], _: &[S; 1]) -> [S; 1] {
        [x[0]]
    }
}
