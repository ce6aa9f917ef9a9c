#!/bin/sh
# The samples of `cargo bench --bench lab`, put to NumPy and pysindy. Makes a
# Python environment of its own in the folder given (else a temporary one).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=${1:-$(mktemp -d)}
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet numpy==2.4.6 pysindy==2.1.0
export FERNTAST_BENCH_SAMPLES="$folder/samples.f64"
# The whole workspace, as `tests/run` selects it: else Cargo compiles the middleware anew.
(cd "$here/../.." && cargo bench --workspace --bench lab)
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$folder/venv/bin/python" "$here/lab_peers.py" "$FERNTAST_BENCH_SAMPLES"
