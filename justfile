# Lists the chores.
default:
    @just --list --unsorted

# Formats everything.
fmt:
    cargo fmt --all

# Checks style: lints, sizes of files and functions, keys of papers, the README's example.
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    cargo xtask budgets
    cargo xtask references
    cargo xtask readme

# Lints the core for processors with other instructions, and for those with none that it knows.
elsewhere:
    rustup target add aarch64-unknown-linux-gnu wasm32-unknown-unknown
    cargo clippy -p kdray --lib --tests --target aarch64-unknown-linux-gnu -- -D warnings
    cargo clippy -p kdray --lib --target wasm32-unknown-unknown -- -D warnings

# Runs every test.
test:
    .ci/vulkan
    cargo test --workspace

# Measures kdray beside its peers on the meshes of a folder and writes a record.
bench record meshes="../shared/meshes" threads="1,2":
    cargo run --release -p kdray-bench -- run --definition bench/definitions/peers.toml \
        --meshes {{ meshes }} --threads {{ threads }} --embree "$(bench/get-embree)" --output {{ record }}

# Prints a record as the README's tables.
table record:
    cargo run --release -p kdray-bench -- table {{ record }}

# Builds the Python package's wheel, installs it in a clean environment and tests it there.
python:
    python/test

# Builds the Python package's documentation as a site; needs python/requirements.txt.
python-docs:
    cd python && mkdocs build

# Measures the Python package beside Open3D and trimesh; needs it installed.
python-bench record meshes="../shared/meshes":
    python python/bench/compare.py run {{ meshes }}/bunny.ply {{ meshes }}/sponza.ply \
        {{ meshes }}/dragon.ply --output {{ record }}

# Builds the documentation of all crates.
docs:
    RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace

# Does what CI does.
ci:
    .ci/run
