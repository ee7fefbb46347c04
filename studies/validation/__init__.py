"""Published cases beside ours, a module for each subject; `make validate` runs them all."""
