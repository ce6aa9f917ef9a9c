//! What the kernel grants this process: `/proc/self/limits`, `/proc/self/status`.

use std::io;

use super::host::Host;

/// Capability to raise one's scheduling priority (bit of `CapEff`).
const CAP_SYS_NICE: u32 = 23;

/// The soft and hard value of a limit; `None` is unlimited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limit {
    pub(super) soft: Option<u64>,
    pub(super) hard: Option<u64>,
}

/// A line of `/proc/self/limits`, by the name that stands there.
///
/// # Errors
///
/// The file cannot be read, or has no such line.
pub(super) fn limit(host: &dyn Host, name: &str) -> io::Result<Limit> {
    let text = host.read("/proc/self/limits")?;
    let unknown = || {
        io::Error::new(
            io::ErrorKind::InvalidData,
            format!("/proc/self/limits says nothing about {name:?}"),
        )
    };
    let mut lines = text.lines();
    let rest = lines
        .find_map(|line| line.strip_prefix(name))
        .ok_or_else(unknown)?;
    let mut words = rest.split_whitespace();
    let mut next = || match words.next() {
        Some("unlimited") => Ok(None),
        Some(word) => word.parse().map(Some).map_err(|_| unknown()),
        None => Err(unknown()),
    };
    Ok(Limit {
        soft: next()?,
        hard: next()?,
    })
}

/// The value of a line `name:` of `/proc/self/status`.
pub(super) fn status_line(host: &dyn Host, name: &str) -> Option<String> {
    let text = host.read("/proc/self/status").ok()?;
    let mut lines = text.lines();
    let value = lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    Some(value.trim().to_owned())
}

/// Whether this process may raise priorities without a limit.
pub(super) fn may_raise_priority(host: &dyn Host) -> bool {
    let effective = status_line(host, "CapEff");
    let bits = effective.and_then(|text| u64::from_str_radix(&text, 16).ok());
    bits.is_some_and(|bits| bits >> CAP_SYS_NICE & 1 == 1)
}

/// Whether this process runs in a Docker or Podman container.
pub(super) fn in_container(host: &dyn Host) -> bool {
    let names = |folder, wanted| {
        let names = host.list(folder).unwrap_or_default();
        names.iter().any(|name| name == wanted)
    };
    names("/", ".dockerenv") || names("/run", ".containerenv")
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::*;

    #[test]
    fn soft_and_hard_are_read() {
        let fake = Fake::empty().file(
            "/proc/self/limits",
            "Limit                     Soft Limit           Hard Limit           Units     \n\
             Max locked memory         8388608              unlimited            bytes     \n\
             Max realtime priority     0                    98                             \n\
             Max realtime timeout      broken\n",
        );
        let read = |name| limit(&fake, name).map_err(|error| error.kind());
        let locked = Limit {
            soft: Some(8_388_608),
            hard: None,
        };
        assert_eq!(read("Max locked memory"), Ok(locked));
        let priority = Limit {
            soft: Some(0),
            hard: Some(98),
        };
        assert_eq!(read("Max realtime priority"), Ok(priority));
        let invalid = Err(io::ErrorKind::InvalidData);
        assert_eq!(read("Max realtime timeout"), invalid);
        assert_eq!(read("Max nonsense"), invalid);
    }

    #[test]
    fn the_capability_is_bit_23() {
        let with = |bits: &str| {
            let text = format!("Name:\tx\nCapEff:\t{bits}\n");
            may_raise_priority(&Fake::empty().file("/proc/self/status", &text))
        };
        assert!(with("0000000000800000"));
        assert!(!with("ffffffffff7fffff"));
        assert!(!with("garbage"));
        assert!(!may_raise_priority(&Fake::empty()));
    }
}
