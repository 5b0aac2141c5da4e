# Furrow's recipes. `./tools/run RECIPE` installs what is missing first; `just RECIPE` is enough afterwards.

set positional-arguments

python := ".venv/bin/python"
# What links OpenCV: video files, and finding boards in pictures
opencv := "virtual-rig/video,capture-sync/video,calibrate/detect,calibrate/video,normalmap-acquire/video"

# What all pages share, and what they are built with
pages := "crates/shared/loopback/web"

# List the recipes
default:
    @just --list --unsorted

# A whole run on a virtual take: from the footage of eight cameras to pictures of the moving, wrinkled face
[group('use')]
demo *ARGS: build
    @tools/demo "$@"

# The same on your take's folder; asks for what is missing, and goes on where it was stopped: take TAKE [OUT] [OPTIONS]
[group('use')]
take *ARGS: build
    @tools/take "$@"

# Parts of it on real recordings; says what is missing if their folder is not there
[group('use')]
demo-real *ARGS: build
    @tools/demo-real "$@"

# From a take's footage to clean markers in 3D, with a table and pictures: capture TAKE [OUT] [OPTIONS]
[group('use')]
capture *ARGS: build
    @tools/capture "$@"

# From a take's footage and painted masks to the wrinkles' cross-sections, with a table and pictures: wrinkles TAKE [OUT] [OPTIONS]
[group('use')]
wrinkles *ARGS: build
    @tools/wrinkles "$@"

# Pages in a browser for what only people can do: names of dots, picks on the scan, paint: workbench TAKE [RUN] [OPTIONS]
[group('use')]
workbench *ARGS: build
    @tools/workbench "$@"

# A take of the virtual rig with its truth: virtual-take NAME [OUT] [OPTIONS], e.g. standard-2-short; alone it lists the names
[group('use')]
virtual-take *ARGS:
    @tools/virtual-take "$@"

# Say where each real data set comes from, under which licence, and where to put it
[group('use')]
fetch-data *ARGS:
    @tools/fetch-data "$@"

# Build all stages, optimised, into target/release
[group('use')]
build:
    cargo build --release --workspace --bins --features {{ opencv }}

# Everything that must hold before a change lands
[group('check')]
test: house _pages
    cargo fmt --all --check
    @python3 tools/peers/test_board.py --quiet
    cargo clippy --workspace --all-targets --features {{ opencv }},suite/video --locked --quiet -- -D warnings
    cargo test --workspace --features {{ opencv }},suite/video --locked

# The rules of the house: floors, flow of artifacts, anatomy, citations, drawings
[group('check')]
house:
    @cargo run --quiet --package house -- check

# Read every golden artifact with the small NumPy readers
[group('check')]
readers-check *ARGS: _python
    @{{ python }} tools/readers/check.py "$@"

# Accuracy of a stage (or `all`) against its targets: score STAGE [--seeds 1,2,3] [--json]
[group('measure')]
score STAGE *ARGS: (_python "peers")
    @{{ python }} tools/peers/board.py score "$@"

# Speed and memory of a stage (or `all`) against named peers: bench STAGE [--json]
[group('measure')]
bench STAGE *ARGS: (_python "peers")
    @{{ python }} tools/peers/board.py bench "$@"

# Build the pages that stages serve; what it writes is committed, and embedded in the binaries
[group('build on it')]
web: _pages
    npm --silent --prefix {{ pages }} run check
    npm --silent --prefix {{ pages }} run build

# Lay the ground for a new stage
[group('build on it')]
new-stage NAME:
    @cargo run --quiet --package house -- new-stage "$1"

# Redraw the README's stage table and the pipeline picture
[group('build on it')]
drawings:
    @cargo run --quiet --package house -- table --write
    @cargo run --quiet --package house -- picture --write

# The libraries' documentation
[group('build on it')]
docs *ARGS:
    cargo doc --workspace --no-deps "$@"

# The Python environment of peers and readers, made on first use
_python *PARTS:
    @tools/peers/environment "$@"

# The packages of pages, installed where npm is and its lock file has changed; their tests say `skipped` without
_pages:
    @cmp --silent {{ pages }}/package-lock.json {{ pages }}/node_modules/.installed || tools/pages
