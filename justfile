# Every recipe is plain cargo commands: nobody needs just.

# List the recipes
default:
    @just --list

# Format, lint, documentation: what CI asks for
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# All tests
test:
    cargo test --workspace

# Random problems by the ten thousand against linear programmes and exact arithmetic, and what the reference answers (minutes)
fuzz problems="10000":
    PROPTEST_CASES={{problems}} cargo test --release --package solver-tests -- fuzz hazards --nocapture

# Run a plan: rows in results/runs, table and figures in reports/out
bench plan="paper":
    cargo run --release -- bench {{plan}}

# Compare the counts of a plan with the accepted ones
regress plan="regress":
    cargo run --release -- regress {{plan}}

# Accept the counts of a plan
bless plan="regress":
    cargo run --release -- bless {{plan}}

# Time the kernels alone, on packings of so many grains
bench-kernels grains="1000 100000":
    GRAINS="{{grains}}" cargo bench --package harness --bench kernels

# Compare the instructions of the kernels, which a busy machine does not change, with the accepted ones; `--bless` accepts those of now (needs valgrind)
count-instructions *bless:
    .ci/count-instructions {{bless}}

# Bytes of an iteration, and the limits of memory and kernel, on one thread: reports/out/roofline.md
roofline grains="1000 100000 1000000":
    mkdir -p reports/out
    GRAINS="{{grains}}" RAYON_NUM_THREADS=1 cargo bench --package harness --bench roofline | tee reports/out/roofline.md

# Iterations on one thread against all, in turns: reports/out/threads.md
threads grains="50000":
    mkdir -p reports/out
    GRAINS="{{grains}}" cargo bench --package harness --bench threads | tee reports/out/threads.md

# Draw a stored study again, with PNG and PDF
figures plan="paper":
    cargo run --release -- report {{plan}} --png --pdf

# A page that shows how methods come to the impulses of a problem
view problem="shear-box-991-sheared":
    cargo run --release -- view {{problem}}

# The paper's section 5 against our runs: every run, figure and number of reports/giens2009.md from nothing; and, where LaTeX is
# installed, reports/paper.tex with a figure and a table of them
paper: readme
    cargo run --release -- report paper --png --pdf --fill reports/giens2009.md.in
    .ci/paper

# Make the runs of a page and put their rows into results/archive; for `which-method` this takes hours
archive plan:
    cargo run --release -- bench {{plan}}
    mkdir -p results/archive/{{plan}} && cp results/runs/{{plan}}/*.parquet results/archive/{{plan}}

# Static pages of all that the tree holds, in reports/out/site
site:
    cargo run --release -- site -o reports/out/site

# Draw the pages and figures of the tree anew, from studies of counts and from results/archive; an error if one changes
pages:
    .ci/pages

# What users of other codes ask: every run and the numbers of reports/questions.md from nothing; needs the other codes installed
questions:
    cargo run --release -- bench questions
    cargo run --release -- report questions --fill reports/questions.md.in

# Write what is generated in the READMEs anew: plans with their counts, charts, keys of files
documents:
    UPDATE_DOCUMENTS=1 cargo test --package harness --test gravel documents

# Run every command of the README, in a copy of the checkout
try-readme:
    .ci/readme

# Get the contact problems of Siconos' own tests, into cases/foreign (needs curl)
fetch-dumps:
    cd cases/foreign && while read -r _ name; do curl -fsSLO "https://raw.githubusercontent.com/siconos/siconos/6070f0f6fcd9e12457f509211e88a1a583b811bc/numerics/src/FrictionContact/test/data/$name"; done < siconos.sha256
    cd cases/foreign && sha256sum --check --quiet siconos.sha256

# Draw the figure of the README anew
readme: bench
    cp reports/out/paper/convergence-shear-box-991-sheared.svg reports/readme.svg

# Make our frozen problems anew, the shear boxes from the new sample; git then shows what changed
freeze: (freeze-one "settled-box" "400" "settled-60" "--scene sample.grains=60 --scene scene.box.width_m=1.2") (freeze-one "settled-box" "400" "settled-250" "") (freeze-one "settled-box" "1000" "settled-991" "--scene sample.grains=991 --scene scene.box.width_m=4.75") (freeze-one "shear-box-991" "rest" "shear-box-991-rest" "") (freeze-one "shear-box-991" "onset" "shear-box-991-onset" "") (freeze-one "shear-box-991" "sheared" "shear-box-991-sheared" "") (freeze-one "sphere-box" "300" "spheres-250" "")
    cargo run --release -- freeze sphere-box --time-step 300 --scene scene.friction=0.3 --method active-set --tolerance 1e-4 --force -o cases/frozen/rough-spheres-250.json
    cargo run --release -- freeze rough-shear-box --time-step onset --scene scene.friction=0.3 --method active-set --max-iterations 20000 --force -o cases/frozen/rough-991-onset.json
    cargo run --release -- freeze rough-shear-box --time-step sheared --scene scene.friction=0.3 --method active-set --max-iterations 20000 --force -o cases/frozen/rough-991-sheared.json

[private]
freeze-one case moment name scene:
    cargo run --release -- freeze {{case}} --time-step {{moment}} {{scene}} --force -o cases/frozen/{{name}}.json
