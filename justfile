# What a contributor does; `.ci/run` does the same.

# The whole of what CI does
ci:
    bash .ci/run

# Build, and run the main job
quickstart:
    cargo run --release -- run scenarios/quickstart.toml

# Write results/ again: the paper's evaluation, every hold simulated
reproduce:
    cargo run --release -- reproduce

# Every test
test:
    cargo test --release

# Format and lint
lint:
    cargo fmt --check
    cargo clippy --release --all-targets -- -D warnings

# The Python package's wheel, in target/wheels (needs maturin)
wheel:
    maturin build --locked --manifest-path python/Cargo.toml --out target/wheels

# Every scenario
scenarios:
    cargo run --release -- run scenarios/*.toml

# Write the JSON Schemas again after a change of the file formats
schemas:
    for of in scenario plan verdict staged-plan staged-verdict sweep replan-request replan-answer; do cargo run --release -- schema $of > schemas/$of.schema.json; done

# Write the expected messages under tests/snapshots again after a change that is meant
snapshots:
    INSTA_UPDATE=always cargo test --release --test cli messages

# Write the warm starts that come with the program again after a change of the planner that is meant (minutes)
maps:
    BENCHDOG_WRITE_MAPS=1 cargo test --release --test cli maps_of_the_program

# Write the plans of `benchdog init` again after a change of the planner or of their scenarios
init-plans:
    tools/init_plans.py target/release/benchdog

# Draw the pictures of docs/verdicts.md again after a change of the drawings
verdict-pictures:
    tools/draw_verdicts.py docs/verdicts

# Advisories, licences and sources of the dependencies (needs cargo-deny, and the network)
deny:
    cargo deny check advisories licenses bans sources

# Damaged input files, 15 s of each of eight kinds
fuzz:
    bash .ci/run fuzz_inputs

# Which changes of the judge and the statics no test notices: one in 46, round robin (needs cargo-mutants)
mutants shard="0/46":
    cargo mutants --shard {{shard}} --sharding round-robin
