//! The page of a report in a real browser, opened from its file.

use std::fs;
use std::path::Path;

use pt::compare::{Comparison, Snapshot, report};
use pt::film::Image;
use pt::measure::Metric;
use pt::measure::metric::{ImagePair, Named};
use pt::output::Tonemap;
use pt::output::exr;
use pt::output::tonemap::srgb;
use serde_json::json;

use super::browser::{Browser, point};
use super::synthetic::{ORIGIN, SIZE, comparison};

const SHIFT: char = '\u{e008}';
const ESCAPE: &str = "\u{e00c}";
const LEFT: &str = "\u{e012}";
const RIGHT: &str = "\u{e014}";
const DOWN: &str = "\u{e015}";

/// A pixel of the wall and one of the lamp, which is brighter than a screen, in the whole picture.
const WALL: [u32; 2] = [ORIGIN.x + 5, ORIGIN.y + 9];
const LAMP: [u32; 2] = [ORIGIN.x + 73, ORIGIN.y + 16];
/// Pixel on the wall, a little below the lamp.
const BESIDE: [u32; 2] = [ORIGIN.x + 73, ORIGIN.y + 26];

#[test]
fn the_page_works_in_a_browser() {
    let Some(browser) = Browser::open() else { return };
    let report = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    report::write(&comparison(), &report, true).expect("a report");
    let page = Page { browser, pictures: pictures(&report.join("jeri")) };
    page.browser.prefer("light");
    page.browser.resize(1400, 900);
    page.browser.visit(&report.join("index.html"));

    page.is_self_contained();
    page.is_labelled();
    page.reads_what_the_files_hold();
    page.flips();
    page.tones();
    page.zooms_and_pans();
    page.splits();
    page.shows_errors();
    page.shows_equal_times_and_equal_errors(&comparison());
    page.swaps();
    page.shows_flip(&comparison());
    page.crops_show_the_same_part();
    page.tells_how_it_was_made(&comparison());
    page.explains_its_keys();
    page.fits(1400, 900);
    page.browser.resize(1280, 800);
    page.fits(1280, 800);

    page.browser.resize(390, 844);
    page.fits(390, 844);
    page.is_touched();
    assert_eq!(page.browser.complaints(), [""; 0], "the console is quiet");
    page.photograph();
}

/// Nothing is wider than the window for 2 methods, and for 8 with long names.
#[test]
fn the_page_fits_for_two_to_eight_methods() {
    let Some(browser) = Browser::open() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = Page { browser, pictures: vec![] };
    let full = comparison();
    for count in [2, 8] {
        let mut some = Comparison { methods: full.methods.iter().cycle().take(count).cloned().collect(), ..full.clone() };
        some.methods[1].name = "bidirectional · independent".into();
        report::write(&some, folder.path(), false).expect("a report");
        page.browser.visit(&folder.path().join("index.html"));
        for (width, height) in [(1280, 800), (390, 844)] {
            page.browser.resize(width, height);
            page.fits(width, height);
        }
    }
    assert_eq!(page.browser.complaints(), [""; 0], "the console is quiet");
}

/// The pictures of the report's files: the reference, then each method's render.
fn pictures(folder: &Path) -> Vec<Image> {
    let files = ["reference", "path.render", "nee.render", "nee-sobol.render", "whitted.render"];
    files.iter().map(|stem| exr::read(&folder.join(format!("{stem}.exr"))).expect("EXR").0).collect()
}

struct Page {
    browser: Browser,
    pictures: Vec<Image>,
}

impl Page {
    fn state(&self, name: &str) -> serde_json::Value {
        self.browser.run(&format!("return window.pt.state()[{}]", json!(name)))
    }

    fn number(&self, name: &str) -> f64 {
        self.state(name).as_f64().unwrap_or_else(|| panic!("{name} is no number"))
    }

    /// Position of a pixel of the picture in the window.
    fn locate(&self, [x, y]: [u32; 2]) -> [f64; 2] {
        self.browser.run("document.querySelector('#stage').scrollIntoView({block: 'center', behavior: 'instant'})");
        point(&self.browser.run(&format!("return window.pt.locate({x}, {y})")))
    }

