"""The folder and the page of what this wing computes."""
