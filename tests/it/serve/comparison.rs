//! The page of a comparison that goes on: what its server answers, and the page in a real browser.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use pt::output::serve::ReportServer;
use serde_json::{Value, json};

use super::page::Page;
use super::{Running, answer, event, folder, follow, parts};
use crate::report::browser::Browser;

/// Versions of the page are numbered; one is made where somebody looks or none is there yet; and the button asks the work to end.
#[test]
fn reports_have_versions() {
    let stops = Arc::new(AtomicU32::new(0));
    let theirs = stops.clone();
    let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    let stop = move || {
        theirs.fetch_add(1, Ordering::Relaxed);
    };
    let server = ReportServer::start(any, "localhost", "waiting".into(), Box::new(stop)).expect("a server");
    let (address, token) = parts(&server.url());
    let page = || answer(&address, "GET", &format!("/?token={token}"), &address);
    assert_eq!(page(), (200, b"waiting".to_vec()));
    for path in ["/", "/events", "/?token=0", "/stop"] {
        assert_eq!(answer(&address, if path == "/stop" { "POST" } else { "GET" }, path, &address).0, 403, "{path}");
    }
    server.offer(|version| Some(format!("version {version}")));
    assert_eq!(page(), (200, b"version 1".to_vec()));
    // Longer than the shortest time between two versions.
    thread::sleep(Duration::from_millis(300));
    server.offer(|_| unreachable!("nobody looks, and there is a version"));
    let mut lines = follow(&address, &token);
    let first = event(&mut lines).expect("the state");
    assert_eq!((&first["version"], &first["closing"]), (&json!(1), &Value::Null));
    server.tell("counting", 0.25, 1.0, Some(3.0));
    let told = event(&mut lines).expect("a change");
    assert_eq!((&told["doing"], &told["share"], &told["remaining"]), (&json!("counting"), &json!(0.25), &json!(3.0)));
    assert_eq!((answer(&address, "POST", &format!("/stop?token={token}"), &address).0, stops.load(Ordering::Relaxed)), (202, 1));
    server.finish(|version| Some(format!("version {version}")), "it is over".into());
    let last = std::iter::from_fn(|| event(&mut lines)).last().expect("an end");
    assert_eq!((&last["version"], &last["closing"], &last["is_stopping"]), (&json!(2), &json!("it is over"), &json!(true)));
}

/// The errors of all replicates in the report of a folder.
fn errors(folder: &Path) -> Vec<Value> {
    let text = std::fs::read(folder.join("convergence.json")).expect("a report");
    let report: Value = serde_json::from_slice(&text).expect("JSON");
    let methods = report["methods"].as_array().expect("methods");
    let values = |method: &Value| {
        let measured = method["measurements"].as_array().expect("measurements").iter();
        measured.map(|one| json!([one["replicate"], one["spp"], one["relmse"]])).collect::<Vec<_>>()
    };
    methods.iter().flat_map(values).collect()
}

/// With a page that somebody watches the report has the numbers that it has without.
#[test]
fn a_page_does_not_change_the_comparison() {
    let folder = folder();
    // Long enough for a browser to come.
    let args = ["compare", "scene.json", "--size", "24x16", "--integrators", "path,nee", "--spp", "1024"];
    let output = Command::new(env!("CARGO_BIN_EXE_pt"))
        .current_dir(folder.path())
        .args(args)
        .args(["--reference-time", "200ms", "-o", "plain"])
        .output()
        .expect("a run");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // The reference of the first comparison, since time ends it.
    let served = [&args[..], &["--reference", "plain/reference.exr", "-o", "served"]].concat();
    let running = Running::start(folder.path(), &served);
    let (address, token) = parts(&running.url);
    let last = follow(&address, &token).map_while(Result::ok).filter(|line| line.starts_with("data: ")).last().expect("events");
    let last: Value = serde_json::from_str(last.trim_start_matches("data: ")).expect("JSON");
    assert_eq!(last["closing"], "The report is served/index.html.");
    assert!(last["version"].as_u64() >= Some(2), "the report has grown: {last}");
    let (code, said) = running.end();
    assert_eq!(code, Some(0), "{said}");
    let [plain, served] = ["plain", "served"].map(|name| errors(&folder.path().join(name)));
    assert!(!plain.is_empty() && plain == served);
    let page = std::fs::read_to_string(folder.path().join("served/index.html")).expect("a page");
    assert!(!page.contains("EventSource") && page.contains("convergence.csv"), "the file follows nothing");
}

