#!/usr/bin/env bash
# Builds the manual: docs.sh BINARY FOLDER. The help texts come from the binary. mdBook is installed if it is missing.
set -euo pipefail
binary=$(realpath "$1")
folder=$(realpath -m "$2")
cd "$(dirname "$0")/.."
version=0.5.4 # builds with Rust 1.88 or later

if ! command -v mdbook >/dev/null; then
  # Without optimisation it is built in a third of the time, and takes seconds for the manual.
  cargo install mdbook --debug --locked --version "$version" --no-default-features --features search
fi

generated=docs/manual/src/generated
mkdir -p "$generated"
"$binary" --help > "$generated/squeal.txt"
for command in $(sed -n 's/^## //p' docs/manual/src/commands.md); do
  "$binary" "$command" --help > "$generated/$command.txt"
done

mdbook build docs/manual --dest-dir "$folder"
scripts/check_links.py "$folder"
