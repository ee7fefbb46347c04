"""Studies of the solver: from a TOML file to tasks, records, a dataset and a report.

Rooms, each importing those after it: cli; report and running; bridge; results; tasks; study.
"""
