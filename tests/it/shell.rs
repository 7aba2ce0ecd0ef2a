//! Shell completions and manual pages have all commands and options; and the examples depend only on pt.

use std::io::Write;
use std::process::{Command, Stdio};

/// stdout of a call that succeeds.
fn said(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_pt")).args(args).output().expect("a run");
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The commands that `pt --help` lists.
fn commands() -> Vec<String> {
    let help = said(&["-h"]);
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names: Vec<String> = listed.filter_map(|line| line.strip_prefix("  ")?.split(' ').next().map(str::to_owned)).collect();
    names.into_iter().filter(|name| !name.is_empty() && name != "help").collect()
}

/// Completions contain every command, and options of each kind: long, short, global, of a command, and of a subcommand.
#[test]
fn completions_contain_all_commands() {
    let commands = commands();
    assert!(commands.len() > 10 && commands.contains(&"compare".to_owned()), "{commands:?}");
    for shell in ["bash", "zsh", "fish"] {
        let script = said(&["completions", shell]);
        for word in commands.iter().map(String::as_str).chain(["exposure", "quiet", "replicates", "tolerance", "falsecolor"]) {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
    }
    assert!(!Command::new(env!("CARGO_BIN_EXE_pt")).args(["completions", "csh"]).output().expect("a run").status.success());
}

/// The shell accepts its completions, if it is installed.
#[test]
fn shells_read_their_completions() {
    for (shell, check) in [("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")] {
        let spawned = Command::new(shell).arg(check).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let Ok(mut child) = spawned else {
            println!("NOT TESTED: {shell} is not installed");
            continue;
        };
        child.stdin.take().expect("a pipe").write_all(said(&["completions", shell]).as_bytes()).expect("it reads");
        let output = child.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{shell}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn each_command_has_a_manual_page() {
    let page = said(&["man"]);
    assert!(page.contains(".TH pt 1") && page.contains("\\-\\-exposure"), "{page}");
    for command in commands() {
        let page = said(&["man", &command]);
        assert!(page.contains(&format!(".TH pt\\-{command} 1")) || page.contains(&format!(".TH pt-{command} 1")), "{page}");
        assert!(page.contains(".SH SYNOPSIS"), "{page}");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_pt")).args(["man", "compar"]).output().expect("a run");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*stderr), (Some(2), "error: unknown command \"compar\", did you mean \"compare\"?\n"));
}

/// Examples of how to use pt name no other crate, because pt re-exports what they need.
#[test]
fn examples_for_others_need_pt_alone() {
    for (name, text) in [
        ("plug_in.rs", include_str!("../../examples/plug_in.rs")),
        ("splats.rs", include_str!("../../examples/splats.rs")),
        ("build_scene.rs", include_str!("../../examples/build_scene.rs")),
        ("prove_my_bsdf.rs", include_str!("../../examples/prove_my_bsdf.rs")),
    ] {
        let foreign: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("use ") && !line.starts_with("use pt::") && !line.starts_with("use std::"))
            .collect();
        assert_eq!(foreign, [""; 0], "{name}");
    }
}
