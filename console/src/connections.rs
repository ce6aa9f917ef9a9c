//! The connections that are open: how many there may be, and which one goes
//! when there are too many.
//!
//! A new one is always let in. It takes the place of the one that has done
//! nothing for the longest: neither asked for anything whole, nor read what was
//! sent. A page that is open is not put out that way, so that connections that
//! only wait, however many there are, keep nobody from the page and its stop.

use std::{
    io,
    net::{IpAddr, SocketAddr},
    os::fd::{AsRawFd, RawFd},
    pin::Pin,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    task::{Context, Poll, ready},
    time::{Duration, Instant},
};

use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    net::TcpStream,
    time::Sleep,
};

/// Connections that are open at once, at most.
pub const MOST: usize = 256;
/// Of one address.
pub const MOST_OF_ONE: usize = 128;
/// File descriptors that are left to the rest of the process.
const SPARED: u64 = 48;
/// How long a client may take nothing of what is sent to it.
const WRITE_PATIENCE: Duration = Duration::from_secs(15);

/// Connections that may be open at once in a process with so many file
/// descriptors.
fn most_of(descriptors: u64) -> usize {
    let free = descriptors.saturating_sub(SPARED);
    usize::try_from(free).unwrap_or(MOST).clamp(4, MOST)
}

/// File descriptors that this process may have; as many as it is allowed.
fn descriptors() -> u64 {
    let mut limit = libc::rlimit {
        rlim_cur: 0,
        rlim_max: 0,
    };
    // SAFETY: the structure lives through the call.
    if unsafe { libc::getrlimit(libc::RLIMIT_NOFILE, &raw mut limit) } != 0 {
        return SPARED;
    }
    let raised = libc::rlimit {
        rlim_cur: limit.rlim_max.min(limit.rlim_cur.max(1024)),
        ..limit
    };
    // SAFETY: as above.
    match unsafe { libc::setrlimit(libc::RLIMIT_NOFILE, &raw const raised) } {
        0 => raised.rlim_cur,
        _ => limit.rlim_cur,
    }
}

/// The connections that are open.
#[derive(Debug)]
pub struct Connections {
    most: usize,
    started: Instant,
    open: Mutex<Vec<Arc<Connection>>>,
}

/// One of them.
#[derive(Debug)]
pub struct Connection {
    socket: RawFd,
    from: IpAddr,
    started: Instant,
    /// When it last asked for something whole or took what was sent, after
    /// `started` \[ms\].
    active: AtomicU64,
    page: AtomicBool,
    ended: AtomicBool,
}

impl Connection {
    /// It asked for something whole, or took what was sent.
    pub fn note(&self) {
        let passed = self.started.elapsed().as_millis();
        let passed = u64::try_from(passed).unwrap_or(u64::MAX);
        self.active.store(passed, Ordering::Relaxed);
    }

    /// It is a page that is open: it is not put out.
    pub fn keep(&self) {
        self.page.store(true, Ordering::Relaxed);
    }

    fn can_go(&self) -> bool {
        !self.page.load(Ordering::Relaxed) && !self.ended.load(Ordering::Relaxed)
    }

    /// Ends it; its place is free from now on. Its descriptor is open as long
    /// as it is listed.
    fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
        // SAFETY: takes no pointers.
        unsafe { libc::shutdown(self.socket, libc::SHUT_RDWR) };
    }
}

impl Connections {
    /// None yet; as many as the process has descriptors for.
    pub fn new() -> Arc<Connections> {
        Connections::at_most(most_of(descriptors()))
    }

