python = .venv/bin/python
bench = $(python) -m tools.benchmarks $(DATA)
.PHONY: help environment run test doctest check package docs bench ablation evaluate figures moving-picture \
  rooms-picture test-window guide-pictures site blenders translations release-check

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-15s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

environment: ## make .venv with what all others use; needs Python 3.11 or 3.13
	@for each in python3 python3.11 python3.13; do \
	  $$each -c '' 2>/dev/null && exec $$each tools/environment.py; done; echo "Python 3.11 or 3.13 is needed."; exit 1

run: environment ## build a posed figure and take its pose out, into build/
	$(python) tools/sample/run.py

test: environment ## all tests, outside and inside Blender
	$(python) -m pytest -n logical --maxprocesses 4 --dist loadfile

doctest: environment ## the examples in the docstrings of the core
	$(python) -m pytest --doctest-modules addon/core

check: environment ## lint, format and, with Python 3.11, types
	$(python) -m ruff format --check .
	$(python) -m ruff check .
	@if $(python) -c 'import sys; sys.exit(sys.version_info >= (3, 12))'; then $(python) -m mypy; \
	else echo "Types were not checked: that needs Python 3.11, since numpy's types differ between versions."; fi

package: environment ## one zip of the extension a platform, into build/
	$(python) tools/package.py

docs: environment ## remake docs/api from the docstrings
	$(python) tools/api_reference.py

translations: environment ## gather what the extension says, for translators, and pack what they wrote
	$(python) tools/translations.py

site: environment ## build the site: the documents, and a repository that Blender installs and updates from
	$(python) -m pip install --quiet --disable-pip-version-check -r tools/site/requirements.txt
	$(python) tools/site/build.py

bench: environment ## measure, and write docs/results.md; DATA=folder of meshes, ONLY=poses,limbs, BODIES=man
	$(bench) $(if $(ONLY),--only $(ONLY)) $(if $(BODIES),--bodies $(BODIES))

ablation: environment ## what each step and constant of the default buys; DATA=folder of meshes
	$(bench) --only ablation $(if $(BODIES),--bodies $(BODIES))

evaluate: environment ## run all methods over a dataset; DATA=folder
	$(python) -m addon evaluate $(DATA) --output build/evaluation

figures: environment ## draw the paper's figures; DATA=folder of meshes
	$(python) tools/figures/run.py $(DATA)

moving-picture: environment ## remake the moving picture of the README
	$(python) tools/figures/moving_picture.py

rooms-picture: environment ## remake the picture of the rooms from the imports of the core
	$(python) tools/figures/rooms.py

release-check: environment ## measure again, hours, and compare with docs/results.md; DATA=folder, TAG=v1.2.3
	$(if $(TAG),$(python) tools/release_check.py $(TAG))
	$(bench) --check $(if $(ONLY),--only $(ONLY))

blenders: ## run the whole suite in every Blender that is a Python module; the table in docs/reviewers.md
	python3 tools/blenders.py $(BLENDERS)

test-window: environment ## a session in a window of Blender; BLENDER=path, MESH=some.obj
	$(python) tests/window/run.py $(if $(BLENDER),--blender $(BLENDER)) $(if $(MESH),--mesh $(MESH))

guide-pictures: environment ## remake the pictures of the user guide; BLENDER=path
	$(python) tests/window/run.py --session tools/figures/guide_pictures.py --pictures docs/pictures/guide \
	  $(if $(BLENDER),--blender $(BLENDER))
