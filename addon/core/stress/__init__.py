"""Pairs of points and what each wants, and the majorisation that lowers the stress of them all."""
