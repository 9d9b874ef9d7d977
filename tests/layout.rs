//! The arrows between the crates, and what each of them must not know.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::path::Path;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

/// Who may use whom, among the workspace's own crates.
const ARROWS: &[(&str, &[&str])] = &[
    ("drillsweep-sim", &[]),
    ("drillsweep-api", &["drillsweep-sim"]),
    ("drillsweep-store", &[]),
    ("drillsweep-server", &["drillsweep-api", "drillsweep-store"]),
    ("drillsweep-worker", &["drillsweep-api", "drillsweep-sim", "drillsweep-store"]),
    (
        "drillsweep",
        &["drillsweep-api", "drillsweep-server", "drillsweep-sim", "drillsweep-store", "drillsweep-worker"],
    ),
];

/// Libraries that only some crates may know.
const CONFINED: &[(&str, &[&str])] = &[
    ("sqlx", &["drillsweep-store"]),
    ("object_store", &["drillsweep-store"]),
    ("parquet", &["drillsweep-store"]),
    ("axum", &["drillsweep-server"]),
    ("tower-http", &["drillsweep-server"]),
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
fn only_the_store_knows_sql_and_only_the_server_serves_http() {
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
    let sim = metadata.packages.iter().find(|package| package.name.as_str() == "drillsweep-sim").unwrap();
    for dependency in dependencies(sim) {
        assert!(
            !["tokio", "rayon", "tracing", "ureq", "rustix"].contains(&dependency),
            "sim uses {dependency}"
        );
    }
    let mut sources = Vec::new();
    rust_files(&sim.manifest_path.parent().unwrap().as_std_path().join("src"), &mut sources);
    assert!(sources.len() > 30, "the sources were not found");
    for path in sources {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for word in ["std::fs", "std::time", "std::net", "std::thread", "std::env", "async fn"] {
            assert!(!code.contains(word), "{} mentions {word}", path.display());
        }
    }
}

fn rust_files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}
