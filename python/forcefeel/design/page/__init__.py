"""The report of a design: one page that opens offline, and beside it every number and curve as data."""
