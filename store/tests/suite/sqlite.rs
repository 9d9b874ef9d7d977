//! The embedded engine: a SQLite file and a directory of objects.

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use drillsweep_store::{Role, StoreConfig};
use tempfile::TempDir;

use crate::bench::{Engine, Object};

/// A directory that does not exist yet, in a temporary one.
struct Sqlite {
    temporary: TempDir,
}

impl Sqlite {
    fn directory(&self) -> PathBuf {
        self.temporary.path().join("data")
    }

    fn blobs(&self) -> PathBuf {
        self.directory().join("blobs")
    }
}

impl Engine for Sqlite {
    fn new() -> Self {
        Sqlite { temporary: TempDir::new().unwrap() }
    }

    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig {
        let mut config = StoreConfig::in_directory(&self.directory(), role);
        config.clock_offset_ms = clock_offset_ms;
        config
    }

    fn objects(&self) -> Vec<Object> {
        let mut found = Vec::new();
        collect_objects(&self.blobs(), "", &mut found);
        found.sort();
        found
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        let path = self.blobs().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    fn delete_object(&self, name: &str) {
        std::fs::remove_file(self.blobs().join(name)).unwrap();
    }

    fn abandon_upload(&self, content: &[u8]) {
        // As `object_store` writes them: beside the object, with a number.
        self.write_object("ab/cd/abcd0123#1", content);
    }

    fn refuse_scratch_objects(&self) {
        // A file where the folder should be stops every user; permissions would not stop root.
        self.write_object("probe", b"");
    }

    fn database_holds(&self, bytes: &[u8]) -> bool {
        ["", "-wal"].iter().any(|suffix| {
            let file = std::fs::read(self.directory().join(format!("drillsweep.sqlite{suffix}"))).unwrap();
            file.windows(bytes.len()).any(|window| window == bytes)
        })
    }
}

fn collect_objects(directory: &Path, prefix: &str, found: &mut Vec<Object>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        let metadata = entry.metadata().unwrap();
        if metadata.is_dir() {
            collect_objects(&entry.path(), &format!("{name}/"), found);
        } else {
            // A file that is written anew is another one, or was changed later.
            let version = format!("{} {:?}", metadata.ino(), metadata.modified().unwrap());
            found.push(Object { name, bytes: metadata.len(), version });
        }
    }
}

conformance!(Sqlite);
