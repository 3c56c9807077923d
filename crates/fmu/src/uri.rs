//! Where an importer of FMI 2.0 says that the resources lie: a URI. FMI 3.0 gives a path.

use std::path::PathBuf;

/// The path of a URI such as `file:///tmp/my%20fmu/resources`; a path as it is.
pub fn path_of_uri(uri: &str) -> PathBuf {
    PathBuf::from(path(uri, cfg!(windows)))
}

/// The same as text. On Windows the slash before a drive, `file:///Z:/fmu`, belongs to the URI, and two that are left begin the name
/// of another machine.
pub fn path(uri: &str, windows: bool) -> String {
    let Some(rest) = uri.strip_prefix("file:") else { return uri.to_owned() };
    let local = rest.strip_prefix("//localhost/").map(|path| format!("/{path}"));
    let named = rest.strip_prefix("//").map(|path| {
        let machine = windows && !path.starts_with('/');
        if machine { rest.to_owned() } else { path.to_owned() }
    });
    let escaped = local.or(named).unwrap_or_else(|| rest.to_owned());
    let path = without_escapes(&escaped);
    match path.as_bytes() {
        [b'/', drive, b':', ..] if windows && drive.is_ascii_alphabetic() => path[1..].to_owned(),
        _ => path,
    }
}

/// `%20` and the like as their bytes.
fn without_escapes(text: &str) -> String {
    let (mut bytes, mut left) = (Vec::with_capacity(text.len()), text.as_bytes());
    while let [first, rest @ ..] = left {
        let escaped = rest.get(..2).filter(|_| *first == b'%').and_then(|digits| core::str::from_utf8(digits).ok());
        if let Some(byte) = escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            bytes.push(byte);
            left = &rest[2..];
        } else {
            bytes.push(*first);
            left = rest;
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
