//! Cores, their frequency governors, and how busy they are.

use std::collections::BTreeSet;

use super::host::Host;
use super::limits::status_line;
use super::report::Check;

/// With one core, every node waits for every other.
const MIN_CORES: usize = 2;

pub(super) fn check(host: &dyn Host) -> Check {
    const ID: &str = "processor";
    const TITLE: &str = "Processor";
    let allowed = status_line(host, "Cpus_allowed_list");
    let Some(cores) = allowed.as_deref().and_then(parse_cores) else {
        return Check::ok(ID, TITLE, "").warn(
            "number of cores unknown: /proc/self/status does not say",
            "mount /proc",
        );
    };
    let governors: BTreeSet<String> = cores
        .iter()
        .filter_map(|core| {
            let path = format!("/sys/devices/system/cpu/cpu{core}/cpufreq/scaling_governor");
            let text = host.read(&path).ok()?;
            Some(text.trim().to_owned())
        })
        .collect();
    let names: Vec<&str> = governors.iter().map(String::as_str).collect();
    let names = names.join(", ");
    let frequency = if names.is_empty() {
        "frequency not governed here (virtual machine or fixed)".to_owned()
    } else {
        format!("frequency governor {names}")
    };
    let plural = if cores.len() == 1 { "" } else { "s" };
    let found = format!("{} core{plural} for this process, {frequency}", cores.len());
    let mut check = Check::ok(ID, TITLE, found)
        .with("cores", cores.len())
        .with("governors", names.as_str());
    if cores.len() < MIN_CORES {
        check = check.warn(
            "too few: the nodes of a session wait for each other",
            "give this process more cores (taskset, cpuset, `docker run --cpus`, the virtual machine's settings)",
        );
    }
    if governors.iter().any(|governor| governor != "performance") {
        check = check.warn(
            "the frequency follows the load: steps after a sleep run slowly",
            "`echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor`",
        );
    }
    let load = host.read("/proc/loadavg").ok();
    let load = load.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    if let Some(load) = load {
        check = check.with("load_last_minute", load);
        if load > cores.len() as f64 {
            check = check.warn(
                &format!("busy: {load:.1} threads wanted to run in the last minute"),
                "stop what else runs (`top` names it), then ask the doctor again",
            );
        }
    }
    check
}

/// A kernel's list such as `0-3,8`; `None` when it is none or names no core.
fn parse_cores(list: &str) -> Option<BTreeSet<u32>> {
    /// More than any Linux has; keeps a garbled list from filling the memory.
    const MOST: u32 = 8192;
    let mut cores = BTreeSet::new();
    for part in list.trim().split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last): (u32, u32) = (first.parse().ok()?, last.parse().ok()?);
        if first > last || last > MOST {
            return None;
        }
        cores.extend(first..=last);
    }
    Some(cores)
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    #[test]
    fn lists_of_cores_are_read() {
        let parse = |text| parse_cores(text).map(|cores| cores.len());
        assert_eq!(parse("0"), Some(1));
        assert_eq!(parse("0-3,8,10-11"), Some(7));
        for bad in ["", "a", "3-1", "0-", "0-4000000000", "-1", "1,,2"] {
            assert_eq!(parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_good_machine_is_good() {
        let check = check(&Fake::good());
        assert_eq!(
            (check.status, &check.values["cores"]),
            (Status::Ok, &4.into())
        );
    }

    #[test]
    fn a_virtual_machine_has_no_governor_and_that_is_fine() {
        let fake = Fake::empty().file("/proc/self/status", "Cpus_allowed_list:\t0-1\n");
        assert_eq!(check(&fake).status, Status::Ok);
    }

    #[test]
    fn one_core_power_saving_and_load_each_warn() {
        let one = Fake::good().file("/proc/self/status", "Cpus_allowed_list:\t2\n");
        assert!(check(&one).found.contains("1 core for"));
        let saving = Fake::good().file(
            "/sys/devices/system/cpu/cpu3/cpufreq/scaling_governor",
            "powersave\n",
        );
        assert_eq!(check(&saving).values["governors"], "performance, powersave");
        let busy = Fake::good().file("/proc/loadavg", "7.50 1 1 2/3 4\n");
        assert!(check(&busy).found.contains("7.5 threads"));
        for fake in [one, saving, busy, Fake::empty()] {
            assert_eq!(check(&fake).status, Status::Warn);
        }
    }
}
