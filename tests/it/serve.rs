//! The page of a running render: who may see it, what it is given, and that no browser disturbs the render.

mod comparison;
mod page;

use std::cell::Cell;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use glam::UVec2;
use pt::film::{Channel, Image};
use pt::output::serve::{Progress, Server, Snapshot, Watched};
use serde_json::Value;

/// A render that only counts how often it was ended, and has a pixel at 3, 4.
#[derive(Default)]
struct Counter {
    stops: AtomicU32,
}

impl Watched for Counter {
    fn stop(&self) {
        self.stops.fetch_add(1, Ordering::Relaxed);
    }

    fn explain(&self, pixel: [u32; 2]) -> Option<String> {
        (pixel == [3, 4]).then(|| "the reason".to_owned())
    }
}

fn served() -> (Server, Arc<Counter>) {
    let render = Arc::new(Counter::default());
    let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    (Server::start(any, "render-box", "a < b", 0.01, render.clone()).expect("a server"), render)
}

/// Address and token of a server.
fn parts(url: &str) -> (String, String) {
    let (address, token) = url.strip_prefix("http://").and_then(|rest| rest.split_once("/?token=")).expect("an address with a token");
    (address.to_owned(), token.to_owned())
}

/// Sends a request and leaves the answer to be read.
///
/// # Errors
/// Those of the connection, which a server that ends may close at any time.
fn sent(address: &str, method: &str, path: &str, host: &str) -> io::Result<TcpStream> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_secs(60)))?;
    write!(stream, "{method} {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")?;
    Ok(stream)
}

/// Status and body of an answer of known length.
fn answer(address: &str, method: &str, path: &str, host: &str) -> (u16, Vec<u8>) {
    let answered = |bytes: &mut Vec<u8>| sent(address, method, path, host)?.read_to_end(bytes);
    let mut bytes = vec![];
    answered(&mut bytes).expect("an answer");
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("a head") + 4;
    let status = String::from_utf8_lossy(&bytes[9..12]).parse().expect("a status");
    (status, bytes.split_off(end))
}

