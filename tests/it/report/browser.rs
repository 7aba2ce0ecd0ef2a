//! A browser controlled by a test: the part of W3C WebDriver that the test needs.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;

/// With this variable set, a missing browser is a failure.
const REQUIRED: &str = "PT_REQUIRE_BROWSER";

/// A headless Chromium with its own profile. It ends when the value is dropped.
pub struct Browser {
    driver: Child,
    session: String,
    _profile: TempDir,
}

impl Browser {
    /// Starts a browser. Returns `None`, with a line of text, if no driver is installed.
    ///
    /// Panics if a driver is installed and does not start, or if [`REQUIRED`] is set and there is no driver.
    pub fn open() -> Option<Browser> {
        let spawned = Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut driver = match spawned {
            Ok(driver) => driver,
            Err(e) if std::env::var_os(REQUIRED).is_some() => panic!("chromedriver: {e}"),
            Err(e) => {
                // Not `eprintln!`, because the line must be visible although the test passes.
                let _ = writeln!(std::io::stderr(), "NOT TESTED: the report in a browser (chromedriver: {e})");
                return None;
            }
        };
        let lines = BufReader::new(driver.stdout.take().expect("piped")).lines();
        let port = lines.map_while(Result::ok).find_map(|line| {
            let (_, port) = line.split_once("started successfully on port ")?;
            port.trim_end_matches('.').parse::<u16>().ok()
        });
        let profile = tempfile::tempdir().expect("a folder for the profile");
        let mut browser = Browser { driver, session: String::new(), _profile: profile };
        let root = format!("http://127.0.0.1:{}/session", port.expect("chromedriver tells its port"));
        let args = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--no-first-run",
            "--hide-scrollbars",
        ];
        let args: Vec<String> =
            args.iter().map(|a| (*a).to_owned()).chain([format!("--user-data-dir={}", browser._profile.path().display())]).collect();
        let wanted = json!({"browserName": "chrome", "goog:chromeOptions": {"args": args}, "goog:loggingPrefs": {"browser": "ALL"}});
        let answer = request(&root, &json!({"capabilities": {"alwaysMatch": wanted}}));
        browser.session = format!("{root}/{}", answer["sessionId"].as_str().expect("a session"));
        Some(browser)
    }

    fn post(&self, command: &str, body: &Value) -> Value {
        request(&format!("{}/{command}", self.session), body)
    }

    pub fn visit(&self, file: &Path) {
        self.go(&format!("file://{}", file.display()));
    }

    pub fn go(&self, url: &str) {
        self.post("url", &json!({"url": url}));
    }

    /// Asserts that nothing is wider than the window, which has this size.
    pub fn fits(&self, width: u32, height: u32) {
        let wide = format!(
            "return [...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > {width} + 0.5) \
             .map(e => e.outerHTML.slice(0, 80))"
        );
        assert_eq!(self.run(&wide), json!([]));
        assert_eq!(self.run("return [innerWidth, innerHeight]"), json!([width, height]));
    }

    /// Asserts that every element that can be focused has a name.
    pub fn is_labelled(&self) {
        let nameless = "return [...document.querySelectorAll('button, select, input, [tabindex], svg[role=img]')] \
                        .filter(e => !(e.getAttribute('aria-label') || e.textContent).trim()).map(e => e.outerHTML)";
        assert_eq!(self.run(nameless), json!([]));
    }

    /// Sets the size of the viewport, also below the minimum size of a window.
    pub fn resize(&self, width: u32, height: u32) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
        self.chrome("Emulation.setDeviceMetricsOverride", &metrics);
    }

    pub fn prefer(&self, scheme: &str) {
        self.chrome("Emulation.setEmulatedMedia", &json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]}));
    }

    fn chrome(&self, command: &str, parameters: &Value) -> Value {
        self.post("goog/cdp/execute", &json!({"cmd": command, "params": parameters}))
    }

    /// The value of a JavaScript function's body.
    pub fn run(&self, script: &str) -> Value {
        self.post("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Presses keys one after the other, given as characters. The WebDriver standard has characters for keys without one.
    pub fn press(&self, keys: &str) {
        let strokes: Vec<Value> =
            keys.chars().flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({"type": kind, "value": key.to_string()}))).collect();
        self.act(&json!([{"type": "key", "id": "keys", "actions": strokes}]));
    }

    pub fn press_with(&self, modifier: char, key: &str) {
        let modifier = modifier.to_string();
        let strokes = [("keyDown", modifier.as_str()), ("keyDown", key), ("keyUp", key), ("keyUp", modifier.as_str())]
            .map(|(kind, value)| json!({"type": kind, "value": value}));
        self.act(&json!([{"type": "key", "id": "keys", "actions": strokes}]));
    }

    /// Moves a pointer (`mouse` or `touch`) to the first point, presses it, drags it over the other points, and releases it.
    pub fn drag(&self, pointer: &str, points: &[[f64; 2]]) {
        self.act(&json!([track(pointer, pointer, points)]));
    }

    /// Drags two fingers at once.
    pub fn pinch(&self, first: &[[f64; 2]], second: &[[f64; 2]]) {
        self.act(&json!([track("touch", "finger 1", first), track("touch", "finger 2", second)]));
    }

    pub fn hover(&self, [x, y]: [f64; 2]) {
        let to = json!({"type": "pointerMove", "duration": 0, "x": x.round() as i64, "y": y.round() as i64});
        self.act(&json!([{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [to]}]));
    }

    pub fn wheel(&self, [x, y]: [f64; 2], down: i32) {
        let scroll = json!({"type": "scroll", "x": x.round() as i64, "y": y.round() as i64, "deltaX": 0, "deltaY": down});
        self.act(&json!([{"type": "wheel", "id": "wheel", "actions": [scroll]}]));
    }

    fn act(&self, sources: &Value) {
        self.post("actions", &json!({"actions": sources}));
        // Waits for the next frame, in which the page is painted.
        self.post("execute/async", &json!({"script": "requestAnimationFrame(() => setTimeout(arguments[0]))", "args": []}));
    }

    /// Clicks with the mouse in the middle of the element.
    pub fn click(&self, selector: &str) {
        let script = format!(
            "const e = document.querySelector({}); e.scrollIntoView({{block: 'nearest'}}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]",
            json!(selector)
        );
        let at = point(&self.run(&script));
        self.drag("mouse", &[at]);
    }

    /// The errors on the page's console. Advice about reading many pixels is left out, because the test causes it.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.post("se/log", &json!({"type": "browser"}));
        let errors = log.as_array().into_iter().flatten().filter(|entry| entry["level"] == "SEVERE");
        errors.map(|entry| entry["message"].to_string()).collect()
    }

    /// The whole page, or what the window shows, as PNG.
    pub fn screenshot(&self, whole: bool) -> Vec<u8> {
        use base64::Engine;
        let shot = self.chrome("Page.captureScreenshot", &json!({"format": "png", "captureBeyondViewport": whole}));
        base64::engine::general_purpose::STANDARD.decode(shot["data"].as_str().expect("a picture")).expect("base64")
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ends the browser; the driver would leave it behind.
        if !self.session.is_empty() {
            let _ = ureq::delete(&self.session).call();
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

fn track(pointer: &str, id: &str, points: &[[f64; 2]]) -> Value {
    let to = |[x, y]: &[f64; 2]| json!({"type": "pointerMove", "duration": 0, "x": x.round() as i64, "y": y.round() as i64});
    let mut actions = vec![to(&points[0]), json!({"type": "pointerDown", "button": 0})];
    actions.extend(points[1..].iter().map(to));
    actions.push(json!({"type": "pointerUp", "button": 0}));
    json!({"type": "pointer", "id": id, "parameters": {"pointerType": pointer}, "actions": actions})
}

/// Two numbers of an answer.
pub fn point(value: &Value) -> [f64; 2] {
    [0, 1].map(|i| value[i].as_f64().unwrap_or_else(|| panic!("two numbers, found {value}")))
}

/// The value of the driver's answer.
fn request(url: &str, body: &Value) -> Value {
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let mut answer = agent.post(url).send_json(body).unwrap_or_else(|e| panic!("{url}: {e}"));
    // Screenshots are longer than the default limit.
    let body = answer.body_mut().with_config().limit(1 << 28);
    let found: Value = body.read_json().unwrap_or_else(|e| panic!("{url}: {e}"));
    let value = &found["value"];
    assert!(value["error"].is_null(), "{url}: {}: {}", value["error"], value["message"]);
    value.clone()
}
