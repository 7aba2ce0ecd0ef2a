//! A server of one page: its address with a token, and the thread that answers all browsers.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, HeaderName, HeaderValue, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use tokio::sync::oneshot;

use super::connections::Connections;
use super::guard::Guard;

/// Time that [`Host::end`] waits for browsers.
const END_TIMEOUT: Duration = Duration::from_secs(2);
/// Time between two looks at whether they are served.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

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

/// A server that answers until it is ended.
pub struct Host {
    address: SocketAddr,
    guard: Arc<Guard>,
    end: oneshot::Sender<()>,
    thread: JoinHandle<()>,
}

impl Host {
    /// Starts to answer.
    ///
    /// - `address`: where it listens; port 0 is any free one
    /// - `host`: name or number by which the user named the address
    /// - `answers`: what is answered to those who may ask
    ///
    /// # Errors
    /// Those of the system, such as for a port that is in use.
    pub fn start(address: SocketAddr, host: &str, answers: Router) -> io::Result<Host> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let guard = Arc::new(Guard::new(host)?);
        let answers = answers.layer(from_fn_with_state(guard.clone(), guarded));
        let (end, ended) = oneshot::channel();
        // What takes long, such as an explanation of a pixel, has one thread of its own.
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().max_blocking_threads(1).build()?;
        let serve = move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
                let ended = async { ended.await.unwrap_or_default() };
                let _ = axum::serve(Connections::new(listener), answers).with_graceful_shutdown(ended).await;
            });
            // An explanation that takes long ends with the program.
            runtime.shutdown_background();
        };
        let thread = thread::Builder::new().name("serve".into()).spawn(serve)?;
        Ok(Host { address, guard, end, thread })
    }

    /// The address of the page, with its token.
    pub fn url(&self) -> String {
        let mut address = self.address;
        // A server at all addresses is at this one too.
        if address.ip().is_unspecified() {
            address.set_ip(if address.is_ipv4() { Ipv4Addr::LOCALHOST.into() } else { Ipv6Addr::LOCALHOST.into() });
        }
        format!("http://{address}/?token={}", self.guard.token())
    }

    /// Ends the server. It waits a moment for browsers to take the last state of the page.
    ///
    /// - `is_awaited`: whether a browser has yet to ask for it
    pub fn end(self, is_awaited: impl Fn() -> bool) {
        let start = Instant::now();
        while is_awaited() && start.elapsed() < END_TIMEOUT {
            thread::sleep(POLL_INTERVAL);
        }
        let _ = self.end.send(());
        // What is on its way to a browser arrives, unless the browser is stuck.
        while !self.thread.is_finished() && start.elapsed() < END_TIMEOUT {
            thread::sleep(POLL_INTERVAL);
        }
    }
}

/// Refuses requests that may not watch, and adds the headers of all answers.
async fn guarded(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut answer = match guard.admits(request.uri(), request.headers()) {
        true => next.run(request).await,
        false => (StatusCode::FORBIDDEN, "expected the address that pt printed, with its token\n").into_response(),
    };
    HEADERS.into_iter().for_each(|(name, value)| drop(answer.headers_mut().insert(name, HeaderValue::from_static(value))));
    answer
}