/// A comparison that would take for ever grows under the eyes of two browsers, keeps what they have chosen, and is ended by a click.
#[test]
fn a_report_grows_in_a_browser() {
    let Some(browser) = Browser::open() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-box.json"), folder.path().join("cornell-box.json"))
        .expect("copied");
    let args =
        ["compare", "cornell-box.json", "--size", "48x36", "--integrators", "path,nee", "--spp", "4000000", "--reference-time", "1s"];
    let desk = Page { browser };
    desk.browser.prefer("light");
    desk.browser.resize(1400, 900);
    let phone = Page { browser: Browser::open().expect("another browser") };
    phone.browser.prefer("dark");
    phone.browser.resize(390, 844);
    let running = Running::start(folder.path(), &[&args[..], &["-o", "report"]].concat());
    let pages = [(&desk, 1400, 900), (&phone, 390, 844)];
    for (page, ..) in pages {
        page.browser.go(&running.url);
    }
    for (page, ..) in pages {
        page.waits_for("window.pt");
        page.browser.click("[data-overlay=error]");
        page.browser.run("document.getElementById('split').focus()");
        page.browser.press("w");
        page.browser.run(
            "window.before = [document.getElementById('methods').textContent, document.getElementById('plots').innerHTML, \
             JSON.stringify(pt.read(20, 20))]",
        );
    }
    for (page, width, height) in pages {
        page.waits_for(
            "document.getElementById('methods').textContent !== before[0] && document.getElementById('plots').innerHTML !== before[1] \
             && JSON.stringify(pt.read(20, 20)) !== before[2]",
        );
        page.browser.is_labelled();
        assert_eq!((page.state("overlay"), page.state("split")), (json!("error"), json!(0.5)));
        assert_eq!(page.browser.run("return document.activeElement.id"), "split", "the focus stays");
        assert_eq!(page.text("doing"), "Comparing");
        // One press has one effect: the viewer before does not listen any more.
        page.browser.press("w");
        assert_eq!(page.state("split"), Value::Null);
        assert_eq!(page.browser.run("return document.querySelector('[data-overlay=flip]').disabled"), true);
        page.browser.fits(width, height);
        page.photograph(&format!("comparison-{width}"));
    }
    // A time that is chosen stays chosen, though the scale has another end; and an open help is not disturbed until it is closed.
    desk.browser.press(",,");
    let time = || desk.browser.run("return pt.state().stops[pt.state().stop]").as_f64().expect("a time");
    let longest = || desk.browser.run("return pt.state().stops.at(-1)");
    let (chosen, last) = (time(), longest());
    phone.browser.run("document.getElementById('help').showModal()");
    desk.browser.run("window.before = document.getElementById('methods').textContent");
    phone.browser.run("window.before = document.getElementById('methods').textContent");
    desk.browser.click("#end");
    for page in [&desk, &phone] {
        page.waits_for("document.getElementById('doing').textContent === 'Done'");
    }
    desk.waits_for("document.getElementById('methods').textContent !== before");
    assert!((time() / chosen).log2().abs() < 0.51 && longest() != last, "{chosen} s was chosen, and is {} s", time());
    assert_eq!(phone.browser.run("return document.getElementById('methods').textContent === before"), true);
    phone.browser.run("document.getElementById('help').close()");
    for page in [&desk, &phone] {
        page.waits_for("!document.querySelector('[data-overlay=flip]').disabled");
        assert_eq!(page.text("closing"), "The report is report/index.html.");
        assert_eq!(page.browser.complaints(), [""; 0], "the console is quiet");
    }
    let (code, said) = running.end();
    assert_eq!(code, Some(0), "{said}");
    assert!(!errors(&folder.path().join("report")).is_empty());
}
