//! The protocol of the viewer tev, byte by byte; and no behaviour of a viewer disturbs a render.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use glam::UVec2;
use pt::film::{Channel, Image};
use pt::output::tev::Viewer;
use tev_client::{PacketCloseImage, PacketCreateImage, PacketOpenImage, PacketReloadImage, PacketUpdateImage, TevClient};

use crate::random::Random;

/// A listening port of this machine, and its address.
fn listener() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound").to_string();
    (listener, address)
}

/// Accepts the next connection. The test fails after some time if there is none.
fn caller(listener: &TcpListener) -> TcpStream {
    listener.set_nonblocking(true).expect("a mode");
    let came = || {
        thread::sleep(Duration::from_millis(1));
        listener.accept().ok()
    };
    let (stream, _) = (0..60_000).find_map(|_| came()).expect("a caller");
    stream.set_nonblocking(false).expect("a mode");
    stream
}

fn everything(mut stream: TcpStream) -> Vec<u8> {
    let mut bytes = vec![];
    stream.read_to_end(&mut bytes).expect("the sender shuts down");
    bytes
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// The expected bytes are derived by hand from the layout in tev's `Ipc.h`.
#[test]
fn packets_are_those_of_the_protocol() {
    let sent = |send: &dyn Fn(&mut TevClient)| {
        let (listener, address) = listener();
        let mut client = TevClient::wrap(TcpStream::connect(address).expect("it listens"));
        send(&mut client);
        drop(client);
        hex(&everything(caller(&listener)))
    };
    let create = sent(&|client| {
        let packet = PacketCreateImage { image_name: "t", grab_focus: true, width: 2, height: 1, channel_names: &["R", "G", "B"] };
        client.send(packet).expect("sent");
    });
    assert_eq!(create, "1a00000004017400020000000100000003000000520047004200");
    let update = sent(&|client| {
        let packet = PacketUpdateImage {
            image_name: "t",
            grab_focus: false,
            channel_names: &["R", "G", "B"],
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: 0,
            y: 0,
            width: 2,
            height: 1,
            data: &[1.0, 0.5, 0.25, 0.0, 0.0, 2.0],
        };
        client.send(packet).expect("sent");
    });
    let expected = "6a0000000600740003000000520047004200000000000000000002000000010000000000000000000000010000000000000002000000000000000300\
        000000000000030000000000000003000000000000000000803f0000003f0000803e000000000000000000000040";
    assert_eq!(update, expected.replace(' ', ""));
    assert_eq!(sent(&|client| client.send(PacketCloseImage { image_name: "t" }).expect("sent")), "07000000027400");
    assert_eq!(sent(&|client| client.send(PacketReloadImage { image_name: "t", grab_focus: false }).expect("sent")), "0800000001007400");
    let open = PacketOpenImage { image_name: "/a.exr", grab_focus: true, channel_selector: "" };
    let open = std::cell::Cell::new(Some(open));
    let opened = sent(&|client| client.send(open.take().expect("once")).expect("sent"));
    assert_eq!(opened, "0e00000007012f612e6578720000");
}

/// Picture that a viewer has put together from packets.
#[derive(Default)]
struct Screen {
    name: String,
    size: UVec2,
    /// Red, green, blue.
    pixels: Vec<[f32; 3]>,
    created: usize,
    /// Corner and size of every tile, in the order of their arrival.
    tiles: Vec<(UVec2, UVec2)>,
}

/// Reads fields one after the other.
struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_first_chunk().expect("a field");
        self.0 = rest;
        *head
    }

    fn int(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    fn long(&mut self) -> usize {
        u64::from_le_bytes(self.bytes()) as usize
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|b| *b == 0).expect("a text ends");
        let text = String::from_utf8(self.0[..end].to_vec()).expect("UTF-8");
        self.0 = &self.0[end + 1..];
        text
    }
}

