//! Compresses what the program holds: the files of the web page, as they are sent, and the OpenAPI document.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use flate2::Compression;
use flate2::write::GzEncoder;

/// What is served; the rest of the folder is for those who work on it.
const SERVED: [&str; 4] = ["html", "css", "js", "svg"];

const OPENAPI: &str = "../api/openapi.json";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=web");
    println!("cargo::rerun-if-changed={OPENAPI}");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo sets OUT_DIR"))?);
    let mut paths = Vec::new();
    collect(Path::new("web"), &mut paths)?;
    paths.sort();
    let mut list = String::from("&[\n");
    for (number, path) in paths.iter().enumerate() {
        let bytes = fs::read(path)?;
        let compressed = out.join(format!("{number}.gz"));
        fs::write(&compressed, compress(&bytes)?)?;
        let name = path.strip_prefix("web").map_err(io::Error::other)?;
        let hash = blake3::hash(&bytes).to_hex();
        let imported =
            if name.extension().is_some_and(|end| end == "js") { imports(&bytes)? } else { Vec::new() };
        writeln!(
            list,
            "    ({:?}, {:?}, include_bytes!({compressed:?}), &{imported:?}),",
            name,
            hash.as_str()
        )
        .map_err(io::Error::other)?;
    }
    list.push_str("]\n");
    fs::write(out.join("web.rs"), list)?;
    fs::write(out.join("openapi.json.gz"), compress(&fs::read(OPENAPI)?)?)
}

fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// The modules beside it that a module needs before it runs.
fn imports(bytes: &[u8]) -> io::Result<Vec<&str>> {
    let lines = str::from_utf8(bytes).map_err(io::Error::other)?.lines();
    let beside = lines.filter(|line| line.starts_with("import ")).filter_map(|line| line.split_once("\"./"));
    Ok(beside.filter_map(|(_, path)| path.split('"').next()).collect())
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default();
        if path.is_dir() {
            if name != "node_modules" {
                collect(&path, paths)?;
            }
        } else if path.extension().is_some_and(|end| SERVED.iter().any(|served| end == *served)) {
            paths.push(path);
        }
    }
    Ok(())
}
