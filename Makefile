# squeal: `make demo` shows a brake that squeals, `make test` passes the tests. Both set up what they need.

export OPENBLAS_NUM_THREADS := 1
# A test with a missing or changed snapshot fails and writes nothing; `INSTA_UPDATE=always make test` accepts all.
export INSTA_UPDATE ?= no
size_coarse  := 1
size_small   := 1
size_medium  := 2
size_fine    := 3
size_full    := 3
size_million := 4
size_hexahedra := 2
options_hexahedra := -setnumber extruded_disc 1
BINARY := target/release/squeal
RANKS  ?= 2
MPIRUN := mpirun --bind-to none -n $(RANKS)
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_btl_vader_single_copy_mechanism := none
export OMPI_MCA_rmaps_base_oversubscribe := 1

.PHONY: help install deb demo demo-deck explore test python-test report-test calculix td1 validation docs full fuzz bench lint setup build clean
.DELETE_ON_ERROR:

help: ## print this list
	@grep -hE '^[a-z0-9-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

demo: setup results/demo/report.html ## complex modes of the demo brake (medium mesh), and the report
	@cat results/demo/summary.txt
	@echo "\nopen results/demo/report.html in a browser"

demo-deck: setup results/demo-deck/report.html ## the same of an Abaqus deck: the demo brake with a disc of hexahedra
	@cat results/demo-deck/summary.txt
	@echo "\nthe deck is meshes/build/brake-hexahedra.inp; open results/demo-deck/report.html in a browser"

explore: setup build meshes/build/brake-small.msh ## vary four parameters of the small demo brake: how probable is squeal?
	@mkdir -p results
	$(MPIRUN) $(BINARY) explore meshes/explore.toml --output results/explore --force --verbose

test: setup meshes/build/brake-small.msh meshes/build/td1-coarse.msh ## run all tests
	@scripts/setup.sh --tests
	cargo nextest run --workspace --release
	cargo test --workspace --release --doc
	node --test tests/page/*.test.mjs
	$(MAKE) python-test

python-test: setup build ## test the Python package with the tables of the same run
	@scripts/setup.sh --tests
	SQUEAL=$(CURDIR)/$(BINARY) MODEL=tests/data/pads_on_disc.toml PYTHONPATH=python /usr/bin/python3 -m pytest -q -p no:cacheprovider python/tests

validation: setup $(patsubst %,meshes/build/td1-%.msh,coarse medium fine) ## write docs/validation.md: results beside exact solutions and results of other programs
	@scripts/setup.sh --tests
	cargo nextest run --release --test validation --run-ignored only

calculix: setup ## compare modes with CalculiX on the same meshes
	@scripts/setup.sh --tests
	cargo nextest run --release --test physics --no-capture -E 'test(/^calculix::/)'

report-test: setup ## test the report's page in a browser
	@scripts/setup.sh --tests
	cargo nextest run --release --test cli -E 'test(/^browser::/)'

td1: setup meshes/build/td1-coarse.msh ## compare a whole brake with the frequencies that Ansys publishes
	@scripts/setup.sh --tests
	cargo nextest run --release --test validation --no-capture -E 'test(/^td1::/)'

FUZZ_SECONDS ?= 450

fuzz: setup ## read damaged files of every format, FUZZ_SECONDS (450) for each
	@scripts/setup.sh --tests
	SQUEAL_FUZZ_SECONDS=$(FUZZ_SECONDS) cargo nextest run --test fuzz --no-capture --no-fail-fast

docs: build ## build the manual: target/manual/index.html
	@scripts/docs.sh $(BINARY) target/manual

full: setup build meshes/build/brake-full.msh ## complex modes of the demo brake with 179 thousand nodes on $(RANKS) ranks
	$(MPIRUN) $(BINARY) stability meshes/brake-full.toml --friction 0.1:0.9:0.1 --output results/full --force --verbose

bench: setup meshes/build/brake-medium.msh meshes/build/brake-small.msh ## measure time and memory of assembly, factorisation and eigensolution
	cargo bench --bench element
	cargo bench --bench assembly
	cargo bench --bench path
	cargo bench --bench equilibria
	cargo bench --bench features

lint: setup ## check formatting, clippy, documentation and the page's scripts; warnings are errors
	@scripts/setup.sh --lint
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --release -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --release
	tools/node_modules/.bin/biome check --config-path=tools/biome.json --error-on-warnings src/report/assets tests/page

setup: ## install missing system packages
	@scripts/setup.sh

build: setup ## build the optimised binary
	cargo build --release

PREFIX  ?= /usr/local
DESTDIR ?=
SHARE    = $(DESTDIR)$(PREFIX)/share

install: build ## install the program, its manual pages and completions below PREFIX (/usr/local)
	install -Dm755 $(BINARY) $(DESTDIR)$(PREFIX)/bin/squeal
	install -d $(SHARE)/man/man1 $(SHARE)/bash-completion/completions $(SHARE)/zsh/site-functions $(SHARE)/fish/vendor_completions.d
	$(BINARY) man $(SHARE)/man/man1
	$(BINARY) completions bash > $(SHARE)/bash-completion/completions/squeal
	$(BINARY) completions zsh > $(SHARE)/zsh/site-functions/_squeal
	$(BINARY) completions fish > $(SHARE)/fish/vendor_completions.d/squeal.fish

deb: build ## build a Debian package: target/debian
	@command -v cargo-deb >/dev/null || cargo install cargo-deb --locked
	rm -rf target/package
	$(MAKE) install DESTDIR=target/package PREFIX=/usr
	cargo deb --no-build

clean: ## remove everything that can be built again
	cargo clean
	rm -rf meshes/build results

$(BINARY): $(shell find src sys Cargo.toml Cargo.lock build.rs -type f 2>/dev/null)
	cargo build --release
	@touch $@

meshes/build/brake-%.msh: meshes/brake.geo | setup
	@mkdir -p $(@D)
	gmsh -3 $< -setnumber size $(size_$*) $(options_$*) -o $@ > $@.log

meshes/build/td1-%.msh: meshes/td1.geo | setup
	@mkdir -p $(@D)
	gmsh -3 $< -setnumber size $(size_$*) -o $@ > $@.log

results/demo/summary.txt: $(BINARY) meshes/brake-medium.toml meshes/build/brake-medium.msh
	$(MPIRUN) $(BINARY) stability meshes/brake-medium.toml --friction 0.1:0.9:0.1 --output results/demo --force --verbose > /dev/null

meshes/build/brake-hexahedra.inp: $(BINARY) meshes/brake-hexahedra.toml meshes/build/brake-hexahedra.msh
	$(BINARY) convert meshes/brake-hexahedra.toml -o $@ --force

results/demo-deck/summary.txt: $(BINARY) meshes/build/brake-hexahedra.inp
	$(MPIRUN) $(BINARY) stability meshes/build/brake-hexahedra.inp --friction 0.1:0.9:0.1 --output results/demo-deck --force --verbose > /dev/null

results/%/report.html: results/%/summary.txt
	$(BINARY) report results/$* --force > /dev/null
