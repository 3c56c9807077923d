"""Folder and page of a comparison of laws."""
