python = .venv/bin/python
.PHONY: environment run test check package docs bench evaluate figures test-window guide-pictures

environment:
	@for each in python3 python3.11 python3.13; do \
	  $$each -c '' 2>/dev/null && exec $$each tests/environment.py; done; echo "Python 3.11 or 3.13 is needed."; exit 1

run: environment
	$(python) tests/sample/run.py

test: environment
	$(python) -m pytest

check: environment
	$(python) -m ruff format --check .
	$(python) -m ruff check .
	$(python) -m mypy

package: environment
	$(python) tests/package.py

docs: environment
	$(python) docs/make_reference.py

bench: environment
	$(python) tests/benchmarks/form_tables.py $(DATA)
	$(python) tests/benchmarks/contact_sheet.py build/benchmarks/gallery.npz docs/pictures/contact-sheet.png

evaluate: environment
	$(python) -m addon evaluate $(DATA) --output build/evaluation

figures: environment
	$(python) tests/figures/run.py $(DATA)

test-window: environment
	$(python) tests/window/run.py $(if $(BLENDER),--blender $(BLENDER)) $(if $(MESH),--mesh $(MESH))

guide-pictures: environment
	$(python) tests/window/run.py --session tests/window/guide_pictures.py --pictures docs/pictures/guide \
	  $(if $(BLENDER),--blender $(BLENDER))
