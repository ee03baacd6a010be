"""Surveys, paths of the hole, and the references of toolfaces."""
