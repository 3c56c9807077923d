//! The force sensor at the grip: `F_g = K_g (F_p - (m_a + m_o) R_p theta'' - d_a R_p theta' - k_a R_p theta)`.

use crate::near::{ROUNDING, assert_near};
use forcefeel_model::grip_sensor::GripForce;
use forcefeel_model::parameters::Parameters;

#[test]
fn sensor_shows_the_force_less_what_moves_arm_and_grip() {
    let mut p = Parameters::elevator();
    (p.grip_sensor.gain, p.grip_sensor.mass) = (0.98, 0.3);
    (p.pilot.arm_mass, p.pilot.arm_damping, p.pilot.arm_stiffness) = (0.8, 5.5, 30.0);
    let (angle, rate, acceleration) = (0.1, -0.7, 12.0);
    let shown = GripForce::new(&p).shown(50.0, [angle, rate, acceleration].map(|x| x * p.column.base_arm));
    let lever = p.column.grip_arm;
    let expected = 50.0 - (0.8 + 0.3) * lever * acceleration - 5.5 * lever * rate - 30.0 * lever * angle;
    assert_near(shown, 0.98 * expected, ROUNDING);
}

#[test]
fn loader_without_a_gain_has_no_such_sensor() {
    let p = Parameters::elevator();
    assert_near(GripForce::new(&p).shown(50.0, [1.0, 1.0, 1.0]), 0.0, 0.0);
}
