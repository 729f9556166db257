"""A run: jobs in processes, an accuracy pass, a timing pass, rows and files."""
