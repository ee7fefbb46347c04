"""The command line: study new|keys|schema, and study plan|run|status|show|rerun|collect|verify|report|clean STUDY.

Imports every other room, the heavy ones inside functions.
"""