impl Screen {
    /// The next packet of a stream; false at its end.
    fn receive(&mut self, stream: &mut TcpStream) -> bool {
        let mut length = [0; 4];
        if stream.read_exact(&mut length).is_err() {
            return false;
        }
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut bytes).expect("a whole packet");
        let mut packet = Packet(&bytes);
        let ([kind], [_grab_focus], name) = (packet.bytes(), packet.bytes(), packet.text());
        match kind {
            4 => self.create(name, &mut packet),
            6 => self.update(&name, &mut packet),
            _ => panic!("packet of kind {kind}"),
        }
        assert!(packet.0.is_empty(), "nothing follows");
        true
    }

    fn create(&mut self, name: String, packet: &mut Packet) {
        (self.name, self.size) = (name, UVec2::new(packet.int(), packet.int()));
        let channels: Vec<String> = (0..packet.int()).map(|_| packet.text()).collect();
        assert_eq!(channels, ["R", "G", "B"]);
        self.pixels = vec![[0.0; 3]; (self.size.x * self.size.y) as usize];
        self.created += 1;
    }

    fn update(&mut self, name: &str, packet: &mut Packet) {
        assert_eq!(name, self.name);
        let channels: Vec<String> = (0..packet.int()).map(|_| packet.text()).collect();
        assert_eq!(channels, ["R", "G", "B"]);
        let [x, y, width, height] = [0; 4].map(|_| packet.int());
        assert!(x + width <= self.size.x && y + height <= self.size.y, "tev drops a tile that reaches beyond the picture");
        let [offsets, strides] = [0; 2].map(|_| [0; 3].map(|_| packet.long()));
        let count = (width * height) as usize;
        let needed = (0..3).map(|c| offsets[c] + (count - 1) * strides[c] + 1).max().expect("three");
        let data: Vec<f32> = (0..needed).map(|_| f32::from_le_bytes(packet.bytes())).collect();
        for p in 0..count {
            let at = (y + p as u32 / width) * self.size.x + x + p as u32 % width;
            self.pixels[at as usize] = [0, 1, 2].map(|c| data[offsets[c] + p * strides[c]]);
        }
        self.tiles.push((UVec2::new(x, y), UVec2::new(width, height)));
    }

    /// Whether this part of the screen shows the picture, bit for bit.
    fn shows(&self, image: &Image) -> bool {
        let at = |x: u32, y: u32| self.pixels[((y + image.origin.y) * self.size.x + x + image.origin.x) as usize];
        let bits = |pixel: [f32; 3]| pixel.map(f32::to_bits);
        let mut places = (0..image.size.y).flat_map(|y| (0..image.size.x).map(move |x| (x, y)));
        self.size == image.full_size && places.all(|(x, y)| bits(at(x, y)) == bits(image.rgb(x, y)))
    }
}

/// Starts a viewer that accepts one connection and shows what it receives. It sends the number of tiles after every packet.
fn screen(listener: TcpListener) -> (JoinHandle<Screen>, Receiver<usize>) {
    let (tell, told) = channel();
    let run = move || {
        let mut stream = caller(&listener);
        let mut screen = Screen::default();
        while screen.receive(&mut stream) {
            let _ = tell.send(screen.tiles.len());
        }
        screen
    };
    (thread::spawn(run), told)
}

fn noise(size: [u32; 2], seed: u64) -> Image {
    let mut random = Random::new(seed);
    let mut values = || (0..size[0] * size[1]).map(|_| random.unit() as f32).collect();
    let channels = ["B", "G", "R", "StdErr.R"].map(|name| Channel { name: name.into(), values: values() }).into();
    Image { full_size: size.into(), origin: UVec2::ZERO, size: size.into(), channels }
}

/// Returns a function that collects warnings, and the collected warnings.
fn warnings() -> (impl Fn(&str) + Send, Arc<Mutex<Vec<String>>>) {
    let heard = Arc::new(Mutex::new(vec![]));
    let hear = heard.clone();
    (move |text: &str| hear.lock().expect("unpoisoned").push(text.to_owned()), heard)
}

fn silent(text: &str) {
    panic!("{text}");
}

/// Waits until the viewer has at least this number of tiles.
fn wait_for(told: &Receiver<usize>, tiles: usize) {
    while told.recv_timeout(Duration::from_secs(60)).expect("tiles come") < tiles {}
}

