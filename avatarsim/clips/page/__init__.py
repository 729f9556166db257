"""Pages of a folder of clips: a summary, and of each clip one that plays it before and after; they hold everything they show."""
