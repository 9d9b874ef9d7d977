//! The arrows between the crates, and what each of them must not know.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

/// Permitted dependencies among the workspace's own crates.
const ARROWS: &[(&str, &[&str])] = &[
    ("drillsweep-quantity", &[]),
    ("drillsweep-scenario", &["drillsweep-quantity"]),
    ("drillsweep-import", &["drillsweep-quantity", "drillsweep-scenario"]),
    ("drillsweep-sim", &["drillsweep-scenario"]),
    ("drillsweep-study", &["drillsweep-scenario", "drillsweep-sim"]),
    ("drillsweep-table", &["drillsweep-quantity"]),
    (
        "drillsweep-api",
        &[
            "drillsweep-quantity",
            "drillsweep-scenario",
            "drillsweep-sim",
            "drillsweep-study",
            "drillsweep-table",
        ],
    ),
    (
        "drillsweep-chart",
        &["drillsweep-api", "drillsweep-quantity", "drillsweep-scenario", "drillsweep-table"],
    ),
    (
        "drillsweep-report",
        &[
            "drillsweep-api",
            "drillsweep-chart",
            "drillsweep-quantity",
            "drillsweep-scenario",
            "drillsweep-table",
        ],
    ),
    ("drillsweep-store", &[]),
    (
        "drillsweep-server",
        &[
            "drillsweep-api",
            "drillsweep-chart",
            "drillsweep-import",
            "drillsweep-quantity",
            "drillsweep-report",
            "drillsweep-store",
            "drillsweep-table",
        ],
    ),
    (
        "drillsweep-worker",
        &[
            "drillsweep-quantity",
            "drillsweep-scenario",
            "drillsweep-sim",
            "drillsweep-store",
            "drillsweep-study",
            "drillsweep-table",
        ],
    ),
    (
        "drillsweep",
        &[
            "drillsweep-api",
            "drillsweep-chart",
            "drillsweep-import",
            "drillsweep-quantity",
            "drillsweep-scenario",
            "drillsweep-server",
            "drillsweep-sim",
            "drillsweep-study",
            "drillsweep-store",
            "drillsweep-table",
            "drillsweep-worker",
        ],
    ),
];

/// Libraries that only some crates may know.
const CONFINED: &[(&str, &[&str])] = &[
    ("sqlx", &["drillsweep-store"]),
    ("object_store", &["drillsweep-store"]),
    ("parquet", &["drillsweep-table"]),
    ("csv", &["drillsweep-import", "drillsweep-table"]),
    ("calamine", &["drillsweep-import"]),
    ("axum", &["drillsweep-server"]),
    ("utoipa-axum", &["drillsweep-server"]),
    ("tower-http", &["drillsweep-server"]),
    ("resvg", &["drillsweep-chart"]),
    ("rustfft", &["drillsweep-sim"]),
    ("skrifa", &["drillsweep-chart"]),
    ("notosans", &["drillsweep-chart"]),
    ("maud", &["drillsweep-report"]),
];

fn metadata() -> Metadata {
    MetadataCommand::new().no_deps().exec().unwrap()
}

fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let normal = package.dependencies.iter().filter(|dependency| dependency.kind == DependencyKind::Normal);
    normal.map(|dependency| dependency.name.as_str())
}

#[test]
fn crates_use_each_other_only_along_the_arrows() {
    let metadata = metadata();
    assert_eq!(metadata.packages.len(), ARROWS.len(), "a crate without a place in the map");
    for package in &metadata.packages {
        let (_, allowed) = ARROWS.iter().find(|(name, _)| *name == package.name.as_str()).unwrap();
        for dependency in dependencies(package).filter(|name| name.starts_with("drillsweep")) {
            assert!(allowed.contains(&dependency), "{} must not use {dependency}", package.name);
        }
    }
}

#[test]
fn only_the_store_knows_sql_only_the_server_serves_http_and_only_chart_rasterises() {
    for package in &metadata().packages {
        for dependency in dependencies(package) {
            if let Some((_, allowed)) = CONFINED.iter().find(|(name, _)| *name == dependency) {
                assert!(
                    allowed.contains(&package.name.as_str()),
                    "{} must not use {dependency}",
                    package.name
                );
            }
        }
    }
}

