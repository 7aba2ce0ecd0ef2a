#!/usr/bin/env bash
# Corrupts constants and signs of the renderer, one at a time, and asks `pt torture --quick` whether it notices.
#
# Each line of list.txt is a file, a piece of its code, and what to put in its place. The program is built from a copy of the last
# commit. Prints the first row that fails for each corruption; exit code 1 if one is not noticed. Takes one to two minutes a line:
#
#     tests/mutations/run.sh            # all
#     tests/mutations/run.sh fresnel    # only lines that contain this word
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(git -C "$here" rev-parse --show-toplevel)
copy=$(mktemp -d)
trap 'git -C "$root" worktree remove --force "$copy" 2>/dev/null; rm -rf "$copy"' EXIT
git -C "$root" worktree add --quiet --detach "$copy" HEAD
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target}/mutations

unseen=0 count=0
while IFS='|' read -r file old new; do
    # In the list `\|` stands for a bar within code; here it is the character 1.
    clean() { local text=${1//$'\x01'/|}; text=${text# }; printf '%s' "${text% }"; }
    file=$(clean "$file") OLD=$(clean "$old") NEW=$(clean "$new")
    export OLD NEW
    count=$((count + 1))
    git -C "$copy" checkout --quiet -- .
    perl -0pi -e 's/\Q$ENV{OLD}\E/$ENV{NEW}/' "$copy/$file"
    if git -C "$copy" diff --quiet; then
        echo "$file: no such code: $OLD" >&2
        exit 2
    fi
    if ! (cd "$copy" && cargo build --quiet --profile fast --bin pt) >"$copy.log" 2>&1; then
        echo "$file: does not compile: $NEW" >&2
        grep -m 3 '^error' "$copy.log" >&2
        exit 2
    fi
    # A corrupted program may also panic or not end.
    answers=$(timeout 600 "$CARGO_TARGET_DIR/fast/pt" torture --quick --fail-fast 2>&1) && code=0 || code=$?
    row=$(grep -m 1 -oE '^  [A-Z][0-9]+[a-z]? +FAILS' <<<"$answers" | awk '{ print $1 }' || true)
    case $code in
        0) verdict="NOT NOTICED" unseen=$((unseen + 1)) ;;
        124) verdict="does not end" ;;
        *) verdict="row ${row:-none: exit code $code}" ;;
    esac
    printf '%-14s %s: %s -> %s\n' "$verdict" "$file" "$OLD" "$NEW"
done < <(grep -F -- "${1:-|}" "$here/list.txt" | sed 's/\\|/\x01/g')
echo "$((count - unseen)) of $count corruptions noticed"
exit $((unseen > 0))
