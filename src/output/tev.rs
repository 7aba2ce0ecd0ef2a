//! Display of pictures in tev, the image viewer, while they are rendered.
//!
//! The protocol is one-way over TCP: the viewer never answers. A picture is created once, and then its changed tiles are sent. A
//! thread of its own sends the latest picture whenever it is done with the one before. So a render never waits, and a viewer that
//! is slow, stuck, gone or not there yet costs it nothing.
//!
//! Source: tev's `Ipc.h` (protocol); pbrt-v4's `display.cpp` (tiles, names, timeouts).

use std::io::{self, Read};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use glam::UVec2;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::pace::Pace;
use crate::film::Image;

/// Edge of the tiles that are compared and sent (pixels).
const TILE: u32 = 128;
/// Largest share of the time that making and sending pictures may take.
const SHARE: f64 = 0.01;
/// Time before the next attempt after a failure.
const RETRY: Duration = Duration::from_secs(5);
/// Time after which a viewer that accepts nothing is given up.
const SEND_TIMEOUT: Duration = Duration::from_secs(3);
/// Time that [`Viewer::finish`] waits for the last picture to be sent.
const FINISH_TIMEOUT: Duration = Duration::from_secs(10);
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Connection to a viewer, which may not be there.
///
/// When it is dropped or finished, it sends the last picture.
#[derive(Debug)]
pub struct Viewer {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    /// Latest picture that was not sent yet.
    waiting: Option<Image>,
    /// When the next picture is requested.
    pace: Pace,
    /// Whether the last picture has been given.
    is_last: bool,
    /// Whether the thread has ended.
    is_over: bool,
}

impl Viewer {
    /// Starts the thread and returns at once. Whether a viewer listens is known later.
    ///
    /// - `address`: `host:port`
    /// - `name`: name of the picture; the process id is added, so that two renders do not overwrite each other
    /// - `warn`: called once, with a sentence, when the viewer cannot be reached or goes away
    pub fn start(address: &str, name: &str, warn: impl Fn(&str) + Send + 'static) -> Viewer {
        let state = State { waiting: None, pace: Pace::new(SHARE), is_last: false, is_over: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let sender = Sender {
            address: address.to_owned(),
            // A zero byte ends a name in the protocol.
            name: format!("{} ({})", name.replace('\0', ""), std::process::id()),
            warn: Box::new(warn),
            has_warned: false,
            connection: None,
            unsent: None,
            failed: None,
        };
        let theirs = shared.clone();
        let thread = thread::Builder::new().name("viewer".into()).spawn(move || sender.run(&theirs));
        if thread.is_err() {
            shared.lock().is_over = true;
        }
        Viewer { shared, thread: thread.ok() }
    }

    /// Shows a picture, of which `R`, `G`, `B` are sent. It never waits, and replaces a picture that was not sent yet.
    pub fn show(&self, image: Image) {
        let forgotten = self.shared.lock().waiting.replace(image);
        self.shared.changed.notify_all();
        // Dropped outside of the lock, as it may be large.
        drop(forgotten);
    }

    /// Shows the picture that `make` makes, unless it is too early. There is at most one every quarter of a second. Making it (in
    /// real time, since a render waits for it) and sending it (in processor time) take at most a hundredth of the time.
    pub fn offer(&self, make: impl FnOnce() -> Image) {
        let start = Instant::now();
        if self.shared.lock().pace.is_early(start) {
            return;
        }
        let image = make();
        self.shared.lock().pace.postpone(start.elapsed());
        self.show(image);
    }

    /// Sends the last picture and closes the connection; waits some seconds at most.
    pub fn finish(self) {}
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.is_last = true;
        self.shared.changed.notify_all();
        let waited = self.shared.changed.wait_timeout_while(state, FINISH_TIMEOUT, |state| !state.is_over);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        // A thread that still waits for a viewer is left alone; it ends with the program.
        let is_over = state.is_over;
        drop(state);
        if let Some(thread) = self.thread.take().filter(|_| is_over) {
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Next picture, or none after `patience`; and whether it was the last.
    fn next(&self, patience: Duration) -> (Option<Image>, bool) {
        let nothing_new = |state: &mut State| state.waiting.is_none() && !state.is_last;
        let waited = self.changed.wait_timeout_while(self.lock(), patience, nothing_new);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        (state.waiting.take(), state.is_last)
    }
}

/// Marks the thread as ended, however it ends.
struct EndGuard<'a>(&'a Shared);

impl Drop for EndGuard<'_> {
    fn drop(&mut self) {
        self.0.lock().is_over = true;
        self.0.changed.notify_all();
    }
}

/// State of the thread.
struct Sender {
    address: String,
    name: String,
    warn: Box<dyn Fn(&str) + Send>,
    has_warned: bool,
    connection: Option<Connection>,
    /// Latest picture, if it could not be sent.
    unsent: Option<Arc<Image>>,
    failed: Option<Instant>,
}