#[test]
fn simulation_knows_no_clock_files_threads_network_or_async() {
    let metadata = metadata();
    let mut sources = Vec::new();
    for name in ["drillsweep-scenario", "drillsweep-sim", "drillsweep-study"] {
        let package = metadata.packages.iter().find(|package| package.name.as_str() == name).unwrap();
        for dependency in dependencies(package) {
            assert!(
                !["tokio", "rayon", "tracing", "reqwest", "ureq", "rustix"].contains(&dependency),
                "{name} uses {dependency}"
            );
        }
        rust_files(&package.manifest_path.parent().unwrap().as_std_path().join("src"), &mut sources);
    }
    assert!(sources.len() > 30, "the sources were not found");
    for path in sources {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = code_of(&text);
        for word in ["std::fs", "std::time", "std::net", "std::thread", "std::env", "async fn"] {
            assert!(!code.contains(word), "{} mentions {word}", path.display());
        }
    }
}

/// Storeys of the simulation from the ground up, and its files outside of them: each may use those before it.
const STOREYS: &[&str] = &["control", "math", "string", "force", "key", "solve", "validation"];

#[test]
fn layers_of_the_simulation_use_only_those_below_them() {
    assert!(arrows_down("sim", STOREYS) > 100, "the arrows were not found");
}

/// Rooms of the store, and its files outside of them, from the ground up: each may use those before it.
const ROOMS_OF_THE_STORE: &[&str] =
    &["blob_id", "error", "engine", "blob", "metrics", "store", "work", "sweep", "access", "care"];

#[test]
fn modules_of_the_store_use_only_those_below_them() {
    assert!(arrows_down("store", ROOMS_OF_THE_STORE) > 100, "the arrows were not found");
}

/// Number of uses of one module by another in the crate of a folder; fails at one that does not lead to the same layer or a lower one.
fn arrows_down(folder: &str, layers: &[&str]) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src");
    let level = |module: &str| layers.iter().position(|layer| *layer == module);
    let mut sources = Vec::new();
    rust_files(&root, &mut sources);
    let mut arrows = 0;
    for path in sources {
        let within = path.strip_prefix(&root).unwrap();
        let module = within.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = module.trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let own = level(module).unwrap_or_else(|| panic!("{module} has no place among the layers"));
        let text = std::fs::read_to_string(&path).unwrap();
        let code = code_of(&text);
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        for used in code.flat_map(|line| line.split("crate::").skip(1)) {
            let used =
                used.split(|letter: char| !(letter.is_ascii_lowercase() || letter == '_')).next().unwrap();
            // Constants of the crate itself.
            if used.is_empty() {
                continue;
            }
            let used = level(used).unwrap_or_else(|| panic!("{} uses {used}", within.display()));
            assert!(used <= own, "{} uses {}", within.display(), layers[used]);
            arrows += 1;
        }
    }
    arrows
}

/// Folders of the crates.
const CRATES: &[&str] = &[
    "api", "chart", "cli", "import", "quantity", "report", "scenario", "server", "sim", "store", "study",
    "table", "worker",
];

#[test]
fn no_module_imports_itself_by_way_of_others() {
    for folder in CRATES {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src");
        let imported = imported_modules(&root);
        assert!(
            imported.contains_key("lib") || imported.contains_key("main"),
            "the sources of {folder} were not found"
        );
        let circles = importing_themselves(&imported);
        assert!(circles.is_empty(), "modules of {folder} that import each other are among {circles:?}");
    }
}

#[test]
fn imports_are_found_in_every_notation() {
    let folder = tempfile::tempdir().unwrap();
    let write = |path: &str, code: &str| {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, code).unwrap();
    };
    write("lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod tests;\n\npub use b::B;\n");
    write("a.rs", "// use crate::b;\nuse crate::{b::{c::C, d}, B};\n#[cfg(test)]\nuse crate::a::A;\n");
    write("b/mod.rs", "mod c;\nmod d;\npub use c::C;\nfn f() { self::d::g() }\n");
    write("b/c.rs", "pub(super) use super::d::D;\n");
    write("b/d.rs", "use super::super::a;\n");
    let imported = imported_modules(folder.path());
    let of = |module: &str| imported[module].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(of("lib"), ["b"]);
    assert_eq!(of("a"), ["b::c", "b::d"]);
    assert_eq!(of("b"), ["b::c", "b::d"]);
    assert_eq!(of("b::c"), ["b::d"]);
    assert_eq!(of("b::d"), ["a"]);
    assert_eq!(importing_themselves(&imported), BTreeSet::from(["a", "b", "b::c", "b::d", "lib"]));
    write("b/d.rs", "use crate::B;\n");
    assert!(importing_themselves(&imported_modules(folder.path())).is_empty());
}

