# Coaxial: `make demo` runs four targets end to end; `make test` proves the tree.
PYTHON ?= python3.11
VENV   := .venv
BENCH_VENV := .venv-bench
BIN    := $(VENV)/bin
# Hours of results, which go on where they ended: a new environment must not take them away.
RESULTS := var
PIP    := $(BIN)/pip install --quiet --disable-pip-version-check
# Many small matrices: threads of the linear algebra only fight over two cores.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

.DEFAULT_GOAL := help
.PHONY: $(shell grep -oE '^[a-z-]+:' Makefile | tr -d ':')

help:  ## this list
	@grep -hE '^[a-z-]+:.*## ' Makefile | sed 's/:.*## /\t/' | expand -t 12

demo: $(VENV)/.runtime  ## four pedicle screws, from C-arm to sleeve, in a simulated room
	$(BIN)/coaxial demo

run: $(VENV)/.runtime  ## leave the service and the simulated room up; prints address and sign-in
	$(BIN)/coaxial demo --stay

test: check tests  ## everything that must hold before a change lands

check: $(VENV)/.test  ## formatting, lint, types, import contracts
	$(BIN)/ruff format --check --quiet .
	$(BIN)/ruff check --quiet .
	$(BIN)/mypy
	$(BIN)/lint-imports

# What every database must do alike: records that refuse changes, the ledger, contested writes. The rest on demand.
ON_POSTGRESQL := $(addprefix tests/service/,ledger test_contested_permits.py test_engines.py test_event_store.py test_migrations.py)

