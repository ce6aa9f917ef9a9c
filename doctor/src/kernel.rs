//! Which kernel, and whether it bounds the wake-up lateness.

use super::host::Host;
use super::report::Check;

pub(super) fn check(host: &dyn Host) -> Check {
    const ID: &str = "kernel";
    const TITLE: &str = "Kernel";
    let release = match host.read("/proc/sys/kernel/osrelease") {
        Ok(text) => text.trim().to_owned(),
        Err(error) => {
            return Check::ok(ID, TITLE, "").warn(
                &format!("unknown: /proc/sys/kernel/osrelease: {error}"),
                "mount /proc: without it little can be found out here",
            );
        }
    };
    let says = |path, word| {
        let text = host.read(path);
        text.is_ok_and(|text| text.split_whitespace().any(|found| found == word))
    };
    let preempt_rt = says("/sys/kernel/realtime", "1") || says("/proc/version", "PREEMPT_RT");
    let found = if preempt_rt {
        format!("Linux {release}, PREEMPT_RT: wake-up lateness has a bound")
    } else {
        format!("Linux {release}, not PREEMPT_RT: wake-up lateness has percentiles only, no bound")
    };
    let mut check = Check::ok(ID, TITLE, found)
        .with("release", release)
        .with("preempt_rt", preempt_rt);
    if !preempt_rt {
        // Enough for a simulated arm, so no warning.
        check.mend = Some(
            "only where a real arm needs a bound: a PREEMPT_RT kernel (Debian: `apt install linux-image-rt-amd64`)"
                .to_owned(),
        );
    }
    check
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn preempt_rt_is_seen_in_either_place() {
        let by_sysfs = Fake::good().file("/proc/version", "Linux");
        let by_version = Fake::good().without_file("/sys/kernel/realtime");
        for fake in [by_sysfs, by_version] {
            let check = check(&fake);
            assert_eq!(check.values["preempt_rt"], true, "{check:?}");
            assert_eq!(check.mend, None);
        }
    }

    #[test]
    fn without_it_percentiles_only() {
        let fake = Fake::empty()
            .file("/proc/sys/kernel/osrelease", "6.1.0\n")
            .file(
                "/proc/version",
                "Linux version 6.1.0 #1 SMP PREEMPT_DYNAMIC",
            );
        let check = check(&fake);
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.values["preempt_rt"], false);
        assert!(check.found.contains("Linux 6.1.0") && check.found.contains("percentiles only"));
    }

    #[test]
    fn without_proc_it_warns() {
        assert_eq!(check(&Fake::empty()).status, Status::Warn);
    }
}
