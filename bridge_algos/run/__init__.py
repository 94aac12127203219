"""Runs: a configuration in, labelled results on disk, tables and figures out."""
