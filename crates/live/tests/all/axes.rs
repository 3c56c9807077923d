//! Axes of different rates in one loop.

use forcefeel_live::axes::due;
use forcefeel_live::clock::Woken;

#[test]
fn an_axis_of_a_third_of_the_rate_counts_its_own_missed_cycles() {
    let on_time = Woken { late_ns: 10, missed: 0 };
    assert_eq!(due(3, [0, 1], on_time, 500), None);
    assert_eq!(due(3, [2, 3], on_time, 500), Some(on_time));
    // Beats 4 to 10 in one: its cycles of beats 6 and 9, the first of which was 2 periods after the beat that was late.
    let late = Woken { late_ns: 3010, missed: 6 };
    assert_eq!(due(3, [3, 10], late, 500), Some(Woken { late_ns: 2010, missed: 1 }));
    assert_eq!(due(1, [3, 10], late, 500), Some(late));
}
