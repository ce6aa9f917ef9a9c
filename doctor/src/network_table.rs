//! Who holds which port: `/proc/net/{tcp,tcp6,udp,udp6}` and `/proc/*/fd`.

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};

use super::host::Host;

/// A socket of this machine (of this network namespace).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Socket {
    pub(super) address: IpAddr,
    pub(super) port: u16,
    /// A TCP socket that takes connections.
    pub(super) listening: bool,
    /// The user that opened it.
    pub(super) user: u32,
    pub(super) inode: u64,
}

/// Who holds a socket.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Holder {
    Process {
        id: u32,
        name: String,
    },
    /// A process that this user may not look into.
    User(u32),
}

impl fmt::Display for Holder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Holder::Process { id, name } => write!(formatter, "{name} (process {id})"),
            Holder::User(user) => write!(formatter, "a process of user {user}"),
        }
    }
}

/// The sockets of `protocol`, `tcp` or `udp`, over IPv4 and IPv6.
///
/// # Errors
///
/// The IPv4 table cannot be read. Without IPv6 there is no table of it.
pub(super) fn sockets(host: &dyn Host, protocol: &str) -> io::Result<Vec<Socket>> {
    let mut text = host.read(&format!("/proc/net/{protocol}"))?;
    if let Ok(more) = host.read(&format!("/proc/net/{protocol}6")) {
        text.push('\n');
        text.push_str(&more);
    }
    Ok(text.lines().filter_map(parse_line).collect())
}

/// `sl local remote state queues timer retransmits user timeout inode …`;
/// `None` for headings and whatever else is no socket.
fn parse_line(line: &str) -> Option<Socket> {
    let mut words = line.split_whitespace().skip(1);
    let (address, port) = words.next()?.split_once(':')?;
    let state = words.nth(1)?;
    let user = words.nth(3)?;
    let inode = words.nth(1)?;
    Some(Socket {
        address: parse_address(address)?,
        port: u16::from_str_radix(port, 16).ok()?,
        listening: state == "0A",
        user: user.parse().ok()?,
        inode: inode.parse().ok()?,
    })
}

/// Words of 32 bits in the machine's byte order, as hexadecimal numbers.
fn parse_address(text: &str) -> Option<IpAddr> {
    let word = |index: usize| {
        let digits = text.get(8 * index..8 * index + 8)?;
        Some(u32::from_str_radix(digits, 16).ok()?.to_ne_bytes())
    };
    match text.len() {
        8 => Some(Ipv4Addr::from(word(0)?).into()),
        32 => {
            let mut bytes = [0; 16];
            for (index, chunk) in bytes.chunks_exact_mut(4).enumerate() {
                chunk.copy_from_slice(&word(index)?);
            }
            Some(Ipv6Addr::from(bytes).into())
        }
        _ => None,
    }
}

/// The holders of sockets, in their order.
pub(super) fn holders(host: &dyn Host, sockets: &[&Socket]) -> Vec<Holder> {
    let mut found: BTreeMap<u64, Holder> = BTreeMap::new();
    if !sockets.is_empty() {
        for id in processes(host) {
            let folder = format!("/proc/{id}/fd");
            for file in host.list(&folder).unwrap_or_default() {
                let Some(inode) = socket_inode(host, &format!("{folder}/{file}")) else {
                    continue;
                };
                if sockets.iter().any(|socket| socket.inode == inode) {
                    let name = host.read(&format!("/proc/{id}/comm"));
                    let name = name.unwrap_or_default().trim().to_owned();
                    found.entry(inode).or_insert(Holder::Process { id, name });
                }
            }
        }
    }
    let holder = |socket: &&Socket| {
        let process = found.get(&socket.inode).cloned();
        process.unwrap_or(Holder::User(socket.user))
    };
    sockets.iter().map(holder).collect()
}

/// The ids of the processes that run.
pub(super) fn processes(host: &dyn Host) -> Vec<u32> {
    let names = host.list("/proc").unwrap_or_default();
    names.iter().filter_map(|name| name.parse().ok()).collect()
}

fn socket_inode(host: &dyn Host, path: &str) -> Option<u64> {
    let target = host.link_target(path).ok()?;
    target
        .strip_prefix("socket:[")?
        .strip_suffix(']')?
        .parse()
        .ok()
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::super::fake::Fake;
    use super::*;

    /// The text of `/proc/net/tcp` with sockets on 127.0.0.1: port, state,
    /// user, inode.
    pub(in super::super) fn table(sockets: &[(u16, &str, u32, u64)]) -> String {
        let mut text = "  sl  local_address rem_address   st tx_queue:rx_queue\n".to_owned();
        let address = u32::from_ne_bytes([127, 0, 0, 1]);
        for (port, state, user, inode) in sockets {
            text += &format!(
                "   0: {address:08X}:{port:04X} 00000000:0000 {state} 00000000:00000000 \
                 00:00000000 00000000  {user}        0 {inode} 1 00000000f731a161 100 0 0 10 0\n"
            );
        }
        text
    }

    #[test]
    fn sockets_of_both_families_are_read() {
        let any = "   1: 00000000000000000000000000000000:1D17 \
            00000000000000000000000000000000:0000 0A 00000000:00000000 00:00000000 00000000 \
            1000 0 99 1 0 100 0 0 10 0\n";
        let fake = Fake::empty()
            .file(
                "/proc/net/tcp",
                &table(&[(7447, "0A", 0, 42), (22, "01", 5, 43)]),
            )
            .file("/proc/net/tcp6", &format!("heading\n{any}"));
        let sockets = sockets(&fake, "tcp").expect("the table is there");
        assert_eq!(sockets.len(), 3);
        assert_eq!(sockets[0].address, IpAddr::from([127, 0, 0, 1]));
        assert_eq!((sockets[0].port, sockets[0].listening), (7447, true));
        assert_eq!((sockets[1].user, sockets[1].listening), (5, false));
        assert_eq!(sockets[2].address, IpAddr::from(Ipv6Addr::UNSPECIFIED));
        assert_eq!(
            (sockets[2].port, sockets[2].user, sockets[2].inode),
            (0x1d17, 1000, 99)
        );
    }

    #[test]
    fn a_holder_is_named_where_it_can_be_seen() {
        let fake = Fake::empty()
            .file(
                "/proc/net/tcp",
                &table(&[(1, "0A", 0, 42), (2, "0A", 7, 43)]),
            )
            .process(12, "zenohd", &["/dev/null", "socket:[42]"]);
        let sockets = sockets(&fake, "tcp").expect("the table is there");
        let holders = holders(&fake, &sockets.iter().collect::<Vec<_>>());
        let texts: Vec<_> = holders.iter().map(Holder::to_string).collect();
        assert_eq!(texts, ["zenohd (process 12)", "a process of user 7"]);
    }

    proptest! {
        #[test]
        fn no_line_makes_it_panic(line in "\\PC{0,120}", words in "[ 0-9A-F:é]{0,120}") {
            parse_line(&line);
            let socket = parse_line(&words);
            prop_assert!(socket.is_none_or(|socket| words.contains(&socket.inode.to_string())));
        }
    }
}
