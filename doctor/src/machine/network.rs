//! Interfaces, shared UDP ports and multicast.

use std::ffi::CStr;
use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::time::Duration;

use super::super::host::Interface;

/// Loopback of a datagram takes microseconds; a busy machine some milliseconds.
const ANSWER_WITHIN: Duration = Duration::from_millis(300);

/// Binds a UDP port on all addresses, shared as DDS does, and closes it.
pub(super) fn try_sharing_udp_port(port: u16) -> io::Result<()> {
    // SAFETY: takes no pointers.
    let raw = unsafe { libc::socket(libc::AF_INET, libc::SOCK_DGRAM | libc::SOCK_CLOEXEC, 0) };
    if raw < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: `raw` was just opened and belongs to nobody else.
    let socket = unsafe { OwnedFd::from_raw_fd(raw) };
    let yes: libc::c_int = 1;
    set_option(&socket, libc::SOL_SOCKET, libc::SO_REUSEADDR, &yes)?;
    // SAFETY: an all-zero sockaddr_in is a valid value: any address.
    let mut address: libc::sockaddr_in = unsafe { std::mem::zeroed() };
    address.sin_family = libc::AF_INET as libc::sa_family_t;
    address.sin_port = port.to_be();
    // SAFETY: pointer and length describe `address`.
    let result = unsafe {
        libc::bind(
            socket.as_raw_fd(),
            (&raw const address).cast(),
            size_of::<libc::sockaddr_in>() as libc::socklen_t,
        )
    };
    if result != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(())
}

/// Sends a datagram to `group` through `interface` and receives it back.
pub(super) fn try_multicast(group: Ipv4Addr, interface: Ipv4Addr) -> io::Result<()> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    socket.join_multicast_v4(&group, &interface)?;
    socket.set_multicast_loop_v4(true)?;
    // It shall not leave this machine's network.
    socket.set_multicast_ttl_v4(0)?;
    let through = libc::in_addr {
        s_addr: u32::from_ne_bytes(interface.octets()),
    };
    set_option(&socket, libc::IPPROTO_IP, libc::IP_MULTICAST_IF, &through)?;
    socket.set_read_timeout(Some(ANSWER_WITHIN))?;
    let port = socket.local_addr()?.port();
    let sent = format!("ferntast doctor {}", std::process::id());
    socket.send_to(sent.as_bytes(), SocketAddrV4::new(group, port))?;
    let mut received = [0; 64];
    let length = socket
        .recv(&mut received)
        .map_err(|error| match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => io::Error::new(
                io::ErrorKind::TimedOut,
                "what was sent to the group did not come back",
            ),
            _ => error,
        })?;
    if received.get(..length) == Some(sent.as_bytes()) {
        Ok(())
    } else {
        Err(io::Error::other(
            "something else than what was sent came back",
        ))
    }
}

/// All interfaces, each once, in the kernel's order.
pub(super) fn interfaces() -> io::Result<Vec<Interface>> {
    let mut first: *mut libc::ifaddrs = std::ptr::null_mut();
    // SAFETY: `first` is valid for writing; the list is freed below.
    if unsafe { libc::getifaddrs(&mut first) } != 0 {
        return Err(io::Error::last_os_error());
    }
    let mut interfaces: Vec<Interface> = Vec::new();
    let mut next = first;
    // SAFETY: the list's entries are valid until freeifaddrs and end in null.
    while let Some(entry) = unsafe { next.as_ref() } {
        next = entry.ifa_next;
        // SAFETY: `ifa_name` is a string that ends in a zero byte.
        let name = unsafe { CStr::from_ptr(entry.ifa_name) }
            .to_string_lossy()
            .into_owned();
        let index = interfaces.iter().position(|known| known.name == name);
        let index = index.unwrap_or_else(|| {
            let has = |flag: libc::c_int| entry.ifa_flags & flag as libc::c_uint != 0;
            interfaces.push(Interface {
                name,
                running: has(libc::IFF_UP) && has(libc::IFF_RUNNING),
                loopback: has(libc::IFF_LOOPBACK),
                multicast: has(libc::IFF_MULTICAST),
                addresses: Vec::new(),
            });
            interfaces.len() - 1
        });
        // SAFETY: `ifa_addr` is null or valid; its family says what it is.
        let address = unsafe {
            match entry.ifa_addr.as_ref() {
                Some(any) if libc::c_int::from(any.sa_family) == libc::AF_INET => {
                    let address = entry.ifa_addr.cast::<libc::sockaddr_in>().read_unaligned();
                    Some(Ipv4Addr::from(address.sin_addr.s_addr.to_ne_bytes()))
                }
                _ => None,
            }
        };
        interfaces[index].addresses.extend(address);
    }
    // SAFETY: `first` came from getifaddrs and is freed once.
    unsafe { libc::freeifaddrs(first) };
    Ok(interfaces)
}

fn set_option<T>(
    socket: &impl AsRawFd,
    level: libc::c_int,
    name: libc::c_int,
    value: &T,
) -> io::Result<()> {
    // SAFETY: pointer and length describe `value`.
    let result = unsafe {
        libc::setsockopt(
            socket.as_raw_fd(),
            level,
            name,
            std::ptr::from_ref(value).cast(),
            size_of::<T>() as libc::socklen_t,
        )
    };
    if result != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loopback_interface_is_found_with_its_address() {
        let interfaces = interfaces().expect("getifaddrs");
        let loopback = interfaces.iter().find(|interface| interface.loopback);
        let loopback = loopback.expect("every Linux has one");
        assert!(loopback.running);
        assert!(loopback.addresses.contains(&Ipv4Addr::LOCALHOST));
    }

    #[test]
    fn a_udp_port_that_is_not_shared_is_refused() {
        let socket = UdpSocket::bind("0.0.0.0:0").expect("a free port");
        let port = socket.local_addr().expect("bound").port();
        let refused = try_sharing_udp_port(port).map_err(|error| error.kind());
        assert_eq!(refused, Err(io::ErrorKind::AddrInUse));
        // Shared, it is not: another that shares it is let in.
        let yes: libc::c_int = 1;
        set_option(&socket, libc::SOL_SOCKET, libc::SO_REUSEADDR, &yes).expect("allowed");
        assert!(try_sharing_udp_port(port).is_ok());
    }

    #[test]
    fn an_address_of_no_interface_carries_no_multicast() {
        // TEST-NET-3 (RFC 5737) is on no machine.
        let foreign = Ipv4Addr::new(203, 0, 113, 7);
        assert!(try_multicast(Ipv4Addr::new(239, 255, 0, 1), foreign).is_err());
    }
}
