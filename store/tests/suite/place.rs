//! Places for objects, with access past the store.

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use drillsweep_store::{BlobStore, ObjectsLocation};
use tempfile::TempDir;

use crate::servers::seaweed::Seaweed;

/// A place for objects that is its own and goes with it, or with the process.
pub(crate) trait Place {
    /// A place with nothing in it.
    fn new() -> Self;

    /// Location of the place.
    fn location(&self) -> ObjectsLocation;

    /// Everything in it, by name.
    fn objects(&self) -> Vec<Object>;

    /// Writes or overwrites an object.
    fn write_object(&self, name: &str, content: &[u8]);

    /// Deletes an object.
    fn delete_object(&self, name: &str);

    /// The objects as the store sees them, over connections of its own.
    fn open(&self) -> BlobStore {
        BlobStore::open(&self.location()).unwrap()
    }
}

/// An object of the object store.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Object {
    pub(crate) name: String,
    pub(crate) bytes: u64,
    /// Another one after every write, whatever is written.
    pub(crate) version: String,
}

/// The name of a blob's object.
pub(crate) fn object_name(blob: &str) -> String {
    format!("{}/{}/{blob}", &blob[..2], &blob[2..4])
}

/// A directory that does not exist yet, in a temporary one.
pub(crate) struct Directory {
    temporary: TempDir,
}

impl Directory {
    fn path(&self) -> PathBuf {
        self.temporary.path().join("blobs")
    }
}

impl Place for Directory {
    fn new() -> Self {
        Directory { temporary: TempDir::new().unwrap() }
    }

    fn location(&self) -> ObjectsLocation {
        ObjectsLocation::Directory(self.path())
    }

    fn objects(&self) -> Vec<Object> {
        let mut found = Vec::new();
        collect_objects(&self.path(), "", &mut found);
        found.sort();
        found
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    fn delete_object(&self, name: &str) {
        std::fs::remove_file(self.path().join(name)).unwrap();
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

/// A prefix of the bucket of a server that all tests of a process share.
pub(crate) struct Bucket {
    server: &'static Seaweed,
    prefix: String,
}

impl Place for Bucket {
    fn new() -> Self {
        static PLACES: AtomicU32 = AtomicU32::new(0);
        let prefix = format!("team/{}", PLACES.fetch_add(1, Ordering::Relaxed));
        Bucket { server: Seaweed::shared(), prefix }
    }

    fn location(&self) -> ObjectsLocation {
        self.server.location(&self.server.address(), &self.prefix)
    }

    fn objects(&self) -> Vec<Object> {
        let files = self.server.files(&self.prefix).into_iter();
        let mut found: Vec<Object> = files
            .map(|file| Object {
                name: file.name[self.prefix.len() + 1..].to_owned(),
                bytes: file.bytes,
                version: file.place,
            })
            .collect();
        found.sort();
        found
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        self.server.write(&format!("{}/{name}", self.prefix), content);
    }

    fn delete_object(&self, name: &str) {
        self.server.delete(&format!("{}/{name}", self.prefix));
    }
}
