//! Cost of a viewer: CPU time of the Cornell box at 512², with a viewer relative to without.
//!
//! `cargo bench --bench viewer [-- PAIRS]`: 32 samples per pixel, and the viewer is another process that reads and discards all data, as
//! tev would get it.
//!
//! `cargo bench --bench viewer -- page [PAIRS [SPP]]`: the program `pt` with `--serve`, 256 samples per pixel, and a client that takes each
//! picture as the page does. It reads processor times from `/proc`, so that it needs Linux.
//!
//! The pairs of runs (default 16) are in alternating order. The viewer's own CPU time is not counted.

mod subject;

use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};

use cpu_time::ProcessTime;
use pt::film::{Film, FilmSpec, MomentFilm, PixelSums, Wave};
use pt::output::tev::Viewer;
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;
use statrs::distribution::{ContinuousCDF, StudentsT};
use subject::Subject;

const SAMPLES: u64 = 32;

/// Argument that makes a copy of this program the viewer.
const LISTEN: &str = "--listen";

fn main() -> pt::Result<()> {
    if std::env::args().any(|arg| arg == LISTEN) {
        listen();
        return Ok(());
    }
    let mut numbers = std::env::args().filter_map(|arg| arg.parse::<usize>().ok());
    let (pairs, samples) = (numbers.next().unwrap_or(16), numbers.next().unwrap_or(256));
    if std::env::args().any(|arg| arg == "page") {
        program_seconds(samples, true);
        compare(pairs, |is_watched| program_seconds(samples, is_watched));
        return Ok(());
    }
    let subject = Subject::load("cornell-box", &[])?;
    let (mut viewer, address) = viewer();
    let seconds = |is_watched: bool| cpu_seconds(&subject, is_watched.then_some(&address));
    seconds(true);
    compare(pairs, seconds);
    let _ = viewer.kill();
    Ok(())
}

/// Prints the ratio of the times with a viewer to those without.
///
/// - `seconds`: CPU time (s) of a run, with a viewer or without
fn compare(pairs: usize, seconds: impl Fn(bool) -> f64) {
    let ratio = |pair: usize| {
        let first = pair.is_multiple_of(2);
        let (a, b) = (seconds(first), seconds(!first));
        (if first { a / b } else { b / a }).ln()
    };
    let logs: Vec<f64> = (0..pairs).map(ratio).collect();
    let (low, middle, high) = interval(&logs);
    println!("watched / unwatched: {middle:.4} (95 %: {low:.4}-{high:.4}), {pairs} pairs");
}

/// CPU time (s) of a render by the program.
///
/// - `is_watched`: with a page, whose pictures a client takes
fn program_seconds(samples: usize, is_watched: bool) -> f64 {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.json");
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pt"));
    command.args([scene, "--size", "512x512", "--spp", &samples.to_string(), "-o", "a.exr"]).current_dir(&folder);
    if is_watched {
        command.args(["--serve", "127.0.0.1:0"]);
    }
    let mut render = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program");
    let mut said = BufReader::new(render.stderr.take().expect("piped"));
    if is_watched {
        let mut line = String::new();
        while !line.contains("http://") {
            line.clear();
            assert!(said.read_line(&mut line).is_ok_and(|count| count > 0), "the program ended without an address");
        }
        let url = line[line.find("http://").expect("found above")..].trim();
        watch(url);
    }
    let _ = std::io::copy(&mut said, &mut std::io::sink());
    let seconds = ended_after(render.id());
    assert!(render.wait().is_ok_and(|status| status.success()), "the render failed");
    seconds
}

/// Takes each picture of a page until the render ends, as the script of the page does.
fn watch(url: &str) {
    let (page, query) = url.split_once("/?").expect("an address with a token");
    let events = ureq::get(&format!("{page}/events?{query}")).call().expect("events");
    let mut since = 0;
    for line in BufReader::new(events.into_body().into_reader()).lines().map_while(Result::ok) {
        let Some(state) = line.strip_prefix("data:") else { continue };
        let state: serde_json::Value = serde_json::from_str(state).expect("a state");
        if state["picture"]["number"].as_u64().is_none_or(|number| number <= since) {
            continue;
        }
        let picture = ureq::get(&format!("{page}/picture?since={since}&{query}")).call().expect("a picture");
        let mut bytes = vec![];
        picture.into_body().into_reader().read_to_end(&mut bytes).expect("a whole picture");
        // A newer picture than that of the event may have come. Its header tells which.
        let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
        let header: serde_json::Value = serde_json::from_slice(&bytes[4..][..length]).expect("a header");
        since = header["number"].as_u64().expect("a number");
    }
    assert!(since > 0, "no picture was shown");
}

/// Waits for the end of a process that has not been waited for. Returns its CPU time (s).
fn ended_after(process: u32) -> f64 {
    loop {
        let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).expect("`/proc`, as Linux has it");
        // State, then 10 other fields, then the times in user and in system mode, in hundredths of a second.
        let fields: Vec<&str> = stat.rsplit_once(')').expect("a name").1.split_whitespace().collect();
        if fields[0] == "Z" {
            return fields[11..13].iter().map(|ticks| ticks.parse::<f64>().expect("a number")).sum::<f64>() / 100.0;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

/// Reads and discards data from one connection after the other.
fn listen() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    println!("{}", listener.local_addr().expect("bound"));
    for mut stream in listener.incoming().flatten() {
        let mut buffer = vec![0; 1 << 16];
        while stream.read(&mut buffer).is_ok_and(|count| count > 0) {}
    }
}

/// Viewer process and its address.
fn viewer() -> (Child, String) {
    let program = std::env::current_exe().expect("a program");
    let mut child = Command::new(program).arg(LISTEN).stdout(Stdio::piped()).spawn().expect("a process");
    let mut address = String::new();
    BufReader::new(child.stdout.take().expect("piped")).read_line(&mut address).expect("an address");
    (child, address.trim().into())
}

fn cpu_seconds(subject: &Subject, address: Option<&String>) -> f64 {
    let settings = Settings::new(SamplerSpec { spp: SAMPLES, ..SamplerSpec::default() });
    let start = ProcessTime::now();
    let viewer = address.map(|address| Viewer::start(address, "cornell-box", |text| panic!("{text}")));
    let mut film = Watched { film: MomentFilm::new(subject.spec.clone()), viewer };
    render(subject.scene.clone(), &*subject.integrator, &mut film, &settings, &Silent);
    drop(film);
    start.elapsed().as_secs_f64()
}

/// Film that sends the picture to a viewer, as `pt --display-server` does.
struct Watched {
    film: MomentFilm,
    viewer: Option<Viewer>,
}

impl Film for Watched {
    fn spec(&self) -> &FilmSpec {
        self.film.spec()
    }

    fn add(&mut self, wave: Wave, block: PixelSums) {
        self.film.add(wave, block);
        if let Some(viewer) = &self.viewer {
            viewer.offer(|| self.film.image());
        }
    }
}

/// Mean ratio and its confidence interval, from the logarithms of the ratios by Student's t.
fn interval(logs: &[f64]) -> (f64, f64, f64) {
    let n = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / n;
    let variance = logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let reach = StudentsT::new(0.0, 1.0, n - 1.0).expect("two pairs").inverse_cdf(0.975) * (variance / n).sqrt();
    ((mean - reach).exp(), mean.exp(), (mean + reach).exp())
}
