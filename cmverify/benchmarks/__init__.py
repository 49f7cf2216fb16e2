"""asv's benchmarks: the same `Case` objects and the kernel, tracked over the project's history."""
