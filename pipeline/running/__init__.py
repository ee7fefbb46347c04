"""Tasks in hand: batches, the pool that they run on, and what is kept of each.

Imports `bridge` and below; `schedule` alone knows dask.
"""