/// The next event of a stream, until the server ends it.
fn event(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> Option<Value> {
    let data = lines.map_while(Result::ok).find_map(|line| line.strip_prefix("data: ").map(str::to_owned))?;
    Some(serde_json::from_str(&data).expect("JSON"))
}

fn follow(address: &str, token: &str) -> impl Iterator<Item = std::io::Result<String>> + use<> {
    BufReader::new(sent(address, "GET", &format!("/events?token={token}"), address).expect("a connection")).lines()
}

/// A picture whose values tell their place.
fn picture(size: [u32; 2], seed: f32) -> Image {
    let size = UVec2::from(size);
    let channel = |(c, name): (usize, &str)| Channel {
        name: name.to_owned(),
        values: (0..size.element_product()).map(|i| seed * (1.0 + i as f32 + 1000.0 * c as f32)).collect(),
    };
    let names = ["R", "G", "B", "StdErr.R", "StdErr.G", "StdErr.B"];
    Image { full_size: size + 7, origin: UVec2::new(2, 5), size, channels: names.into_iter().enumerate().map(channel).collect() }
}

/// Shows a picture, as soon as one is due.
fn shown(server: &Server, samples: f64, image: &Image) {
    let mut is_shown = false;
    let start = Instant::now();
    while !is_shown {
        assert!(start.elapsed() < Duration::from_secs(60), "no picture is due");
        let (colors, errors) = (Cell::new(false), Cell::new(false));
        let made = |kind: &Cell<bool>| {
            kind.set(true);
            image.clone()
        };
        server.offer(samples, || made(&colors), Some(|| Snapshot { samples, image: made(&errors), worst: vec![] }));
        is_shown = colors.get() || errors.get();
        thread::sleep(Duration::from_millis(5));
    }
}

/// A half float, by the definition of IEEE 754.
fn half(pair: &[u8]) -> f64 {
    let bits = u16::from_le_bytes([pair[0], pair[1]]);
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    let size = if exponent == 0 { fraction * 2f64.powi(-14) } else { (1.0 + fraction) * 2f64.powi(exponent - 15) };
    if bits >> 15 == 1 { -size } else { size }
}

#[test]
fn requests_without_the_token_or_for_another_host_are_refused() {
    let (server, render) = served();
    shown(&server, 1.0, &picture([4, 3], 1.0));
    let (address, token) = parts(&server.url());
    let requests = [
        ("GET", "/", 200),
        ("GET", "/picture", 200),
        ("GET", "/pixel", 400),
        ("POST", "/stop", 202),
        ("GET", "/none", 404),
        ("GET", "/stop", 405),
    ];
    for (method, path, status) in requests {
        let right = format!("{path}?token={token}");
        for refused in [path.to_owned(), format!("{path}?token={}", "0".repeat(32)), format!("{path}?token="), format!("{path}?x={token}")]
        {
            assert_eq!(answer(&address, method, &refused, &address).0, 403, "{method} {refused}");
        }
        for host in ["attacker.example", "127.0.0.1.attacker.example"] {
            assert_eq!(answer(&address, method, &right, host).0, 403, "{method} {path} for {host}");
        }
        assert_eq!(render.stops.load(Ordering::Relaxed), 0, "nobody ends the render");
        if path != "/stop" {
            assert_eq!(answer(&address, method, &right, &address).0, status, "{method} {path}");
        }
    }
    assert_eq!(answer(&address, "GET", "/events", &address).0, 403);
    for host in ["localhost", "render-box:99", "[::1]:1", "10.1.2.3"] {
        assert_eq!(answer(&address, "GET", &format!("/?token={token}"), host).0, 200, "{host}");
    }
    assert_eq!(answer(&address, "GET", &format!("/stop?token={token}"), &address).0, 405);
    assert_eq!(answer(&address, "POST", &format!("/stop?token={token}"), &address).0, 202);
    assert_eq!(render.stops.load(Ordering::Relaxed), 1);
    server.finish(None, "over".into());
}

/// The title is escaped, and nothing of the page is loaded from elsewhere.
#[test]
fn the_page_is_one_file() {
    let (server, _) = served();
    let (address, token) = parts(&server.url());
    let page = String::from_utf8(answer(&address, "GET", &format!("/?token={token}"), &address).1).expect("text");
    assert!(page.contains("<b>a &lt; b</b>") && !page.contains("a < b<"), "the title is escaped");
    assert!(!page.contains("{{") && !page.contains("src=") && !page.contains("href=\"http"), "all of it is here");
    assert_eq!(answer(&address, "GET", &format!("/pixel?x=3&y=4&token={token}"), &address), (200, b"the reason".to_vec()));
    assert_eq!(answer(&address, "GET", &format!("/pixel?x=4&y=4&token={token}"), &address).0, 404);
    server.finish(None, "over".into());
}

/// The file has the values of the picture within half a unit in the last of eleven bits, and comes once.
#[test]
fn pictures_arrive_once_and_whole() {
    let (server, _) = served();
    let (address, token) = parts(&server.url());
    let take = |since: u64| answer(&address, "GET", &format!("/picture?since={since}&token={token}"), &address);
    assert_eq!(take(0).0, 204, "there is none");
    for (number, seed) in [(1, 1.0), (2, 3.7e-9)] {
        let image = picture([13, 5], seed);
        shown(&server, number as f64, &image);
        let (status, bytes) = take(number - 1);
        assert_eq!((status, take(number).0), (200, 204));
        let length = u32::from_le_bytes(bytes[..4].try_into().expect("four")) as usize;
        let header: Value = serde_json::from_slice(&bytes[4..4 + length]).expect("JSON");
        assert_eq!((header["number"].as_u64(), length % 4), (Some(number), 0));
        assert_eq!((&header["size"], &header["origin"]), (&serde_json::json!([13, 5]), &serde_json::json!([2, 5])));
        let unit = |plane: &str| (header[plane]["exponent"].as_i64().expect("a number") as f64).exp2();
        let (units, planes) = ([unit("color"), unit("error")], bytes[4 + length..].split_at(2 * 3 * 65));
        assert_eq!(planes.1.len(), 2 * 65);
        let value = |name: &str, i: usize| f64::from(image.channel(name).expect("a channel")[i]);
        for i in 0..65 {
            for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
                let (found, wanted) = (half(&planes.0[2 * (3 * i + c)..]) * units[0], value(name, i));
                assert!((found / wanted - 1.0).abs() <= 2f64.powi(-11), "{name} of {i}: {found} for {wanted}");
            }
            let wanted = (["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| value(name, i).powi(2)).iter().sum::<f64>() / 3.0).sqrt();
            assert!((half(&planes.1[2 * i..]) * units[1] / wanted - 1.0).abs() <= 2f64.powi(-11) + 1e-6, "error of {i}");
        }
    }
    server.finish(None, "over".into());
}

/// All browsers are told of changes, also after one has gone, and the last event closes.
#[test]
fn every_browser_is_told() {
    let (server, _) = served();
    let (address, token) = parts(&server.url());
    let (mut first, mut second) = (follow(&address, &token), follow(&address, &token));
    for lines in [&mut first, &mut second] {
        assert_eq!(event(&mut *lines).expect("the state")["picture"], Value::Null);
    }
    server.tell(Progress { samples: 3.0, ..Progress::default() });
    for lines in [&mut first, &mut second] {
        assert_eq!(event(&mut *lines).expect("a change")["progress"]["samples"], 3.0);
    }
    drop(first);
    shown(&server, 4.0, &picture([4, 3], 1.0));
    let change = event(&mut second).expect("a change");
    assert_eq!((&change["picture"]["number"], &change["picture"]["size"]), (&Value::from(1), &serde_json::json!([4, 3])));
    assert_eq!(event(&mut follow(&address, &token)).expect("the state")["picture"]["number"], 1, "one that comes later knows it at once");
    server.finish(Some(Snapshot { samples: 8.0, image: picture([4, 3], 2.0), worst: vec![] }), "it is over".into());
    let last = std::iter::from_fn(|| event(&mut second)).last().expect("an end");
    assert_eq!((&last["closing"], &last["picture"]["number"]), (&Value::from("it is over"), &Value::from(2)));
}

/// Unwatched, pictures are made when the samples have doubled.
#[test]
fn pictures_that_nobody_watches_are_few() {
    let (server, _) = served();
    let image = picture([4, 3], 1.0);
    let mut made = vec![];
    for samples in 1..=64 {
        thread::sleep(Duration::from_millis(10));
        // Longer than the shortest time between two pictures.
        if samples % 16 == 0 {
            thread::sleep(Duration::from_millis(300));
        }
        let is_made = Cell::new(false);
        let make = || {
            is_made.set(true);
            image.clone()
        };
        let samples = f64::from(samples);
        server.offer(samples, make, Some(|| Snapshot { samples, image: make(), worst: vec![] }));
        made.extend(is_made.get().then_some(samples));
    }
    assert_eq!((made[0], made.last()), (1.0, Some(&64.0)), "{made:?}");
    assert!(made.windows(2).all(|pair| pair[1] >= 2.0 * pair[0]), "{made:?}");
    server.finish(None, "over".into());
}

/// Browsers that read nothing hold up neither the render, nor others, nor the end.
#[test]
fn stuck_browsers_hold_nothing_up() {
    let (server, _) = served();
    let (address, token) = parts(&server.url());
    // 8 MB as half floats: more than what the system keeps for a connection.
    let image = picture([1024, 1024], 1.0);
    shown(&server, 1.0, &image);
    let stuck: Vec<TcpStream> = (0..8)
        .map(|i| sent(&address, "GET", &format!("/{}?token={token}", if i < 4 { "picture" } else { "events" }), &address).expect("sent"))
        .collect();
    let start = Instant::now();
    for samples in 2..2000 {
        server.tell(Progress { samples: f64::from(samples), ..Progress::default() });
        let samples = f64::from(samples);
        server.offer(samples, || image.clone(), Some(|| Snapshot { samples, image: image.clone(), worst: vec![] }));
    }
    // Each of them takes microseconds, and some pictures are copied.
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    let (status, bytes) = answer(&address, "GET", &format!("/picture?token={token}"), &address);
    assert!(status == 200 && bytes.len() > 8 << 20, "another browser gets the picture");
    let start = Instant::now();
    server.finish(Some(Snapshot { samples: 2000.0, image, worst: vec![] }), "over".into());
    // Two seconds of patience, and room for a busy machine.
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    drop(stuck);
}

const SCENE: &str = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } }, "film": { "width": 40, "height": 30 },
    "sampler": { "spp": 64 }, "shapes": [{ "type": "sphere" }], "background": { "radiance": 1 } }"#;

