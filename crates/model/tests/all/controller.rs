//! Converters of the digital controller, and commands on their way.

use crate::near::{ROUNDING, assert_near, assert_within};
use forcefeel_model::controller::{CommandDelay, Converters, MOST_UNDER_WAY};
use forcefeel_model::parameters::Parameters;

/// Converters of the elevator loader: inputs of ±5 V and 10 bits, output of ±2 V and 8 bits, current of 1.5 V's worth.
fn converters() -> Converters<f64> {
    let mut parameters = Parameters::elevator();
    parameters.controller.input_range = 5.0;
    parameters.controller.input_bits = 10.0;
    parameters.controller.output_range = 2.0;
    parameters.controller.output_bits = 8.0;
    parameters.amplifier.current_limit = 1.5 * parameters.amplifier.admittance;
    Converters::new(&parameters)
}

#[test]
fn inputs_are_read_in_steps_of_their_range_at_the_voltage() {
    let parameters = Parameters::elevator();
    let (force, piston) = (parameters.load_cell.gain, parameters.potentiometer.gain);
    let step = 10.0 / 1024.0;
    for (volts, read) in [
        (0.4 * step, 0.0),
        (0.6 * step, step),
        (-0.6 * step, -step),
        (100.3 * step, 100.0 * step),
        (4.999, 5.0), // within half a step of the range
        (7.0, 5.0),
        (-60.0, -5.0),
    ] {
        let (found_force, found_piston) = converters().read(volts / force, volts / piston);
        assert_near(found_force, read / force, ROUNDING);
        assert_near(found_piston, read / piston, ROUNDING);
    }
}

#[test]
fn output_is_written_in_steps_and_cut_off_at_its_range() {
    let step = 4.0 / 256.0;
    for (e, written) in
        [(0.3 * step, 0.0), (7.4 * step, 7.0 * step), (-7.6 * step, -8.0 * step), (9.0, 2.0), (-2.01, -2.0)]
    {
        assert_near(converters().write(e), written, ROUNDING);
    }
}

#[test]
fn amplifier_answers_within_its_own_range_and_the_converters() {
    for (e, cut) in [(1.4, 0.0), (-1.5, 0.0), (1.75, 0.25), (-9.0, -7.5)] {
        assert_within(e - converters().within_range(e), cut, 1e-15); // the limit is a quotient
    }
}

#[test]
fn converters_that_are_not_given_change_no_bit() {
    let converters = Converters::new(&Parameters::elevator());
    for e in [-1e6, -0.1, 0.3, 7e4] {
        assert_eq!((converters.write(e), converters.within_range(e)), (e, e));
        let (force, piston) = converters.read(e, e);
        assert_near(force, e, ROUNDING); // to volts and back
        assert_near(piston, e, ROUNDING);
    }
}

#[test]
fn bits_without_a_range_are_no_steps() {
    let mut parameters = Parameters::elevator();
    parameters.controller.output_range = 1.0;
    assert_near(Converters::new(&parameters).write(0.123_456), 0.123_456, 0.0);
    parameters.controller.output_bits = 1.0;
    assert_near(Converters::new(&parameters).write(0.6), 1.0, 0.0);
    parameters.controller.output_bits = 52.0;
    assert_near(Converters::new(&parameters).write(0.6), 0.6, 1e-15);
}

#[test]
fn commands_arrive_in_their_order() {
    let mut under_way = CommandDelay::holding(-1.0);
    for delay in 0..MOST_UNDER_WAY {
        for sample in 0..3 * MOST_UNDER_WAY {
            #[expect(clippy::cast_precision_loss, reason = "some dozens")]
            let command = |sample: usize| sample as f64;
            under_way.send(sample, command(sample));
            if sample >= delay {
                assert_near(under_way.arriving(sample - delay), command(sample - delay), 0.0);
            }
        }
    }
    assert_near(CommandDelay::holding(-1.0).arriving(3), -1.0, 0.0);
}
