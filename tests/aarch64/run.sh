#!/usr/bin/env bash
# Does a processor of another architecture give the same bits? Builds pt for aarch64, whose instructions qemu executes here, renders
# every scene in scenes/ with it and with pt for this machine, and compares the pictures. Then asks both `pt torture` some rows whose
# answers are numbers, and compares the answers to the last digit.
#
#     tests/aarch64/run.sh                 # all scenes: half an hour on two cores, of which building takes five minutes
#     tests/aarch64/run.sh cornell glass   # only scenes whose name contains one of these words
#
# Needs Rust's standard library for aarch64 (`rustup target add aarch64-unknown-linux-gnu`), and Debian's packages qemu-user and
# gcc-aarch64-linux-gnu or their like. Prints a line for each scene; exit code 1 if any bit differs.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root"
target=aarch64-unknown-linux-gnu
command -v qemu-aarch64 >/dev/null || { echo "there is no qemu-aarch64; Debian has it in qemu-user" >&2; exit 2; }
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=${CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER:-aarch64-linux-gnu-gcc}
cargo build --quiet --release --bin pt
cargo build --quiet --release --bin pt --target "$target"
built=${CARGO_TARGET_DIR:-target}
here=$built/release/pt
there=(qemu-aarch64 -L "${QEMU_LD_PREFIX:-/usr/aarch64-linux-gnu}" "$built/$target/release/pt")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

different=0 count=0
# Compares here.$1 with there.$1.
compare() {
    count=$((count + 1))
    if cmp -s "$folder/here.$1" "$folder/there.$1"; then
        echo "same bits  $2"
    else
        echo "DIFFERENT  $2"
        different=$((different + 1))
    fi
}
for scene in scenes/*.json; do
    name=$(basename "$scene" .json)
    [ $# -gt 0 ] && ! grep -qF "$(printf '%s\n' "$@")" <<<"$name" && continue
    for sampler in sobol independent; do
        options=("$scene" --size 48x36 --spp 4 --sampler "$sampler" -q)
        "$here" "${options[@]}" -o "$folder/here.pfm"
        "${there[@]}" "${options[@]}" -o "$folder/there.pfm"
        compare pfm "$name, $sampler"
    done
done
if [ $# -eq 0 ]; then
    for rows in 'F*' 'O*' 'G1*' 'S*'; do
        for pt in here there; do
            if [ "$pt" = here ]; then program=("$here"); else program=("${there[@]}"); fi
            if ! "${program[@]}" torture --quick -q --only "$rows" -o "$folder/$pt.csv" >"$folder/said"; then cat "$folder/said"; fi
        done
        compare csv "pt torture --quick --only '$rows'"
    done
fi
[ "$count" -gt 0 ] || { echo "no scene is called so" >&2; exit 2; }
echo "$((count - different)) of $count are the same"
exit $((different > 0))
