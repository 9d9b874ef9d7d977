//! The arrows between the crates, and what each of them must not know.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

/// Permitted dependencies among the workspace's own crates.
const ARROWS: &[(&str, &[&str])] = &[
    ("drillsweep-scenario", &[]),
    ("drillsweep-sim", &["drillsweep-scenario"]),
    ("drillsweep-table", &[]),
    ("drillsweep-api", &["drillsweep-scenario", "drillsweep-sim", "drillsweep-table"]),
    ("drillsweep-chart", &["drillsweep-api", "drillsweep-scenario", "drillsweep-table"]),
    ("drillsweep-store", &[]),
    ("drillsweep-server", &["drillsweep-api", "drillsweep-chart", "drillsweep-store", "drillsweep-table"]),
    (
        "drillsweep-worker",
        &["drillsweep-api", "drillsweep-scenario", "drillsweep-sim", "drillsweep-store", "drillsweep-table"],
    ),
    (
        "drillsweep",
        &[
            "drillsweep-api",
            "drillsweep-chart",
            "drillsweep-scenario",
            "drillsweep-server",
            "drillsweep-sim",
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
    ("csv", &["drillsweep-table"]),
    ("axum", &["drillsweep-server"]),
    ("tower-http", &["drillsweep-server"]),
    ("resvg", &["drillsweep-chart"]),
    ("rustfft", &["drillsweep-sim"]),
    ("skrifa", &["drillsweep-chart"]),
    ("notosans", &["drillsweep-chart"]),
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
fn only_tests_make_the_openapi_document() {
    let metadata = metadata();
    let all = metadata.packages.iter().flat_map(|package| &package.dependencies);
    let built: Vec<_> = all.filter(|dependency| dependency.kind != DependencyKind::Development).collect();
    assert!(built.iter().any(|dependency| dependency.name == "utoipa"), "the annotations were not found");
    for dependency in built {
        assert!(dependency.name != "utoipa" || dependency.optional, "utoipa is in every build");
        assert!(!dependency.features.iter().any(|name| name == "openapi"), "{} has it", dependency.name);
    }
}

#[test]
fn simulation_knows_no_clock_files_threads_network_or_async() {
    let metadata = metadata();
    let mut sources = Vec::new();
    for name in ["drillsweep-scenario", "drillsweep-sim"] {
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
        let code = text.split("#[cfg(test)]").next().unwrap();
        for word in ["std::fs", "std::time", "std::net", "std::thread", "std::env", "async fn"] {
            assert!(!code.contains(word), "{} mentions {word}", path.display());
        }
    }
}

/// The modules of the simulation from the ground up: each may use those before it.
const LAYERS: &[&str] = &[
    "control",
    "freedom",
    "linalg",
    "signal",
    "well",
    "beam",
    "contact",
    "string",
    "mud",
    "drive",
    "term",
    "force",
    "effect",
    "canonical",
    "model",
    "statics",
    "motion",
    "modes",
    "transient",
    "admission",
    "study",
];

#[test]
fn modules_of_the_simulation_use_only_what_lies_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sim/src");
    let level = |module: &str| LAYERS.iter().position(|layer| *layer == module);
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
        let code = text.split("#[cfg(test)]").next().unwrap();
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        for used in code.flat_map(|line| line.split("crate::").skip(1)) {
            let used =
                used.split(|letter: char| !(letter.is_ascii_lowercase() || letter == '_')).next().unwrap();
            // Constants of the crate itself.
            if used.is_empty() {
                continue;
            }
            let used = level(used).unwrap_or_else(|| panic!("{} uses {used}", within.display()));
            assert!(used <= own, "{} uses {}", within.display(), LAYERS[used]);
            arrows += 1;
        }
    }
    assert!(arrows > 100, "the arrows were not found");
}

#[test]
fn no_module_of_the_server_imports_itself_by_way_of_others() {
    let metadata = metadata();
    let server =
        metadata.packages.iter().find(|package| package.name.as_str() == "drillsweep-server").unwrap();
    let root = server.manifest_path.parent().unwrap().as_std_path().join("src");
    let mut sources = Vec::new();
    rust_files(&root, &mut sources);
    let modules: BTreeMap<String, String> = sources
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            (module(path.strip_prefix(&root).unwrap()), text.split("#[cfg(test)]").next().unwrap().to_owned())
        })
        .collect();
    assert!(modules.len() > 20 && modules.contains_key("route::sweeps"), "the sources were not found");

    // Modules that import none but those already taken out are taken out, until what is left imports itself.
    let mut left: BTreeMap<&str, BTreeSet<String>> = modules
        .iter()
        .map(|(name, code)| {
            assert!(!code.contains("super::"), "{name} is looked at by its `crate::` paths only");
            let mut imported: BTreeSet<String> =
                imports(code).into_iter().filter_map(|path| known(path, &modules)).collect();
            imported.remove(name);
            (name.as_str(), imported)
        })
        .collect();
    assert!(left["route::sweeps"].contains("guard::quota"), "imports are not found: {left:?}");
    loop {
        let names: BTreeSet<String> = left.keys().map(|name| (*name).to_owned()).collect();
        left.retain(|_, imported| !imported.is_disjoint(&names));
        if left.len() == names.len() {
            break;
        }
    }
    assert!(left.is_empty(), "modules that import each other are among {:?}", left.keys());
}

/// The path of a module from that of its file.
fn module(file: &Path) -> String {
    let parts: Vec<_> =
        file.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    parts.join("::").trim_end_matches("::mod").to_owned()
}

/// The paths below `crate::` that code names, those in braces one by one.
fn imports(code: &str) -> Vec<String> {
    let of = |path: &str| {
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        let end = path.find(|c| !is_part(c)).unwrap_or(path.len());
        let (stem, rest) = path.split_at(end);
        match rest.strip_prefix('{').and_then(|rest| rest.split_once('}')) {
            Some((names, _)) => names.split(',').map(|name| format!("{stem}{}", name.trim())).collect(),
            None => vec![stem.to_owned()],
        }
    };
    code.split("crate::").skip(1).flat_map(of).collect()
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
