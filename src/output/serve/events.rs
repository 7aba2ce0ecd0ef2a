//! Server-sent events: a state, now and whenever it changes.

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{Stream, unfold};
use serde::Serialize;
use tokio::sync::watch;

/// A state whose changes browsers follow.
pub trait Followed: Clone + Serialize + Send + Sync + 'static {
    /// Whether no other state follows.
    fn is_last(&self) -> bool;
}

/// The answer that follows a state.
pub fn events<T: Followed>(receiver: watch::Receiver<T>) -> Response {
    Sse::new(states(receiver)).keep_alive(KeepAlive::default()).into_response()
}

/// The state now and after each change. A browser that is slow misses states between. The state after the end is the last.
fn states<T: Followed>(mut receiver: watch::Receiver<T>) -> impl Stream<Item = serde_json::Result<Event>> {
    receiver.mark_changed();
    unfold(Some(receiver), |receiver| async {
        let mut receiver = receiver?;
        receiver.changed().await.ok()?;
        let state = receiver.borrow_and_update().clone();
        let event = serde_json::to_string(&state).map(|text| Event::default().data(text));
        Some((event, Some(receiver).filter(|_| !state.is_last())))
    })
}
