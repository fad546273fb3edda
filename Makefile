# make demo: from a fresh clone to a table. make test: everything that is checked. Both install what they need below .sumo/.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help demo dist wheel test bytes matrix tuning chaos day fuzz mutants coverage bench book setup setup-test clean

controllers ?= ideal,classic,adaptive,calibrating,pid
seeds ?= 1..3
gains ?= 2
tuned ?= classic,adaptive,calibrating,pid,smith_pi,lqi,mpc
chaos_seed ?= 1
chaos_n ?= 320
fuzz_cases ?= 1000000
fuzz_seed ?= 1
room ?= plant control traci cosim stats
mutants_tests := coupling plant slots group_law same_bits commonroad traci_wire traci self_check live

help: ## Show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  make \1\t/' | expand -t 20

demo: ## A city whose cars answer late and measure with noise: compare five controllers, one table and one page
	cargo build --release --locked
	.ci/with-sumo target/release/sumo-mfc compare scenarios/demo.toml --controllers $(controllers) --seeds $(seeds) -o out/demo

test: setup-test ## All tests, examples and documentation tests, on real SUMO 1.28.0 and 1.15.0
	cargo test --release --locked
	@.ci/libsumo
	@.ci/python

dist: ## A static Linux program with manual pages, completions and a list of its parts, packed into target/dist/
	.ci/dist

wheel: ## The Python package as a wheel for manylinux_2_28: target/python/wheels/ (needs python3 with venv)
	@.ci/python wheel

bytes: setup-test ## Compare the bytes of eight simulations and the paper's tests with the recorded ones
	cargo build --release --locked
	tests/bytes.sh target/release/sumo-mfc target/bytes --check

matrix: setup-test ## Every controller in eighteen conditions on four networks beside `ideal`, one line per run (an hour and a half); laws=classic,mpc for some
	$(if $(laws),SUMO_MFC_MATRIX_LAWS=$(laws)) cargo test --release --locked --test matrix -- --ignored --nocapture

tuning: ## Tune every law with as many gains on the same drives, and judge them on others, in twenty-two conditions (a quarter of an hour)
	cargo build --release --locked
	target/release/sumo-mfc tune scenarios/tuning/vehicle.toml -o out/tuning --gains $(gains) --trials 60 \
	  --controllers $(tuned) \
	  --train scenarios/paper/data/udds.csv --test scenarios/paper/data/hwfet.csv scenarios/paper/data/racing_lap.csv \
	  --condition "as it is:" \
	  --condition "noise of -6 dB: noise.power_db=-6" \
	  --condition "noise of 0 dB: noise.power_db=0" \
	  --condition "lag 0.3 s: actuator.lag_s=0.3" \
	  --condition "dead time 0.1 s: actuator.delay_s=0.1" \
	  --condition "dead time 0.25 s: actuator.delay_s=0.25" \
	  --condition "dead time 0.5 s: actuator.delay_s=0.5" \
	  --condition "half the mass: vehicle.mass_factor=0.5" \
	  --condition "twice the mass: vehicle.mass_factor=2" \
	  --condition "half the friction: vehicle.friction_factor=0.5" \
	  --condition "twice the mass, dead time 0.25 s: vehicle.mass_factor=2 actuator.delay_s=0.25" \
	  --condition "told four times the torque: law.torque_scale=4" \
	  --condition "told a quarter of the torque: law.torque_scale=0.25" \
	  --condition "slope of 5 %: road.grade=0.05" \
	  --condition "slope of -5 %: road.grade=-0.05" \
	  --condition "hills of 5 %, 400 m apart: road.grade=0.05 road.hill_m=400"
	target/release/sumo-mfc tune scenarios/tuning/vehicle.toml -o out/tuning_constant --gains $(gains) --trials 60 \
	  --controllers $(tuned) \
	  --train scenarios/paper/data/udds.csv --test scenarios/tuning/constant.csv \
	  --condition "as it is:" \
	  --condition "told four times the torque: law.torque_scale=4" \
	  --condition "told a quarter of the torque: law.torque_scale=0.25" \
	  --condition "four times, dead time 0.25 s: law.torque_scale=4 actuator.delay_s=0.25" \
	  --condition "a quarter, dead time 0.25 s: law.torque_scale=0.25 actuator.delay_s=0.25"
	target/release/sumo-mfc tune scenarios/tuning/vehicle.toml -o out/tuning_limits --gains $(gains) --trials 60 \
	  --controllers $(tuned) \
	  --train scenarios/paper/data/udds.csv --test scenarios/paper/data/hwfet.csv scenarios/paper/data/racing_lap.csv \
	  --condition "as it is:" \
	  --condition "control period 5 ms: coupling.control_period_s=0.005" \
	  --condition "control period 50 ms: coupling.control_period_s=0.05" \
	  --condition "5 ms, dead time 0.25 s: coupling.control_period_s=0.005 actuator.delay_s=0.25" \
	  --condition "50 ms, dead time 0.25 s: coupling.control_period_s=0.05 actuator.delay_s=0.25" \
	  --condition "limits of 3 m/s²: vehicle.drive_torque_max_nm=1547 vehicle.brake_torque_max_nm=1547" \
	  --condition "limits of 3 m/s², dead time 0.25 s: vehicle.drive_torque_max_nm=1547 vehicle.brake_torque_max_nm=1547 actuator.delay_s=0.25"

