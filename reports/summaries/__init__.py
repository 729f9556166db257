"""What is said beside the pages: summary.md, junit.xml, the README's table, the baseline and what changed against it."""
