//! Files of a store to which other users of the machine have access: reading them needs no token.

use std::ffi::OsString;
use std::fmt;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

/// Permissions of group and others.
const OF_OTHERS: u32 = 0o077;

/// A file or directory to which group or others have access.
pub(crate) struct Exposed {
    path: PathBuf,
    mode: u32,
}

/// Files and directories among `paths` to which group or others have access.
pub(crate) fn exposed(paths: impl IntoIterator<Item = PathBuf>) -> Vec<Exposed> {
    let exposed = |path: PathBuf| {
        // A path that is not there, as the write-ahead log of a closed database, exposes nothing.
        let mode = path.metadata().ok()?.permissions().mode() & 0o777;
        (mode & OF_OTHERS != 0).then_some(Exposed { path, mode })
    };
    paths.into_iter().filter_map(exposed).collect()
}

/// The files of a SQLite database.
pub(crate) fn database_files(path: &Path) -> [PathBuf; 3] {
    ["", "-wal", "-shm"].map(|suffix| {
        let mut file = OsString::from(path);
        file.push(suffix);
        file.into()
    })
}

impl fmt::Display for Exposed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, mode } = self;
        let path = path.display();
        write!(
            formatter,
            "other users have access to {path} (mode {mode:04o}), without a token; remove it by: chmod go= {path}"
        )
    }
}
