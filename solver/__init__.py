"""Coupled dynamics of hinged wave energy converters on elastic platforms."""