    /// The colour on the screen at a pixel of the picture, in 8 bits.
    fn shown(&self, pixel: [u32; 2]) -> [u8; 3] {
        let [x, y] = self.locate(pixel);
        let script = format!(
            "const c = document.querySelector('canvas'), b = c.getBoundingClientRect(); \
             return [...c.getContext('2d').getImageData({x} - b.left, {y} - b.top, 1, 1).data]"
        );
        let found = self.browser.run(&script);
        std::array::from_fn(|c| found[c].as_u64().expect("a byte") as u8)
    }

    fn expected(&self, picture: usize, [x, y]: [u32; 2], tone: impl Fn(f32) -> f32) -> [u8; 3] {
        self.pictures[picture].rgb(x - ORIGIN.x, y - ORIGIN.y).map(|v| (255.0 * tone(v).clamp(0.0, 1.0)).round() as u8)
    }

    /// Asserts that the screen shows this value, with a tolerance of one level of 255 for half floats (2⁻¹¹) and rounding.
    fn shows(&self, pixel: [u32; 2], expected: [u8; 3], what: &str) {
        let found = self.shown(pixel);
        assert!(found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{what}: {found:?} is shown, {expected:?} expected");
    }

    fn is_self_contained(&self) {
        assert_eq!(self.browser.run("return performance.getEntriesByType('resource').map(e => e.name)"), json!([]));
    }

    /// Every element that can be focused has a name, and the six plots have a description, in either width.
    fn is_labelled(&self) {
        self.browser.is_labelled();
        assert!(self.browser.run("return document.querySelectorAll('svg[role=img]').length") == 12);
    }

    /// The page reads every pixel of every picture, with a tolerance of half a unit in the last of a half float's eleven bits.
    fn reads_what_the_files_hold(&self) {
        let script = format!(
            "const all = []; for (let y = 0; y < {}; y++) for (let x = 0; x < {}; x++) \
             all.push(window.pt.read(x + {}, y + {}).map(p => p.rgb)); return all",
            SIZE.y, SIZE.x, ORIGIN.x, ORIGIN.y
        );
        let read = self.browser.run(&script);
        for (pixel, found) in read.as_array().expect("pixels").iter().enumerate() {
            let (x, y) = (pixel as u32 % SIZE.x, pixel as u32 / SIZE.x);
            for (picture, image) in self.pictures.iter().enumerate() {
                for (c, value) in image.rgb(x, y).into_iter().map(f64::from).enumerate() {
                    let back = found[picture][c].as_f64().expect("a number");
                    assert!((back - value).abs() <= value.abs() / 2048.0, "picture {picture}, pixel {x}, {y}: {back} for {value}");
                }
            }
        }
        // The numbers under the mouse are the same, to four digits.
        self.browser.hover(self.locate(WALL));
        let status = self.browser.run("return document.querySelector('#status').textContent");
        assert_eq!(status, format!("Pixel {}, {}", WALL[0], WALL[1]));
        let cell = self.browser.run("return document.querySelector('#values').rows[2].cells[2].textContent");
        let cell: f64 = cell.as_str().and_then(|text| text.parse().ok()).expect("a number");
        let value = f64::from(self.pictures[2].rgb(WALL[0] - ORIGIN.x, WALL[1] - ORIGIN.y)[1]);
        assert!((cell / value - 1.0).abs() < 1.0 / 2048.0 + 0.0005, "{cell} for {value}");
    }

    fn flips(&self) {
        for (key, picture) in [("0", 0), ("1", 1), ("4", 4), ("2", 2), ("9", 2)] {
            self.browser.press(key);
            assert_eq!(self.state("shown"), picture, "after {key}");
            self.shows(WALL, self.expected(picture, WALL, srgb), "a picture by its key");
        }
        self.browser.click("#names button:nth-child(4)");
        assert_eq!(self.state("shown"), 3);
        assert_eq!(self.browser.run("return document.querySelector('#left-name').textContent"), "nee · sobol");
        self.shows(WALL, self.expected(3, WALL, srgb), "a picture by its button");
    }

    fn tones(&self) {
        self.browser.press("0eee");
        assert_eq!(self.number("exposure"), 1.5);
        self.shows(WALL, self.expected(0, WALL, |v| srgb(v * 1.5f32.exp2())), "three halves of a stop brighter");
        self.browser.press("EEEEEEEEEEEEEEE");
        assert_eq!(self.number("exposure"), -6.0);
        // The lamp was white before. Its values above 1 are still there with another exposure.
        self.shows(LAMP, self.expected(0, LAMP, |v| srgb(v / 64.0)), "the lamp, six stops darker");
        self.browser.press("r");
        assert_eq!(self.number("exposure"), 0.0);
        self.shows(LAMP, [255; 3], "the lamp");
        self.browser.press("t");
        let filmic = |x: f32| srgb(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
        self.shows(WALL, self.expected(0, WALL, filmic), "the other curve");
        self.browser.click("#curve");
        self.shows(WALL, self.expected(0, WALL, srgb), "the first curve again");
    }

    fn zooms_and_pans(&self) {
        let (at, before) = (self.locate(LAMP), self.number("zoom"));
        self.browser.wheel(at, -300);
        // Pointers are at whole CSS pixels, so the point of the picture under the pointer may move by less than one, times the zoom.
        let (now, zoom) = (self.locate(LAMP), self.number("zoom"));
        assert!(zoom > 1.5 * before, "{zoom} after {before}");
        assert!(now.iter().zip(at).all(|(a, b)| (a - b).abs() <= zoom / before), "{now:?} is where {at:?} was");
        self.browser.press("+");
        assert!(self.number("zoom") > 1.2 * zoom);
        self.browser.press("-");
        assert!((self.number("zoom") / zoom - 1.0).abs() < 1e-9);
        self.shows(BESIDE, self.expected(0, BESIDE, srgb), "zoomed in");

        let at = self.locate(LAMP);
        self.browser.drag("mouse", &[at, [at[0] - 40.0, at[1] + 10.0], [at[0] - 90.0, at[1] + 30.0]]);
        let now = self.locate(LAMP);
        assert!((now[0] - at[0] + 90.0).abs() < 1.0 && (now[1] - at[1] - 30.0).abs() < 1.0, "{now:?} after {at:?}");
        self.browser.run("document.querySelector('canvas').focus()");
        self.browser.press(LEFT);
        assert!(self.locate(LAMP)[0] > now[0] + 30.0, "the left arrow looks to the left");
        self.browser.press(DOWN);
        assert!(self.locate(LAMP)[1] < now[1] - 30.0, "the down arrow looks down");
        // With shift, the keys move the pixel that is read.
        let probe = point(&self.state("probe"));
        self.browser.press_with(SHIFT, RIGHT);
        assert_eq!(point(&self.state("probe")), [probe[0] + 1.0, probe[1]]);
        self.browser.press("r");
        assert_eq!(self.number("zoom"), before);
        self.browser.click("#in");
        assert!(self.number("zoom") > before);
        self.browser.click("#reset");
    }

    /// One picture is shown on the left of the split and the other on the right, for every position of the split.
    fn splits(&self) {
        self.browser.press("4w");
        self.shows(WALL, self.expected(4, WALL, srgb), "left of the split");
        self.shows(LAMP, self.expected(0, LAMP, srgb), "right of the split");
        let far = [ORIGIN.x + SIZE.x - 6, ORIGIN.y + 40];
        self.shows(far, self.expected(0, far, srgb), "right of the split");
        let middle = "const b = document.querySelector('#handle').getBoundingClientRect(); return [b.x + b.width / 2, b.y + 60]";
        let [x, y] = point(&self.browser.run(middle));
        let [edge, _] = self.locate(far);
        self.browser.drag("mouse", &[[x, y], [x + 20.0, y], [edge + 20.0, y]]);
        self.shows(far, self.expected(4, far, srgb), "left of the moved split");
        let at = self.number("split");
        self.browser.run("document.querySelector('#handle').focus()");
        self.browser.press(LEFT);
        assert!((self.number("split") - at + 0.02).abs() < 1e-9);
        self.browser.press_with(SHIFT, "2");
        assert_eq!(self.state("other"), 2);
        self.browser.click("#split");
        assert!(self.state("split").is_null());
        self.browser.press("r");
    }

    /// The reference has no error, so it has the lowest colour of the scale. The biased method has an error of 11 % on the wall, and a
    /// colour between the ends.
    fn shows_errors(&self) {
        self.browser.press("0d");
        self.shows(WALL, [0x44, 0x01, 0x54], "no error");
        self.browser.press("4");
        let biased = self.shown(WALL);
        assert!(biased[1] > 0x80 && biased[2] < 0x90, "{biased:?} is not high on the scale");
        assert_eq!(self.browser.run("return document.querySelector('#scale').hidden"), false);
        self.browser.press("b");
        assert_eq!(self.state("overlay"), "bar");
        let bar = self.shown(WALL);
        assert!(bar[2] > bar[1], "{bar:?}: the method's error bar is small, for it does not know its bias");
        self.browser.click("[data-view=mean]");
        assert_eq!(self.state("view"), "mean");
        self.browser.press("mb");
        assert_eq!([self.state("view"), self.state("overlay")], ["render", "picture"]);
        self.browser.press("r");
    }

    /// At each stop of the slider, every method shows the checkpoint that is nearest to the time or error chosen, on a logarithmic
    /// scale. The pixels are those of its picture, and its error is told within one eighth.
    fn shows_equal_times_and_equal_errors(&self, comparison: &Comparison) {
        let kept = |snapshots: &'_ [Snapshot], value: &dyn Fn(&Snapshot) -> f64, wanted: f64| -> u64 {
            let distance = |one: &&Snapshot| (value(one) / wanted).ln().abs();
            snapshots.iter().rev().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a checkpoint").samples
        };
        type Value<'a> = (&'a str, &'a dyn Fn(&Snapshot) -> f64);
        let values: [Value; 2] = [("seconds", &|s| s.seconds), ("error", &|s| s.error.expect("an error"))];
        for (by, value) in values {
            self.browser.press("r");
            self.browser.click(&format!("[data-by={by}]"));
            assert_eq!([self.state("by"), self.state("view")], [json!(by), json!("render")]);
            let stops: Vec<f64> = serde_json::from_value(self.state("stops")).expect("numbers");
            assert!(stops.len() > 6, "{stops:?}");
            self.browser.run("document.querySelector('#stop').focus()");
            for at in (0..stops.len()).rev() {
                assert_eq!(self.state("stop"), at, "stops of the slider");
                let chosen: Vec<u64> = comparison.methods.iter().map(|m| kept(&m.snapshots, value, stops[at])).collect();
                let shown = self.state("samples");
                assert!(shown[0].is_null(), "the reference has no checkpoints");
                assert_eq!(shown.as_array().expect("a list")[1..], chosen.iter().map(|n| json!(n)).collect::<Vec<_>>(), "{by}, stop {at}");
                self.is_labelled_with(comparison, &chosen);
                self.browser.press(LEFT);
            }
            self.browser.press(".");
            assert_eq!(self.state("stop"), 1);
        }
        self.browser.press("m");
        assert!(self.state("samples")[1].is_null(), "the mean of all has no checkpoints");
        self.browser.press("rq");
        assert_eq!(self.state("by"), "error");
        self.browser.press("r");
    }

    /// Picture and words are those of these checkpoints.
    fn is_labelled_with(&self, comparison: &Comparison, samples: &[u64]) {
        let read = self.browser.run(&format!("return window.pt.read({}, {}).map(p => p.rgb)", WALL[0], WALL[1]));
        let words = self.browser.run("return document.querySelector('#stop').getAttribute('aria-valuetext')");
        let crops = self.browser.run("return [...document.querySelectorAll('.crop small')].map(e => e.textContent)");
        let reference = comparison.reference.image.rgb(WALL[0] - ORIGIN.x, WALL[1] - ORIGIN.y);
        for (i, (method, samples)) in comparison.methods.iter().zip(samples).enumerate() {
            let snapshot = method.snapshots.iter().find(|one| one.samples == *samples).expect("a checkpoint");
            let crop = crops[i + 1].as_str().expect("a text");
            assert!(crop.starts_with(&format!("{samples} spp · ")) && crop.ends_with(" %") && !crop.contains("e+"), "{crop}");
            assert!(words.as_str().expect("a text").contains(&format!("; {} {crop}", method.name)), "{words}");
            for (c, value) in snapshot.image.rgb(WALL[0] - ORIGIN.x, WALL[1] - ORIGIN.y).into_iter().map(f64::from).enumerate() {
                let (found, r) = (read[i + 1][c].as_f64().expect("a number"), f64::from(reference[c]));
                let tolerance = (value - r).abs() / 8.0 + (value.abs() + r.abs()) / 2048.0;
                assert!((found - value).abs() <= tolerance, "{} at {samples}: {found} for {value}", method.name);
            }
        }
    }

    fn swaps(&self) {
        self.browser.press("2");
        self.browser.press_with(SHIFT, "4");
        self.browser.press("wx");
        assert_eq!([self.state("shown"), self.state("other")], [4, 2]);
        self.shows(WALL, self.expected(4, WALL, srgb), "the other picture");
        self.browser.click("#swap");
        self.shows(WALL, self.expected(2, WALL, srgb), "the first picture again");
        self.browser.press_with(SHIFT, "0");
        self.browser.press("r");
    }

    /// The page tells the FLIP of every picture as the measure does, within half a step of 10^(3/255).
    fn shows_flip(&self, comparison: &Comparison) {
        self.browser.press("p");
        assert_eq!(self.state("overlay"), "flip");
        let found = self.browser.run(&format!("return window.pt.flip({}, {})", WALL[0], WALL[1]));
        let named = |image| Named { name: "", image };
        for (i, method) in comparison.methods.iter().enumerate() {
            let pair = ImagePair::new(named(&method.sample), named(&comparison.reference.image), Tonemap::default()).expect("a pair");
            let map = Metric::parse("flip").expect("a measure").measure(&pair).map;
            let value = map[((WALL[1] - ORIGIN.y) * SIZE.x + WALL[0] - ORIGIN.x) as usize];
            let told = found[i + 1].as_f64().expect("a number");
            assert!((told / value).log10().abs() < 1.51 / 255.0, "{}: {told} for {value}", method.name);
        }
        self.browser.press("0");
        self.shows(WALL, [0x44, 0x01, 0x54], "the reference differs from itself by nothing");
        self.browser.press("1r");
    }

    /// All small pictures show the part that the large one shows, also after the wheel has turned over one of them.
    fn crops_show_the_same_part(&self) {
        let at_a_pixel = format!(
            "const b = document.querySelector('canvas').getBoundingClientRect(); const [x, y] = window.pt.locate({}, {}); \
             const [u, v] = [(x - b.left) / b.width, (y - b.top) / b.height]; \
             return [...document.querySelectorAll('.crop canvas')].map(c => \
             [...c.getContext('2d').getImageData(u * c.width, v * c.height, 1, 1).data].slice(0, 3))",
            BESIDE[0], BESIDE[1]
        );
        let check = |when: &str| {
            let found = self.browser.run(&at_a_pixel);
            for picture in 0..self.pictures.len() {
                let expected = self.expected(picture, BESIDE, srgb);
                let found: Vec<u8> = serde_json::from_value(found[picture].clone()).expect("three bytes");
                assert!(
                    found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1),
                    "{when}: picture {picture} shows {found:?}, not {expected:?}"
                );
            }
        };
        self.browser.press("r");
        let crop = "const c = document.querySelectorAll('.crop canvas')[2]; c.scrollIntoView({block: 'center', behavior: 'instant'}); \
             const b = c.getBoundingClientRect(); return [b.x + 0.6 * b.width, b.y + 0.3 * b.height]";
        check("at first");
        let before = self.number("zoom");
        self.browser.wheel(point(&self.browser.run(crop)), -300);
        assert!(self.number("zoom") > 1.5 * before, "the wheel over a small picture zooms all");
        check("zoomed");
        self.browser.click(".crop:nth-child(3)");
        assert_eq!(self.state("shown"), 2);
        self.browser.press("r");
    }

