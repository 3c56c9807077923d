//! The hinge moment against one that is worked out from the angles of control, surface and tab themselves.

#![expect(clippy::float_cmp, reason = "a switch, and what is exactly nothing")]

use forcefeel_model::parameters::Parameters;
use forcefeel_model::surface::{Added, FlightState};

const FLIGHT: FlightState = FlightState {
    dynamic_pressure: 2400.0,
    true_airspeed: 70.0,
    angle_of_attack: 0.06,
    sideslip: -0.03,
    rates: [0.1, 0.2, -0.05],
    load_factor: 1.4,
    mach: 0.3,
    tab: 0.05,
};
/// Factors of [`tabled`] at Mach 0.3, halfway between the first two.
const TABLED: [f64; 3] = [1.1, 1.6, 0.75];
/// Angles and coefficients of [`steepened`], as a tunnel has them: steeper beyond, and not the same on both sides.
const MEASURED: [(f64, f64); 5] = [(-0.35, 0.16), (-0.17, 0.05), (0.02, -0.001), (0.12, -0.03), (0.3, -0.11)];
/// Area in m², chord in m.
const AREA: f64 = 1.3;
const CHORD: f64 = 0.4;

fn loader(change: impl Fn(&mut Parameters<f64>)) -> Parameters<f64> {
    let mut parameters = Parameters::elevator();
    let surface = &mut parameters.surface;
    (surface.area, surface.chord, surface.gearing) = (AREA, CHORD, -1.2);
    (surface.at_zero, surface.per_flow, surface.per_deflection) = (0.01, -0.08, -0.25);
    (surface.per_tab, surface.per_rate, surface.pressure_ratio) = (-0.12, -0.6, 0.9);
    (surface.flow_per_attack, surface.flow_per_sideslip, surface.incidence) = (0.6, 0.2, -0.03);
    (surface.roll_arm, surface.pitch_arm, surface.yaw_arm) = (1.0, 4.0, 0.5);
    surface.bobweight = 20.0;
    change(&mut parameters);
    parameters
}

fn tabled(of: &mut Parameters<f64>) {
    let surface = &mut of.surface;
    (surface.mach_1, surface.mach_2, surface.mach_3) = (0.2, 0.4, 0.6);
    (surface.flow_factor_1, surface.flow_factor_2, surface.flow_factor_3) = (0.9, 1.3, 7.0);
    (surface.deflection_factor_1, surface.deflection_factor_2, surface.deflection_factor_3) = (1.2, 2.0, 0.5);
    (surface.tab_factor_1, surface.tab_factor_2, surface.tab_factor_3) = (1.0, 0.5, -1.0);
}

fn steepened(of: &mut Parameters<f64>) {
    let surface = &mut of.surface;
    surface.per_deflection = 0.0;
    let angles = [
        &mut surface.deflection_1,
        &mut surface.deflection_2,
        &mut surface.deflection_3,
        &mut surface.deflection_4,
        &mut surface.deflection_5,
    ];
    angles.into_iter().zip(MEASURED).for_each(|(angle, (of, _))| *angle = of);
    let coefficients = [
        &mut surface.coefficient_1,
        &mut surface.coefficient_2,
        &mut surface.coefficient_3,
        &mut surface.coefficient_4,
        &mut surface.coefficient_5,
    ];
    coefficients.into_iter().zip(MEASURED).for_each(|(coefficient, (_, of))| *coefficient = of);
}

/// `C(delta)`: between the two points beside it, or on the line of the two nearest ones.
fn measured(delta: f64) -> f64 {
    let k = (1..MEASURED.len() - 1).find(|&k| delta < MEASURED[k].0).unwrap_or(MEASURED.len() - 1);
    let ((from, low), (to, high)) = (MEASURED[k - 1], MEASURED[k]);
    (low * (to - delta) + high * (delta - from)) / (to - from)
}

