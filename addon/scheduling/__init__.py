"""Work for many processes, of this machine or of a Dask cluster; one that dies costs its own piece of work only."""