impl Sender {
    fn run(mut self, shared: &Shared) {
        let _leave = EndGuard(shared);
        loop {
            let (image, is_last) = shared.next(RETRY);
            self.unsent = image.map(Arc::new).or(self.unsent);
            let is_early = self.failed.is_some_and(|failed| failed.elapsed() < RETRY);
            // After the last picture there is no later attempt.
            if is_last || !is_early {
                let start = ThreadTime::now();
                self.send();
                shared.lock().pace.postpone(start.elapsed());
            }
            if is_last {
                break;
            }
        }
        self.connection.take().into_iter().for_each(Connection::close);
    }

    /// Sends the picture, over the existing connection or a new one.
    fn send(&mut self) {
        let Some(image) = self.unsent.take() else { return };
        let was_there = self.connection.is_some();
        let connection = self.connection.take().map_or_else(|| Connection::open(&self.address), Ok);
        match connection.and_then(|connection| connection.update(&self.name, &image)) {
            Ok(connection) => (self.connection, self.failed) = (Some(connection), None),
            Err(error) => {
                (self.unsent, self.failed) = (Some(image), Some(Instant::now()));
                self.warn_once(was_there, &error);
            }
        }
    }

    fn warn_once(&mut self, was_there: bool, error: &io::Error) {
        if !std::mem::replace(&mut self.has_warned, true) {
            let what = if was_there { "went away" } else { "cannot be reached" };
            (self.warn)(&format!("the viewer at {} {what} ({error}); the render goes on", self.address));
        }
    }
}

/// Connection to a viewer, and what it shows.
struct Connection {
    client: TevClient,
    /// Second handle of the same socket.
    stream: TcpStream,
    shown: Option<Arc<Image>>,
}

impl Connection {
    fn open(address: &str) -> io::Result<Connection> {
        let mut refusal = io::Error::new(io::ErrorKind::NotFound, "no such address");
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, SEND_TIMEOUT) {
                Ok(stream) => {
                    stream.set_write_timeout(Some(SEND_TIMEOUT))?;
                    stream.set_nodelay(true)?;
                    return Ok(Connection { client: TevClient::wrap(stream.try_clone()?), stream, shown: None });
                }
                Err(error) => refusal = error,
            }
        }
        Err(refusal)
    }

    /// Creates the picture if it is new, and sends the tiles that have changed. An error ends the connection.
    fn update(mut self, name: &str, image: &Arc<Image>) -> io::Result<Connection> {
        let shown = self.shown.take().filter(|shown| shown.full_size == image.full_size);
        if shown.is_none() {
            let UVec2 { x: width, y: height } = image.full_size;
            self.client.send(PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names: &CHANNELS })?;
        }
        let before = shown.filter(|shown| (shown.origin, shown.size) == (image.origin, image.size));
        for corner in corners(image.size) {
            let size = (image.size - corner).min(UVec2::splat(TILE));
            let data = tile(image, corner, size);
            let is_old = before.as_ref().is_some_and(|before| same_bits(&tile(before, corner, size), &data));
            if !is_old {
                self.send_tile(name, image.origin + corner, size, &data)?;
            }
        }
        self.shown = Some(image.clone());
        Ok(self)
    }

    fn send_tile(&mut self, name: &str, corner: UVec2, size: UVec2, data: &[f32]) -> io::Result<()> {
        self.client.send(PacketUpdateImage {
            image_name: name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: corner.x,
            y: corner.y,
            width: size.x,
            height: size.y,
            data,
        })
    }

    /// Signals the end, and waits until the viewer has read everything: a socket that is closed at once may lose data.
    fn close(mut self) {
        let end = Instant::now() + SEND_TIMEOUT;
        let said = self.stream.shutdown(Shutdown::Write).and_then(|()| self.stream.set_read_timeout(Some(SEND_TIMEOUT)));
        let mut answer = [0; 256];
        // The content of an answer is ignored; the end of the answers is awaited.
        while said.is_ok() && Instant::now() < end && self.stream.read(&mut answer).is_ok_and(|count| count > 0) {}
    }
}

/// Upper left pixels of all tiles.
fn corners(size: UVec2) -> impl Iterator<Item = UVec2> {
    let starts = |to: u32| (0..to).step_by(TILE as usize);
    starts(size.y).flat_map(move |y| starts(size.x).map(move |x| UVec2::new(x, y)))
}

/// Red, green and blue of every pixel of a part, row by row.
fn tile(image: &Image, corner: UVec2, size: UVec2) -> Vec<f32> {
    let channels = CHANNELS.map(|name| image.channel(name));
    let value = |channel: &Option<&[f32]>, x: u32, y: u32| channel.map_or(0.0, |values| values[(y * image.size.x + x) as usize]);
    let pixels = (corner.y..corner.y + size.y).flat_map(|y| (corner.x..corner.x + size.x).map(move |x| (x, y)));
    pixels.flat_map(|(x, y)| [0, 1, 2].map(|c| value(&channels[c], x, y))).collect()
}

fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
