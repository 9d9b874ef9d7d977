//! Compresses the files of the web page, which are sent so.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use flate2::Compression;
use flate2::write::GzEncoder;

/// Endings of the files that are served; other files are for developers.
const SERVED: [&str; 4] = ["html", "css", "js", "svg"];

/// Folders of the page that are for developers alone.
const UNSERVED: [&str; 2] = ["node_modules", "tests"];

fn main() -> io::Result<()> {
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
            if name.extension().is_some_and(|end| end == "js") { imports(name, &bytes)? } else { Vec::new() };
        writeln!(
            list,
            "    ({:?}, {:?}, include_bytes!({compressed:?}), &{imported:?}),",
            name,
            hash.as_str()
        )
        .map_err(io::Error::other)?;
    }
    list.push_str("]\n");
    fs::write(out.join("web.rs"), list)
}

fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// The modules that a module imports statically, by their paths from the page's folder.
fn imports(module: &Path, bytes: &[u8]) -> io::Result<Vec<String>> {
    let lines = str::from_utf8(bytes).map_err(io::Error::other)?.lines();
    let statements = lines.filter(|line| line.starts_with("import ") || line.starts_with("} from "));
    let relative = statements.filter_map(|line| line.split('"').nth(1)).filter(|path| path.starts_with('.'));
    relative.map(|path| resolve(module, path)).collect()
}

/// A path from the page's folder, from one that is relative to a module.
fn resolve(module: &Path, relative: &str) -> io::Result<String> {
    let mut path = module.parent().unwrap_or(Path::new("")).to_owned();
    for part in relative.split('/') {
        match part {
            "." => {}
            ".." if path.pop() => {}
            ".." => return Err(io::Error::other(format!("{} imports {relative}", module.display()))),
            name => path.push(name),
        }
    }
    path.into_os_string().into_string().map_err(|_| io::Error::other("paths of the page are UTF-8"))
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default();
        if UNSERVED.iter().any(|unserved| name == *unserved) {
            continue;
        }
        if path.is_dir() {
            collect(&path, paths)?;
        } else if path.extension().is_some_and(|end| SERVED.iter().any(|served| end == *served)) {
            // A new file is named by one that is here already, which changes with it.
            println!("cargo::rerun-if-changed={}", path.display());
            paths.push(path);
        }
    }
    Ok(())
}