/// A render with a page.
struct Running {
    child: Child,
    url: String,
    stderr: BufReader<std::process::ChildStderr>,
}

impl Running {
    fn start(folder: &Path, args: &[&str]) -> Running {
        let mut child = Command::new(env!("CARGO_BIN_EXE_pt"))
            .current_dir(folder)
            .args(args)
            .args(["--progress", "none", "--threads", "1", "--serve", "127.0.0.1:0"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("a process");
        let mut stderr = BufReader::new(child.stderr.take().expect("piped"));
        let mut line = String::new();
        while !line.starts_with("watch at ") {
            line.clear();
            assert!(stderr.read_line(&mut line).expect("readable") > 0, "no address");
        }
        let url = line["watch at ".len()..].trim().to_owned();
        Running { child, url, stderr }
    }

    /// Waits for the end: exit code, and what was said after the address.
    fn end(mut self) -> (Option<i32>, String) {
        let mut said = String::new();
        self.stderr.read_to_string(&mut said).expect("text");
        (self.child.wait().expect("an end").code(), said)
    }
}

impl Drop for Running {
    /// Ends a render that a failed test leaves behind.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.json"), SCENE).expect("written");
    folder
}

/// With a page, watched all the time, the file is the same as without. If the port is in use there is a warning, and the file is the same, too.
#[test]
fn a_page_does_not_change_the_render() {
    let folder = folder();
    let read = |name: &str| {
        let (image, attributes) = pt::output::read(&folder.path().join(name)).expect("readable");
        (pt::output::hash(&image), attributes)
    };
    let render = |out: &str, more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pt"));
        let output =
            command.current_dir(folder.path()).args(["scene.json", "--progress", "none", "-o", out]).args(more).output().expect("a run");
        assert!(output.status.success());
        (read(out), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (alone, _) = render("alone.exr", &[]);
    let running = Running::start(folder.path(), &["scene.json", "-o", "watched.exr"]);
    let (address, token) = parts(&running.url);
    let mut pictures = 0;
    let mut events = follow(&address, &token);
    while event(&mut events).is_some() {
        // The render may end before it answers.
        let mut bytes = vec![];
        let asked = sent(&address, "GET", &format!("/picture?token={token}"), &address);
        let is_whole = asked.and_then(|mut stream| stream.read_to_end(&mut bytes)).is_ok();
        pictures += u32::from(is_whole && bytes.starts_with(b"HTTP/1.1 200"));
    }
    assert_eq!(running.end().0, Some(0));
    assert!(pictures > 0, "it was watched");
    assert_eq!(read("watched.exr"), alone);

    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("bound").to_string();
    let (unseen, said) = render("unseen.exr", &["--serve", &address]);
    assert_eq!((unseen, said.matches("warning: ").count()), (alone, 1), "{said}");
    assert!(said.contains(&format!("warning: no page at {address} (")) && !said.contains("watch at"), "{said}");
}

/// A render that would take for ever is ended by the page: its files are there, and it exits as after Ctrl-C.
#[test]
fn the_page_ends_the_render_as_an_interrupt_does() {
    let folder = folder();
    let running = Running::start(folder.path(), &["scene.json", "--spp", "4000000000", "-o", "x.exr", "-o", "x.png"]);
    let (address, token) = parts(&running.url);
    let mut events = follow(&address, &token);
    while event(&mut events).expect("an event")["picture"].is_null() {}
    assert_eq!(answer(&address, "POST", &format!("/stop?token={token}"), &address).0, 202);
    let last = std::iter::from_fn(|| event(&mut events)).last().expect("an end");
    let (code, said) = running.end();
    assert_eq!(code, Some(130), "{said}");
    let closing = last["closing"].as_str().expect("a closing line");
    assert!(closing.contains(" · interrupted") && said.contains(closing), "{closing}\n{said}");
    let (_, attributes) = pt::output::read(&folder.path().join("x.exr")).expect("readable");
    let taken = attributes.iter().find(|(name, _)| name == "pt/spp").expect("a number of samples").1.to_string();
    assert_eq!(taken.parse::<f64>().expect("a number"), last["picture"]["samples"].as_f64().expect("a number"), "{taken}");
    assert!(folder.path().join("x.png").exists());
}

#[test]
fn addresses_that_others_reach_and_none_are_refused() {
    let folder = folder();
    let refused = [
        (&["--serve", "0.0.0.0:0"][..], "error: --serve 0.0.0.0:0: other machines reach this address; --serve-any allows it"),
        (&["--serve", "127.0.0.1"], "error: --serve 127.0.0.1: expected HOST:PORT, such as 127.0.0.1:0; "),
        (&["--serve", "nowhere.invalid:80"], "error: --serve nowhere.invalid:80: expected HOST:PORT"),
        (&["--serve-any"], "--serve <HOST:PORT>"),
        (&["--serve", "127.0.0.1:0", "--pixel", "1,1"], "cannot be used with"),
        (&["--serve", "127.0.0.1:0", "--frames", "1..2"], "cannot be used with"),
    ];
    for (args, phrase) in refused {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pt"));
        let output = command.current_dir(folder.path()).arg("scene.json").args(args).output().expect("a run");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(phrase), "{args:?}: {said}");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_pt"));
    let args = ["scene.json", "--spp", "1", "-o", "x.exr", "--serve", "0.0.0.0:0", "--serve-any"];
    let output = command.current_dir(folder.path()).args(args).output().expect("a run");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.contains("watch at http://127.0.0.1:"), "{said}");
}
