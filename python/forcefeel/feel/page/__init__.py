"""The page of a fitted feel."""
