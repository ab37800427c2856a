"""Text and tables of the benchmark report, which plots/report.py combines with its pictures."""
