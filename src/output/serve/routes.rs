//! What the server of a render answers.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::http::{StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};

use super::events;
use super::guard::parameter;
use super::shared::{Shared, lock};

type Served = State<Arc<Shared>>;

/// All answers.
pub fn router(shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/events", get(events))
        .route("/picture", get(picture))
        .route("/pixel", get(pixel))
        .route("/stop", post(stop))
        .with_state(shared)
}

async fn page(State(shared): Served) -> Response {
    ([(CONTENT_TYPE, "text/html; charset=utf-8")], shared.html.clone()).into_response()
}

async fn events(State(shared): Served) -> Response {
    events::events(shared.status.subscribe())
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
