"""What is on the disk: statuses and records of tasks, netCDF, and the dataset collected from them.

Imports `tasks` and `study`.
"""
