//! The page of a running render in a real browser.

use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{Running, parts};
use crate::report::browser::Browser;

/// Longest wait for something on a page. Checkpoints of a comparison come after twice the time each.
const PATIENCE: Duration = Duration::from_secs(150);

/// A page, and how it is asked.
pub struct Page {
    pub browser: Browser,
}

impl Page {
    /// Waits until the value of a JavaScript expression is true.
    pub fn waits_for(&self, what: &str) {
        let start = Instant::now();
        while self.browser.run(&format!("return Boolean({what})")) != json!(true) {
            assert!(start.elapsed() < PATIENCE, "waited for: {what}");
            thread::sleep(Duration::from_millis(50));
        }
    }

    pub fn text(&self, id: &str) -> String {
        self.browser.run(&format!("return document.getElementById({}).textContent", json!(id))).as_str().expect("text").to_owned()
    }

    pub fn state(&self, name: &str) -> Value {
        self.browser.run(&format!("return window.pt.state()[{}]", json!(name)))
    }

    /// The bytes of all pixels on the screen, summed up.
    fn screen(&self) -> f64 {
        let sum = "const c = document.getElementById('canvas'); \
                   return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.reduce((sum, v) => sum + v, 0)";
        self.browser.run(sum).as_f64().expect("a number")
    }

    /// The picture gets better by itself: its numbers and its words change.
    fn changes(&self) {
        self.waits_for("window.pt");
        self.browser.run("window.before = [JSON.stringify(pt.read(40, 30)), document.getElementById('samples').textContent]");
        self.waits_for("JSON.stringify(pt.read(40, 30)) !== before[0] && document.getElementById('samples').textContent !== before[1]");
        assert!(self.text("elapsed").contains(" so far"), "{}", self.text("elapsed"));
        self.waits_for("document.getElementById('relative-error').textContent.endsWith(' %')");
        self.waits_for("document.getElementById('words').textContent.includes(' % would take about ')");
    }

    /// The error lies over the picture in false colours, with a scale. What compares pictures is not there.
    fn shows_its_error(&self) {
        let picture = self.screen();
        self.browser.click("[data-overlay=bar]");
        assert_eq!(
            (self.state("overlay"), self.browser.run("return document.getElementById('scale').hidden")),
            (json!("bar"), json!(false))
        );
        assert!(self.text("scale-title").contains("standard error"));
        assert_ne!(self.screen(), picture);
        self.browser.press("b");
        assert_eq!(self.state("overlay"), "picture");
        self.browser.press("dpwxm");
        assert_eq!((self.state("overlay"), self.state("split"), self.state("view")), (json!("picture"), Value::Null, json!("render")));
    }

    /// The first of the worst pixels explains itself by the same text as the command that it names.
    fn explains_the_worst_pixel(&self, folder: &Path) {
        self.waits_for("document.querySelectorAll('#worst a').length === 8");
        self.browser.run("document.querySelector('#worst a').id = 'first'");
        self.browser.click("#first");
        self.waits_for("document.getElementById('explanation').textContent.includes('--trace')");
        let (text, title) = (self.text("explanation"), self.text("explained-title"));
        let pixel = self.browser.run("return window.pt.chosen()");
        assert!(title.contains(&format!("pixel {}, {} ", pixel[0], pixel[1])), "{title} for {pixel}");
        let (told, trace) = text.split_once("\n\n").expect("words and a trace");
        let command = told.lines().last().expect("a command").trim().strip_prefix("pt ").expect("a call of pt");
        let output = Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).args(command.split(' ')).output().expect("a run");
        assert_eq!(String::from_utf8_lossy(&output.stdout), trace, "{command}");
        // Any other pixel, too.
        self.browser.run("window.pt.choose(5, 6)");
        self.browser.click("#explain");
        self.waits_for("document.getElementById('explanation').textContent.startsWith('Pixel 5, 6: ')");
    }

    pub fn photograph(&self, name: &str) {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("serve-{name}.png"));
        std::fs::write(path, self.browser.screenshot(true)).expect("a picture");
    }
}

/// A render that would take for ever is watched by two browsers, at the width of a desk and of a phone, and ended by a click.
#[test]
fn the_page_of_a_render_works_in_a_browser() {
    let Some(browser) = Browser::open() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-box.json"), folder.path().join("cornell-box.json"))
        .expect("copied");
    let running = Running::start(folder.path(), &["cornell-box.json", "--size", "96x72", "--spp", "4000000", "-o", "box.exr"]);
    let page = Page { browser };
    page.browser.prefer("light");
    page.browser.resize(1400, 900);
    page.browser.go(&running.url);
    page.changes();
    page.browser.is_labelled();
    page.shows_its_error();
    page.explains_the_worst_pixel(folder.path());
    page.browser.fits(1400, 900);
    page.photograph("1400-light");

    // A second browser, as narrow as a phone, sees the same, and going away it disturbs nothing.
    let second = Page { browser: Browser::open().expect("another browser") };
    second.browser.resize(390, 844);
    let (address, _) = parts(&running.url);
    second.browser.go(&format!("http://{address}/?token={}", "0".repeat(32)));
    assert!(second.browser.run("return document.body.textContent").as_str().expect("text").starts_with("expected the address"));
    second.browser.complaints();
    second.browser.go(&running.url);
    second.changes();
    second.shows_its_error();
    second.explains_the_worst_pixel(folder.path());
    second.browser.fits(390, 844);
    second.photograph("390-light");
    second.browser.prefer("dark");
    second.photograph("390-dark");
    assert_eq!(second.browser.complaints(), [""; 0], "the console is quiet");
    drop(second);
    page.changes();

    // Who changes their mind goes on.
    page.browser.click("#end");
    page.browser.click("#confirm button:not(#end-now)");
    page.changes();
    page.browser.click("#end");
    page.browser.click("#end-now");
    page.waits_for("document.getElementById('phase').textContent === 'Rendered'");
    let (code, said) = running.end();
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains(&page.text("words")) && page.text("words").contains(" · interrupted"), "{said}\n{}", page.text("words"));
    page.browser.fits(1400, 900);
    page.photograph("1400-ended");
    // The page has the picture of the file, in half floats.
    let (image, _) = pt::output::exr::read(&folder.path().join("box.exr")).expect("readable");
    for (x, y) in [(0, 0), (40, 30), (95, 71)] {
        let found = page.browser.run(&format!("return window.pt.read({x}, {y})[0].rgb"));
        for (c, wanted) in image.rgb(x, y).into_iter().map(f64::from).enumerate() {
            let found = found[c].as_f64().expect("a number");
            assert!((found - wanted).abs() <= wanted * 2f64.powi(-11), "pixel {x}, {y}: {found} for {wanted}");
        }
    }
    assert_eq!(page.browser.complaints(), [""; 0], "the console is quiet");
}
