"""Sources of the docs site: Markdown pages, and the Python that Sphinx builds them with."""
