//! Whether the 1 kHz loops may run before everything else (SCHED_FIFO).

use super::host::Host;
use super::limits::{in_container, limit, may_raise_priority};
use super::options::DoctorOptions;
use super::report::Check;
use super::units;

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let priority = options.real_time_priority;
    let allowed = limit(host, "Max realtime priority").ok();
    let locked = limit(host, "Max locked memory").ok();
    let granted = host.try_real_time_priority(priority);

    let mut check = Check::ok("real_time_priority", "Real-time priority", "")
        .with("granted", granted.is_ok())
        .with("priority", priority);
    if let Some(soft) = allowed.and_then(|limit| limit.soft) {
        check = check.with("limit_rtprio", soft);
    }
    let memory = match locked.map(|limit| limit.soft) {
        Some(Some(bytes)) => {
            check = check.with("limit_memlock_bytes", bytes);
            format!("may lock {} of memory", units::bytes(bytes))
        }
        Some(None) => "may lock all memory".to_owned(),
        None => "limit of locked memory unknown".to_owned(),
    };
    let Err(error) = granted else {
        check.found = format!("SCHED_FIFO {priority} granted; {memory}");
        return check;
    };

    let number = |value: Option<u64>| value.map_or("unlimited".to_owned(), |n| n.to_string());
    let limits = match allowed {
        Some(limit) => format!("limit {}, hard {}", number(limit.soft), number(limit.hard)),
        None => "limit unknown".to_owned(),
    };
    let wanted = u64::try_from(priority).unwrap_or(u64::MAX);
    let enough = |value: Option<u64>| value.is_none_or(|value| value >= wanted);
    let mend = if !(1..=99).contains(&priority) {
        "choose a priority from 1 to 99".to_owned()
    } else if in_container(host) {
        "start the container with `--cap-add SYS_NICE --ulimit rtprio=99 --ulimit memlock=-1`"
            .to_owned()
    } else if may_raise_priority(host) || allowed.is_some_and(|limit| enough(limit.soft)) {
        // Permitted, yet refused: the control group has no real-time budget.
        "`sudo sysctl kernel.sched_rt_runtime_us=-1`: the control group of this shell has no real-time budget".to_owned()
    } else if allowed.is_some_and(|limit| enough(limit.hard)) {
        format!("`ulimit -r {priority}` in this shell")
    } else {
        let program = host.link_target("/proc/self/exe");
        let program = program.unwrap_or_else(|_| "ferntast".to_owned());
        format!(
            "`echo \"$USER - rtprio 98\" | sudo tee /etc/security/limits.d/90-ferntast.conf`, then log in again; or `sudo setcap cap_sys_nice+ep {program}`, again after each build"
        )
    };
    check.warn(
        &format!(
            "SCHED_FIFO {priority} refused ({error}; {limits}); {memory}\na session runs on without: other programs may delay its loops"
        ),
        mend,
    )
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;

    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn refused(limits: &str) -> Fake {
        let mut fake = Fake::good().file("/proc/self/limits", limits);
        fake.real_time = Err((ErrorKind::PermissionDenied, "Operation not permitted"));
        fake
    }

    fn mend(fake: &Fake) -> String {
        let check = check(fake, &DoctorOptions::default());
        assert_eq!(check.status, Status::Warn);
        assert_eq!(check.values["granted"], false);
        check.mend.expect("a refusal can be mended")
    }

    const NONE: &str = "Max realtime priority 0 0\nMax locked memory 8388608 8388608 bytes\n";

    #[test]
    fn granted_is_good() {
        let check = check(&Fake::good(), &DoctorOptions::default());
        assert_eq!(check.status, Status::Ok);
        assert_eq!(check.found, "SCHED_FIFO 40 granted; may lock all memory");
        assert_eq!(check.values["limit_rtprio"], 98);
    }

    #[test]
    fn refused_says_why_and_that_it_runs_on() {
        let check = check(&refused(NONE), &DoctorOptions::default());
        assert!(
            check
                .found
                .contains("Operation not permitted; limit 0, hard 0")
        );
        assert!(check.found.contains("8.0 MiB") && check.found.contains("runs on without"));
    }

    #[test]
    fn the_mend_fits_the_reason() {
        assert!(mend(&refused(NONE)).contains("limits.d"));
        let soft = refused("Max realtime priority 0 98\n");
        assert!(mend(&soft).contains("ulimit -r 40"));
        let group = refused(NONE).file("/proc/self/status", "CapEff:\t00000000a0800000\n");
        assert!(mend(&group).contains("sched_rt_runtime_us"));
        let container = refused(NONE).file("/.dockerenv", "");
        assert!(mend(&container).contains("--cap-add SYS_NICE"));
        let mut unreadable = refused(NONE);
        unreadable.forbidden.insert("/proc/self/limits".to_owned());
        assert!(mend(&unreadable).contains("limits.d"));
    }

    #[test]
    fn a_priority_that_does_not_exist_is_named() {
        let options = DoctorOptions {
            real_time_priority: 400,
            ..DoctorOptions::default()
        };
        let check = check(&refused(NONE), &options);
        assert!(check.mend.is_some_and(|mend| mend.contains("1 to 99")));
    }
}
