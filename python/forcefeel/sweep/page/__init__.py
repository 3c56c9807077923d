"""The folder and the page of a sweep."""
