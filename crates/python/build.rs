//! The Rust that runs on a target board, kept as text: what is exported is what the extension itself was compiled from.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// What a board's library is made of, from the workspace's root.
const PARTS: [&str; 5] =
    ["Cargo.lock", "crates/model/Cargo.toml", "crates/model/src", "crates/firmware/Cargo.toml", "crates/firmware/src"];

fn main() {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo says where the package is")).join("../..");
    let mut files = Vec::new();
    for part in PARTS {
        println!("cargo::rerun-if-changed={}", root.join(part).display());
        collect(&root.join(part), &mut files);
    }
    files.sort();
    let mut text = String::from("&[\n");
    for path in files {
        let name = path.strip_prefix(&root).expect("it lies below").display().to_string().replace('\\', "/");
        let _ = writeln!(text, "    ({name:?}, include_str!({:?})),", path.display().to_string());
    }
    text.push(']');
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo says where to")).join("board_sources.rs");
    fs::write(out, text).expect("cargo's folder can be written");
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).expect("the sources can be read") {
            collect(&entry.expect("the sources can be read").path(), files);
        }
    } else if path.is_file() {
        files.push(path.to_path_buf());
    }
}
