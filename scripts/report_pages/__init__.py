"""The pages of the benchmark report, which plots/report.py writes around its pictures."""