/// The first picture is created and all its tiles are sent; of a second picture only the tiles that differ are sent; of a third, which is
/// the same, none.
#[test]
fn only_changed_tiles_are_sent() {
    let (listener, address) = listener();
    let (screen, told) = screen(listener);
    let viewer = Viewer::start(&address, "scene ä", silent);
    let mut image = noise([300, 140], 1);
    viewer.show(image.clone());
    wait_for(&told, 6);
    // NaN is not equal to itself, but is sent only once.
    image.channels[1].values[139 * 300 + 299] = f32::NAN;
    viewer.show(image.clone());
    wait_for(&told, 7);
    viewer.show(image.clone());
    viewer.finish();
    let screen = screen.join().expect("no violation");
    assert!(screen.shows(&image));
    assert_eq!((screen.name, screen.created), (format!("scene ä ({})", std::process::id()), 1));
    let tile = |x, y, w, h| (UVec2::new(x, y), UVec2::new(w, h));
    let first = [tile(0, 0, 128, 128), tile(128, 0, 128, 128), tile(256, 0, 44, 128)];
    let second = [tile(0, 128, 128, 12), tile(128, 128, 128, 12), tile(256, 128, 44, 12), tile(256, 128, 44, 12)];
    assert_eq!(screen.tiles, [first.as_slice(), &second].concat());
}

/// A crop is shown at its position in the whole picture. A picture of another size is created anew.
#[test]
fn crops_lie_where_they_belong() {
    let (listener, address) = listener();
    let (screen, told) = screen(listener);
    let viewer = Viewer::start(&address, "crop", silent);
    viewer.show(noise([10, 10], 2));
    wait_for(&told, 1);
    let part = Image { full_size: UVec2::new(50, 40), origin: UVec2::new(7, 9), ..noise([30, 20], 3) };
    viewer.show(part.clone());
    viewer.finish();
    let screen = screen.join().expect("no violation");
    assert!(screen.shows(&part) && screen.created == 2);
    assert_eq!(screen.pixels.iter().filter(|p| **p != [0.0; 3]).count(), 600);
}

/// A viewer that reads nothing until all pictures were given does not delay the render, and shows the last picture.
#[test]
fn showing_never_waits_and_the_latest_wins() {
    let (listener, address) = listener();
    let (go, gone) = channel();
    let reader = thread::spawn(move || {
        let mut stream = caller(&listener);
        gone.recv().expect("all were given");
        let mut screen = Screen::default();
        while screen.receive(&mut stream) {}
        screen
    });
    let viewer = Viewer::start(&address, "many", silent);
    // The pictures have 12 MB each, more than the buffers of sockets.
    let images: Vec<Image> = (0..8).map(|seed| noise([1000, 1000], seed)).collect();
    images.iter().for_each(|image| viewer.show(image.clone()));
    go.send(()).expect("the reader waits");
    viewer.finish();
    let screen = reader.join().expect("no violation");
    assert!(screen.shows(&images[7]) && screen.created == 1);
    assert!(screen.tiles.len() < 8 * 64, "some pictures are forgotten");
}

/// If there is no viewer, or it has ended, there is one warning, and the render is not delayed.
#[test]
fn a_missing_viewer_is_reported_once() {
    let (listener, address) = listener();
    drop(listener);
    let (warn, heard) = warnings();
    let viewer = Viewer::start(&address, "nobody", warn);
    (0..5).for_each(|seed| {
        viewer.show(noise([20, 20], seed));
        thread::sleep(Duration::from_millis(20));
    });
    viewer.finish();
    let heard = heard.lock().expect("unpoisoned").clone();
    assert_eq!(heard.len(), 1, "{heard:?}");
    let expected = format!("the viewer at {address} cannot be reached (");
    assert!(heard[0].starts_with(&expected) && heard[0].ends_with("); the render goes on"), "{heard:?}");

    for nonsense in ["nonsense", "127.0.0.1:port", "127.0.0.1:99999", ""] {
        let (warn, heard) = warnings();
        let viewer = Viewer::start(nonsense, "nobody", warn);
        viewer.show(noise([20, 20], 1));
        viewer.finish();
        assert_eq!(heard.lock().expect("unpoisoned").len(), 1, "{nonsense:?}");
    }
    // Without a picture no connection is made.
    let (warn, heard) = warnings();
    Viewer::start("nonsense", "nobody", warn).finish();
    assert!(heard.lock().expect("unpoisoned").is_empty());
}

