"""Speed beside accuracy: ratios against what one would otherwise use, taken in one run."""
