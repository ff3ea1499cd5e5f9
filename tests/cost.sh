#!/usr/bin/env bash
# Measures three examples and draws the plots of examples/cost.md anew, with the figures beside them, on the first graphics
# device there is. Other arguments are given to `sdfc cost`, such as --device nvidia.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release -p sdfc
mkdir -p examples/cost
for scene in smallest carved colonnade; do
  target/release/sdfc cost "examples/$scene.sdf" --plot "examples/cost/$scene.svg" --csv "examples/cost/$scene.csv" "$@"
done
