"""One module a benchmark problem; `registry` finds them."""