chaos: setup-test ## Strike runs at random times chaos_n=320 times: kills, cut sockets, full disks; one table (chaos_seed=1)
	CHAOS_SEED=$(chaos_seed) CHAOS_N=$(chaos_n) cargo test --release --locked --test chaos -- --ignored --nocapture

day: setup-test ## A day of simulated time with 200 vehicles on the road: memory, open files, clock, odometer (ten minutes)
	cargo test --release --locked --test memory -- --ignored --nocapture law_a_day

fuzz: ## Changed files against everything that reads them; fuzz_cases=10000000 takes a night, fuzz_seed=2 makes other cases
	SUMO_MFC_FUZZ_CASES=$(fuzz_cases) SUMO_MFC_FUZZ_SEED=$(fuzz_seed) cargo test --release --locked --test fuzz -- --nocapture

mutants: setup-test ## Change the code in every small way, or room=cosim alone, and list what no test notices (two hours)
	@cargo mutants --version >/dev/null 2>&1 || { echo "cargo-mutants is missing, which lists the changes: cargo install cargo-mutants" >&2; exit 1; }
	cargo build --release --locked --manifest-path tests/mutants/Cargo.toml --target-dir target/mutants-tool
	.ci/with-sumo target/mutants-tool/release/sumo-mfc-mutants --survivors tests/mutants/survivors.txt $(addprefix src/,$(room)) -- \
	  --locked --profile mutants --lib $(foreach test,$(mutants_tests),--test $(test)) \
	  $$(command -v g++ >/dev/null && echo --features libsumo --test libsumo)

coverage: setup-test ## Lines and functions that tests reach, by room, with cargo-llvm-cov (half an hour)
	@.ci/with-sumo .ci/coverage

bench: setup-test ## The benchmarks, one line per figure: whole processes, then parts, at last up to 20 000 cars (an hour and a half)
	.ci/with-sumo cargo bench --locked --bench whole $$(command -v g++ >/dev/null && echo --features libsumo)
	.ci/with-sumo cargo bench --locked --bench codec --bench fleet --bench plant --bench study --bench scale

book: ## The documentation as a site: target/site/docs/index.html (installs mdBook below .tools/ at the first call)
	@.ci/book

setup: ## Install the pinned SUMO below .sumo/
	@.ci/install 1.28.0

setup-test: ## Install what the tests need: three versions of SUMO, foreign networks (sumo-rl), and what SUMO's plots need
	@.ci/install 1.28.0 1.15.0 1.14.1 sumo-rl==1.4.5 +matplotlib==3.10.9

clean: ## Remove what was built and written; .sumo/ and .tools/ stay
	cargo clean
	rm -rf out
