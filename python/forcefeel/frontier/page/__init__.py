"""Folder and page of a frontier."""