/// Other modules that each module of a crate imports, by the folder of its sources. Names at the root of the crate do not count: the root
/// defines them, or hands them on.
fn imported_modules(root: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let mut sources = Vec::new();
    rust_files(root, &mut sources);
    let modules: BTreeMap<String, String> = sources
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            let code = code_of(&text);
            let code: Vec<_> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            (module(path.strip_prefix(root).unwrap()), code.join("\n"))
        })
        .collect();
    let imported = |(name, code): (&String, &String)| {
        let paths = imports(name, code, &modules);
        let mut imported: BTreeSet<String> =
            paths.into_iter().filter_map(|path| known(path, &modules)).collect();
        imported.remove(name);
        (name.clone(), imported)
    };
    modules.iter().map(imported).collect()
}

/// Modules that import themselves by way of others, and those that import such: modules are taken out once all that they import is.
fn importing_themselves(imported: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<&str> {
    let mut left: BTreeSet<&str> = imported.keys().map(String::as_str).collect();
    loop {
        let number = left.len();
        let before = left.clone();
        left.retain(|name| imported[*name].iter().any(|other| before.contains(other.as_str())));
        if left.len() == number {
            return left;
        }
    }
}

/// Text of a module without its tests: modules of tests in files of their own may stand among its declarations, others at its end.
fn code_of(text: &str) -> String {
    let text = text.replace("#[cfg(test)]\nmod tests;\n", "");
    text.split("#[cfg(test)]").next().unwrap().to_owned()
}

/// The path of a module from that of its file.
fn module(file: &Path) -> String {
    let parts: Vec<_> =
        file.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    parts.join("::").trim_end_matches("::mod").to_owned()
}

/// Paths from the root of the crate that the code of a module names, those in braces one by one: by `crate`, `self` and `super`, or by the
/// name of a module within it.
fn imports(name: &str, code: &str, modules: &BTreeMap<String, String>) -> Vec<String> {
    let own: Vec<&str> = if matches!(name, "lib" | "main") { vec![] } else { name.split("::").collect() };
    let within = |first: &str| {
        let path: Vec<&str> = own.iter().copied().chain([first]).collect();
        modules.contains_key(&path.join("::"))
    };
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(start) = rest.find(is_part) {
        let (paths, after) = unfolded(&rest[start..]);
        rest = after;
        for path in paths {
            let Some((first, _)) = path.split_once("::") else { continue };
            let parents = match first {
                "crate" => 0,
                "super" => own.len() - path.split("::").take_while(|part| *part == "super").count(),
                "self" => own.len(),
                child if within(child) => own.len(),
                _ => continue,
            };
            let parts = path.split("::").filter(|part| !matches!(*part, "" | "crate" | "super" | "self"));
            found.push(own[..parents].iter().copied().chain(parts).collect::<Vec<_>>().join("::"));
        }
    }
    found
}

fn is_part(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == ':'
}

/// The paths that a text begins with, and the text after them: one, or several with a common beginning, `a::{b, c::{d, e}}`.
fn unfolded(text: &str) -> (Vec<String>, &str) {
    let end = text.find(|letter| !is_part(letter)).unwrap_or(text.len());
    let (stem, after) = text.split_at(end);
    let Some(mut rest) = after.strip_prefix('{').filter(|_| stem.ends_with("::")) else {
        return (vec![stem.to_owned()], after);
    };
    let mut paths = Vec::new();
    loop {
        rest = rest.trim_start_matches(|letter: char| letter.is_whitespace() || letter == ',');
        if let Some(after) = rest.strip_prefix('}') {
            return (paths, after);
        }
        let (inner, after) = unfolded(rest);
        assert!(after.len() < rest.len(), "{text}");
        paths.extend(inner.into_iter().map(|path| format!("{stem}{path}")));
        // Another name for it.
        rest = after.trim_start_matches(|letter| !matches!(letter, ',' | '}'));
    }
}

/// The module that a path leads into.
fn known(mut path: String, modules: &BTreeMap<String, String>) -> Option<String> {
    while !modules.contains_key(&path) {
        path.truncate(path.rfind("::")?);
    }
    Some(path)
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}
