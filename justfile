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

# Run a plan: rows in results/runs, table and figures in reports/out
bench plan="paper":
    cargo run --release -- bench {{plan}}

# Time the kernels alone
bench-kernels:
    cargo bench --package harness --bench kernels

# Draw the figure of the README anew
readme: bench
    cp reports/out/paper/convergence-shear-box-991-sheared.svg reports/readme.svg

# Make the frozen problems anew, into FOLDER
freeze folder:
    cargo run --release -- freeze settled-box --scene sample.grains=991 --scene scene.box.width_m=4.75 --time-step 1000 --set preconditioner=diagonal -o {{folder}}/settled-991.json
    cargo run --release -- freeze shear-box-991 --time-step rest --set preconditioner=diagonal -o {{folder}}/shear-box-991-rest.json
    cargo run --release -- freeze shear-box-991 --time-step onset --set preconditioner=diagonal -o {{folder}}/shear-box-991-onset.json
    cargo run --release -- freeze shear-box-991 --time-step sheared --set preconditioner=diagonal -o {{folder}}/shear-box-991-sheared.json