/// Torque on the control at an angle and a rate, by the balance of control, cables and tab: repeated until it stands.
fn torque(parameters: &Parameters<f64>, theta: f64, rate: f64) -> f64 {
    let of = &parameters.surface;
    let flow = 0.6 * FLIGHT.angle_of_attack + 0.2 * FLIGHT.sideslip - 0.03
        + (FLIGHT.rates[0] + 4.0 * FLIGHT.rates[1] + 0.5 * FLIGHT.rates[2]) / FLIGHT.true_airspeed;
    let tabled: [f64; 3] = if of.mach_1 < 1.0 { TABLED } else { [1.0; 3] };
    let grown = if of.compressible == 1.0 { 1.0 / (1.0f64 - 0.09).sqrt() } else { 1.0 };
    let moment = of.share * 0.9 * FLIGHT.dynamic_pressure * AREA * CHORD;
    let mut torque = 0.0;
    for _ in 0..200 {
        let control = theta + torque / of.cable_stiffness;
        let gearing = of.gearing + of.gearing * of.gearing_change * control;
        let deflection = of.gearing * control + of.gearing * of.gearing_change * control * control / 2.0;
        let tab = FLIGHT.tab + of.tab_gearing * deflection + torque / of.tab_stiffness;
        let of_deflection = if of.deflection_1 < 1.0 { measured(deflection) } else { -0.25 * deflection };
        let angles = grown * (-0.08 * tabled[0] * flow + tabled[1] * of_deflection - 0.12 * tabled[2] * tab);
        let damped = -0.6 * gearing * rate * CHORD / (2.0 * FLIGHT.true_airspeed);
        torque = moment * gearing * (0.01 + angles + damped);
    }
    torque
}

/// The same by the coefficients at the control's angle.
fn linear(parameters: &Parameters<f64>, theta: f64, rate: f64) -> f64 {
    let Added { force, stiffness, damping } = parameters.hinge_moment(&FLIGHT, theta);
    let still = force + parameters.surface.bobweight * FLIGHT.load_factor;
    parameters.column.grip_arm * still - stiffness * theta - damping * rate
}

#[track_caller]
fn agrees(parameters: &Parameters<f64>, within: f64) {
    for theta in [-0.2, -0.05, 0.0, 0.1, 0.25] {
        for rate in [0.0, 0.8, -1.5] {
            let (whole, by_coefficients) = (torque(parameters, theta, rate), linear(parameters, theta, rate));
            assert!(
                (whole - by_coefficients).abs() <= within * whole.abs().max(1.0),
                "{theta}, {rate}: {whole} {by_coefficients}"
            );
        }
        // The spring is the slope of the torque.
        let step = 1e-5;
        let slope = (torque(parameters, theta + step, 0.0) - torque(parameters, theta - step, 0.0)) / (2.0 * step);
        let stiffness = parameters.hinge_moment(&FLIGHT, theta).stiffness;
        assert!((slope + stiffness).abs() <= (1e-6 + 2.0 * within) * stiffness.abs(), "{theta}: {slope} {stiffness}");
    }
}

#[test]
fn coefficients_are_those_of_the_balance_of_control_surface_and_tab() {
    agrees(&loader(|_| ()), 1e-12);
    agrees(&loader(|of| of.surface.share = 0.3), 1e-12);
    agrees(&loader(|of| of.surface.tab_gearing = 0.7), 1e-12);
    agrees(&loader(|of| of.surface.compressible = 1.0), 1e-12);
    agrees(&loader(tabled), 1e-12);
    agrees(&loader(|of| of.surface.gearing_change = 0.8), 1e-12);
    agrees(&loader(steepened), 1e-12);
    let all = |of: &mut Parameters<f64>| {
        tabled(of);
        steepened(of);
        (of.surface.gearing_change, of.surface.tab_gearing) = (0.4, 0.7);
    };
    agrees(&loader(all), 1e-12);
    let soft_tab = |of: &mut Parameters<f64>| {
        steepened(of);
        of.surface.tab_stiffness = 900.0;
    };
    agrees(&loader(soft_tab), 1e-12);
    agrees(&loader(|of| of.surface.tab_stiffness = 900.0), 1e-12);
    agrees(&loader(|of| of.surface.cable_stiffness = 2000.0), 1e-12);
    agrees(&loader(|of| (of.surface.tab_stiffness, of.surface.cable_stiffness) = (900.0, 2000.0)), 1e-12);
    // A gearing that changes over the stretch of the cables: what the stretch changes of it is left out, of second order.
    agrees(&loader(|of| (of.surface.gearing_change, of.surface.cable_stiffness) = (0.3, 20_000.0)), 0.02);
}

