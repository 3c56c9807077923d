//! `forcefeel._core`: the Rust model and solvers for Python. Converts, calls, wraps; decides nothing.
#![allow(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]

mod arrays;
mod bus;
mod bus_drive;
mod emulator;
mod errors;
mod export;
mod faults;
mod firmware;
mod flown_feel;
mod fmu;
mod host;
mod laws;
mod limits;
mod linked;
mod live;
mod lockstep;
mod loops;
mod model;
mod release;
mod releases;
mod simulate;
mod slopes;
mod solve;
mod statics;

use pyo3::prelude::*;

/// Puts everything into the module.
///
/// # Errors
/// If Python has no memory for it.
pub fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("ArgumentError", py.get_type::<errors::ArgumentError>())?;
    module.add("ThreadsError", py.get_type::<errors::ThreadsError>())?;
    module.add_class::<model::Parameter>()?;
    module.add_class::<model::GainLaw>()?;
    module.add_class::<solve::Recursion>()?;
    module.add_class::<loops::Loops>()?;
    module.add_function(wrap_pyfunction!(releases::released, module)?)?;
    module.add_class::<simulate::Simulation>()?;
    module.add_function(wrap_pyfunction!(linked::link_parameters, module)?)?;
    module.add_function(wrap_pyfunction!(linked::simulate_linked, module)?)?;
    module.add_function(wrap_pyfunction!(linked::linked_feels, module)?)?;
    module.add_function(wrap_pyfunction!(linked::linked_outputs, module)?)?;
    module.add("MOST_LINK_DELAY", forcefeel_model::link::MOST_DELAY)?;
    module.add_class::<release::ReleaseMeasuring>()?;
    module.add_function(wrap_pyfunction!(release::release_feature_groups, module)?)?;
    module.add_class::<export::ExportedLaw>()?;
    module.add_class::<export::ExportedPair>()?;
    module.add_class::<export::LawSource>()?;
    module.add_class::<firmware::BoardAxis>()?;
    module.add_function(wrap_pyfunction!(firmware::board_sources, module)?)?;
    module.add("FMU_CLOCK", forcefeel_fmu::variables::CLOCK)?;
    module.add_class::<fmu::FmuVariable>()?;
    module.add_function(wrap_pyfunction!(fmu::fmu_variables, module)?)?;
    module.add("BOUND_RAD", forcefeel_simulate::measures::BOUND_RAD)?;
    module.add_function(wrap_pyfunction!(simulate::sampled_loops, module)?)?;
    module.add_function(wrap_pyfunction!(solve::inside_unit_circle, module)?)?;
    module.add("OBSERVER_NUMBERS", forcefeel_model::observer::NUMBERS)?;
    module.add("CONTACT_SMOOTHING_S", forcefeel_model::contact_law::SMOOTHING_S)?;
    module.add("MOST_RECURSION_STEPS", solve::MOST_STEPS)?;
    module.add("PERIOD_BASE", forcefeel_model::machine::period::BASE)?;
    module.add("PERIOD_SHOWN", forcefeel_model::machine::period::SHOWN)?;
    module.add("PERIOD_COMMAND", forcefeel_model::machine::period::YOUNGEST)?;
    module.add_function(wrap_pyfunction!(model::grip_force, module)?)?;
    module.add_function(wrap_pyfunction!(slopes::channels, module)?)?;
    module.add_function(wrap_pyfunction!(slopes::linear_slopes, module)?)?;
    module.add_function(wrap_pyfunction!(slopes::sampled_slopes, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulation_outputs, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulation_measures, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulation_measure, module)?)?;
    module.add_function(wrap_pyfunction!(faults::safety_functions, module)?)?;
    module.add_function(wrap_pyfunction!(faults::fault_kinds, module)?)?;
    module.add_function(wrap_pyfunction!(faults::supervised_faults, module)?)?;
    module.add_function(wrap_pyfunction!(faults::supervised_pair_faults, module)?)?;
    module.add_function(wrap_pyfunction!(model::parameters, module)?)?;
    module.add_function(wrap_pyfunction!(model::parts, module)?)?;
    module.add_function(wrap_pyfunction!(model::rigid, module)?)?;
    module.add_function(wrap_pyfunction!(model::compliant, module)?)?;
    module.add_function(wrap_pyfunction!(model::design_plant, module)?)?;
    module.add_function(wrap_pyfunction!(model::electric_plant, module)?)?;
    module.add_function(wrap_pyfunction!(model::ideal_feel, module)?)?;
    module.add_function(wrap_pyfunction!(model::orifice_flow, module)?)?;
    module.add_function(wrap_pyfunction!(model::valve_gains, module)?)?;
    module.add_function(wrap_pyfunction!(model::linkage_from_resonance, module)?)?;
    module.add_function(wrap_pyfunction!(model::feel_from_frequency, module)?)?;
    module.add_function(wrap_pyfunction!(model::feel_from_frequencies, module)?)?;
    module.add_function(wrap_pyfunction!(model::feel_frequency, module)?)?;
    module.add_function(wrap_pyfunction!(solve::feel_frequencies, module)?)?;
    module.add_function(wrap_pyfunction!(solve::discretize, module)?)?;
    module.add_function(wrap_pyfunction!(solve::recursion, module)?)?;
    module.add_function(wrap_pyfunction!(solve::stationary, module)?)?;
    module.add_function(wrap_pyfunction!(solve::schedule, module)?)?;
    module.add_function(wrap_pyfunction!(solve::feel_transitions, module)?)?;
    module.add_function(wrap_pyfunction!(solve::feel_steps, module)?)?;
    module.add_function(wrap_pyfunction!(statics::column_grip_force, module)?)?;
    module.add_function(wrap_pyfunction!(statics::feel_held_along, module)?)?;
    module.add_function(wrap_pyfunction!(statics::feel_held_between, module)?)?;
    module.add_function(wrap_pyfunction!(statics::hinge_moment, module)?)?;
    module.add_function(wrap_pyfunction!(flown_feel::feel_held_in_flight, module)?)?;
    module.add_class::<flown_feel::FlownFeel>()?;
    module.add_class::<statics::ValveStatics>()?;
    module.add_class::<statics::MotorStatics>()?;
    module.add_class::<live::LiveSetup>()?;
    module.add_class::<live::LiveLoop>()?;
    module.add_class::<live::LiveMachine>()?;
    module.add_class::<emulator::BusEmulator>()?;
    module.add_class::<bus_drive::BusDrive>()?;
    module.add_function(wrap_pyfunction!(bus_drive::bus_nodes, module)?)?;
    module.add_function(wrap_pyfunction!(bus::bus_kinds, module)?)?;
    module.add_function(wrap_pyfunction!(bus::drive_fault, module)?)?;
    module.add_class::<lockstep::LockStep>()?;
    module.add_function(wrap_pyfunction!(host::host_numbers, module)?)?;
    module.add_function(wrap_pyfunction!(host::host_packet, module)?)?;
    module.add_function(wrap_pyfunction!(host::host_switches, module)?)?;
    module.add_function(wrap_pyfunction!(host::host_answer, module)?)?;
    module.add_function(wrap_pyfunction!(host::host_request, module)?)?;
    module.add_function(wrap_pyfunction!(live::live_columns, module)?)?;
    module.add_function(wrap_pyfunction!(live::live_states, module)?)?;
    module.add_function(wrap_pyfunction!(live::live_trips, module)?)?;
    module.add_function(wrap_pyfunction!(live::start_loops, module)?)?;
    module.add_function(wrap_pyfunction!(live::live_record, module)?)?;
    module.add_function(wrap_pyfunction!(live::live_replay, module)?)?;
    Ok(())
}
