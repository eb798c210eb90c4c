python = .venv/bin/python
.PHONY: environment run test check package docs bench evaluate figures test-window guide-pictures

environment:
	@for each in python3 python3.11 python3.13; do \
	  $$each -c '' 2>/dev/null && exec $$each tools/environment.py; done; echo "Python 3.11 or 3.13 is needed."; exit 1

run: environment
	$(python) tools/sample/run.py

test: environment
	$(python) -m pytest

check: environment
	$(python) -m ruff format --check .
	$(python) -m ruff check .
	$(python) -m mypy

package: environment
	$(python) tools/package.py

docs: environment
	$(python) tools/api_reference.py

bench: environment
	$(python) tools/benchmarks/form_tables.py $(DATA)
	$(python) tools/benchmarks/contact_sheet.py build/benchmarks/gallery.npz docs/pictures/contact-sheet.png

evaluate: environment
	$(python) -m addon evaluate $(DATA) --output build/evaluation

figures: environment
	$(python) tools/figures/run.py $(DATA)

test-window: environment
	$(python) tests/window/run.py $(if $(BLENDER),--blender $(BLENDER)) $(if $(MESH),--mesh $(MESH))

guide-pictures: environment
	$(python) tests/window/run.py --session tools/figures/guide_pictures.py --pictures docs/pictures/guide \
	  $(if $(BLENDER),--blender $(BLENDER))
