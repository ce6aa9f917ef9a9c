//! What comes with a request: how much of it is taken, and how fast it has to come.

use std::time::Duration;

use axum::{
    body::{Body, to_bytes},
    extract::Request,
    http::{StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

/// How long a request without a recording in it may take to arrive.
const PATIENCE: Duration = Duration::from_secs(10);
/// The longest of them \[bytes\].
const LONGEST: usize = 1 << 20;
/// The address that takes recordings, and looks after them itself.
pub const UPLOAD: &str = "/api/lab/upload";

/// Has the body of a request in whole before anybody works on it.
pub async fn take_whole(request: Request, next: Next) -> Response {
    if request.uri().path() == UPLOAD {
        return next.run(request).await;
    }
    let (head, body) = request.into_parts();
    let said = head.headers.get(header::CONTENT_LENGTH);
    let said = said.and_then(|value| value.to_str().ok()?.parse::<u64>().ok());
    if said.is_some_and(|length| length > LONGEST as u64) {
        return too_long();
    }
    match tokio::time::timeout(PATIENCE, to_bytes(body, LONGEST)).await {
        Ok(Ok(bytes)) => {
            let request = Request::from_parts(head, Body::from(bytes));
            next.run(request).await
        }
        Ok(Err(_)) => too_long(),
        Err(_) => {
            let seconds = PATIENCE.as_secs();
            let text = format!("the request did not arrive whole within {seconds} s");
            (StatusCode::REQUEST_TIMEOUT, text).into_response()
        }
    }
}

fn too_long() -> Response {
    let text = format!("a request of more than {LONGEST} bytes is not taken here");
    (StatusCode::PAYLOAD_TOO_LARGE, text).into_response()
}
