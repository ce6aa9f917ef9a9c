//! Whether recordings find room.

use std::io;
use std::path::{Path, PathBuf};

use super::host::{FileSystem, Host};
use super::options::DoctorOptions;
use super::report::Check;
use super::text::quoted;
use super::units;

/// With less than this no recording is worth starting.
const MIN_MINUTES: f64 = 1.0;

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let wanted = &options.recording_folder;
    let empty =
        Check::ok("disk", "Disk for recordings", "").with("folder", wanted.display().to_string());
    let (folder, file_system) = match nearest(host, wanted) {
        Ok(found) => found,
        Err(error) => {
            return empty.fail(
                &format!("{}: {error}", wanted.display()),
                "name a folder on a disk that is there",
            );
        }
    };
    let rate = options.recording_bytes_per_second;
    let minutes = file_system.free_bytes as f64 / rate / 60.0;
    // A rate of zero, or one that is no number, says nothing about time.
    let minutes = Some(minutes).filter(|minutes| minutes.is_finite() && rate > 0.0);
    let mut check = empty
        .with("free_bytes", file_system.free_bytes)
        .with("minutes", minutes);
    let free = units::bytes(file_system.free_bytes);
    let time = minutes.map_or(String::new(), |minutes| {
        format!(
            ", {} of session at {:.1} MB/s",
            units::minutes(minutes),
            rate / 1e6
        )
    });
    let not_yet = if folder == *wanted {
        ""
    } else {
        " (not there yet)"
    };
    check.found = format!("{free} free in {}{not_yet}{time}", wanted.display());

    let elsewhere = "record elsewhere, or delete recordings that are no longer needed";
    if file_system.read_only {
        return check.fail(
            "mounted read-only",
            "record elsewhere, or mount it for writing",
        );
    }
    if let Err(error) = host.try_writing(&folder) {
        let mend = match error.kind() {
            io::ErrorKind::PermissionDenied => {
                // Only the folder itself changes hands, never one above it.
                let make = if not_yet.is_empty() {
                    ""
                } else {
                    "sudo mkdir -p \"$DIR\" && "
                };
                format!(
                    "`DIR={}; {make}sudo chown \"$USER\" \"$DIR\"`, or record elsewhere",
                    quoted(&wanted.display().to_string())
                )
            }
            _ => elsewhere.to_owned(),
        };
        return check.fail(&format!("cannot be written to: {error}"), mend);
    }
    let enough = options.recording_duration.as_secs_f64() / 60.0;
    match minutes {
        Some(minutes) if minutes < MIN_MINUTES.min(enough) => check.fail("full", elsewhere),
        Some(minutes) if minutes < enough => {
            let found = format!("less than the {} that should fit", units::minutes(enough));
            check.warn(&found, elsewhere)
        }
        _ => check,
    }
}

/// The folder, or the nearest above it that is there.
fn nearest(host: &dyn Host, folder: &Path) -> io::Result<(PathBuf, FileSystem)> {
    let here = PathBuf::from(".");
    let mut error = io::Error::from(io::ErrorKind::NotFound);
    for candidate in folder.ancestors() {
        let candidate = if candidate.as_os_str().is_empty() {
            &here
        } else {
            candidate
        };
        match host.file_system(candidate) {
            Ok(file_system) => return Ok((candidate.to_owned(), file_system)),
            Err(failed) if failed.kind() == io::ErrorKind::NotFound => error = failed,
            Err(failed) => return Err(failed),
        }
    }
    Err(error)
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn fake(free: u64) -> Fake {
        let mut fake = Fake::empty().disk(".", 1 << 40, free);
        fake.writing = Ok(());
        fake
    }

    /// 1 MB/s, 30 minutes wanted: 1.8 GB.
    fn status(fake: &Fake) -> Status {
        check(fake, &DoctorOptions::default()).status
    }

    #[test]
    fn free_space_is_told_in_minutes() {
        let check = check(&fake(3_600_000_000), &DoctorOptions::default());
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.values["minutes"], 60.0);
        assert_eq!(
            check.found,
            "3.4 GiB free in recordings (not there yet), 60 min of session at 1.0 MB/s"
        );
    }

    #[test]
    fn little_warns_and_full_fails() {
        assert_eq!(status(&fake(1_800_000_000)), Status::Ok);
        assert_eq!(status(&fake(1_799_000_000)), Status::Warn);
        assert_eq!(status(&fake(60_000_000)), Status::Warn);
        assert_eq!(status(&fake(59_000_000)), Status::Fail);
        let mut full = fake(3_600_000_000);
        full.writing = Err((io::ErrorKind::StorageFull, "No space left on device"));
        assert_eq!(status(&full), Status::Fail);
    }

    #[test]
    fn a_folder_that_cannot_be_written_fails() {
        let mut denied = fake(1 << 40);
        denied.writing = Err((io::ErrorKind::PermissionDenied, "Permission denied"));
        let found = check(&denied, &DoctorOptions::default());
        assert_eq!(found.status, Status::Fail);
        let mend = found.mend.unwrap_or_default();
        assert!(
            mend.starts_with("`DIR=recordings; sudo mkdir -p \"$DIR\" && sudo chown"),
            "{mend}"
        );
        let there = check(
            &denied.disk("recordings", 1 << 40, 1 << 40),
            &DoctorOptions::default(),
        );
        assert!(there.mend.is_some_and(|mend| !mend.contains("mkdir")));
        let mut read_only = fake(1 << 40);
        if let Some(disk) = read_only.file_systems.get_mut(Path::new(".")) {
            disk.read_only = true;
        }
        assert!(
            check(&read_only, &DoctorOptions::default())
                .found
                .contains("read-only")
        );
        assert_eq!(status(&Fake::empty()), Status::Fail);
    }

    #[test]
    fn a_rate_that_is_none_leaves_the_minutes_out() {
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let options = DoctorOptions {
                recording_bytes_per_second: rate,
                ..DoctorOptions::default()
            };
            let check = check(&fake(1 << 40), &options);
            if rate.is_infinite() {
                assert_eq!(check.status, Status::Fail);
            } else {
                assert_eq!(
                    (check.status, &check.values["minutes"]),
                    (Status::Ok, &().into())
                );
            }
        }
    }
}