    /// The page has the commands, the machine, the seeds and the hashes; a command opens below its conclusion and can be selected.
    fn tells_how_it_was_made(&self, comparison: &Comparison) {
        let made = self.browser.run("return document.querySelector('#made').innerText");
        let made = made.as_str().expect("a text");
        let hash = pt::output::hash(&comparison.methods[2].image).to_string();
        let provenance = &comparison.provenance;
        for fact in [&provenance.command, &provenance.version, &provenance.cpu, &provenance.scene_hash, &provenance.reference_hash, &hash] {
            assert!(made.contains(fact.as_str()), "{fact} is not in {made}");
        }
        assert!(made.contains("1, 2, 3, 4, 5, 6, 7, 8") && made.contains("pt compare --replay convergence.json"), "{made}");
        self.browser.click("#conclusions summary");
        self.browser.click("#conclusions [data-copy]");
        let selected = self.browser.run("return getSelection().toString()");
        assert_eq!(selected.as_str(), comparison.conclusions[0].command.as_deref());
        self.browser.run("document.querySelector('#canvas').scrollIntoView({block: 'center', behavior: 'instant'})");
    }

    fn explains_its_keys(&self) {
        self.browser.press("?");
        assert_eq!(self.browser.run("return document.querySelector('#help').open"), true);
        self.browser.press(ESCAPE);
        assert_eq!(self.browser.run("return document.querySelector('#help').open"), false);
    }

