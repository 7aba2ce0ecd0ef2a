#!/usr/bin/env bash
# Fuzzes the targets of tests/it/fuzz/targets/ in turn, guided by coverage, on stable Rust with a C++ compiler:
#
#     tests/fuzz/run.sh 600             # all targets, 600 seconds each
#     tests/fuzz/run.sh 3600 scene part # these, an hour each
#
# The corpus stays in target/fuzz/corpus/, so that a later call goes on from there. Inputs that pt answers wrongly are written to
# target/fuzz/findings/, each with a line that begins with FINDING; exit code 1 if there is one. A finding that is kept goes
# to tests/it/fuzz/findings/TARGET/.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
seconds=${1:?seconds for each target}
shift
work=${CARGO_TARGET_DIR:-$here/../../target}/fuzz
mkdir -p "$work/findings"
work=$(cd "$work" && pwd)
system=$(rustc -vV | sed -n 's/^host: //p')
coverage='-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares'
RUSTFLAGS=${coverage//$'\n'/ } CARGO_TARGET_DIR=$work/build cargo build --release --manifest-path "$here/Cargo.toml" --target "$system"

targets=("$@")
[[ $# -gt 0 ]] || mapfile -t targets < <(ls "$here/../it/fuzz/seeds")
export PT_FUZZ_FINDINGS=$work/findings
before=$(find "$work/findings" -type f | wc -l)
for target in "${targets[@]}"; do
    seeds=$here/../it/fuzz/seeds/$target findings=$here/../it/fuzz/findings/$target corpus=$work/corpus/$target
    mkdir -p "$corpus"
    [[ -d $findings ]] || findings=$seeds
    echo "== $target"
    # Files of inputs are in memory where the system has a place for that.
    TMPDIR=$([[ -d /dev/shm ]] && echo /dev/shm || echo "${TMPDIR:-/tmp}") PT_FUZZ_TARGET=$target PT_THREADS=1 RAYON_NUM_THREADS=1 \
        "$work/build/$system/release/fuzz" "$corpus" "$seeds" "$findings" -artifact_prefix="$work/findings/$target-" \
        -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 -verbosity=0 2>&1 |
        grep -E '^(FINDING|stat::number_of|stat::average|ERROR|SUMMARY|.*ERROR: libFuzzer)' || true
done
exit $(($(find "$work/findings" -type f | wc -l) > before))
