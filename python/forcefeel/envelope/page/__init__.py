"""Folder and page of an envelope."""