    fn at_most(most: usize) -> Arc<Connections> {
        Arc::new(Connections {
            most,
            started: Instant::now(),
            open: Mutex::default(),
        })
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Arc<Connection>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a connection in; `None` where all others are pages.
    pub fn enter(self: &Arc<Self>, stream: TcpStream, from: SocketAddr) -> Option<Watched> {
        let from = from.ip();
        let mut open = self.lock();
        let counts = |own: &&Arc<Connection>| !own.ended.load(Ordering::Relaxed);
        let all = open.iter().filter(counts).count();
        let of_one = open.iter().filter(counts).filter(|own| own.from == from);
        let of_one = of_one.count();
        if of_one >= MOST_OF_ONE.min(self.most) {
            idlest(open.iter().filter(|own| own.from == from))?.end();
        } else if all >= self.most {
            idlest(open.iter())?.end();
        }
        let connection = Arc::new(Connection {
            socket: stream.as_raw_fd(),
            from,
            started: self.started,
            active: AtomicU64::new(0),
            page: AtomicBool::new(false),
            ended: AtomicBool::new(false),
        });
        connection.note();
        open.push(connection.clone());
        drop(open);
        Some(Watched {
            stream,
            waiting: None,
            connection,
            all: self.clone(),
        })
    }

    /// Ends the one that has done nothing for the longest: there is no
    /// descriptor for a new one.
    pub fn make_room(&self) {
        if let Some(idlest) = idlest(self.lock().iter()) {
            idlest.end();
        }
    }
}

fn idlest<'a>(open: impl Iterator<Item = &'a Arc<Connection>>) -> Option<&'a Arc<Connection>> {
    open.filter(|connection| connection.can_go())
        .min_by_key(|connection| connection.active.load(Ordering::Relaxed))
}

/// A connection's stream. A client that takes nothing is cut off.
#[derive(Debug)]
pub struct Watched {
    stream: TcpStream,
    /// Until when something has to be taken.
    waiting: Option<Pin<Box<Sleep>>>,
    /// What is known of it.
    pub connection: Arc<Connection>,
    all: Arc<Connections>,
}

impl Watched {
    fn wrote<T>(
        &mut self,
        context: &mut Context<'_>,
        result: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        if result.is_ready() {
            self.waiting = None;
            self.connection.note();
            return result;
        }
        let waiting = self
            .waiting
            .get_or_insert_with(|| Box::pin(tokio::time::sleep(WRITE_PATIENCE)));
        ready!(waiting.as_mut().poll(context));
        Poll::Ready(Err(io::ErrorKind::TimedOut.into()))
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        // Before the descriptor is closed, and so may be another's.
        let mut open = self.all.lock();
        open.retain(|own| !Arc::ptr_eq(own, &self.connection));
    }
}

impl AsyncRead for Watched {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

impl AsyncWrite for Watched {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.wrote(context, result)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write_vectored(context, parts);
        self.wrote(context, result)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use tokio::{io::AsyncReadExt, net::TcpListener, runtime};

    use super::*;

    #[test]
    fn descriptors_are_left_to_the_rest() {
        for (descriptors, most) in [(0, 4), (64, 16), (1024, MOST), (u64::MAX, MOST)] {
            assert_eq!(most_of(descriptors), most);
        }
    }

    #[test]
    fn a_new_one_takes_the_place_of_the_idlest_and_no_page_goes() {
        let runtime = runtime::Builder::new_current_thread().enable_all().build();
        runtime.unwrap().block_on(async {
            let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
            let address = listener.local_addr().unwrap();
            let all = Connections::at_most(3);
            let mut clients = Vec::new();
            let mut entered = Vec::new();
            for _ in 0..3 {
                clients.push(TcpStream::connect(address).await.unwrap());
                let (stream, from) = listener.accept().await.unwrap();
                entered.push(all.enter(stream, from).unwrap());
                tokio::time::sleep(Duration::from_millis(3)).await;
            }
            // The first is a page; the second was active again.
            entered[0].connection.keep();
            entered[1].connection.note();
            let _fourth = TcpStream::connect(address).await.unwrap();
            let (stream, from) = listener.accept().await.unwrap();
            let fourth = all.enter(stream, from).unwrap();
            let mut byte = [0];
            assert_eq!(clients[2].read(&mut byte).await.unwrap(), 0, "it is cut");
            assert_eq!(all.lock().len(), 4, "until its task has noticed");
            drop(entered.pop());
            assert_eq!(all.lock().len(), 3);
            for connection in [&entered[1].connection, &fourth.connection] {
                connection.keep();
            }
            let _fifth = TcpStream::connect(address).await.unwrap();
            let (stream, from) = listener.accept().await.unwrap();
            assert!(all.enter(stream, from).is_none(), "all are pages");
        });
    }
}
