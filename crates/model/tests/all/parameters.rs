//! The table of parameters obeys its own laws.

use crate::near::{ROUNDING, assert_near, assert_within};
use core::array;
use forcefeel_model::parameters::{ALTERNATIVES, COUNT, DriveKind, PARTS, Parameter, Parameters, TABLE};
use forcefeel_model::units::SWITCH;

fn rows() -> impl Iterator<Item = &'static Parameter> {
    TABLE.iter().chain(ALTERNATIVES)
}

fn position(part: &str, name: &str) -> usize {
    TABLE.iter().position(|row| row.part == part && row.name == name).expect("a row of the table")
}

#[test]
fn names_are_unique_within_a_part() {
    for (k, row) in rows().enumerate() {
        let twin = rows().skip(k + 1).find(|other| (other.part, other.name) == (row.part, row.name));
        assert!(twin.is_none(), "{}.{} stands twice", row.part, row.name);
    }
}

#[test]
fn parts_of_the_rows_are_the_listed_ones_in_their_order() {
    let mut parts: Vec<_> = TABLE.iter().map(|row| row.part).collect();
    parts.dedup();
    assert_eq!(parts, PARTS.iter().map(|(part, _)| *part).collect::<Vec<_>>());
    assert!(ALTERNATIVES.iter().all(|row| parts.contains(&row.part)));
}

#[test]
fn every_row_says_what_it_is_and_where_its_value_comes_from() {
    for row in rows() {
        for text in [row.symbol, row.meaning, row.source] {
            assert!(!text.trim().is_empty(), "{}.{}: empty text", row.part, row.name);
        }
    }
}

#[test]
fn defaults_lie_inside_their_ranges() {
    for row in rows() {
        let (low, high) = (row.minimum_us, row.maximum_us);
        assert!(low < high && (low..=high).contains(&row.default_us), "{}.{}", row.part, row.name);
        assert!(low.is_finite() && high.is_finite(), "{}.{}", row.part, row.name);
        assert!(low >= 0.0 || row.off_us.is_some(), "{}.{}", row.part, row.name);
    }
}

#[test]
fn what_stands_for_an_optional_row_is_in_its_range_or_none_or_endless() {
    for row in rows() {
        let Some(off) = row.off_us else { continue };
        let stands = (row.minimum_us..=row.maximum_us).contains(&off) || off == 0.0 || off.is_infinite();
        assert!(stands, "{}.{}: {off}", row.part, row.name);
        assert_eq!(row.off_si(), Some(off * row.unit.si_per_us));
        assert!(row.instead_of.is_empty(), "{}.{}: optional and alternative", row.part, row.name);
    }
}

#[test]
fn switches_are_off_unless_given_and_either_yes_or_no() {
    for row in rows().filter(|row| row.unit == SWITCH) {
        assert_eq!((row.off_us, row.minimum_us, row.maximum_us), (Some(0.0), 0.0, 1.0), "{}.{}", row.part, row.name);
    }
}

#[test]
fn alternatives_replace_rows_of_their_own_part() {
    for row in ALTERNATIVES {
        assert!(!row.instead_of.is_empty(), "{}.{} replaces nothing", row.part, row.name);
        for replaced in row.instead_of {
            let found = TABLE.iter().any(|other| other.part == row.part && other.name == *replaced);
            assert!(found, "{}.{} would replace {replaced}, which is no row", row.part, row.name);
        }
    }
    assert!(TABLE.iter().all(|row| row.instead_of.is_empty()));
}

#[test]
fn values_go_in_and_out_in_the_order_of_the_table() {
    let numbers: [u16; COUNT] = array::from_fn(|k| u16::try_from(k).expect("a short table"));
    let parameters = Parameters::from_values(&numbers);
    assert_eq!(parameters.values(), numbers);
    // A few fields by name: the order alone could be wrong both ways.
    assert_eq!(usize::from(parameters.amplifier.admittance), position("amplifier", "admittance"));
    assert_eq!(usize::from(parameters.linkage.stiffness), position("linkage", "stiffness"));
    assert_eq!(usize::from(parameters.feel.maximum_stiffness), position("feel", "maximum_stiffness"));
    assert_eq!(usize::from(parameters.pilot.force), position("pilot", "force"));
}

#[test]
fn elevator_holds_the_defaults_in_si_and_nothing_optional() {
    let elevator = Parameters::elevator();
    for (row, value) in TABLE.iter().zip(elevator.values()) {
        // It has a valve: a motor's rows are off, or zero.
        let stated = if row.drive() == Some(DriveKind::Electric) { 0.0 } else { row.default_us };
        let expected = row.off_us.unwrap_or(stated) * row.unit.si_per_us;
        assert_eq!(value.to_bits(), expected.to_bits(), "{}.{}", row.part, row.name);
    }
    // Three conversions worked out from the exact inch and pound.
    assert_within(elevator.linkage.stiffness / 100.0, 10_696.50, 0.005); // k in N/cm, from 6107.86 lb/in
    assert_within(elevator.valve.pressure_gain * 1e10, 0.242_43, 0.000_005); // C_p in cm^5/(N s), from 0.0102
    assert_near(elevator.column.inertia, 37.4 * 4.448_221_615_260_5 * 0.0254, ROUNDING);
}
