# The commands of this project; README.md says what each leaves behind.
.PHONY: deps build test demo bench benchmark-logs lint format clean

deps:
	@scripts/install_dependencies.sh

build: deps
	@scripts/build.sh

demo: deps
	@scripts/demo.sh

test: deps
	@scripts/test.sh

clean:
	rm -rf build devel install
