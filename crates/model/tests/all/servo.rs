//! Amplifier, valve, actuator and potentiometer against numbers worked out by hand, in U.S. customary units.

use crate::near::{ROUNDING, assert_near, assert_within};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::units;

const MA: f64 = units::CURRENT.si_per_us;
const PSI: f64 = units::PRESSURE.si_per_us;
const FLOW: f64 = units::FLOW.si_per_us;
const IN: f64 = units::LENGTH.si_per_us;
const LB: f64 = units::FORCE.si_per_us;

#[test]
fn amplifier_gives_its_admittance_times_the_voltage() {
    let amplifier = Parameters::elevator().amplifier;
    assert_near(amplifier.current(2.5), 3.9 * MA, ROUNDING); // 1.56 mA/V times 2.5 V
}

#[test]
fn potentiometer_reads_its_gain_times_the_travel() {
    let potentiometer = Parameters::elevator().potentiometer;
    assert_near(potentiometer.signal(0.5 * IN), 3.816, ROUNDING); // 7.632 V/in times 0.5 in
}

#[test]
fn valve_at_rest_passes_what_the_current_commands_less_what_the_load_takes() {
    let valve = Parameters::elevator().valve;
    let q = valve.flow(valve.commanded_flow(3.0 * MA), 400.0 * PSI);
    assert_near(q, 12.27 * FLOW, ROUNDING); // 5.45 * 3 - 0.0102 * 400
}

#[test]
fn valve_settles_where_the_flow_is_the_commanded_one() {
    let valve = Parameters::elevator().valve;
    let i = 3.0 * MA;
    assert_near(valve.flow_acceleration(valve.commanded_flow(i), 0.0, i), 0.0, 0.0);
}

#[test]
fn valve_flow_swings_at_its_frequency_and_damping() {
    let valve = Parameters::elevator().valve;
    // w_n^2 = 377^2, 2 zeta w_n = 2 * 0.9 * 377
    assert_near(valve.flow_acceleration(1.0, 0.0, 0.0), -142_129.0, ROUNDING);
    assert_near(valve.flow_acceleration(0.0, 1.0, 0.0), -678.6, ROUNDING);
}

#[test]
fn orifice_flow_is_the_rated_one_at_rated_current_and_falls_with_the_root_of_the_pressure_left() {
    let valve = Parameters::elevator().valve;
    assert_near(valve.orifice_flow(15.0 * MA, 0.0), 100.0 * FLOW, ROUNDING);
    assert_near(valve.orifice_flow(15.0 * MA, 900.0 * PSI), 50.0 * FLOW, ROUNDING); // sqrt(300 / 1200) = 1/2
    // A load that draws the oil along: sqrt(2700 / 1200) = 3/2.
    assert_near(valve.orifice_flow(7.5 * MA, -1500.0 * PSI), 75.0 * FLOW, ROUNDING);
    // A current the other way opens the other orifice, which sees the load's pressure with its sign reversed.
    assert_near(valve.orifice_flow(-7.5 * MA, 1500.0 * PSI), -75.0 * FLOW, ROUNDING);
    assert_near(valve.orifice_flow(-15.0 * MA, -900.0 * PSI), -50.0 * FLOW, ROUNDING);
    // A load that presses harder than the supply drives the oil back: sqrt(300 / 1200) = 1/2.
    assert_near(valve.orifice_flow(15.0 * MA, 1500.0 * PSI), -50.0 * FLOW, ROUNDING);
    assert_near(valve.orifice_flow(-15.0 * MA, -1500.0 * PSI), 50.0 * FLOW, ROUNDING);
}

#[test]
fn valve_gains_are_the_slopes_of_the_orifice_flow() {
    let valve = Parameters::elevator().valve;
    let per_pressure = units::FLOW_PER_PRESSURE.si_per_us;
    for (i_share, p_share) in [(0.2, 0.33), (1.0, 0.0), (-0.5, 0.9), (0.05, -0.4)] {
        let (c_i, c_p) = valve.gains_at(i_share, p_share);
        let root = f64::sqrt(1.0 - p_share * f64::signum(i_share));
        // s = sgn i: dq/di = q_r / i_r sqrt(1 - s p/p_s), -dq/dp = q_r |i|/i_r / (2 p_s sqrt(1 - s p/p_s)), derived by hand
        assert_near(c_i, 100.0 / 15.0 * root * FLOW / MA, ROUNDING);
        assert_near(c_p, 100.0 * f64::abs(i_share) / (2.0 * 1200.0 * root) * per_pressure, ROUNDING);
    }
}

#[test]
fn printed_valve_gains_belong_to_the_reports_operating_point() {
    let (c_i, c_p) = Parameters::elevator().valve.gains_at(0.2, 0.33);
    let (c_i, c_p) = (c_i / units::FLOW_PER_CURRENT.si_per_us, c_p / units::FLOW_PER_PRESSURE.si_per_us);
    assert_within(c_i, 5.457, 0.0005);
    assert_within(c_i, 5.45, 0.01); // printed: cut off rather than rounded, so one unit of the last digit
    assert_within(c_p, 0.010_18, 0.000_005);
    assert_within(c_p, 0.0102, 0.000_05); // printed: half a unit of the last digit
}

#[test]
fn actuator_keeps_the_flow_balance() {
    let actuator = Parameters::elevator().actuator;
    let (q, x_p_rate) = (12.0 * FLOW, 3.0 * IN);
    let p_rate = actuator.pressure_rate(q, x_p_rate);
    // Eq. (5) with its result put back, in U.S. units: A x_p' + V_E p' / (4 beta) = q.
    let back = 2.36 * 3.0 + 11.7 * (p_rate / PSI) / (4.0 * 250_000.0);
    assert_near(back, 12.0, ROUNDING);
    // A piston that makes room for all the flow leaves the pressure alone, up to the rounding of q.
    assert_within(actuator.pressure_rate(2.36 * 3.0 * FLOW, x_p_rate) / p_rate, 0.0, ROUNDING);
}

#[test]
fn actuator_pushes_with_pressure_times_area() {
    let actuator = Parameters::elevator().actuator;
    assert_near(actuator.force(100.0 * PSI), 236.0 * LB, ROUNDING); // 2.36 in^2
}
