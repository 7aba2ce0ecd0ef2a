//! Cost of a viewer: CPU time of the Cornell box at 512² with 32 samples per pixel, with a viewer relative to without.
//!
//! `cargo bench --bench viewer [-- PAIRS]`: the number of pairs of runs (default 16), in alternating order. The viewer is another process
//! that reads and discards all data; its own CPU time is not counted.

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
    let pairs: usize = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(16);
    let subject = Subject::load("cornell-box", &[])?;
    let (mut viewer, address) = viewer();
    let seconds = |is_watched: bool| cpu_seconds(&subject, is_watched.then_some(&address));
    seconds(true);
    let ratio = |pair: usize| {
        let first = pair.is_multiple_of(2);
        let (a, b) = (seconds(first), seconds(!first));
        (if first { a / b } else { b / a }).ln()
    };
    let logs: Vec<f64> = (0..pairs).map(ratio).collect();
    let _ = viewer.kill();
    let (low, middle, high) = interval(&logs);
    println!("watched / unwatched: {middle:.4} (95 %: {low:.4}-{high:.4}), {pairs} pairs");
    Ok(())
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
