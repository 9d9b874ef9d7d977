//! Objects as they lie in an object store.

use std::path::PathBuf;

use object_store::path::Path as ObjectPath;

use crate::blob_id::BlobId;

/// The folder of scratch objects.
pub(super) const SCRATCH: &str = "probe";

/// An object in the store, or a part of one whose upload was not finished.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StoredObject {
    /// Path of the blob, present or not.
    pub(super) path: ObjectPath,
    pub(crate) bytes: u64,
    /// Path of the part that an unfinished upload has written.
    pub(super) unfinished: Option<PathBuf>,
}

impl StoredObject {
    /// The name of the blob that it is or was to become; none of a scratch object.
    pub(crate) fn blob(&self) -> Option<String> {
        let name = self.path.filename()?;
        let id: BlobId = name.parse().ok()?;
        (path_of(id) == self.path).then(|| name.to_owned())
    }

    /// True if its upload was not finished.
    pub(crate) fn is_upload(&self) -> bool {
        self.unfinished.is_some()
    }
}

/// Path of a blob. Two levels of folders keep directories small.
pub(super) fn path_of(id: BlobId) -> ObjectPath {
    let hex = id.to_string();
    ObjectPath::from(format!("{}/{}/{hex}", &hex[..2], &hex[2..4]))
}
