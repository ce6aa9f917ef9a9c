//! Shared memory, over which the nodes of one host talk.

use std::io;
use std::path::Path;

use super::host::Host;
use super::limits::in_container;
use super::options::DoctorOptions;
use super::report::Check;
use super::units;

const FOLDER: &str = "/dev/shm";

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let mut check = Check::ok("shared_memory", "Shared memory", "");
    let container = in_container(host);
    let needed = units::bytes(options.shared_memory_bytes);
    let file_system = match host.file_system(Path::new(FOLDER)) {
        Ok(file_system) => file_system,
        Err(error) => {
            return check.fail(
                &format!("{FOLDER}: {error}"),
                "`sudo mkdir -p /dev/shm && sudo mount -t tmpfs -o mode=1777 tmpfs /dev/shm`",
            );
        }
    };
    check = check
        .with("size_bytes", file_system.size_bytes)
        .with("free_bytes", file_system.free_bytes)
        .with("needed_bytes", options.shared_memory_bytes)
        .with("no_exec", file_system.no_exec);
    let exec = if file_system.no_exec {
        "noexec (nothing there is executed)"
    } else {
        "exec"
    };
    check.found = format!(
        "{} in {FOLDER}, {} free, {needed} needed, {exec}",
        units::bytes(file_system.size_bytes),
        units::bytes(file_system.free_bytes)
    );

    match mounted_as(host) {
        Some(kind) if kind == "tmpfs" => {}
        Some(kind) => {
            check = check.with("file_system", kind.as_str()).warn(
                &format!("is a {kind}, not in memory: every message waits for it"),
                "`sudo mount -t tmpfs -o mode=1777 tmpfs /dev/shm`",
            );
        }
        None => {
            check = check.warn(
                "nothing is mounted there: messages go to the disk",
                "`sudo mount -t tmpfs -o mode=1777 tmpfs /dev/shm`",
            );
        }
    }
    let remount = if container {
        "start the container with `--shm-size=1g`, or `--ipc=host`"
    } else {
        "`sudo mount -o remount,rw,mode=1777,size=1g /dev/shm`, or remove what lies there unused"
    };
    if file_system.read_only {
        return check.fail("mounted read-only", remount);
    }
    if let Err(error) = host.try_writing(Path::new(FOLDER)) {
        let mend = match error.kind() {
            io::ErrorKind::PermissionDenied => "`sudo chmod 1777 /dev/shm`",
            _ => remount,
        };
        return check.fail(&format!("cannot be written to: {error}"), mend);
    }
    if file_system.free_bytes < options.shared_memory_bytes {
        return check.fail("too little is free", remount);
    }
    if file_system.free_bytes < options.shared_memory_bytes.saturating_mul(2) {
        return check.warn("little is free: a second session finds no room", remount);
    }
    check
}

/// The type of the file system mounted at the folder; the last mount is on top.
fn mounted_as(host: &dyn Host) -> Option<String> {
    let text = host.read("/proc/mounts").ok()?;
    let mount = |line: &str| {
        let mut words = line.split_whitespace().skip(1);
        let (place, kind) = (words.next()?, words.next()?);
        (place == FOLDER).then(|| kind.to_owned())
    };
    text.lines().filter_map(mount).next_back()
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    const NEEDED: u64 = 64 << 20;

    fn examine(fake: &Fake) -> Check {
        check(fake, &DoctorOptions::default())
    }

    fn with_free(bytes: u64) -> Fake {
        Fake::good().disk(FOLDER, 1 << 30, bytes)
    }

    #[test]
    fn a_tmpfs_with_room_is_good() {
        let check = examine(&Fake::good());
        assert_eq!(check.status, Status::Ok);
        assert_eq!(
            check.found,
            "16.0 GiB in /dev/shm, 15.0 GiB free, 64.0 MiB needed, exec"
        );
        let mut no_exec = Fake::good();
        if let Some(memory) = no_exec.file_systems.get_mut(Path::new(FOLDER)) {
            memory.no_exec = true;
        }
        let check = examine(&no_exec);
        assert_eq!(
            (check.status, &check.values["no_exec"]),
            (Status::Ok, &true.into())
        );
    }

    #[test]
    fn too_little_fails_and_little_warns() {
        assert_eq!(examine(&with_free(NEEDED - 1)).status, Status::Fail);
        assert_eq!(examine(&with_free(NEEDED)).status, Status::Warn);
        assert_eq!(examine(&with_free(2 * NEEDED)).status, Status::Ok);
        let container = with_free(0).file("/run/.containerenv", "");
        assert!(
            examine(&container)
                .mend
                .is_some_and(|mend| mend.contains("--shm-size"))
        );
    }

    #[test]
    fn not_mounted_is_told() {
        let disk = Fake::good().file("/proc/mounts", "/dev/vda / ext4 rw 0 0\nbroken\n");
        assert_eq!(examine(&disk).status, Status::Warn);
        let over = "tmpfs /dev/shm tmpfs rw 0 0\n/dev/vdb /dev/shm ext4 rw 0 0\n";
        let over = examine(&Fake::good().file("/proc/mounts", over));
        assert!(over.found.contains("is a ext4"));
        assert_eq!(examine(&Fake::empty()).status, Status::Fail);
    }

    #[test]
    fn what_cannot_be_written_fails() {
        let mut denied = Fake::good();
        denied.writing = Err((io::ErrorKind::PermissionDenied, "Permission denied"));
        assert!(
            examine(&denied)
                .mend
                .is_some_and(|mend| mend.contains("chmod 1777"))
        );
        let mut full = Fake::good();
        full.writing = Err((io::ErrorKind::StorageFull, "No space left on device"));
        assert_eq!(examine(&full).status, Status::Fail);
        let mut read_only = Fake::good();
        if let Some(memory) = read_only.file_systems.get_mut(Path::new(FOLDER)) {
            memory.read_only = true;
        }
        assert!(examine(&read_only).found.contains("read-only"));
    }
}
