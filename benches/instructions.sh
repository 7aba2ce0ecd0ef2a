#!/bin/sh
# Instructions per sample of the work tree over those of another commit: what a change costs scenes that do not use it.
#
#   benches/instructions.sh COMMIT [SCENE…]
#
# The default are four demo scenes. Needs valgrind. A scene is rendered twice with different numbers of samples, and the difference
# counted, so that loading does not; by single paths, and by eight side by side. Both sides are built with the profile `fast`.
set -eu
cd "$(dirname "$0")/.."
base=$(git rev-parse --verify "$1^{commit}")
shift
[ $# -gt 0 ] || set -- scenes/cornell-box.json scenes/statue.json scenes/glass-panel.json scenes/lanterns.json
work=$(mktemp -d)
trap 'git worktree remove --force "$work/base" 2> /dev/null || true; rm -rf "$work"' EXIT
git worktree add --quiet --detach "$work/base" "$base"
cargo build --quiet --profile fast
cargo build --quiet --profile fast --manifest-path "$work/base/Cargo.toml" --target-dir "$work/target"
new=${CARGO_TARGET_DIR:-target}/fast/pt old=$work/target/fast/pt

# instructions PROGRAM SCENE LANES SAMPLES
instructions() {
    PT_LANES=$3 valgrind --tool=callgrind --callgrind-out-file="$work/out" "$1" "$2" -i nee --sampler independent --spp "$4" \
        --size 64x48 --threads 1 --progress none -o "$work/picture.pfm" > /dev/null 2> "$work/log" || { cat "$work/log" >&2; exit 1; }
    sed -n 's/^summary: *//p' "$work/out"
}

# per_sample PROGRAM SCENE LANES: instructions of a further sample of each pixel
per_sample() {
    few=$(instructions "$1" "$2" "$3" 2)
    many=$(instructions "$1" "$2" "$3" 10)
    echo $(((many - few) / (8 * 64 * 48)))
}

printf '%-28s %5s %10s %10s %8s\n' scene lanes before after ratio
for scene; do
    for lanes in 1 8; do
        before=$(per_sample "$old" "$scene" $lanes) after=$(per_sample "$new" "$scene" $lanes)
        ratio=$(awk "BEGIN { printf \"%.4f\", $after / $before }")
        printf '%-28s %5s %10s %10s %8s\n' "$scene" $lanes "$before" "$after" "$ratio"
    done
done
