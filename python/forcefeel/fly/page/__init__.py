"""The page of an aircraft flown through a loader."""
