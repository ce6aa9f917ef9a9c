//! Which requests are answered.
//!
//! * `Host` must be a name of this machine's loopback while the server listens
//!   there only: a page of another site cannot reach it under a name of its own
//!   (DNS rebinding).
//! * `Origin`, which browsers send with whatever one site asks of another, must
//!   be the server's own; so must `Sec-Fetch-Site`, except for opening the page.
//! * With a token, everything but the page's own files wants it.

use std::{net::SocketAddr, sync::Arc};

use axum::{
    extract::{Request, State},
    http::{
        HeaderMap, HeaderValue, StatusCode, Uri,
        header::{self, HeaderName},
    },
    middleware::Next,
    response::{IntoResponse, Response},
};

/// What requests are held against.
#[derive(Clone, Debug)]
pub struct Guard {
    /// Where the server listens.
    pub address: SocketAddr,
    /// What must be shown, if anything.
    pub token: Option<String>,
}

/// Why a request is not answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The name under which the server was asked for is not its own.
    #[error("asked for under a foreign name: open the address that ferntast printed")]
    Host,
    /// A page of another site asks.
    #[error("asked for by a page of another site, which is refused")]
    Origin,
    /// The token is missing or wrong.
    #[error("token missing or wrong: open the address with ?token=… that ferntast printed")]
    Token,
}

impl Refusal {
    fn status(self) -> StatusCode {
        match self {
            Refusal::Host | Refusal::Origin => StatusCode::FORBIDDEN,
            Refusal::Token => StatusCode::UNAUTHORIZED,
        }
    }
}

/// Whether a path is one of the page's own files, which hold no secrets.
fn is_asset(path: &str) -> bool {
    !path.starts_with("/api/")
}

/// Equal, in a time that tells nothing of where they differ.
fn same(a: &str, b: &str) -> bool {
    let differing = a
        .bytes()
        .zip(b.bytes())
        .fold(0, |all, (a, b)| all | (a ^ b));
    a.len() == b.len() && differing == 0
}

/// The token that a request shows: `Authorization: Bearer …`, or `token=…` in
/// the address (a WebSocket of a browser can show it nowhere else).
fn shown<'a>(uri: &'a Uri, headers: &'a HeaderMap) -> Option<&'a str> {
    let bearer = headers
        .get(header::AUTHORIZATION)
        .and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
    bearer.or_else(|| {
        uri.query()?
            .split('&')
            .find_map(|part| part.strip_prefix("token="))
    })
}

impl Guard {
    /// Whether a request may be answered.
    ///
    /// # Errors
    ///
    /// [`Refusal`].
    pub fn judge(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let text = |name: HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
        let host = text(header::HOST).unwrap_or_default();
        if self.address.ip().is_loopback() && !self.is_own_name(host) {
            return Err(Refusal::Host);
        }
        if let Some(origin) = headers.get(header::ORIGIN)
            && origin.to_str().ok() != Some(format!("http://{host}").as_str())
        {
            return Err(Refusal::Origin);
        }
        let site = text(HeaderName::from_static("sec-fetch-site"));
        let opens_page = uri.path() == "/"
            && text(HeaderName::from_static("sec-fetch-mode")) == Some("navigate");
        if site.is_some_and(|site| site != "same-origin" && site != "none") && !opens_page {
            return Err(Refusal::Origin);
        }
        match &self.token {
            Some(token) if !is_asset(uri.path()) => match shown(uri, headers) {
                Some(shown) if same(shown, token) => Ok(()),
                _ => Err(Refusal::Token),
            },
            _ => Ok(()),
        }
    }

    fn is_own_name(&self, host: &str) -> bool {
        let Some((name, port)) = host.rsplit_once(':') else {
            return false;
        };
        port.parse() == Ok(self.address.port())
            && (matches!(name, "localhost" | "127.0.0.1" | "[::1]")
                || name.trim_matches(['[', ']']) == self.address.ip().to_string())
    }
}

/// What the page may load: itself. plotly.js compiles its WebGL programs with
/// `Function`, draws into blobs and styles what it draws.
const POLICY: &str = "default-src 'self'; script-src 'self' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data: blob:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'";

/// Judges every request, and tells the browser what the page may do.
pub async fn watch(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.judge(request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => (refusal.status(), refusal.to_string()).into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in [
        ("content-security-policy", POLICY),
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        ("cross-origin-resource-policy", "same-origin"),
        ("cross-origin-opener-policy", "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(
        token: Option<&str>,
        path: &str,
        headers: &[(&'static str, &str)],
    ) -> Result<(), Refusal> {
        let guard = Guard {
            address: "127.0.0.1:8080".parse().unwrap(),
            token: token.map(str::to_owned),
        };
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(*name, value.parse().unwrap());
        }
        guard.judge(&path.parse().unwrap(), &map)
    }

    #[test]
    fn own_names_are_answered_and_no_others() {
        for host in ["127.0.0.1:8080", "localhost:8080", "[::1]:8080"] {
            assert_eq!(judge(None, "/api/lab/files", &[("host", host)]), Ok(()));
        }
        for host in [
            "evil.example:8080",
            "127.0.0.1:8081",
            "127.0.0.1",
            "127.0.0.1.evil.example:8080",
            "",
        ] {
            let judged = judge(None, "/", &[("host", host)]);
            assert_eq!(judged, Err(Refusal::Host), "{host}");
        }
        assert_eq!(judge(None, "/", &[]), Err(Refusal::Host));
    }

    #[test]
    fn pages_of_other_sites_are_refused() {
        let host = ("host", "127.0.0.1:8080");
        let from = |origin| judge(None, "/api/session", &[host, ("origin", origin)]);
        assert_eq!(from("http://127.0.0.1:8080"), Ok(()));
        for origin in [
            "http://evil.example",
            "http://127.0.0.1:8081",
            "https://127.0.0.1:8080",
            "null",
        ] {
            assert_eq!(from(origin), Err(Refusal::Origin), "{origin}");
        }
        let fetched = |path, site, mode| {
            judge(
                None,
                path,
                &[host, ("sec-fetch-site", site), ("sec-fetch-mode", mode)],
            )
        };
        assert_eq!(fetched("/api/lab/files", "same-origin", "cors"), Ok(()));
        assert_eq!(fetched("/", "cross-site", "navigate"), Ok(()));
        assert_eq!(fetched("/", "cross-site", "no-cors"), Err(Refusal::Origin));
        assert_eq!(
            fetched("/api/lab/files", "cross-site", "navigate"),
            Err(Refusal::Origin)
        );
    }

    #[test]
    fn the_token_is_wanted_for_everything_but_the_page() {
        let host = ("host", "127.0.0.1:8080");
        assert_eq!(judge(Some("s3cret"), "/", &[host]), Ok(()));
        assert_eq!(judge(Some("s3cret"), "/style.css", &[host]), Ok(()));
        assert_eq!(
            judge(Some("s3cret"), "/api/session?x=1&token=s3cret", &[host]),
            Ok(())
        );
        let bearer = ("authorization", "Bearer s3cret");
        assert_eq!(
            judge(Some("s3cret"), "/api/lab/files", &[host, bearer]),
            Ok(())
        );
        for path in [
            "/api/lab/files",
            "/api/session?token=s3cre",
            "/api/session?token=s3cret2",
            "/api/session?token=",
        ] {
            assert_eq!(
                judge(Some("s3cret"), path, &[host]),
                Err(Refusal::Token),
                "{path}"
            );
        }
    }
}
