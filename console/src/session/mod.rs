//! A session's console: pages over WebSocket on one side, the bus on the other.
//!
//! * [`operator_lock`]: who operates, and whether the hand is held,
//! * [`shared_session`]: what pages and the loop share,
//! * [`link`](SessionPorts): the loop's side, topics of the bus,
//! * [`message`]: what is said between page and server,
//! * [`spatial`]: the arm and what it can touch, to be drawn.

mod event_log;
pub mod hand;
pub mod message;
pub mod operator_lock;
mod ports;
pub mod shared_session;
pub mod spatial;

use std::sync::Arc;

use axum::{
    Extension, Json, Router,
    extract::{
        State,
        ws::{Message, WebSocket, WebSocketUpgrade},
    },
    response::Response,
    routing::get,
};

pub use hand::{GripModel, HandMapping, PageHand};
pub use ports::{ArmTopics, SessionPorts, page_of};
pub use shared_session::SharedSession;

use crate::connections::Connection;
use message::{Answer, Request};

/// Longest request of a page \[bytes\].
const LONGEST_REQUEST: usize = 4096;

/// The session's addresses. Without a session there is only the word that
/// there is none.
pub fn routes(shared: Option<Arc<SharedSession>>) -> Router {
    let about = shared.is_some();
    let router = Router::new().route(
        "/api/about",
        get(move || async move { Json(serde_json::json!({ "session": about })) }),
    );
    match shared {
        Some(shared) => router.merge(
            Router::new()
                .route("/api/session", get(connect))
                .with_state(shared),
        ),
        None => router,
    }
}

async fn connect(
    State(shared): State<Arc<SharedSession>>,
    Extension(connection): Extension<Arc<Connection>>,
    upgrade: WebSocketUpgrade,
) -> Response {
    upgrade
        .max_message_size(LONGEST_REQUEST)
        .on_upgrade(move |socket| async move {
            connection.keep();
            let (page, put_out) = shared.enter();
            tokio::select! {
                () = serve(&shared, page, socket) => {}
                () = put_out.notified() => {}
            }
            shared.leave(page);
        })
}

/// Talks with a page until it goes.
async fn serve(shared: &SharedSession, page: u64, mut socket: WebSocket) {
    let hello = Answer::Hello {
        page,
        session: &shared.about,
    };
    if send(&mut socket, &hello).await.is_none() {
        return;
    }
    let mut snapshots = shared.snapshots();
    loop {
        tokio::select! {
            changed = snapshots.changed() => {
                let text = snapshots.borrow_and_update().clone();
                if changed.is_err() || socket.send(Message::Text(text)).await.is_err() {
                    return;
                }
            }
            received = socket.recv() => {
                let text = match received {
                    Some(Ok(Message::Text(text))) => text,
                    Some(Ok(Message::Ping(_) | Message::Pong(_))) => continue,
                    _ => return,
                };
                let refused = match serde_json::from_str::<Request>(&text) {
                    Ok(request) => shared.ask(page, request).err().map(|error| error.to_string()),
                    Err(error) => Some(format!("not understood: {error}")),
                };
                if let Some(reason) = refused
                    && send(&mut socket, &Answer::Refused { reason }).await.is_none()
                {
                    return;
                }
            }
        }
    }
}

/// Says something to a page; `None` when it is gone.
async fn send(socket: &mut WebSocket, answer: &Answer<'_>) -> Option<()> {
    let text = serde_json::to_string(answer).ok()?;
    socket.send(Message::Text(text.into())).await.ok()
}
