//! A record is in its file with each flush.

use forcefeel_live::record::{AxisOpening, Opening, Record, Size};
use forcefeel_live::replay::read;
use forcefeel_live::row::{COLUMNS, Row};
use std::collections::BTreeMap;

#[test]
fn every_row_is_in_the_file_after_a_flush() {
    let path = std::env::temp_dir().join(format!("forcefeel-record-{}.mcap", std::process::id()));
    let size = Size { most_bytes: 1 << 20, rows: 0, ring: false };
    let setup = vec![("values", vec![1.0])];
    let axis = AxisOpening { prefix: String::new(), about: BTreeMap::new(), setup };
    let opening = Opening { path: path.clone(), size, start_ns: 0, axes: vec![axis] };
    let mut record = Record::create(opening).expect("the folder can be written");
    for cycle in 0..40_u32 {
        record.row(0, &Row { cycle: f64::from(cycle), ..Row::default() });
        let written = if cycle % 7 == 6 { record.end_chunk() } else { record.flush() };
        written.expect("there is room");
        let contents = read(&std::fs::read(&path).expect("it is there"), None).expect("it is a record");
        assert_eq!(contents.broken, None, "cycle {cycle}");
        let cycles: Vec<f64> = contents.rows.chunks_exact(COLUMNS).map(|row| row[1]).collect();
        assert_eq!(cycles, (0..=cycle).map(f64::from).collect::<Vec<_>>());
    }
    record.finish("with the run").expect("there is room");
    let contents = read(&std::fs::read(&path).expect("it is there"), None).expect("it is a record");
    assert_eq!((contents.broken, contents.ended.as_deref()), (None, Some("with the run")));
    std::fs::remove_file(path).expect("it is there");
}
