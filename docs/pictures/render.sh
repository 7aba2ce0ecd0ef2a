#!/bin/sh
# Renders the pictures of the README into this folder: `docs/pictures/render.sh [NAME…]`, default all.
set -eu
cd "$(dirname "$0")/../.."
cargo build --release --quiet
wanted=" $* "

# picture  scene  further options
picture() {
    name=$1 scene=$2
    shift 2
    case $wanted in
    "  " | *" $name "*) target/release/pt "scenes/$scene.json" -o "docs/pictures/$name.png" --progress none "$@" ;;
    esac
}

picture cornell-box       cornell-box     --size 280x280 --spp 256
picture mirror-balls      mirror-balls    --size 280x210 --spp 256
picture mattness          mattness        --size 288x180 --spp 256
picture matter            matter          --size 288x180 --spp 256
picture metals            metals          --size 288x180 --spp 512
picture compounds       compounds       --size 288x180 --spp 512
picture statue            statue          --size 270x360 --spp 256
picture pawns             pawns           --size 280x210 --spp 256
picture pawn-army         pawn-army       --size 320x240 --spp 256
picture triangle-stacks   triangle-stacks --size 240x320 --spp 256
picture caustic           caustic         --size 280x210 --spp 256
picture caustic-light     caustic         --size 280x210 --spp 1024 --integrator light
picture glass-panel       glass-panel     --size 320x320 --spp 1024
# The story of docs/glass-panel.md: without the mistake, and with it.
picture panel             glass-panel     --size 200x200 --spp 256
case $wanted in
"  " | *" panel-magnifies "*)
    cargo run --release --quiet --example magnifying_panel -- --integrator magnifying scenes/glass-panel.json \
        --size 200x200 --spp 256 -o docs/pictures/panel-magnifies.png --progress none ;;
esac
# The same number of samples per pixel, so that the two can be compared.
picture mis-plates        mis-plates      --size 360x270 --spp 256
picture mis-plates-path   mis-plates      --size 264x198 --spp 256 --integrator path
picture fog               fog             --size 360x270 --spp 256
picture media             media           --size 400x200 --spp 512
picture cloud             cloud           --size 400x250 --spp 256 --exposure auto --tonemap filmic
picture translucent       translucent     --size 360x203 --spp 192 --exposure auto --tonemap filmic
picture macro-lens        macro-lens      --size 360x240 --spp 2048
picture double-gauss      double-gauss    --size 360x240 --spp 2048
picture terrace           terrace
picture shapes            shapes          --size 360x225 --spp 512 --exposure 1.3
picture subdivision       subdivision     --size 360x203 --spp 256 --exposure auto --tonemap filmic
picture prism             prism           --size 360x203 --spp 1024 --integrator light
picture bubbles           bubbles         --size 360x225 --spp 1024 --exposure 1.2
picture fur               fur             --size 360x270 --spp 256
picture gallery           gallery         --size 320x200 --spp 1024
picture reflections       reflections     --size 360x203 --spp 2048
# Models in the light that they get without any of their own, for docs/import.md.
model() {
    name=model-$1 mesh=$2
    shift 2
    case $wanted in
    "  " | *" $name "*)
        target/release/pt "scenes/meshes/$mesh.ply" --size 264x264 --spp 1024 --tonemap agx --exposure auto "$@" \
            -o "docs/pictures/$name.png" --progress none ;;
    esac
}
model sky     statue
model studio  statue --studio --view front -D '/shapes/0/material={"type":"conductor","metal":"Au","roughness":0.25}'
model sunset  pawn   --sky -D /background/sky/elevation=5 -D '/shapes/0/material={"type":"conductor","metal":"Cu","roughness":0.4}'
model plastic pawn   --studio -D '/shapes/0/material={"type":"plastic","albedo":[0.5,0.03,0.03]}'
model glass   pawn   --studio --integrator path -D '/shapes/0/material={"type":"dielectric","eta":1.5}'
# One stop darker, so that too much light would show as well as too little; and what is there.
picture furnace           furnace         --size 320x200 --spp 256 --exposure -1
picture furnace-normals   furnace         --size 320x200 --spp 64 --integrator normals
# In the tones of the program that it comes from; and with directions of an even angle, for docs/hemisphere.md.
picture postcard-cosine   postcard        --size 240x135 --spp 128 --tonemap postcard
picture postcard-angle    postcard        --size 240x135 --spp 128 --tonemap postcard -D /integrator/hemisphere=angle

# points  warp
points() {
    name=sample-$1
    case $wanted in
    "  " | *" $name "*) target/release/pt sample "$1" -n 2000 -o "docs/pictures/$name.png" ;;
    esac
}

points cosine
points hemisphere
points hemisphere-angles
