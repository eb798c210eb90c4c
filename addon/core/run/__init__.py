"""Errors, messages, progress and cancellation, stages kept between runs, the memory limit."""
