"""Envelopes of a cockpit: each axis by itself, and each linked pair."""
