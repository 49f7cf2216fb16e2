"""The harness: cases, runs, reports, benchmarks."""
