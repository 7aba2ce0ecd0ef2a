//! SIGSTOP and SIGCONT, and readers that go away.

use std::process::{Command, Stdio};
use std::time::Duration;

use super::{DOCUMENTED, command, done, folder, picture, said, send, shell, wait_until};

/// A render that was stopped for a while goes on to the same picture.
#[test]
fn a_stopped_render_goes_on() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json --spp 4000 -q -o whole.exr");
    let mut child = command(at, "s.json --spp 4000 -q -o x.exr --checkpoint 0.001").spawn().expect("it starts");
    for _ in 0..3 {
        send("STOP", &child);
        std::thread::sleep(Duration::from_millis(30));
        send("CONT", &child);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
}

/// The time while it is stopped counts for `--time`: a stop that is longer ends the render soon after it goes on, with the right picture
/// of the samples so far.
#[test]
fn a_time_budget_runs_out_during_a_stop() {
    let folder = folder();
    let at = folder.path();
    let mut child = command(at, "s.json --time 1 -q -o x.exr -o x.ptc --checkpoint 0.001").spawn().expect("it starts");
    wait_until("it has begun", || at.join("x.ptc").exists());
    send("STOP", &child);
    std::thread::sleep(Duration::from_millis(1100));
    send("CONT", &child);
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    let samples = pt::part::Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
    done(at, &format!("s.json --spp {samples} -q -o whole.exr"));
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
}

/// A reader that closes its end of the pipe ends no render, and causes no panic.
#[test]
fn closed_pipes() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("r.csv"), "0,0,1,0,0,-1\n".repeat(10_000)).expect("write");
    done(at, "s.json --spp 4 -q -o whole.exr -o whole.ptc --checkpoint 1h");
    let lines = [
        "s.json --spp 4 -o x.exr --stats --progress json -v",
        "check s.json",
        "list",
        "schema",
        "man",
        "completions bash",
        "image info whole.exr",
        "image diff whole.exr whole.exr",
        "merge whole.ptc -o sum.exr",
        "rays a.obj --from r.csv",
        "sample cosine -n 100000",
        "s.json --pixel 3,3 --sample 0 --trace",
        "no.json",
    ];
    for line in lines {
        let mut child = command(at, line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop((child.stdout.take(), child.stderr.take()));
        let code = child.wait().expect("it ends").code();
        assert!(code.is_some_and(|code| code == if line == "no.json" { 3 } else { 0 }), "{line}: {code:?}");
    }
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
    // The program also runs where stdin, stdout and stderr are closed.
    let output = shell(at, "", "s.json --spp 4 -o y.exr --stats", "<&- >&- 2>&-");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(picture(at, "y.exr"), picture(at, "whole.exr"));
}

/// A reader of a table that is cut off, and an endless one, end as the answers say.
#[test]
fn stdin_ends_early() {
    let folder = folder();
    for (text, args, code) in
        [("", "-", 3), ("{\"pt\": 1, \"camera\": {", "check -", 3), ("0,0,1,0,0", "rays a.obj --from -", 3), ("", "rays a.obj --from -", 0)]
    {
        let line = format!("printf '%s' '{text}' |");
        let output = Command::new("sh")
            .args(["-c", &format!("{line} {} {args}", assert_cmd::cargo::cargo_bin("pt").display())])
            .current_dir(folder.path())
            .output()
            .expect("it runs");
        assert_eq!(output.status.code(), Some(code), "{args}: {}", said(&output));
        assert!(DOCUMENTED.contains(&code) && (code == 0 || said(&output).starts_with("error: ")), "{args}: {}", said(&output));
    }
}
