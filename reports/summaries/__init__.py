"""Short forms of a report: terminal, summary.md, junit.xml, the table of the README, the baseline."""
