//! A directory of objects, past the store.

use std::os::unix::fs::MetadataExt as _;
use std::path::Path;

use crate::bench::Object;

/// Everything in it, by name.
pub(crate) fn objects(directory: &Path) -> Vec<Object> {
    let mut found = Vec::new();
    collect_objects(directory, "", &mut found);
    found.sort();
    found
}

/// Writes or overwrites an object.
pub(crate) fn write_object(directory: &Path, name: &str, content: &[u8]) {
    let path = directory.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Deletes an object.
pub(crate) fn delete_object(directory: &Path, name: &str) {
    std::fs::remove_file(directory.join(name)).unwrap();
}

/// Leaves what a writer leaves that is killed: `object_store` writes beside the object, with a number.
pub(crate) fn abandon_upload(directory: &Path, content: &[u8]) {
    write_object(directory, "ab/cd/abcd0123#1", content);
}

/// From now on no scratch object can be written: a file where the folder should be stops every user; permissions would not stop root.
pub(crate) fn refuse_scratch_objects(directory: &Path) {
    write_object(directory, "probe", b"");
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
