"""Hulls, linear potential flow, radiation memory and the loads of the incident wave."""
