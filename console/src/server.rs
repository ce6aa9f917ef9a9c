//! Listens, and answers.

use std::{
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, UdpSocket},
    path::PathBuf,
    sync::Arc,
    thread::JoinHandle,
    time::Duration,
};

use axum::{Router, body::Body, middleware};
use hyper::{body::Incoming, server::conn::http1, service::service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::sync::oneshot;
use tower_service::Service;

use crate::{
    ServerError, assets, bodies,
    connections::{Connections, Watched},
    guard::{self, Guard},
    lab, session,
};

/// Where the page is served, and to whom.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listen {
    /// Address and port; `None` for the first free port of this machine's
    /// loopback from 8080 on.
    pub address: Option<SocketAddr>,
    /// What has to be shown; a must beyond loopback.
    pub token: Option<String>,
}

/// Ports that are tried one after the other where none is asked for.
const PORTS: std::ops::Range<u16> = 8080..8180;

impl Listen {
    fn bind(&self) -> Result<TcpListener, ServerError> {
        let bind = |address| {
            TcpListener::bind(address).map_err(|source| ServerError::Listen { address, source })
        };
        if let Some(address) = self.address {
            return bind(address);
        }
        let loopback = |port| SocketAddr::from(([127, 0, 0, 1], port));
        let free = PORTS.map(loopback).find_map(|address| bind(address).ok());
        free.map_or_else(|| bind(loopback(0)), Ok)
    }

    /// That others than this machine cannot get in unasked.
    ///
    /// # Errors
    ///
    /// [`ServerError::NoToken`], [`ServerError::WeakToken`].
    pub fn check(&self) -> Result<(), ServerError> {
        let allowed = |sign: char| sign.is_ascii_alphanumeric() || sign == '-' || sign == '_';
        let beyond = self.address.filter(|address| !address.ip().is_loopback());
        match (&self.token, beyond) {
            (Some(token), _) if token.len() < 16 || !token.chars().all(allowed) => {
                Err(ServerError::WeakToken)
            }
            (None, Some(address)) => Err(ServerError::NoToken(address)),
            _ => Ok(()),
        }
    }
}

/// What the page serves.
#[derive(Default)]
pub struct Content {
    /// The session, if one runs.
    pub shared: Option<Arc<session::SharedSession>>,
    /// The lab's folder.
    pub folder: PathBuf,
}

/// A page that is being served, by threads of its own; dropping it ends that.
pub struct Server {
    /// Where to look at it, with the token.
    pub url: String,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves from now on.
    ///
    /// # Errors
    ///
    /// [`ServerError`].
    pub fn start(listen: &Listen, content: Content) -> Result<Server, ServerError> {
        listen.check()?;
        let listener = listen.bind()?;
        listener.set_nonblocking(true).map_err(ServerError::Run)?;
        let address = listener.local_addr().map_err(ServerError::Run)?;
        let guard = Arc::new(Guard {
            address,
            token: listen.token.clone(),
        });
        let lab = lab::Lab::new(&content.folder)?;
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("page")
            .enable_all()
            .build()
            .map_err(ServerError::Run)?;
        let (stop, stopped) = oneshot::channel::<()>();
        let router = Router::new()
            .merge(assets::routes())
            .merge(lab::routes(Arc::new(lab)))
            .merge(session::routes(content.shared))
            .layer(middleware::from_fn(bodies::take_whole))
            .layer(middleware::from_fn_with_state(guard, guard::watch));
        let thread = std::thread::Builder::new()
            .name("page".to_owned())
            .spawn(move || {
                runtime.block_on(async move {
                    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
                        return;
                    };
                    // Connections that are open are cut: nobody waits for a
                    // page that somebody left open.
                    tokio::select! {
                        () = accept(listener, router) => {}
                        _ = stopped => {}
                    }
                });
                // Nor for a diagnosis that nobody reads any more.
                runtime.shutdown_background();
            })
            .map_err(ServerError::Run)?;
        let token = listen.token.as_ref();
        let query = token.map_or_else(String::new, |token| format!("/?token={token}"));
        Ok(Server {
            url: format!("http://{}{query}", reachable(address)),
            stop: Some(stop),
            thread: Some(thread),
        })
    }
}

/// Where others find what listens at `address`: of all addresses, the one by which this host
/// reaches beyond itself.
fn reachable(address: SocketAddr) -> SocketAddr {
    if !address.ip().is_unspecified() {
        return address;
    }
    // Addresses for documentation, on no network: nothing is sent, the system only says by
    // which of its own it would be.
    let (any, beyond) = match address.is_ipv4() {
        true => ("0.0.0.0:0", "192.0.2.1:9"),
        false => ("[::]:0", "[2001:db8::1]:9"),
    };
    let own = UdpSocket::bind(any).and_then(|socket| {
        socket.connect(beyond)?;
        socket.local_addr()
    });
    let loopback = match address.is_ipv4() {
        true => IpAddr::from(Ipv4Addr::LOCALHOST),
        false => IpAddr::from(Ipv6Addr::LOCALHOST),
    };
    SocketAddr::new(own.map_or(loopback, |own| own.ip()), address.port())
}

/// How long a client may take to ask for something; as long it may ask for nothing.
const HEAD_PATIENCE: Duration = Duration::from_secs(10);

/// Answers whoever connects, for as long as it is asked.
async fn accept(listener: tokio::net::TcpListener, router: Router) {
    let connections = Connections::new();
    loop {
        match listener.accept().await {
            Ok((stream, from)) => {
                // Snapshots are small and are to be there at once.
                let _ = stream.set_nodelay(true);
                if let Some(stream) = connections.enter(stream, from) {
                    tokio::spawn(answer(stream, router.clone()));
                }
            }
            // No descriptor is free, or the client has gone again.
            Err(_) => {
                connections.make_room();
                tokio::time::sleep(Duration::from_millis(5)).await;
            }
        }
    }
}

/// Answers one connection to its end.
async fn answer(stream: Watched, router: Router) {
    let connection = stream.connection.clone();
    let service = service_fn(move |mut request: hyper::Request<Incoming>| {
        connection.note();
        request.extensions_mut().insert(connection.clone());
        router.clone().call(request.map(Body::new))
    });
    let serving = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_PATIENCE)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    // How it ended is nobody's concern: the client has gone, or was too slow.
    let _ = serving.await;
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A panic in there was told already.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_can_be_opened() {
        let own: SocketAddr = "192.168.7.5:8090".parse().unwrap();
        assert_eq!(reachable(own), own);
        for any in ["0.0.0.0:8090", "[::]:8090"] {
            let any: SocketAddr = any.parse().unwrap();
            let told = reachable(any);
            assert!(!told.ip().is_unspecified(), "{told}");
            assert_eq!((told.port(), told.is_ipv4()), (8090, any.is_ipv4()));
        }
    }
}