    /// Nothing is wider than the window, and the text of plots is legible.
    fn fits(&self, width: u32, height: u32) {
        self.browser.fits(width, height);
        let small = "return [...document.querySelectorAll('svg text')].filter(e => e.getClientRects().length && \
                     e.getScreenCTM().a * parseFloat(e.getAttribute('font-size')) < 11).map(e => e.textContent)";
        assert_eq!(self.browser.run(small), json!([]));
        // Texts of a plot do not overlap.
        let touching = "const found = []; for (const svg of document.querySelectorAll('svg')) { \
             const all = [...svg.querySelectorAll('text')].map(e => [e, e.getBoundingClientRect()]).filter(([, b]) => b.width); \
             all.forEach(([a, p], i) => all.slice(i + 1).forEach(([b, q]) => { \
             if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 3 && q.top < p.bottom - 3) \
             found.push(a.textContent + ' / ' + b.textContent) })) } return found";
        assert_eq!(self.browser.run(touching), json!([]));
    }

    fn is_touched(&self) {
        self.browser.press("r");
        let at = self.locate(LAMP);
        self.browser.drag("touch", &[at]);
        assert_eq!(point(&self.state("probe")), [f64::from(LAMP[0] - ORIGIN.x), f64::from(LAMP[1] - ORIGIN.y)]);
        let before = self.number("zoom");
        let [x, y] = at;
        self.browser.pinch(&[[x - 20.0, y], [x - 30.0, y], [x - 60.0, y]], &[[x + 20.0, y], [x + 30.0, y], [x + 60.0, y]]);
        let ratio = self.number("zoom") / before;
        assert!((2.0..4.0).contains(&ratio), "fingers three times as far apart: zoomed by {ratio}");
        self.browser.press("r");
    }

    /// Saves screenshots for people to look at, as `target/tmp/report-*.png`.
    fn photograph(&self) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        for (width, height) in [(390, 844), (1400, 900)] {
            self.browser.resize(width, height);
            for scheme in ["light", "dark"] {
                self.browser.prefer(scheme);
                self.browser.run("scrollTo(0, 0)");
                let shot = |name: &str, whole| {
                    let path = folder.join(format!("report-{width}-{scheme}{name}.png"));
                    fs::write(&path, self.browser.screenshot(whole)).expect("a picture");
                };
                shot("", false);
                shot("-whole", true);
            }
            self.browser.prefer("light");
        }
    }
}
