"""The command line: study plan|run|status|show|rerun|collect|verify|report|clean STUDY.

Imports every other room, the heavy ones inside functions.
"""
