"""Distributes work to processes of this machine or of a Dask cluster; one that dies loses only its own task."""
