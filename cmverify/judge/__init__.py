"""Measurements judged: norms, orders, bounds, work against precision."""
