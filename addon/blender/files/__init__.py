"""Files in and out: which kinds there are, what may be read and written, and nothing left there in part."""