/// A viewer that ends during a render and starts again gets the whole picture again.
#[test]
fn a_viewer_that_reconnects_gets_the_whole_picture() {
    let (listener, address) = listener();
    let again = listener.try_clone().expect("the same port");
    let (warn, heard) = warnings();
    let viewer = Viewer::start(&address, "back", warn);
    let (mut image, other) = (noise([300, 140], 4), noise([300, 140], 5));
    viewer.show(image.clone());
    let mut stream = caller(&listener);
    let mut first = Screen::default();
    while first.tiles.len() < 6 {
        assert!(first.receive(&mut stream));
    }
    drop(stream);
    // The first write after that may still succeed, because the system notices only from the answer that the connection is closed.
    let mut seed = 0;
    while heard.lock().expect("unpoisoned").is_empty() {
        image = noise([300, 140], 100 + seed);
        seed += 1;
        viewer.show(image.clone());
        thread::sleep(Duration::from_millis(10));
    }
    let (screen, _) = screen(again);
    viewer.show(other.clone());
    viewer.finish();
    let screen = screen.join().expect("no violation");
    // All six tiles arrive, or twelve if an attempt came before the last picture.
    assert!(screen.shows(&other) && screen.created == 1 && screen.tiles.len() >= 6);
    let heard = heard.lock().expect("unpoisoned").clone();
    assert!(heard.len() == 1 && heard[0].contains(" went away ("), "{heard:?}");
}

/// A picture that takes long to make is made less often: this takes at most a hundredth of the time that has passed.
#[test]
fn expensive_pictures_are_made_rarely() {
    let (listener, address) = listener();
    let (screen, _) = screen(listener);
    let viewer = Viewer::start(&address, "offers", silent);
    let image = noise([30, 20], 6);
    let (start, mut made) = (Instant::now(), 0);
    for _ in 0..50 {
        viewer.offer(|| {
            made += 1;
            thread::sleep(Duration::from_millis(100));
            image.clone()
        });
    }
    // The first is made at once, each other one 100 · 0.1 s after the one before it.
    let passed = start.elapsed().as_secs_f64();
    assert!(made >= 1 && f64::from(made - 1) <= passed / 10.0, "{made} in {passed} s");
    let last = noise([30, 20], 7);
    viewer.show(last.clone());
    viewer.finish();
    assert!(screen.join().expect("no violation").shows(&last));
}

/// If the other end is no viewer, sends data or does not read, closing the connection still ends.
#[test]
fn closing_a_viewer_always_ends() {
    let (listener, address) = listener();
    let talker = thread::spawn(move || {
        let mut stream = caller(&listener);
        while stream.write_all(&[7; 1000]).is_ok() {}
    });
    let (warn, _) = warnings();
    let viewer = Viewer::start(&address, "talker", warn);
    viewer.show(noise([30, 20], 8));
    viewer.finish();
    talker.join().expect("its caller is gone");
}

/// With `--display-server` the viewer finally shows the picture of the file, and the file is the same as without a viewer. If there is no
/// viewer at the address, the file is also the same, and there is a warning.
#[test]
fn a_viewer_does_not_change_the_render() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } }, "film": { "width": 40, "height": 30 },
        "sampler": { "spp": 4 }, "shapes": [{ "type": "sphere" }], "background": { "radiance": 1 } }"#;
    std::fs::write(folder.path().join("scene.json"), scene).expect("written");
    let render = |out: &str, more: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("pt").expect("the binary");
        let output = command.current_dir(folder.path()).args(["scene.json", "--progress", "none", "-o", out]).args(more).assert().success();
        let (image, attributes) = pt::output::read(&folder.path().join(out)).expect("readable");
        ((pt::output::hash(&image), attributes), String::from_utf8_lossy(&output.get_output().stderr).into_owned())
    };
    let (alone, _) = render("alone.exr", &[]);
    let (listener, address) = listener();
    let (screen, _) = screen(listener);
    assert_eq!(render("shown.exr", &["--display-server", &address]).0, alone);
    let screen = screen.join().expect("no violation");
    let image = pt::output::read(&folder.path().join("shown.exr")).expect("readable").0;
    assert!(screen.shows(&image) && screen.name.starts_with("scene ("), "{}", screen.name);

    // No viewer listens at the address any more.
    let (unseen, said) = render("unseen.exr", &["--display-server", &address]);
    assert_eq!((unseen, said.matches("warning: ").count()), (alone, 1), "{said}");
    assert!(said.contains(&format!("warning: the viewer at {address} cannot be reached (")), "{said}");
}
