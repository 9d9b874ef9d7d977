//! A disk that is soon full.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

/// Mounts a file system of `$1` MiB at `$0` and goes on as the rest, which holds it.
const MOUNT: &str = r#"
mount -t tmpfs -o "size=$1m,mode=0777" tmpfs "$0" && shift && exec "$@"
"#;

/// A file system in memory, in a mount namespace that ends with the value, and with the test's thread.
pub(crate) struct SmallDisk {
    holder: Child,
    mount_point: TempDir,
    path: PathBuf,
}

impl SmallDisk {
    /// One of so many MiB. The command runs what follows it as the user who needs the disk.
    fn mount(megabytes: u32, user: &Command, is_for_another: bool) -> Self {
        let mount_point = TempDir::new().expect("a temporary directory");
        let mut command = Command::new("unshare");
        if !is_for_another {
            // Whoever this is is root in a namespace of its own, and knows its own files there alone.
            command.args(["--user", "--map-root-user"]);
        }
        command.args(["--mount", "sh", "-c", MOUNT]).arg(mount_point.path()).arg(megabytes.to_string());
        command.arg(user.get_program()).args(user.get_args());
        // It tells once it is the user's: only then is it seen by that user's other processes.
        command.args(["sh", "-c", "echo mounted && exec sleep infinity"]);
        let mut holder = command.stdout(Stdio::piped()).spawn().expect("unshare");
        let mut told = String::new();
        BufReader::new(holder.stdout.take().expect("a pipe")).read_line(&mut told).expect("it tells");
        assert_eq!(told, "mounted\n", "the tests need to mount a tmpfs: as root, or in a user namespace");
        // As it is seen by others: they need not be in the namespace.
        let root = Path::new("/proc").join(holder.id().to_string()).join("root");
        let path = root.join(mount_point.path().strip_prefix("/").expect("an absolute path"));
        SmallDisk { holder, mount_point, path }
    }

    /// One for processes of this user.
    pub(crate) fn new(megabytes: u32) -> Self {
        let mut user = Command::new("setpriv");
        user.args(["--pdeathsig", "KILL"]);
        Self::mount(megabytes, &user, false)
    }

    /// One for processes of the user as whom a command runs what follows it: another one where this is root.
    pub(super) fn of(user: &Command, megabytes: u32) -> Self {
        let is_root = std::fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0);
        Self::mount(megabytes, user, is_root)
    }

    /// Its directory, for processes of the user who needs it.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Mount point, for processes in its namespace.
    pub(crate) fn mount_point(&self) -> &Path {
        self.mount_point.path()
    }

    /// A program in the namespace of a disk for this user.
    pub(crate) fn command_inside(&self, program: &str) -> Command {
        let mut command = Command::new("nsenter");
        command.args(["--user", "--mount", "--preserve-credentials", "--target"]);
        command.arg(self.holder.id().to_string()).arg(program);
        command
    }

    /// Fills it but for so many bytes; a file holds the room until it is removed.
    pub(crate) fn fill_but(&self, room: u64) {
        let block = vec![0; 64 << 10];
        let mut filler = File::create(self.filler()).expect("a file");
        while filler.write_all(&block).is_ok() {}
        // The last block did not fit as a whole: one byte at a time does until nothing fits.
        while filler.write_all(&block[..1]).is_ok() {}
        let full = filler.metadata().expect("its size").len();
        filler.set_len(full.saturating_sub(room)).expect("a shorter file");
    }

    /// Removes what fills it.
    pub(crate) fn make_room(&self) {
        std::fs::remove_file(self.filler()).expect("it was filled");
    }

    fn filler(&self) -> PathBuf {
        self.path.join("filler")
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = self.holder.kill();
        let _ = self.holder.wait();
    }
}