# What keeps real time (the arm's 125 Hz, a heartbeat's 200 ms) mostly waits: two files at a time disturb one another
# little, calculations beside them would.
tests: $(VENV)/.test
	@for need in dcmtk:storescu dicom3tools:dciodvfy orthanc:Orthanc postgresql:pg_lsclusters chromium:chromium strace:strace nginx-light:nginx; do command -v $${need#*:} >/dev/null || \
	  { echo "missing Debian package: apt-get install $${need%:*}"; exit 1; }; done
	$(BIN)/python -m pytest -n 2 -m "not real_time"
	$(BIN)/python -m pytest -n 2 --database postgresql $(ON_POSTGRESQL)
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "real_time and not matrix and not lengthy"

bench-stop: $(VENV)/.test  ## how soon a stop is on the wire under full load; COUNT=2000 trials of KINDS, or MINUTES, in ROOMS=1, kinds side by side; kept in FOLDER
	$(BIN)/python -m benchmarks.stop --count $(or $(COUNT),2000) $(if $(KINDS),--kinds $(KINDS)) \
	  $(if $(MINUTES),--minutes $(MINUTES)) --rooms $(or $(ROOMS),1) --folder $(or $(FOLDER),$(RESULTS)/stop)

evidence: $(VENV)/.test  ## sequences against a model, kills, a soak, power cuts, full disks, flipped bits, contested permits, hostile input, and docs/evidence.md; goes on where it ended; SHARE=1 of ITEMS (0: the page alone), PROCESSES=2; results in docs/evidence.json, every trial in FOLDER
	$(BIN)/python -m benchmarks.evidence --folder $(or $(FOLDER),$(RESULTS)/evidence) --share $(or $(SHARE),1) \
	  --processes $(or $(PROCESSES),2) $(if $(ITEMS),--items $(ITEMS)) --page docs/evidence.md

fault-matrix: $(VENV)/.test  ## every fault in every state of a motion, over the real protocols
	$(BIN)/python -m pytest tests/robot/test_fault_matrix.py -v

test-tablet: $(VENV)/.test  ## the tablet in Debian's Chromium, by touch alone, with what make test leaves out
	$(BIN)/python -m pytest -m tablet

explore: $(VENV)/.test  ## new examples for the tests of properties, which make test runs with the same ones each time
	HYPOTHESIS_PROFILE=explore $(BIN)/python -m pytest -n 2 -m "hypothesis and not real_time"

test-kills: $(VENV)/.test  ## SIGKILL of the service in every state of a case
	$(BIN)/python -m pytest tests/system/test_service_killed.py -v

tablet-speed: $(VENV)/.test  ## first screen, image on screen, frames of a window drag in Chromium; COUNT=10 of each
	$(BIN)/python -m benchmarks.tablet_speed --count $(or $(COUNT),10)

pictures: $(VENV)/.test  ## the same, and the documentation's pictures of the tablet taken anew
	COAXIAL_TEST_PICTURES=docs/pictures $(BIN)/python -m pytest -m tablet

test-postgresql: $(VENV)/.test  ## every test that opens a database, on PostgreSQL
	$(BIN)/python -m pytest -n 2 --database postgresql -m "not real_time" tests/service
	$(BIN)/python -m pytest -n 2 --dist loadfile --database postgresql -m real_time tests/service tests/system

bench: $(VENV)/.runtime  ## time register against OpenCV on the images of SAMPLES=folder, or on rendered ones; memory, both cores
	$(BIN)/python benchmarks/speed.py $(SAMPLES)

bench-service: $(VENV)/.runtime  ## from an image to its registration on a tablet, all cores busy: COUNT=100 images; results kept in FOLDER
	$(BIN)/python benchmarks/service_latency.py --count $(or $(COUNT),100) --folder $(or $(FOLDER),$(RESULTS)/service-latency)

bench-load: $(VENV)/.runtime  ## what a command takes while fifty screens follow the case and images are registered; SECONDS=60
	$(BIN)/python benchmarks/load.py --seconds $(or $(SECONDS),60)

bench-archive: $(VENV)/.runtime  ## what each command and list takes in a room with CASES=10000 closed cases, and in one with none; kept in FOLDER
	$(BIN)/python -m benchmarks.archive --cases $(or $(CASES),10000) --folder $(or $(FOLDER),$(RESULTS)/archive)

bench-senders: $(VENV)/.runtime  ## how long a permit's commit waits while four C-arms send COUNT=100 images each (needs dcmtk); SEED=0
	$(BIN)/python benchmarks/four_senders.py --count $(or $(COUNT),100) --seed $(or $(SEED),0)

samples: $(VENV)/.runtime  ## register, flip and turn the images of SAMPLES=folder against their truth
	$(BIN)/python benchmarks/samples.py $(SAMPLES)

scenes: $(VENV)/.runtime  ## register random rendered scenes against their truth; COUNT=12 of each group
	$(BIN)/python benchmarks/scenes.py --count $(or $(COUNT),12)

two-images: $(VENV)/.runtime  ## what the two-image checks see and falsely see; CASES=1000 simulated, PAIRS=20 rendered
	$(BIN)/python benchmarks/two_images.py --cases $(or $(CASES),1000) --pairs $(or $(PAIRS),20)

efficiency: $(VENV)/.runtime  ## targeting error against the bound by the pixels' information; COUNT=12 of each stratum
	$(BIN)/python benchmarks/efficiency.py --count $(or $(COUNT),12)

coverage: $(VENV)/.runtime  ## are the predicted 95 % bounds true: COUNT=1000 scenes, PROCESSES=2; results kept in FOLDER
	$(BIN)/python benchmarks/coverage.py --count $(or $(COUNT),1000) --processes $(or $(PROCESSES),2) \
	  --folder $(or $(FOLDER),$(RESULTS)/coverage)

faulted: $(VENV)/.runtime  ## register COUNT=1000 scenes with one thing wrong each, or of FAULTS=nothing, from seed FIRST=0, PROCESSES=2, and docs/faulted.md; goes on where it ended (COUNT=0: the page alone); results in docs/faulted.json, every scene in FOLDER
	$(BIN)/python -m benchmarks.faulted --count $(or $(COUNT),1000) --first $(or $(FIRST),0) --processes $(or $(PROCESSES),2) \
	  $(if $(FAULTS),--faults $(FAULTS)) --folder $(or $(FOLDER),$(RESULTS)/faulted) --published docs/faulted.json --page docs/faulted.md

interlock-removal: $(VENV)/.test  ## take each interlock out in turn and say which test of the rules fails: INTERLOCKS="at_rest pin"
	$(BIN)/python -m benchmarks.interlock_removal $(if $(INTERLOCKS),--interlocks $(INTERLOCKS))

check-removal: $(VENV)/.test  ## the same with each check of the guard: CHECKS="robot.guard.preflight:24"
	$(BIN)/python -m benchmarks.check_removal $(if $(CHECKS),--checks $(CHECKS))

mutation: $(VENV)/.test  ## change each part of the rules and of the guard in turn: does a test notice? and docs/mutation.md; goes on where it ended; no longer than MINUTES (0: the page alone); results in docs/mutation.json, every trial in FOLDER
	$(BIN)/python -m benchmarks.mutation $(if $(MINUTES),--minutes $(MINUTES)) --folder $(or $(FOLDER),$(RESULTS)/mutation) \
	  --page docs/mutation.md

audit-bench: $(VENV)/.runtime  ## how fast the ledger is written, verified (COUNT=20000 entries) and read (PAGES=1000000)
	$(BIN)/python benchmarks/audit.py --count $(or $(COUNT),20000) --pages $(or $(PAGES),1000000)

trends-bench: $(VENV)/.runtime  ## how soon a drift across cases is flagged, and how often one that is not there; REPORTS=2000 a line
	$(BIN)/python -m benchmarks.trends --reports $(or $(REPORTS),2000)

replay-bench: $(VENV)/.runtime  ## how fast CASES=40 past cases are replayed by 1, 2, ... WORKERS processes
	$(BIN)/python -m benchmarks.replay --cases $(or $(CASES),40) $(if $(WORKERS),--workers $(WORKERS))

side-by-side: $(BENCH_VENV)/.ready  ## other methods on the same images and rooms: COUNT=6 images a group, ROOMS=20; results and plots kept in FOLDER
	$(BENCH_VENV)/bin/python -m benchmarks.side_by_side --count $(or $(COUNT),6) --rooms $(or $(ROOMS),20) \
	  --folder $(or $(FOLDER),$(RESULTS)/side-by-side)

tcp: $(VENV)/.runtime  ## recover a planted TCP error from images, in rooms with every error; COUNT=10 of them
	$(BIN)/python benchmarks/tcp.py --count $(or $(COUNT),10)

format: $(VENV)/.test  ## write the house format
	$(BIN)/ruff format --quiet .
	$(BIN)/ruff check --quiet --fix .

docs: $(VENV)/.test  ## write the generated pages and the README's picture anew
	$(BIN)/python -m workflow.diagram > docs/state-machine.md
	$(BIN)/python -m service.error_page > docs/error-codes.md
	$(BIN)/python -m tests.docs.safety_page > docs/safety.md
	$(BIN)/python -m tests.docs.soup_page > docs/soup.md
	$(BIN)/python -c 'from workflow.diagram import mermaid; print("```mermaid", mermaid().strip(), "```", sep="\n")' > $(VENV)/picture.md
	sed -i -e '/state-machine:begin/,/state-machine:end/{//!d}' -e '/state-machine:begin/r $(VENV)/picture.md' README.md

site: $(VENV)/.test  ## build the documentation as a site, strictly, into FOLDER
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict -f docs/site/mkdocs.yml -d $(abspath $(or $(FOLDER),$(VENV)/site))

sbom: $(VENV)/.test  ## write what the product runs with as CycloneDX, with the hashes of the lock file, to FILE
	$(BIN)/cyclonedx-py requirements requirements.lock --pyproject pyproject.toml --output-reproducible \
	  --spec-version 1.6 -o $(or $(FILE),$(VENV)/sbom.json)

advisories: $(VENV)/.test  ## ask PyPI's advisories for known holes of what the product runs with; needs a network that has them
	@$(BIN)/pip-audit --strict --disable-pip --require-hashes -r requirements.lock || { echo \
	  "Not clean: holes are listed above, or PyPI's advisories gave no answer (offline, behind a mirror) and nothing was audited"; exit 1; }

lock:  ## resolve the three lock files anew (needs uv)
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --extra build \
	  pyproject.toml -o requirements.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --extra build --extra test \
	  -c requirements.lock pyproject.toml -o requirements-test.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --extra bench \
	  --no-emit-package opencv-python-headless -c requirements.lock pyproject.toml -o benchmarks/side_by_side/requirements.lock

$(VENV)/.runtime: requirements.lock pyproject.toml
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "Python 3.11 with venv is needed: apt-get install python3.11 python3.11-venv"; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(PIP) --require-hashes -r requirements.lock
	$(PIP) --no-deps --no-build-isolation --editable .
	@touch $@

$(VENV)/.test: $(VENV)/.runtime requirements-test.lock
	$(PIP) --require-hashes -r requirements-test.lock
	@touch $@

# A venv of its own: opencv-contrib, which has the ellipse finders, installs the same cv2 as opencv-python-headless.
$(BENCH_VENV)/.ready: benchmarks/side_by_side/requirements.lock
	$(PYTHON) -m venv --clear $(BENCH_VENV)
	$(BENCH_VENV)/bin/pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r benchmarks/side_by_side/requirements.lock
	@touch $@