#[test]
fn a_surface_is_felt_by_its_share_and_not_at_all_on_the_ground() {
    let reversible = loader(|of| of.surface.bobweight = 0.0);
    let still = FlightState { dynamic_pressure: 0.0, true_airspeed: 0.0, ..FLIGHT };
    let none = reversible.hinge_moment(&still, 0.1);
    assert_eq!((none.force.abs(), none.stiffness.abs(), none.damping.abs()), (0.0, 0.0, 0.0));
    let irreversible = loader(|of| (of.surface.share, of.surface.bobweight) = (0.0, 0.0));
    assert_eq!(irreversible.hinge_moment(&FLIGHT, 0.1).stiffness.abs(), 0.0);
    // Twice the pressure, twice the moment.
    let (once, twice) = (
        reversible.hinge_moment(&FLIGHT, 0.1),
        reversible.hinge_moment(&FlightState { dynamic_pressure: 4800.0, ..FLIGHT }, 0.1),
    );
    assert!((twice.stiffness - 2.0 * once.stiffness).abs() < 1e-9 && once.stiffness > 0.0 && once.damping > 0.0);
    // An elevator that leads is unstable, whatever gives way.
    let leads = loader(|of| (of.surface.per_deflection, of.surface.cable_stiffness) = (0.3, 50.0));
    let stiffness = leads.hinge_moment(&FLIGHT, 0.0).stiffness;
    assert!(stiffness < 0.0 && stiffness.is_finite(), "{stiffness}");
}

#[test]
fn a_table_over_mach_begins_at_one_and_ends_at_its_last_factor() {
    let parameters = loader(|of| {
        tabled(of);
        of.surface.bobweight = 0.0;
    });
    let at = |mach| parameters.hinge_moment(&FlightState { mach, ..FLIGHT }, 0.0).stiffness;
    let plain = loader(|_| ()).hinge_moment(&FLIGHT, 0.0).stiffness;
    // With the control at its neutral the spring is C_delta's alone.
    for (mach, factor) in [(0.0, 1.0), (0.1, 1.1), (0.2, 1.2), (0.5, 1.25), (0.6, 0.5), (0.9, 0.5)] {
        assert!((at(mach) - factor * plain).abs() < 1e-12 * plain, "{mach}");
    }
    // Fewer points: as at the last of them.
    let parameters = loader(|of| (of.surface.mach_1, of.surface.deflection_factor_1) = (0.2, 1.2));
    let at = |mach| parameters.hinge_moment(&FlightState { mach, ..FLIGHT }, 0.0).stiffness;
    for (mach, factor) in [(0.1, 1.1), (0.9, 1.2), (3.0, 1.2)] {
        assert!((at(mach) - factor * plain).abs() < 1e-12 * plain, "{mach}");
    }
}

#[test]
fn a_table_over_the_angle_goes_on_beyond_its_points_however_many_there_are() {
    let stiffness = |parameters: &Parameters<f64>, theta| parameters.hinge_moment(&FLIGHT, theta).stiffness;
    let plain = stiffness(&loader(|_| ()), 0.0);
    let parameters = loader(steepened);
    for (theta, piece) in [(0.6, 1), (0.1, 2), (-0.05, 3), (-0.2, 4), (-0.5, 4)] {
        let ((from, low), (to, high)) = (MEASURED[piece - 1], MEASURED[piece]);
        // The gearing is negative: a positive control has a negative surface.
        let of = (high - low) / (to - from) / -0.25 * plain;
        assert!((stiffness(&parameters, theta) - of).abs() < 1e-12 * plain.abs(), "{theta}");
    }
    // Two points on the straight line are that line, at their own angles too.
    let line = loader(|of| {
        let surface = &mut of.surface;
        (surface.per_deflection, surface.deflection_1, surface.deflection_2) = (0.0, -0.1, 0.2);
        (surface.coefficient_1, surface.coefficient_2) = (0.025, -0.05);
    });
    for theta in [-0.4, -1.0 / 6.0, 0.0, 1.0 / 12.0, 0.5] {
        let (of, straight) = (line.hinge_moment(&FLIGHT, theta), loader(|_| ()).hinge_moment(&FLIGHT, theta));
        assert!((of.stiffness - straight.stiffness).abs() < 1e-12 * plain.abs());
        assert!((of.force - straight.force).abs() < 1e-12 * straight.force.abs());
    }
}

#[test]
fn a_bobweight_pulls_towards_negative_angles_with_the_load_factor() {
    let parameters = loader(|of| of.surface.area = 0.0);
    let added = parameters.hinge_moment(&FLIGHT, 0.1);
    assert_eq!((added.force, added.stiffness.abs(), added.damping.abs()), (-20.0 * 1.4, 0.0, 0.0));
}
