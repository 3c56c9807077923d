//! Where an importer says that the resources lie.

use forcefeel_fmu::uri::path;

/// Examples of RFC 8089, and what importers give.
#[test]
fn uris_give_the_paths_of_their_system() {
    for (uri, unix, windows) in [
        ("file:///tmp/my%20fmu/resources", "/tmp/my fmu/resources", "/tmp/my fmu/resources"),
        ("file:/tmp/fmu", "/tmp/fmu", "/tmp/fmu"),
        ("file://localhost/tmp/fmu", "/tmp/fmu", "/tmp/fmu"),
        ("file:///Z:/fmu/resources", "/Z:/fmu/resources", "Z:/fmu/resources"),
        ("file:///c%3A/fmu", "/c:/fmu", "c:/fmu"),
        ("file:/C:/fmu", "/C:/fmu", "C:/fmu"),
        ("file:////server/share/fmu", "//server/share/fmu", "//server/share/fmu"),
        ("C:\\fmu\\resources", "C:\\fmu\\resources", "C:\\fmu\\resources"),
        ("/tmp/100%", "/tmp/100%", "/tmp/100%"),
    ] {
        assert_eq!(path(uri, false), unix, "{uri}");
        assert_eq!(path(uri, true), windows, "{uri}");
    }
    assert_eq!(path("file://server/share/fmu", true), "//server/share/fmu");
}
