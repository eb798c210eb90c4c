"""Runs methods over a dataset and makes tables, a report and figures; not part of the Blender extension.

Needs numpy and scipy, and for some of its parts the packages of the extra ``evaluation`` (see pyproject.toml).
"""
