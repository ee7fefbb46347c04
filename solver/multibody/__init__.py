"""Rigid bodies on chains of joints: kinematics and the equations of motion."""
