//! Whether a control group limits this process to a share of the processor:
//! when the share is used up, the kernel stops every thread, real-time or
//! not, until the next period (usually 100 ms).

use super::host::Host;
use super::report::Check;

pub(super) fn check(host: &dyn Host) -> Check {
    const ID: &str = "processor_quota";
    const TITLE: &str = "Processor quota";
    let Some((quota, period)) = version_2(host).or_else(|| version_1(host)) else {
        return Check::ok(ID, TITLE, "none");
    };
    let cores = quota / period;
    Check::ok(ID, TITLE, "")
        .with("quota_cores", cores)
        .with("period_ms", period / 1000.0)
        .warn(
            &format!(
                "{cores:.2} cores in every {:.0} ms; beyond it all loops stand still until the next",
                period / 1000.0
            ),
            "lift it: `docker run` without --cpus, a systemd unit without CPUQuota",
        )
}

/// Quota and period \[µs\] of the group mounted at the root.
fn version_2(host: &dyn Host) -> Option<(f64, f64)> {
    let text = host.read("/sys/fs/cgroup/cpu.max").ok()?;
    let mut words = text.split_whitespace();
    quota(words.next()?, words.next()?)
}

fn version_1(host: &dyn Host) -> Option<(f64, f64)> {
    let read = |name| host.read(&format!("/sys/fs/cgroup/cpu/{name}")).ok();
    quota(&read("cpu.cfs_quota_us")?, &read("cpu.cfs_period_us")?)
}

/// `None` for no limit: `max` or −1.
fn quota(quota: &str, period: &str) -> Option<(f64, f64)> {
    let quota: u32 = quota.trim().parse().ok()?;
    let period: u32 = period.trim().parse().ok()?;
    (period > 0).then(|| (f64::from(quota), f64::from(period)))
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn no_limit_is_good() {
        let max = Fake::empty().file("/sys/fs/cgroup/cpu.max", "max 100000\n");
        let minus = Fake::empty()
            .file("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "-1\n")
            .file("/sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
        let garbled = Fake::empty().file("/sys/fs/cgroup/cpu.max", "5 0");
        for fake in [Fake::empty(), max, minus, garbled] {
            assert_eq!(check(&fake).status, Status::Ok);
        }
    }

    #[test]
    fn a_limit_warns_in_both_versions() {
        let two = Fake::empty().file("/sys/fs/cgroup/cpu.max", "150000 100000\n");
        let one = Fake::empty()
            .file("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "150000\n")
            .file("/sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
        for fake in [one, two] {
            let check = check(&fake);
            assert_eq!(check.status, Status::Warn);
            assert_eq!(check.values["quota_cores"], 1.5);
        }
    }
}
