"""Folder and page of a flight schedule."""
