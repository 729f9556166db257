"""Work-precision sweep: every engine over a dozen settings of its own knobs, on scenes that tell; resumable by content."""
