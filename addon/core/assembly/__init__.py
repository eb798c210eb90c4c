"""A mesh as pieces; many pieces as one body will live here."""
