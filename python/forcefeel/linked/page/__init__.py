"""The folder and the page of a run of two linked loaders."""
