# The commands of this project; README.md says what each leaves behind.
.PHONY: deps build demo test bench benchmark-logs grade reuse parameters lint format fuzz sanitize clean

deps:
	@scripts/install_dependencies.sh

build: deps
	@scripts/build.sh

demo: deps
	@scripts/demo.sh

test: deps
	@scripts/test.sh

bench: deps
	@scripts/bench.sh

# LOGS: a folder of CARMEN logs with their relations
benchmark-logs: build
	@bash -c 'source scripts/environment.sh && source devel/setup.bash && scripts/benchmark_logs.py "$(abspath $(LOGS))" results/logs'

# SEEDS: one run of every scenario for each
grade: deps
	@scripts/grade.sh $(SEEDS)

# SEED: of the noise
reuse: build
	@bash -c 'source scripts/environment.sh && source devel/setup.bash && scripts/reuse.py --seed $(or $(SEED),1)'

parameters: build
	@devel/lib/ramscout_bringup/parameter_reference .

lint: deps
	@scripts/lint.sh

format:
	@clang-format -i $$(git ls-files '*.hpp' '*.cpp')

# SECONDS: for each target
fuzz: deps
	@scripts/fuzz.sh $(or $(SECONDS),60)

sanitize: deps
	@scripts/sanitize.sh

clean:
	rm -rf build build_fuzz devel install
