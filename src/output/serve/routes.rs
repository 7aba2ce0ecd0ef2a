//! What the server answers.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{StatusCode, Uri};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::stream::{Stream, unfold};
use tokio::sync::watch;

use super::Status;
use super::guard::parameter;
use super::shared::{Shared, lock};

type Served = State<Arc<Shared>>;

/// Headers of all answers: nothing is stored, nothing of another site is loaded, and the token goes nowhere else.
const HEADERS: [(HeaderName, &str); 4] = [
    (CACHE_CONTROL, "no-store"),
    (REFERRER_POLICY, "no-referrer"),
    (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (
        CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; base-uri 'none'; \
         frame-ancestors 'none'",
    ),
];

/// All answers.
pub fn router(shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/events", get(events))
        .route("/picture", get(picture))
        .route("/pixel", get(pixel))
        .route("/stop", post(stop))
        .layer(from_fn_with_state(shared.clone(), guarded))
        .with_state(shared)
}

/// Refuses requests that may not watch, and adds the headers of all answers.
async fn guarded(State(shared): Served, request: Request, next: Next) -> Response {
    let mut answer = match shared.guard.admits(request.uri(), request.headers()) {
        true => next.run(request).await,
        false => (StatusCode::FORBIDDEN, "expected the address that pt printed, with its token\n").into_response(),
    };
    HEADERS.into_iter().for_each(|(name, value)| drop(answer.headers_mut().insert(name, HeaderValue::from_static(value))));
    answer
}

async fn page(State(shared): Served) -> Response {
    ([(CONTENT_TYPE, "text/html; charset=utf-8")], shared.html.clone()).into_response()
}

async fn events(State(shared): Served) -> Response {
    let statuses = statuses(shared.status.subscribe());
    Sse::new(statuses).keep_alive(KeepAlive::default()).into_response()
}

/// The state now and after each change. A browser that is slow misses states between. The state after the end is the last.
fn statuses(mut receiver: watch::Receiver<Status>) -> impl Stream<Item = serde_json::Result<Event>> {
    receiver.mark_changed();
    unfold(Some(receiver), |receiver| async {
        let mut receiver = receiver?;
        receiver.changed().await.ok()?;
        let status = receiver.borrow_and_update().clone();
        let event = serde_json::to_string(&status).map(|text| Event::default().data(text));
        Some((event, Some(receiver).filter(|_| status.closing.is_none())))
    })
}

async fn picture(State(shared): Served, uri: Uri) -> Response {
    let since = parameter(&uri, "since").and_then(|since| since.parse().ok()).unwrap_or(0);
    let latest = lock(&shared.picture).clone();
    let Some(latest) = latest.filter(|latest| latest.number != since) else { return StatusCode::NO_CONTENT.into_response() };
    let (bytes, took) = latest.bytes();
    lock(&shared.pace).postpone(took);
    shared.taken.fetch_add(1, Ordering::Relaxed);
    ([(CONTENT_TYPE, "application/octet-stream")], Body::from(bytes)).into_response()
}

async fn pixel(State(shared): Served, uri: Uri) -> Response {
    let number = |name| parameter(&uri, name).and_then(|text| text.parse().ok());
    let (Some(x), Some(y)) = (number("x"), number("y")) else { return (StatusCode::BAD_REQUEST, "expected x and y\n").into_response() };
    let Ok(place) = shared.explanations.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "others have asked for pixels: try again in a moment\n").into_response();
    };
    let explained = tokio::task::spawn_blocking(move || {
        let text = shared.watched.explain([x, y]);
        drop(place);
        text
    });
    match explained.await {
        Ok(Some(text)) => text.into_response(),
        Ok(None) => (StatusCode::NOT_FOUND, "no pixel of the picture\n").into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

async fn stop(State(shared): Served) -> StatusCode {
    shared.watched.stop();
    shared.status.send_modify(|status| status.is_stopping = true);
    StatusCode::ACCEPTED
}
