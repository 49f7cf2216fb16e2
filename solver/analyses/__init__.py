"""What is done with a scene: each analysis is a function over it and returns a `Result`."""

from .registry import Analysis, analyses

__all__ = ["Analysis", "analyses"]
