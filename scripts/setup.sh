#!/usr/bin/env bash
# Installs what debian-packages.txt lists, as far as it is missing; with --tests also what debian-packages-tests.txt lists, Node.js and
# cargo-nextest; with --lint Node.js and, into tools/node_modules, the linter of the report's scripts.
# Works as root or with sudo.
set -euo pipefail
cd "$(dirname "$0")/.."

lists=(debian-packages.txt)
[ "${1:-}" != "--tests" ] || lists+=(debian-packages-tests.txt)
mapfile -t packages < <(grep -hvE '^[[:space:]]*(#|$)' "${lists[@]}")
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done

# Node.js may be another than Debian's.
[ "${1:-}" != "--tests" ] || command -v node >/dev/null || missing+=(nodejs)
[ "${1:-}" != "--lint" ] || command -v npm >/dev/null || missing+=(npm)

if [ "${#missing[@]}" -gt 0 ]; then
  echo "installing ${missing[*]}"
  root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "not root and no sudo: install these packages by hand: ${missing[*]}" >&2; exit 1; }
    root=(sudo)
  fi
  "${root[@]}" apt-get update -q
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
fi

command -v cargo >/dev/null || { echo "Rust is missing: see https://rustup.rs" >&2; exit 1; }
if [ "${1:-}" = "--lint" ] && [ ! tools/node_modules/.package-lock.json -nt tools/package-lock.json ]; then
  npm ci --prefix tools --no-audit --no-fund
fi
if [ "${1:-}" = "--tests" ] && ! cargo nextest --version >/dev/null 2>&1; then
  cargo install --locked cargo-nextest
fi

case "$(readlink -f /usr/lib/x86_64-linux-gnu/libblas.so.3 2>/dev/null)" in
  *openblas* | *mkl* | *blis* | "") ;;
  *) echo "warning: libblas.so.3 is the reference BLAS; choose a fast one: update-alternatives --config libblas.so.3-x86_64-linux-gnu" >&2 ;;
esac
